#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <eos/tabulate.hpp>
#include <foundation/error.hpp>

namespace tetsuame::eos {

namespace {

std::vector<double> even_in_logarithm(double low, double high, std::size_t n) {
  std::vector<double> nodes(n);
  for (std::size_t k = 0; k < n; ++k)
    nodes[k] = low * std::pow(high / low, static_cast<double>(k) / static_cast<double>(n - 1));
  nodes.back() = high;
  return nodes;
}

// Simpson's rule over ln x from one node to the next.
template <class F>
double step(double from, double to, F slope) {
  return std::log(to / from) / 6.0 * (slope(from) + 4.0 * slope(std::sqrt(from * to)) + slope(to));
}

}  // namespace

table_data tabulate(const caloric& material, const table_axes& axes) {
  table_data table;
  table.title = fmt::format("{}: {}", about(material.material()).name, about(material.material()).source);
  table.rho = even_in_logarithm(axes.rho_low, axes.rho_high, axes.densities);
  table.T = even_in_logarithm(axes.T_low, axes.T_high, axes.temperatures);
  const auto at = [&](double rho, double T) { return evaluate(material.material(), rho, T); };
  const auto& rho = table.rho;
  for (std::size_t j = 0; j < table.T.size(); ++j)
    for (std::size_t i = 0; i < rho.size(); ++i) {
      const double T = table.T[j], u = material.internal_energy(rho[i], T);
      const properties here = at(rho[i], T);
      if (!(std::isfinite(here.p) && std::isfinite(u) && here.c_V > 0.0))
        foundation::fail_input(fmt::format("equation of state '{}' has no state of {:g} kg/m^3 and {:g} K to tabulate",
                                           about(material.material()).name, rho[i], T));
      const double before = j > 0    ? table.s[table.s.size() - rho.size()]
                            : i == 0 ? 0.0
                                     : table.s.back() + step(rho[i - 1], rho[i], [&](double r) {
                                         const properties e = at(r, T);
                                         return -e.alpha * e.K_T / r;
                                       });
      table.p.push_back(here.p);
      table.u.push_back(u);
      const double c = material.at(rho[i], u).c;
      table.c.push_back(std::isnan(c) ? 0.0 : c);
      table.s.push_back(j == 0 ? before
                               : before + step(table.T[j - 1], T, [&](double t) { return at(rho[i], t).c_V; }));
    }
  const double least = *std::ranges::min_element(table.s);
  for (double& s : table.s) s -= least;
  return table;
}

}  // namespace tetsuame::eos
