#include <fmt/core.h>

#include <cmath>
#include <eos/inversion.hpp>
#include <eos/surface.hpp>
#include <eos/tabulated.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

namespace {

std::vector<double> logarithms(std::vector<double> values) {
  for (double& x : values) x = std::log(x);
  return values;
}

// The energy at each density so that it does not fall with temperature: what is above the next is lowered to it.
std::vector<double> rising(std::vector<double> u, std::size_t densities, std::size_t& lowered) {
  for (std::size_t k = u.size() - densities; k-- > 0;)
    if (u[k] > u[k + densities]) {
      u[k] = u[k + densities];
      ++lowered;
    }
  return u;
}

}  // namespace

struct tabulated::surfaces {
  axis L, Y;  // ln rho, ln T
  surface p, u;

  surfaces(const table_data& t, std::size_t& lowered)
      : L(logarithms(t.rho)),
        Y(logarithms(t.T)),
        p(L, Y, t.p, true, false),
        u(L, Y, rising(t.u, t.rho.size(), lowered), false, true) {}
};

tabulated::tabulated(description about_, const table_data& table)
    : about(std::move(about_)),
      reach_{table.rho.front(), table.rho.back(), table.T.front(), table.T.back()},
      surfaces_(std::make_shared<const surfaces>(table, lowered_)) {}

properties tabulated::evaluate(double rho, double T) const {
  const surfaces& s = *surfaces_;
  const double L = std::log(rho), Y = std::log(T);
  if (!(s.L.holds(L) && s.Y.holds(Y))) return {nan, nan, nan, nan, nan};
  const axis_place x = s.L.find(L), y = s.Y.find(Y);
  const surface_point p = s.p.at(x, y), u = s.u.at(x, y);
  const double alpha_K = p.by_y / T, c_V = u.by_y / T;
  const double c2 = (p.by_x + alpha_K / c_V * (p.value / rho - u.by_x)) / rho;
  return {p.value, p.by_x, alpha_K / p.by_x, c_V, std::sqrt(c2)};
}

double tabulated::density(double p, double T) const {
  if (!surfaces_->Y.holds(std::log(T)))
    foundation::fail_calculation(
        fmt::format("equation of state '{}': T = {:g} K lies outside its table, which goes from "
                    "{:g} to {:g} K",
                    about.name, T, reach_.T_low, reach_.T_high));
  return invert(*this, p, T, {reach_.rho_low, std::sqrt(reach_.rho_low * reach_.rho_high), reach_.rho_high});
}

double tabulated::internal_energy(double rho, double T) const {
  const surfaces& s = *surfaces_;
  const double L = std::log(rho), Y = std::log(T);
  if (!(s.L.holds(L) && s.Y.holds(Y))) return nan;
  return s.u.at(s.L.find(L), s.Y.find(Y)).value;
}

double tabulated::temperature(double rho, double u) const {
  const surfaces& s = *surfaces_;
  const double L = std::log(rho);
  if (!s.L.holds(L)) return nan;
  const axis_place x = s.L.find(L);
  std::size_t low = 0, high = s.Y.size() - 1;
  if (!(u >= s.u.at_node(x, low) && u <= s.u.at_node(x, high))) return nan;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (s.u.at_node(x, middle) <= u ? low : high) = middle;
  }
  // Newton's steps in ln T, kept inside the bracket that shrinks.
  double a = s.Y[low], b = s.Y[high], Y = 0.5 * (a + b);
  for (int n = 0; n < 200 && b - a > 0.0; ++n) {
    const surface_point at = s.u.at(x, s.Y.find(Y));
    (at.value > u ? b : a) = Y;
    const double step = at.by_y > 0.0 ? (u - at.value) / at.by_y : nan;
    double next = Y + step;
    if (!(next > a && next < b)) next = 0.5 * (a + b);
    if (std::abs(next - Y) <= 2e-16 * (1.0 + std::abs(Y))) break;
    Y = next;
  }
  return std::exp(Y);
}

}  // namespace tetsuame::eos
