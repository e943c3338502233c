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

template <int D>
solids::point<D> of_solids(const point& x) {
  return solids::point<D>::of([&](std::size_t a) { return x[a]; });
}

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

  sources::fields<D> sources = {};

  // Of dy/dt; of what follows from the state alone, as of now.
  passes::evaluation<D> rates{world}, present{world};

  water(const options& of_input, const parameters& that_follow)
      : rigid::bodies<D>{world, box_of<D>(of_input), that_follow.template bodies_in<D>(),
                         that_follow.template motions_in<D>()},
        o(of_input),
        p(that_follow) {
    const double c = p.water.sound;
    this->fitted = true;
    this->contact = {.gravity = gravity(), .held_below = slow * c, .at_rest = rigid::at_rest * c};
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
