// What stands beyond a wall, by name (docs/theory/walls.md). Every treatment has the same steps, called in this
// order in each evaluation (the fluid's ghosts are up to date, ρ, ΔV and the constants too):
//
//   kinematics   v, T, η, k, ΔV of the wall particles; with markers f = ν∇²v + g of the fluid that they see, and, when
//                terms are handed over, their sums over the same neighbours in the same pass
//   weights      Y of the wall particles from the fluid's Y          (before pressure is smoothed)
//   pressures    p and ΔV = Y/p of the wall particles from the fluid's
//   push         what the wall adds to the forces directly: boundary_force.hpp; of repulsion
//                Dv/Dt ⊃ Λ(y) n,  Λ = (f·n) λ(y),  λ = -1 at the wall, linear to 0 at repulsion_range
#pragma once

#include <foundation/threads.hpp>
#include <variant>
#include <walls/images.hpp>
#include <walls/markers.hpp>

namespace tetsuame::walls {

// Steps that a treatment does not need.
struct nothing {
  template <int D>
  static void kinematics(pairs::workspace<D>&, wall_set<D>&) {}
  template <int D>
  static void weights(pairs::workspace<D>&, wall_set<D>&) {}
  template <int D>
  static void pressures(pairs::workspace<D>&, wall_set<D>&) {}
  template <int D>
  static void push(const pairs::workspace<D>&, const wall_set<D>&, const std::array<double*, D>&) {}
};

struct none : nothing {
  static constexpr const char* name = "none";
  static constexpr bool has_particles = false, has_markers = false;
};

// What the treatments with markers share.
struct with_markers : nothing {
  static constexpr bool has_particles = true, has_markers = true;

  template <int D, class... Added>
  static void kinematics(pairs::workspace<D>& w, wall_set<D>& set, const Added&... added) {
    detail::marker_kinematics(w, set);
    detail::nonpressure_acceleration(w, set, added...);
  }
  template <int D>
  static void weights(pairs::workspace<D>& w, wall_set<D>& set) {
    detail::marker_weights(w, set);
  }
  template <int D>
  static void pressures(pairs::workspace<D>& w, wall_set<D>& set) {
    detail::marker_pressures(w, set);
  }
};

struct virtual_marker : with_markers {
  static constexpr const char* name = "virtual_marker";

  template <int D, class... Added>
  static void kinematics(pairs::workspace<D>& w, wall_set<D>& set, const Added&... added) {
    with_markers::kinematics(w, set, added...);
    set.steps_due = true;
  }
  template <int D>
  static void push(const pairs::workspace<D>& w, const wall_set<D>& set, const std::array<double*, D>& force) {
    for (const std::size_t i : set.read.near_wall.rows)
      push_off(set.force, set.sides, w.s, i, [&](std::size_t axis, double a) { force[axis][i] += w.s.m[i] * a; });
  }
};

struct repulsion : with_markers {
  static constexpr const char* name = "repulsion";

  template <int D>
  static void push(const pairs::workspace<D>& w, const wall_set<D>& set, const std::array<double*, D>& force) {
    const double range = set.how.repulsion_range * w.dx;
    for (const std::size_t i : set.read.near_wall.rows)
      for (const auto& wall : set.sides) {
        const double y = (w.s.x[wall.axis][i] - wall.position) * wall.inward;
        const double lambda = -std::max(0.0, 1.0 - y / range);
        force[wall.axis][i] += w.s.m[i] * (*set.f[wall.axis])[i] * lambda;  // m (f·n) λ n
      }
  }
};

struct frozen : nothing {
  static constexpr const char* name = "frozen";
  static constexpr bool has_particles = true, has_markers = false;

  // The profile was given at the start; only the walls' velocities are set.
  template <int D>
  static void kinematics(pairs::workspace<D>& w, wall_set<D>& set) {
    auto& s = w.s;
    auto &density = set.densities(s), &volume = set.volumes(s);
    for (std::size_t r = 0; r < s.walls; ++r) {
      const std::size_t i = s.first_wall() + r;
      std::array<double, D> v{};
      for (std::size_t k = 0; k < set.sides.size(); ++k)
        if ((set.mirrored[r] >> k & 1U) != 0) v = set.sides[k].velocity;
      for (std::size_t a = 0; a < D; ++a) s.v[a][i] = v[a];
      s.rho[i] = density[i] = set.rho_given[r];
      s.p[i] = set.p_given[r];
      s.dV[i] = volume[i] = s.m[i] / s.rho[i];
    }
    w.exchange_walls(s.v, {s.T.data(), s.rho.data(), s.p.data(), s.dV.data(), s.eta.data(), s.k.data()});
    if (&volume != &s.dV) w.exchange_walls({volume.data(), density.data()});
  }
  template <int D>
  static void weights(pairs::workspace<D>& w, wall_set<D>&) {
    auto& s = w.s;
    for (std::size_t i = s.first_wall(); i < s.total(); ++i) s.Y[i] = s.p[i] * s.dV[i];
  }
};

struct mirror : nothing {
  static constexpr const char* name = "mirror";
  static constexpr bool has_particles = false, has_markers = false;

  template <int D>
  static void weights(pairs::workspace<D>& w, wall_set<D>& set) {
    fill_images(set, w.s, hydrostatic(w.s.Y, w.s.m, w));
  }
  template <int D>
  static void push(const pairs::workspace<D>& w, const wall_set<D>& set, const std::array<double*, D>& force) {
    foundation::for_all(w.s.fluid, [&](std::size_t i) {
      push_off(set.force, set.sides, w.s, i, [&](std::size_t axis, double a) { force[axis][i] += w.s.m[i] * a; });
    });
  }
};

// The treatment of a run, chosen once by name.
using any = std::variant<virtual_marker, none, frozen, repulsion, mirror>;

inline const std::vector<std::string> names{virtual_marker::name, none::name, frozen::name, repulsion::name,
                                            mirror::name};

inline any make(const std::string& name) {
  any treatment;
  if (name == none::name) treatment = none{};
  if (name == frozen::name) treatment = frozen{};
  if (name == repulsion::name) treatment = repulsion{};
  if (name == mirror::name) treatment = mirror{};
  return treatment;
}

}  // namespace tetsuame::walls
