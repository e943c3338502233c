// Elastic energy as a function of state, and what an error of energy is told in.
#pragma once

#include <two_fluids/fluids.hpp>

namespace tetsuame::two_fluids {

// J/kg, ∫ p dρ/ρ² from the density at the start, at the particle's temperature: four Gauss points in ln ρ.
template <int D>
double elastic_energy(const fluids<D>& f, std::size_t i) {
  const auto& s = f.world.w.s;
  const auto& material = f.world.w.materials[static_cast<std::size_t>(s.material[i])];
  constexpr std::array<double, 4> x{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr std::array<double, 4> weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                         0.3478548451374538};
  const double half = 0.5 * std::log(s.rho[i] / f.rho_start()[i]);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double rho = f.rho_start()[i] * std::exp(half * (1.0 + x[k]));
    sum += weight[k] * eos::pressure(material, rho, s.T[i]) / rho;
  }
  return half * sum;
}

// J (2-D: J/m), of p_r over the box: what Σ p_r ΔV stands for.
template <int D>
double reference_integral(const fluids<D>& f) {
  double mean = 0.5 * f.reference_floor;
  for (std::size_t a = 0; a < D; ++a) mean *= f.o.domain.length[a];
  return mean;
}

// m² (2-D: m), of the round drop.
template <int D>
double round_surface(double radius) {
  return std::numbers::pi * radius * (D == 3 ? 4.0 * radius : 2.0);
}

// J (2-D: J/m): Δρ g L³/8 of a square box; of a drop, what it loses on the way from lid to floor, and its surface's.
// Where neither weight nor tension does anything, 1 J.
template <int D>
double energy_scale(const fluids<D>& f) {
  const auto& L = f.o.domain.length;
  const double weight = std::abs(f.p.density_difference) * f.o.gravity, a = f.o.radius;
  const double scale =
      f.is_drop() ? f.number_of_drops() * (weight * L[1] * std::numbers::pi * a * a * (D == 3 ? 4.0 / 3.0 * a : 1.0) +
                                           f.o.surface_tension * round_surface<D>(a))
                  : weight * L[0] * L[1] * L[1] * (D == 3 ? L[2] : 1.0) / 8.0;
  return scale > 0.0 ? scale : 1.0;
}

}  // namespace tetsuame::two_fluids
