// What the ways to find Y have in common. Each is a struct in a file of its own with
//
//   name                             as in outputs
//   carried                          what of it the time integration carries
//   before_walls(w, ...)             ρ and ΔV of the fluid and its ghosts, as far as known before the walls are
//   determine(w, walls, ...)         Y, p, ΔV = Y/p, ρ and the material's properties, of fluid and ghosts
#pragma once

#include <foundation/threads.hpp>
#include <pairs/workspace.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::volume {

// Which field beside position, velocity, temperature and energy is part of the state.
enum class carries { density, weight, nothing };

// Smoothing divided by the kernel sum; see smoothed.hpp for which sum.
struct smoothing_options {
  bool normalise = false;
};

void declare(namelist::schema& schema, smoothing_options& o);

// Everything `determine` may use beside the workspace.
template <int D>
struct surroundings {
  const walls::any& treatment;
  walls::wall_set<D>& walls;
  smoothing_options smoothing;

  // Y of the walls from the fluid's.
  void weights(pairs::workspace<D>& w) const {
    const foundation::stage timed(w.times, "walls");
    std::visit([&](auto t) { t.weights(w, walls); }, treatment);
  }
};

// Y of the walls for a change of the fluid's Y: the part of `weights` that is linear in it.
template <int D>
void linear_weights(pairs::workspace<D>& w, const surroundings<D>& around) {
  std::visit(
      [&]<class Treatment>(Treatment t) {
        auto& s = w.s;
        if constexpr (Treatment::has_markers) {
          particles::array none(around.walls.weight_step.size(), 0.0);
          std::swap(none, around.walls.weight_step);
          t.weights(w, around.walls);
          std::swap(none, around.walls.weight_step);
        } else {
          std::fill(s.Y.begin() + static_cast<std::ptrdiff_t>(s.first_wall()),
                    s.Y.begin() + static_cast<std::ptrdiff_t>(s.total()), 0.0);
        }
      },
      around.treatment);
}

inline std::string where_is(const auto& s, std::size_t i) {
  std::string text = "particle " + std::to_string(s.id[i]) + " at (";
  for (std::size_t a = 0; a < s.x.size(); ++a) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.6g", a > 0 ? ", " : "", s.x[a][i]);
    text += number;
  }
  return text + ") m";
}

inline std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

// p^, K_T, α, c_V and c of the particles [0, n) from ρ and T.
template <int D>
void equation_of_state(pairs::workspace<D>& w, std::size_t n) {
  auto& s = w.s;
  for (std::size_t k = 0; k < w.materials.size(); ++k)
    std::visit(
        [&](const auto& material) {
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
          for (std::size_t i = 0; i < n; ++i) {
            if (s.material[i] != static_cast<std::int32_t>(k)) continue;
            const eos::properties e = material.evaluate(s.rho[i], s.T[i]);
            s.p_eos[i] = e.p;
            s.K_T[i] = e.K_T;
            s.alpha[i] = e.alpha;
            s.c_V[i] = e.c_V;
            s.c[i] = e.sound_speed;
          }
        },
        w.materials[k]);
}

// Y = p ΔV needs p > 0: reports the owned particle of the lowest ID where it is not.
template <int D>
void require_positive(pairs::workspace<D>& w, const particles::array& p, const char* what) {
  const auto& s = w.s;
  bool good = true;
#pragma omp parallel for schedule(static) reduction(&& : good) if (s.fluid > foundation::values_worth_threads)
  for (std::size_t i = 0; i < s.fluid; ++i) good = good && p[i] > 0.0 && std::isfinite(p[i]);
  if (good) return;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (!(p[i] > 0.0) || !std::isfinite(p[i]))
      w.first_fault.report(s.id[i], std::string(what) + " p = " + number(p[i]) +
                                        " Pa is not positive and finite: " + where_is(s, i) +
                                        ", rho = " + number(s.rho[i]) + " kg/m3, T = " + number(s.T[i]) +
                                        " K. Y = p dV has no meaning there; use a smaller time step, a "
                                        "higher pressure, or a volume that allows tension");
}

}  // namespace tetsuame::volume
