#include <algorithm>
#include <cmath>
#include <complex>
#include <foundation/exact_sum.hpp>
#include <planet/mode.hpp>

namespace tetsuame::planet {

namespace {

constexpr double largest_slope = 0.05;  // m/R times the amplitude, up to which growth is linear to half a per cent

}  // namespace

theory::layered_cylinder layers_of(const profile& planet, const std::vector<double>& viscosities) {
  theory::layered_cylinder c{{}, G};
  for (std::size_t n = 0; n < planet.layers().size(); ++n) {
    const level &out = planet.layers()[n].outer(), &in = planet.layers()[n].inner();
    const double volume = pi * (out.r * out.r - in.r * in.r);
    c.layers.push_back({out.r, (out.m - in.m) / volume, viscosities[n]});
  }
  return c;
}

growing_mode::growing_mode(const theory::layered_cylinder& planet, theory::cylinder_mode mode, double amplitude)
    : mode_(std::move(mode)), amplitude_(amplitude), radius_(planet.layers[mode_.fastest].outer_radius) {
  for (const auto& layer : planet.layers) density_.push_back(layer.density);
}

std::array<double, 2> growing_mode::displacement(double x, double y) const {
  const double r = std::hypot(x, y);
  if (r == 0.0) return {mode_.degree == 1 ? amplitude_ * mode_.at(0.0).radial : 0.0, 0.0};
  const auto [radial, tangential] = mode_.at(r);
  const std::complex z(x / r, y / r), of_degree = std::pow(z, static_cast<int>(mode_.degree));
  const double outwards = amplitude_ * radial * of_degree.real(), along = amplitude_ * tangential * of_degree.imag();
  return {outwards * z.real() - along * z.imag(), outwards * z.imag() + along * z.real()};
}

double growing_mode::measure(const gas::view& w, const gas::point& centre,
                             const std::vector<std::size_t>& layer_of) const {
  foundation::exact_sum sum;
  for (std::size_t i = 0; i < w.n; ++i) {
    const std::size_t layer = layer_of[static_cast<std::size_t>(w.material[i])];
    if (layer > inside()) continue;
    const std::complex z((w.x[0][i] - centre[0]) / radius_, (w.x[1][i] - centre[1]) / radius_);
    sum.add(w.m[i] / density_[layer] * std::pow(z, static_cast<int>(mode_.degree)).real());
  }
  return w.ranks.exact(sum) / (pi * radius_);
}

std::optional<theory::growth_fit> growing_mode::fit(const std::vector<double>& time,
                                                    const std::vector<double>& amplitude) const {
  if (amplitude.empty() || !(amplitude.front() > 0.0)) return std::nullopt;
  const double most = largest_slope * radius_ / static_cast<double>(mode_.degree);
  return theory::fit_growth(time, amplitude, 1.2, most / amplitude.front());
}

}  // namespace tetsuame::planet
