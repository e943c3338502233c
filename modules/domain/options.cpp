#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <domain/options.hpp>

namespace tetsuame::domain {

namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

std::string along(const char* what, std::size_t axis) { return std::string(what) + axis_names[axis]; }

// An edge not given is as long as that along x, or as its particles are wide; particles not given have the spacing of
// x.
void follow_x(const namelist::schema& schema, options& o, std::size_t a) {
  const double dx = o.dx();
  auto& length = o.length[a];
  auto& n = o.particles[a];
  if (length == 0.0) length = n > 0 ? dx * static_cast<double>(n) : o.length[0];
  if (n > 0) return;
  const std::string edge = along("length_", a);
  const double wanted = length / dx;
  if (!(wanted < 1e12))
    schema.fail("domain", edge, fmt::format("would hold {:.3g} particles of the spacing along x", wanted));
  n = std::llround(wanted);
  if (n == 0) schema.fail("domain", edge, fmt::format("{} m are less than the spacing along x, {} m", length, dx));
  if (std::abs(length / static_cast<double>(n) - dx) > 1e-9 * dx)
    schema.fail("domain", edge,
                fmt::format("expected a whole number of spacings of x, {} m each, found {}", dx, wanted));
}

}  // namespace

double options::lattice_particles() const {
  double n = 1.0;
  for (std::size_t a = 0; a < axes(); ++a) n *= static_cast<double>(particles[a]);
  return n;
}

void declare(namelist::schema& schema, const demands& of_problem, options& o) {
  schema.group("domain", of_problem.lattice ? "the box and the start lattice" : "the box");
  schema.add("domain", "dimension", o.dimension,
             namelist::between(static_cast<double>(of_problem.least_dimension), 3,
                               of_problem.least_dimension == 1 ? "of space" : "of space; y is up"));
  for (std::size_t a = 0; a < 3; ++a) {
    const bool follows = of_problem.follows_x && a > 0;
    const std::string axis = axis_names[a], only = follows ? "; 0: as along x" : a == 2 ? " (3-D only)" : "";
    schema.add("domain", "length_" + axis, o.length[a],
               {.unit = "m",
                .minimum = 0.0,
                .exclusive_minimum = !follows,
                .meaning = "edge of the box along " + axis + only});
    if (of_problem.lattice)
      schema.add("domain", "particles_" + axis, o.particles[a],
                 namelist::between(follows ? 0.0 : static_cast<double>(of_problem.least_particles), 1e9,
                                   "fluid particles along " + axis + (follows ? "; 0: with the spacing of x" : only)));
    schema.add("domain", "periodic_" + axis, o.periodic[a],
               {.meaning = "the two sides across " + axis + " are one, or else walls" + (follows ? "" : only)});
    if (of_problem.may_be_open)
      schema.add("domain", "open_" + axis, o.open[a],
                 {.meaning = "nothing stands at the two sides across " + axis +
                             ": the box is only where particles start" + (follows ? "" : only)});
  }
  schema.add("domain", "ranks_x", o.ranks_x.number,
             namelist::changing(namelist::between(
                 0, 1e6, "MPI ranks side by side along x, a divisor of their number; 0: as the box's shape suggests")));
  if (of_problem.lattice && of_problem.jitters)
    schema.add(
        "domain", "jitter", o.jitter,
        namelist::between(0.0, 0.3, "particles start off the lattice, by up to so many spacings along each axis"));
}

void resolve(const namelist::schema& schema, const demands& of_problem, options& o) {
  o.ranks_x.place = schema.where("domain", "ranks_x") + ": &domain ranks_x: ";
  if (o.periodic[1] && !of_problem.walls_below_and_above.empty())
    schema.fail("domain", "periodic_y", of_problem.walls_below_and_above);
  for (std::size_t a = 0; a < o.axes(); ++a)
    if (o.open[a] && o.periodic[a])
      schema.fail("domain", along("open_", a), "sides that are one, as a periodic box has them, cannot be open");
  if (!of_problem.lattice) return;
  const double dx = o.dx();
  for (std::size_t a = 1; a < o.axes(); ++a) {
    if (of_problem.follows_x) follow_x(schema, o, a);
    const double spacing = o.length[a] / static_cast<double>(o.particles[a]);
    if (std::abs(spacing - dx) > 1e-9 * dx)
      schema.fail("domain", along("particles_", a),
                  fmt::format("the particle spacing must be the same along all axes: here {} m, along x {} m; change "
                              "particles_{} or length_{}",
                              spacing, dx, axis_names[a], axis_names[a]));
  }
  check_number(schema, o, o.lattice_particles());
}

void check_number(const namelist::schema& schema, const options& o, double expected) {
  if (expected <= 1e12) return;
  const auto first = o.particles.begin();
  const auto most = std::max_element(first, first + o.dimension);
  schema.fail("domain", along("particles_", static_cast<std::size_t>(most - first)),
              fmt::format("expected at most 1e12 particles in the box, found {:.3g}", expected));
}

void check_widths(const namelist::schema& schema, const options& o, double halo, double support) {
  for (std::size_t a = 0; a < o.axes(); ++a) {
    if (o.periodic[a] && halo > o.length[a] * (1.0 - 2e-6))
      schema.fail(
          "domain", along("particles_", a),
          fmt::format("the periodic box is too narrow along {}: {:.6g} m, less than the halo's {:.6g} m (kernel "
                      "support, marker radius and list skin); use more particles, a smaller h_over_dx or a "
                      "smaller skin",
                      axis_names[a], o.length[a], halo));
    if (!o.periodic[a] && !o.open[a] && support > o.length[a] * (1.0 + 1e-9))
      schema.fail("domain", along("particles_", a),
                  fmt::format("the box is narrower along {}, {:.6g} m, than the kernel reaches, {:.6g} m: use more "
                              "particles or a smaller h_over_dx",
                              axis_names[a], o.length[a], support));
  }
}

}  // namespace tetsuame::domain
