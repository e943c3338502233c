// What the pair engine is measured against: the two sums of program C as anyone would first write
// them, a double loop over a full list with plain arrays, one pair at a time.
//
//   p_i            = Σ_j Y_j W_ij                                                 [S0], j = i included
//   m_i Dv_i/Dt    = -Σ_j (p_i ΔV_i² + p_j ΔV_j²) ∇_i W_ij + Σ_j 2 η ΔV_i ΔV_j F_ij v_ij + m_i g
//   m_i Du_i/Dt    =  ½ Σ_j (p_i ΔV_i² + p_j ΔV_j²) v_ij·∇_i W_ij,    D ln ρ_i/Dt = Σ_j ΔV_j v_ij·∇_i W_ij
//   Φ_i            = -½ Σ_j 2 η ΔV_i ΔV_j F_ij v_ij²,                 F = W'(r)/r, quintic spline
//
// CMake compiles scalar.cpp without vectorisation, so that it stays what it says.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <particles/particles.hpp>
#include <vector>

namespace tetsuame::bench {

// Of the first start.size() - 1 of the fluid of s among all its particles.
template <int D>
struct scalar_problem {
  const particles::particles<D>& s;
  double h;                              // m, support 3 h
  double eta;                            // Pa s, of all particles
  std::array<double, D> g;               // m/s2
  std::vector<std::size_t> start{0};     // of each particle's neighbours, and one more
  std::vector<std::int32_t> neighbours;  // may hold particles beyond the support
};

template <int D>
struct scalar_sums {
  std::vector<double> p;                  // Pa
  std::array<std::vector<double>, D> dv;  // m/s2
  std::vector<double> work;               // W/kg, of the pressure
  std::vector<double> dlnrho;             // 1/s
  std::vector<double> heat;               // W, dissipation

  explicit scalar_sums(std::size_t n) : p(n), work(n), dlnrho(n), heat(n) { dv.fill(std::vector<double>(n)); }
};

// Fills `sums`; the forces use the given pressure, not the sum just made, whose ghosts are not known.
template <int D>
void sum_scalar(const scalar_problem<D>& problem, scalar_sums<D>& sums);

}  // namespace tetsuame::bench
