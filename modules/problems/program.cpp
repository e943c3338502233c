#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <problems/make.hpp>
#include <problems/program.hpp>
#include <run/simulation.hpp>

namespace tetsuame::problems {

namespace {

using two_fluids::problem_kind;

bool has(const namelist::document& input, const char* group) {
  return std::ranges::any_of(input.groups(), [&](const auto& g) { return g.name == group; });
}

// A problem and its input.
struct problem_of_input {
  virtual ~problem_of_input() = default;
  virtual void declare(namelist::schema& schema) = 0;
  virtual void complete(const namelist::schema& schema) = 0;
  virtual run::memory_need need() const = 0;
  virtual std::string theory() const { return "there is no theory of this problem\n"; }
  virtual run::common_options& common() = 0;
  virtual std::unique_ptr<run::simulation> make() const = 0;
};

// An iteration ends where sums are known to its tolerance.
void check_precision(const namelist::schema& schema, const liquid::program& scheme, const run::kernel_options& kernel) {
  if (scheme.iterates && kernel.single_pairs())
    schema.fail("kernel", "precision",
                std::string("expected 'double': the iteration for Y of ") + scheme.name +
                    " ends at a tolerance that sums in single precision do not have");
}

// T follows from U where the density is known without it.
void check_energy(const namelist::schema& schema, const liquid::program& scheme, const volume::energy_options& o) {
  if (o.internal() && (scheme.iterates || (scheme.integrates_volume && !scheme.remembers_density)))
    schema.fail("energy", "variable",
                std::string("expected 'temperature': ") + scheme.name +
                    " finds densities at given temperatures, from which these would follow");
}

struct box_at_rest : problem_of_input {
  const liquid::program& scheme;
  hydrostatic::options o;

  explicit box_at_rest(const liquid::program& scheme_) : scheme(scheme_) { o.walls.treatment = scheme.wall; }
  void declare(namelist::schema& schema) override { hydrostatic::declare(schema, o); }
  void complete(const namelist::schema& schema) override {
    hydrostatic::resolve(schema, o);
    check_precision(schema, scheme, o.kernel);
    check_energy(schema, scheme, o.scheme.energy);
  }
  run::memory_need need() const override {
    return run::need_of(o.domain.lattice_particles(), o.kernel.single_pairs() ? 415.0 : 445.0, o.kernel,
                        o.domain.dimension);
  }
  run::common_options& common() override { return o; }
  std::unique_ptr<run::simulation> make() const override { return at_rest(o, scheme); }
};

struct fluids_of_input : problem_of_input {
  problem_kind kind;
  const liquid::program* scheme;
  two_fluids::options o;
  two_fluids::parameters p;

  // The iteration for Y is the cured one: here p < K_T/2 nearly everywhere.
  fluids_of_input(problem_kind kind_, const liquid::program* scheme_) : kind(kind_), scheme(scheme_) {
    if (!scheme) return;
    o.by_program = true;
    o.integrates_volume = scheme->integrates_volume;
    o.integrates_weight = scheme->integrates_weight;
    o.remembers_density = scheme->remembers_density;
    o.by_number = scheme->by_number;
    o.walls.treatment = scheme->wall;
    o.liquid.hosono.solver = "newton";
  }
  void declare(namelist::schema& schema) override { two_fluids::declare(schema, kind, o); }
  void complete(const namelist::schema& schema) override {
    p = two_fluids::resolve(schema, kind, o);
    if (scheme) check_precision(schema, *scheme, o.common.kernel);
    if (o.liquid.energy.internal())
      schema.fail("energy", "variable", "expected 'temperature': here u is the work of compression alone");
  }
  run::memory_need need() const override {
    return run::need_of(two_fluids::particles_at_start(o, p), 800.0, o.common.kernel, o.domain.dimension);
  }
  std::string theory() const override { return two_fluids::theory_text(kind, o, p); }
  run::common_options& common() override { return o.common; }
  std::unique_ptr<run::simulation> make() const override {
    return (o.domain.dimension == 3 ? two_fluids_3d : two_fluids_2d)(kind, o, p, scheme);
  }
};

struct body_of_input : problem_of_input {
  conduction::options o;

  explicit body_of_input(const liquid::program* scheme) {
    if (!scheme) return;
    o.by_program = true;
    o.walls.treatment = scheme->wall;
  }
  void declare(namelist::schema& schema) override { conduction::declare(schema, o); }
  void complete(const namelist::schema& schema) override { conduction::resolve(schema, o); }
  run::memory_need need() const override {
    return run::need_of(o.domain.lattice_particles(), 300.0, o.common.kernel, o.domain.dimension);
  }
  run::common_options& common() override { return o.common; }
  std::unique_ptr<run::simulation> make() const override { return problems::conduction(o); }
};

// What the input names, for a program whose scheme runs several.
std::unique_ptr<problem_of_input> named_by(const namelist::document& input, const liquid::program& scheme) {
  for (const char* other : {"convection", "shock", "flow"})
    if (has(input, other))
      foundation::fail_input(std::string("the input is of program ") + other + ", whose problem " + scheme.name +
                             " cannot run: it takes boxes at rest, &rti, &drop and &conduction");
  if (has(input, "rti")) return std::make_unique<fluids_of_input>(problem_kind::rayleigh_taylor, &scheme);
  if (has(input, "drop")) return std::make_unique<fluids_of_input>(problem_kind::drop, &scheme);
  if (has(input, "conduction")) return std::make_unique<body_of_input>(&scheme);
  return std::make_unique<box_at_rest>(scheme);
}

using choice = std::function<std::unique_ptr<problem_of_input>(const namelist::document&)>;

// theory_is: what --theory prints, for the help; empty: there is no such option.
int start(int argc, char** argv, const char* name, std::unique_ptr<problem_of_input> problem, const choice& choose,
          const std::string& theory_is) {
  bool theory = false;
  run::program_input own{.program = name,
                         .restarts = true,
                         .declare = [&](namelist::schema& schema) { problem->declare(schema); },
                         .complete = [&](const namelist::schema& schema) { problem->complete(schema); },
                         .need = [&] { return problem->need(); }};
  if (!theory_is.empty())
    own.add_options = [&](CLI::App& app, run::command_line&) {
      app.add_flag("--theory", theory, "print " + theory_is + ", and stop");
    };
  if (choose) own.choose = [&](const namelist::document& input) { problem = choose(input); };
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    if (theory) {
      if (domain::communicator::world().rank == 0) run::print(problem->theory());
      return;
    }
    problem->common().start.is_over = !line.restart.empty();
    const auto made = problem->make();
    run::carry_out(*made, problem->common(), line, resolved);
  });
}

}  // namespace

int program(int argc, char** argv, const liquid::program& scheme) {
  return start(
      argc, argv, scheme.name, std::make_unique<box_at_rest>(scheme),
      [&](const namelist::document& input) { return named_by(input, scheme); },
      "what linear theory or creeping flow says of the problem");
}

int two_fluids(int argc, char** argv, const char* name, problem_kind kind, const std::string& theory_is) {
  return start(argc, argv, name, std::make_unique<fluids_of_input>(kind, nullptr), {}, theory_is);
}

int conduction(int argc, char** argv) {
  return start(argc, argv, "conduction", std::make_unique<body_of_input>(nullptr), {}, "");
}

}  // namespace tetsuame::problems
