#include <cmath>
#include <numbers>
#include <theory/drop.hpp>
#include <theory/free_slip_box.hpp>
#include <vector>

namespace tetsuame::theory {

namespace {

constexpr double pi = std::numbers::pi, largest_ka = 60.0;

double form_factor(int dimension, double q) {
  if (q < 1e-3) return 1.0 - q * q / (dimension == 3 ? 10.0 : 8.0);
  return dimension == 3 ? 3.0 * (std::sin(q) - q * std::cos(q)) / (q * q * q) : 2.0 * std::cyl_bessel_j(1.0, q) / q;
}

bool around(const drop_among_free_slip& d, std::size_t a) { return d.periodic[a] && a != 1; }

double unit_of(const drop_among_free_slip& d, std::size_t a) {  // 1/m, the smallest wave number
  return (around(d, a) ? 2.0 : 1.0) * pi / d.length[a];
}

using places = std::span<const std::array<double, 3>>;

struct wave {
  double k, weight;           // 1/m; N_k
  std::vector<double> value;  // at the centres
};

// Along axis a up to ka = most. Of one drop between periodic sides it does not matter where it lies: with its centre at
// 0 there are no sines.
std::vector<wave> waves(const drop_among_free_slip& d, places centres, std::size_t a, double most) {
  if (a >= static_cast<std::size_t>(d.dimension)) return {{0.0, 1.0, std::vector<double>(centres.size(), 1.0)}};
  const bool periodic = around(d, a), anywhere = periodic && centres.size() == 1;
  const double unit = unit_of(d, a);
  std::vector<wave> all;
  for (int m = 0; m * unit * d.radius <= most; ++m)
    for (const bool sine : {false, true}) {
      if (sine ? (m == 0 || anywhere || !(a == 1 || periodic)) : a == 1) continue;
      wave w{m * unit, m == 0 ? 1.0 : 2.0, {}};
      for (const auto& centre : centres) {
        const double phase = anywhere ? 0.0 : w.k * centre[a];
        w.value.push_back(sine ? std::sin(phase) : std::cos(phase));
      }
      all.push_back(std::move(w));
    }
  return all;
}

// m/s, the mean of drops of the surroundings' viscosity, by the series up to ka = most.
double velocity_of(const drop_among_free_slip& d, places centres, double most) {
  const std::array along{waves(d, centres, 0, most), waves(d, centres, 1, most), waves(d, centres, 2, most)};
  double sum = 0.0;
  std::vector<double> both(centres.size());
  for (const auto& x : along[0])
    for (const auto& z : along[2]) {
      const double across = x.k * x.k + z.k * z.k;
      if (across == 0.0) continue;
      for (std::size_t j = 0; j < both.size(); ++j) both[j] = x.value[j] * z.value[j];
      for (const auto& y : along[1]) {
        const double k2 = across + y.k * y.k, q = d.radius * std::sqrt(k2);
        if (q > most) break;
        double amplitude = 0.0;
        for (std::size_t j = 0; j < both.size(); ++j) amplitude += both[j] * y.value[j];
        const double s = form_factor(d.dimension, q) * amplitude;
        sum += x.weight * y.weight * z.weight * across / (k2 * k2) * s * s;
      }
    }
  const bool deep = d.dimension == 3;
  const double volume = pi * d.radius * d.radius * (deep ? 4.0 / 3.0 * d.radius : 1.0);
  const double box = d.length[0] * d.length[1] * (deep ? d.length[2] : 1.0);
  return d.density_difference * d.gravity * volume / (d.viscosity * box) * sum / static_cast<double>(centres.size());
}

// Of several drops the series is shorter, in three dimensions.
double largest_of_many(const drop_among_free_slip& d) { return d.dimension == 3 ? 0.5 * largest_ka : largest_ka; }

// Wave numbers up to ka = most: a quarter of an ellipse, or an eighth of an ellipsoid.
double wave_numbers(const drop_among_free_slip& d, double most) {
  double n = d.dimension == 3 ? pi / 6.0 : pi / 4.0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a) n *= 1.0 + most / (d.radius * unit_of(d, a));
  return n;
}

}  // namespace

double terms_of_fall(const drop_among_free_slip& d) { return wave_numbers(d, largest_ka); }

double terms_of_mean_fall(const drop_among_free_slip& d, std::size_t centres) {
  const double phases = (around(d, 0) ? 2.0 : 1.0) * (d.dimension == 3 && around(d, 2) ? 2.0 : 1.0);
  return wave_numbers(d, largest_of_many(d)) * phases * static_cast<double>(centres);
}

double fall_velocity(const drop_among_free_slip& d) {
  const double equal = velocity_of(d, {&d.centre, 1}, largest_ka);
  if (d.viscosity == d.drop_viscosity) return equal;
  const drop one{d.radius, d.density_difference, d.gravity, d.viscosity, d.drop_viscosity},
      same{d.radius, d.density_difference, d.gravity, d.viscosity, d.viscosity};
  return equal + hadamard_rybczynski(one) - hadamard_rybczynski(same);
}

double mean_fall_velocity(const drop_among_free_slip& d, std::span<const std::array<double, 3>> centres) {
  return velocity_of(d, centres, largest_of_many(d));
}

}  // namespace tetsuame::theory
