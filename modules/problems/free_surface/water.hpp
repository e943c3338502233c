// Water with a free surface: what a run holds, as plain data.
#pragma once

#include <algorithm>
#include <free_surface/options.hpp>
#include <particles/named_fields.hpp>
#include <passes/evaluation.hpp>
#include <rigid/contact.hpp>
#include <run/start.hpp>
#include <sources/fields.hpp>

namespace tetsuame::free_surface {

// Water slower than this part of c0 counts as less lively, by the square of its speed, where a sum would else make or
// take energy at a rate that does not fall as that of viscosity does: its density diffuses less (in water at rest the
// pressure that its sums hold differs from the hydrostatic one), it drifts less, and walls balance more of its power.
inline constexpr double slow = 0.01;

using rigid::moving_body, rigid::free_bodies, rigid::wall_group;

// What the water does to a body.
template <int D>
struct load {
  solids::point<D> force = foundation::zero<double, D>();                    // N; N/m in two dimensions
  solids::about<D> moment = foundation::zero < double, D == 2 ? 1 : 3 > ();  // N m, about a point
};

template <int D>
solids::point<D> of_solids(const point& x) {
  return solids::point<D>::of([&](std::size_t a) { return x[a]; });
}

// Whether the work of all bodies that move is known: of those whose force a gauge reads, or that move freely.
template <int D>
bool counts_work(const parameters& p) {
  bool any = false, all = true;
  const auto& motions = p.template motions_in<D>();
  for (std::size_t b = 0; b < motions.size(); ++b) {
    if (!motions[b].moves()) continue;
    any = true;
    all = all && (motions[b].free.has_value() || std::ranges::find(p.force, b, &force_gauge::body) != p.force.end());
  }
  return any && all;
}

// Of water that has entered, or left, since the start: so many particles, kg, J, N s (in two dimensions for each metre
// of depth), summed with what adding rounds off [A. Neumaier, Z. Angew. Math. Mech. 54, 39 (1974)].
template <int D>
struct passed_through {
  static constexpr std::size_t number = 0, mass = 1, energy = 2, momentum = 3, size = momentum + D;
  std::array<double, size> sum{}, rest{};

  double operator[](std::size_t k) const { return sum[k] + rest[k]; }
  void add(std::span<const double> more) {
    for (std::size_t k = 0; k < size; ++k) {
      const double before = sum[k];
      sum[k] += more[k];
      rest[k] += std::abs(before) < std::abs(more[k]) ? more[k] - sum[k] + before : before - sum[k] + more[k];
    }
  }
};

// Above all IDs of water, where their number grows: those of images begin here.
inline constexpr std::int64_t most_numbers = std::int64_t{1} << 40;

template <int D>
struct water : rigid::bodies<D> {
  const options& o;
  const parameters& p;
  run::state<D> world = {};

  bool two_velocities = false;  // what stands behind walls has another one in the viscous sum (terms.hpp)
  particles::vector_field<D> viscous_velocity = {};  // m/s, that of these; the start declares it

  const bool has_bodies = !p.template bodies_in<D>().empty();
  const bool has_free_bodies = std::ranges::any_of(
      p.template motions_in<D>(), [](const auto& motion) { return motion.moves() && motion.free.has_value(); });

  // Where forces on bodies are asked for (loads.hpp).
  const bool asks_loads = has_bodies && (!p.force.empty() || has_free_bodies);
  particles::vector_field<D> force_without = vector<D>(asks_loads, "ForceWithout", "N");
  particles::array& density_rate_without = field(asks_loads, "DensityRateWithout", "kg/(m^3 s)");

  // What of them is counted (budget.hpp): integrated with the state, on rank 0, impulses (N s, N m s) with an element a
  // gauge, and the work that bodies that move do on the water (J); what is put back, on all ranks.
  struct counted_loads {
    static constexpr std::size_t components = D + (D == 2 ? 1 : 3);
    std::array<std::vector<double>, components> impulse;
    std::array<std::vector<double>, 2> work;               // by pressure, by friction
    std::vector<std::array<double, components>> put_back;  // N s, N m s; of impulses, an element a gauge
    double energy = 0.0;                                   // J, that what is put back gains, with free bodies

    // Of gauges: since they were read last, s; what had been put back then; what was since on those of pressure, Pa s.
    double read_at = 0.0, since_read = 0.0;
    std::vector<std::array<double, components>> put_back_read;
    std::vector<double> on_gauges;
    double mean(double since) const { return since_read > 0.0 ? since / since_read : 0.0; }
    void forget(double now) {
      read_at = now;
      put_back_read = put_back;
      std::ranges::fill(on_gauges, 0.0);
    }
  } counted = {};
  const bool counts_work = asks_loads && free_surface::counts_work<D>(p);

  // With free bodies: how the pressure of their wall particles follows each component of their acceleration, of
  // displacement and of rotation (free_bodies.hpp).
  particles::vector_field<solids::rigid<D>::components> response =
      vector<solids::rigid<D>::components>(has_free_bodies, "PressureResponse", "Pa s^2/m, Pa s^2");

