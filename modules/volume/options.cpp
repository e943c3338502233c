#include <volume/options.hpp>

namespace tetsuame::volume {

using namelist::between, namelist::for_expert, namelist::up_to;

void declare(namelist::schema& schema, options& all) {
  schema.group("volume", "of a particle");
  schema.add("volume", "consistency", all.consistency.name,
             {.choices = {"none", "tied"},
              .meaning = "of a density or Y that is integrated with the particles' places: none, as in the notes, or "
                         "relaxed to the number density, with dV = m/rho, and p <= 0 allowed"});
  schema.add("volume", "rate", all.consistency.rate,
             for_expert(between(0.0, 1.0, "of 'tied': relaxations in the time in which sound crosses a spacing")));
  schema.group("viscosity", "of liquids");
  schema.add("viscosity", "stress", all.stress,
             {.choices = {"auto", "laplacian", "symmetric"},
              .expert = true,
              .meaning = "laplacian: the notes' sum, div(eta grad v); symmetric: with the transpose of the gradient, "
                         "which viscosities that differ need; auto: symmetric where they do"});
  schema.group("energy", "of a particle");
  schema.add("energy", "variable", all.energy.variable,
             {.choices = {"temperature", "internal_energy"},
              .expert = true,
              .expert_name = "energy_variable",
              .meaning = "which is integrated: the temperature by its own equation, or the internal energy, of which "
                         "pairs exchange as much as they do work, and from which the temperature follows"});
  schema.group("smoothing", "of the pressure, p_i = sum_j Y_j W_ij");
  schema.add("smoothing", "normalise", all.smoothing.normalise,
             {.meaning = "divide by the kernel sum, which on a lattice is not quite 1"});
  auto& o = all.hosono;
  schema.group("hosono", "iteration for Y of programs A and B");
  schema.add("hosono", "solver", o.solver,
             {.choices = {"plain", "under_relaxed", "anderson", "newton"},
              .meaning = "plain as published; the others converge where it does not"});
  schema.add("hosono", "tolerance", o.tolerance,
             for_expert(up_to(1e-2, "converged when max |ln(Y_new/Y)| is below it, or below the rounding error of p")));
  schema.add("hosono", "max_iterations", o.max_iterations,
             for_expert(between(1, 1e7, "passes in one evaluation at most")));
  schema.add(
      "hosono", "relaxation", o.relaxation,
      for_expert(between(0.0, 1.0,
                         "exponent of (Y_new/Y) for under_relaxed and anderson; 0: the least p/K_T of all particles")));
  schema.add("hosono", "anderson_depth", o.anderson_depth,
             for_expert(between(0, 50, "earlier passes that anderson combines")));
}

void resolve(const namelist::schema& schema, options& o, bool contrast) {
  if (o.stress == "auto") o.stress = contrast ? "symmetric" : "laplacian";
  if (o.consistency.rate != consistency_options{}.rate && !o.consistency.ties())
    schema.fail("volume", "rate", "belongs to consistency = 'tied'");
}

}  // namespace tetsuame::volume
