#include <fmt/core.h>

#include <foundation/error.hpp>
#include <riemann/material.hpp>

namespace tetsuame::riemann {

moduli local_moduli(const eos::any& material, double rho, double T) {
  constexpr double d = 1e-4;
  const eos::properties here = eos::evaluate(material, rho, T);
  const double gamma = here.alpha * here.K_T / (rho * here.c_V);
  const auto neighbour = [&](double step, double exponent) {
    return eos::evaluate(material, rho * std::exp(step), T * std::exp(exponent * step));
  };
  const auto K_S = [](const eos::properties& s, double density) { return density * s.sound_speed * s.sound_speed; };
  const eos::properties up = neighbour(d, gamma), down = neighbour(-d, gamma);
  const eos::properties warm_up = neighbour(d, 0.0), warm_down = neighbour(-d, 0.0);
  return {K_S(here, rho), (K_S(up, rho * std::exp(d)) - K_S(down, rho * std::exp(-d))) / (up.p - down.p), here.K_T,
          (warm_up.K_T - warm_down.K_T) / (warm_up.p - warm_down.p)};
}

namespace {

side<double> fitted(const eos::any& material, double rho, double u, double T, double K, double K_prime) {
  if (!(K > 0.0 && K_prime > 1.0))
    foundation::fail_calculation(
        fmt::format("Riemann problem in '{}' at {:g} kg/m^3, {:g} K: bulk modulus {:g} Pa and its slope {:g} by "
                    "pressure; above 0 and 1 are needed",
                    eos::about(material).name, rho, T, K, K_prime));
  return local_fit(rho, u, eos::pressure(material, rho, T), K, K_prime);
}

}  // namespace

side<double> adiabatic_side(const eos::any& material, double rho, double u, double T) {
  const moduli m = local_moduli(material, rho, T);
  return fitted(material, rho, u, T, m.K_S, m.K_S_prime);
}

side<double> isothermal_side(const eos::any& material, double rho, double u, double T) {
  const moduli m = local_moduli(material, rho, T);
  return fitted(material, rho, u, T, m.K_T, m.K_T_prime);
}

}  // namespace tetsuame::riemann