  // An evaluation fills these.
  particles::vector_field<D> force = vector<D>(true, "Force", "N");  // but for gravity
  particles::array& density_rate = field(true, "DensityRate", "kg/(m^3 s)");
  // Beside bodies (behind_bodies.hpp): a direction, or 0; the volume of their wall particles, 0 elsewhere.
  particles::vector_field<D> pressed = vector<D>(has_bodies, "PressedDirection", "1");
  particles::array& volume_in_bodies = field(has_bodies, "VolumeInBodies", "m^D");

  // With surface tension (tension.hpp): G, smoothed G, forces; curvature and its weight.
  particles::vector_field<D> inward = vector<D>(has_tension(), "InwardNormal", "1/m");
  particles::vector_field<D> normal_within = vector<D>(has_tension(), "SmoothedInwardNormal", "1/m");
  particles::vector_field<D> tension = vector<D>(has_tension(), "TensionForce", "N");
  particles::array& curvature = field(has_tension(), "Curvature", "1/m");
  particles::array& surface_weight = field(has_tension(), "SurfaceWeight", "1/m");

  // What looks at the surface fills these (surface.hpp): λ, the least of the neighbourhood; 1 or 0.
  particles::vector_field<D> slope = vector<D>(true, "ConcentrationGradient", "1/m");
  particles::vector_field<D> normal = vector<D>(true, "SurfaceNormal", "1");
  particles::array& eigenvalue = field(true, "Eigenvalue", "1");
  particles::array& least_near = field(true, "LeastEigenvalueNear", "1");
  particles::array& covered = field(true, "Covered", "1");

  // With &inflow and &outflow (openings.hpp): the number of the section in whose zone a particle is, minus that of an
  // outflow, 0 in none; sums over what comes behind it there; how many places all inflows have.
  const bool has_openings = !p.openings.empty();
  particles::array& zone = particles::declare_if(has_openings, world.w.s, "Zone", "1", particles::role::memory);
  particles::vector_field<3> behind = vector<3>(has_openings, "ComingBehind", "1, m/s, Pa");
  std::int64_t inflow_places = 0;
  passed_through<D> entered = {}, left = {};
  bool in_zone(std::size_t i) const { return has_openings && zone[i] != 0.0; }

  sources::fields<D> sources = {};

  // Of dy/dt; of what follows from the state alone, as of now.
  passes::evaluation<D> rates{world}, present{world};
  std::vector<load<D>> free_loads = {};  // in the last of the first, on free bodies about their centres

  water(const options& of_input, const parameters& that_follow)
      : rigid::bodies<D>{world, box_of<D>(of_input), that_follow.template bodies_in<D>(),
                         that_follow.template motions_in<D>()},
        o(of_input),
        p(that_follow) {
    const double c = p.water.sound;
    this->fitted = true;
    this->contact = {.gravity = gravity(), .held_below = slow * c, .at_rest = rigid::at_rest * c};
    this->counts_impacts = asks_loads || (has_bodies && !o.gauges.pressure[0].empty());
    counted.put_back.resize(p.force.size());
    counted.put_back_read.resize(p.force.size());
    counted.on_gauges.resize(o.gauges.pressure[0].size());
  }

  water(const water&) = delete;  // its fields are the state's
  water& operator=(const water&) = delete;

  particles::array& field(bool needed, const char* name, const char* unit) {
    return particles::declare_if(needed, world.w.s, name, unit, particles::role::derived);
  }
  template <std::size_t N>
  particles::vector_field<N> vector(bool needed, const char* name, const char* unit) {
    return particles::declare_vector_if<N>(needed, world.w.s, name, unit, particles::role::derived);
  }

  const domain::communicator& ranks() const { return world.w.d.ranks; }
  bool has_tension() const { return o.flow.surface_tension > 0.0; }
  double gravity() const { return o.flow.gravity; }
  double dx() const { return world.w.dx; }
  point place(std::size_t i) const {
    point x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = world.w.s.x[a][i];
    return x;
  }
  double speed2(std::size_t i) const {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += world.w.s.v[a][i] * world.w.s.v[a][i];
    return v2;
  }
};

// Collective. Ghosts, pressures, volumes, and what stands behind walls, as of now.
template <int D>
void refresh(water<D>& f) {
  f.present.run({});
}

// By `slow`: 1 of water that moves, less of slow water.
template <int D>
double speed_limiter(const water<D>& f, double speed) {
  return std::min(1.0, speed / (slow * f.p.water.sound));
}

template <int D>
double length_of(const particles::vector_field<D>& v, std::size_t i) {
  double squared = 0.0;
  for (std::size_t a = 0; a < D; ++a) squared += v[a][i] * v[a][i];
  return std::sqrt(squared);
}

}  // namespace tetsuame::free_surface
