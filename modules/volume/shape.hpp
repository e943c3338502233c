// What the ways to find Y have in common. Each is a struct in a file of its own with
//
//   name        as in outputs
//   carried     what of it the time integration carries
// and their passes in liquid/evaluation.hpp. V, m^D: volumes before the pressure is known, with which the walls'
// treatment and the mean of smoothing are made; the forces' ΔV = Y/p follow from the pressure.
#pragma once

#include <fmt/format.h>

#include <atomic>
#include <foundation/threads.hpp>
#include <functional>
#include <pairs/workspace.hpp>
#include <utility>
#include <volume/options.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::volume {

// Which field beside position, velocity, temperature and energy is part of the state.
enum class carries { density, weight, nothing };

// What a problem makes of the equation of state's values of the particles [first, last), such as slowed sound. None:
// they stay.
using pressure_rule = std::function<void(std::size_t first, std::size_t last)>;

// Everything `determine` may use beside the workspace.
template <int D>
struct wall_context {
  const walls::any& treatment;
  walls::wall_set<D>& walls;
  smoothing_options smoothing;
  particles::array& V;
  const pressure_rule& rule;

  // Y of the walls from the fluid's.
  void weights(pairs::workspace<D>& w) const {
    const foundation::stage timed(w.times, "walls");
    std::visit([&](auto t) { t.weights(w, walls); }, treatment);
  }
};

// Y of the walls for a change of the fluid's Y: the part of `weights` that is linear in it.
template <int D>
void linear_weights(pairs::workspace<D>& w, const wall_context<D>& around) {
  std::visit(
      [&]<class Treatment>(Treatment t) {
        auto& s = w.s;
        if constexpr (Treatment::has_markers) {
          particles::array none(around.walls.weight_step.size(), 0.0);
          const bool due = std::exchange(around.walls.steps_due, false);
          std::swap(none, around.walls.weight_step);
          t.weights(w, around.walls);
          std::swap(none, around.walls.weight_step);
          around.walls.steps_due = due;
        } else if constexpr (std::is_same_v<Treatment, walls::mirror>) {
          walls::fill_images(around.walls, s, walls::even({&s.Y}));
        } else {
          std::fill(s.Y.begin() + static_cast<std::ptrdiff_t>(s.first_wall()),
                    s.Y.begin() + static_cast<std::ptrdiff_t>(s.total()), 0.0);
        }
      },
      around.treatment);
}

inline std::string number(double value) { return fmt::format("{:.6g}", value); }

namespace detail {

// Particles [first, first + lanes) of a material, those of other materials and from n on left alone; where the
// equation of state works on lanes, all at once.
template <int D, class Material>
void evaluate_lanes(particles::particles<D>& s, const Material& material, std::int32_t number, std::size_t first,
                    std::size_t n) {
  using pairs::lanes, pairs::real;
  const std::array<double*, 5> out{s.p_eos.data(), s.K_T.data(), s.alpha.data(), s.c_V.data(), s.c.data()};
  const auto mine = [&](std::size_t i) { return i < n && s.material[i] == number; };
  if constexpr (requires(real r) { material.evaluate(r, r); }) {
    bool all = true, none = true;
    for (std::size_t i = first; i < first + lanes; ++i) mine(i) ? none = false : all = false;
    if (none) return;
    real rho, T;
    if (first + lanes <= n) {
      rho.copy_from(s.rho.data() + first, pairs::stdx::element_aligned);
      T.copy_from(s.T.data() + first, pairs::stdx::element_aligned);
    } else {
      rho = real([&](auto lane) { return s.rho[std::min(first + lane, n - 1)]; });
      T = real([&](auto lane) { return s.T[std::min(first + lane, n - 1)]; });
    }
    const auto e = material.evaluate(rho, T);
    const std::array<real, 5> values{e.p, e.K_T, e.alpha, e.c_V, e.sound_speed};
    for (std::size_t f = 0; f < out.size(); ++f) {
      if (all)
        values[f].copy_to(out[f] + first, pairs::stdx::element_aligned);
      else
        for (std::size_t lane = 0; lane < lanes; ++lane)
          if (mine(first + lane)) out[f][first + lane] = values[f][lane];
    }
  } else {
    for (std::size_t i = first; i < first + lanes; ++i) {
      if (!mine(i)) continue;
      const eos::properties e = material.evaluate(s.rho[i], s.T[i]);
      const std::array<double, 5> values{e.p, e.K_T, e.alpha, e.c_V, e.sound_speed};
      for (std::size_t f = 0; f < out.size(); ++f) out[f][i] = values[f];
    }
  }
}

}  // namespace detail

// p^, K_T, α, c_V and c of the particles [first, last) from ρ and T.
template <int D>
void equation_of_state(pairs::workspace<D>& w, std::size_t first, std::size_t last) {
  const std::size_t groups = (last - first + pairs::lanes - 1) / pairs::lanes;
  for (std::size_t k = 0; k < w.materials.size(); ++k)
    std::visit(
        [&](const auto& material) {
          constexpr std::size_t chunk = 128;  // groups: some 10 microseconds
          foundation::for_chunks(groups, chunk, last - first > foundation::rows_worth_threads,
                                 [&](std::size_t begin, std::size_t end) {
                                   for (std::size_t group = begin; group < end; ++group)
                                     detail::evaluate_lanes(w.s, material, static_cast<std::int32_t>(k),
                                                            first + group * pairs::lanes, last);
                                 });
        },
        w.materials[k]);
}
template <int D>
void equation_of_state(pairs::workspace<D>& w, std::size_t first, std::size_t last, const pressure_rule& rule) {
  equation_of_state(w, first, last);
  if (rule) rule(first, last);
}

// V = m/ρ and Y = p^ V of the particles [first, last), with the equation of state.
template <int D>
void weights_by_density(pairs::workspace<D>& w, particles::array& V, std::size_t first, std::size_t last,
                        const pressure_rule& rule) {
  auto& s = w.s;
  equation_of_state(w, first, last, rule);
  foundation::for_all(last - first, [&](std::size_t k) {
    const std::size_t i = first + k;
    V[i] = s.m[i] / s.rho[i];
    s.Y[i] = s.p_eos[i] * V[i];
  });
}

// Y = p ΔV needs p > 0: reports the owned particle of the lowest ID where it is not.
template <int D>
void require_positive(pairs::workspace<D>& w, const particles::array& p, const char* what, const char* unit = "Pa") {
  const auto& s = w.s;
  std::atomic<bool> good{true};
  foundation::for_chunks(s.fluid, 4096, s.fluid > foundation::values_worth_threads,
                         [&](std::size_t first, std::size_t last) {
                           bool all = true;
                           for (std::size_t i = first; i < last; ++i) all = all && p[i] > 0.0 && std::isfinite(p[i]);
                           if (!all) good = false;
                         });
  if (good) return;
  for (std::size_t i = 0; i < s.fluid; ++i)
    if (!(p[i] > 0.0) || !std::isfinite(p[i]))
      w.first_fault.report(
          s.id[i],
          fmt::format("{} = {:.6g} {} is not positive and finite: {}, rho = {:.6g} kg/m3, T = {:.6g} K. Y = p dV "
                      "has no meaning there (disph_n and rti need no p > 0)",
                      what, p[i], unit, pairs::describe_position(s, i), s.rho[i], s.T[i]));
}

}  // namespace tetsuame::volume
