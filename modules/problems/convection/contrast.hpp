// How much stiffer the viscosity's contrast makes the rates than one viscosity would, where inertia goes with ν (ξ² =
// ν/ν_eff). A line's force acts on particle i as ν_ij/ν_i; and in the norm in which sound keeps its energy, p²/ξ² and
// ξ² v², the matrix that couples pressure and velocity is B_ij = g_ij (ν_i/ν_j)^½, g that of one viscosity. Means over
// the neighbours,
//   viscous_i = Σ F ν_ij/ν_i / Σ F      coupled_i = Σ F r ν_j/ν_i / Σ F r
// the largest viscous_i and the square root of the largest coupled_i are how much more than with one viscosity the
// rates can grow by: a row sum, and Schur's test, |B|² <= max_i (Σ_j |B_ij| w_j/w_i) max_j (Σ_i |B_ij| w_i/w_j), with w
// = ν^½. Images follow their particles: of their viscosity only lines know.
#pragma once

#include <convection/graded_viscosity.hpp>

namespace tetsuame::convection {

struct own_viscosity_tag {};
inline constexpr own_viscosity_tag of_own_viscosity;

struct contrast {
  using real = pairs::real;
  const double* root;  // ν^½, as that of graded_viscosity
  const double* own;   // ν; an image has that of its particle
  double* viscous;
  double* coupled;  // of one viscosity: both 1

  struct me {
    real F, F_nu, F_r, F_r_nu;
  };
  auto reads() const { return std::tuple{pairs::read(of_viscosity_root, root), pairs::read(of_own_viscosity, own)}; }
  me begin(std::size_t) const { return {real(0.0), real(0.0), real(0.0), real(0.0)}; }
  void add(me& a, const auto& ij) const {
    const real F_r = ij.F * ij.r;
    a.F += ij.F;
    a.F_nu += ij.F * line_viscosity(ij.own(of_viscosity_root), ij(of_viscosity_root));
    a.F_r += F_r;
    a.F_r_nu += F_r * ij(of_own_viscosity);
  }
  void end(std::size_t i, const me& a) const {
    viscous[i] = pairs::sum(a.F_nu) / pairs::sum(a.F);
    coupled[i] = pairs::sum(a.F_r_nu) / (pairs::sum(a.F_r) * own[i]);
  }
};

}  // namespace tetsuame::convection
