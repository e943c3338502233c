#include <cmath>
#include <foundation/error.hpp>
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

struct wave {
  double k, weight;           // 1/m; N_k
  std::vector<double> value;  // at the centres; of one drop its square is in the weight
};

bool around(const drop_among_free_slip& d, std::size_t a) { return d.periodic[a] && a != 1; }

double unit_of(const drop_among_free_slip& d, std::size_t a) {  // 1/m, the smallest wave number
  return (around(d, a) ? 2.0 : 1.0) * pi / d.length[a];
}

std::vector<wave> waves(const drop_among_free_slip& d, std::size_t a) {
  std::vector<wave> all;
  const double unit = unit_of(d, a);
  const int n = static_cast<int>(std::ceil(largest_ka / (d.radius * unit)));
  for (int m = 0; m <= n; ++m) {
    const double phase = unit * m * d.centre[a];
    const double shape = a == 1 ? std::sin(phase) : std::cos(phase);
    const double square = around(d, a) ? 0.5 : shape * shape;  // the two waves of one length, each a half
    all.push_back({unit * m, m == 0 ? (a == 1 ? 0.0 : 1.0) : (around(d, a) ? 4.0 : 2.0) * square, {1.0}});
  }
  return all;
}

// Over the wave numbers up to ka = most.
double sum_of(const drop_among_free_slip& d, const std::array<std::vector<wave>, 3>& along, double most) {
  double sum = 0.0;
  std::vector<double> both(along[0][0].value.size());
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
  return sum;
}

// Of several drops the series is shorter, in three dimensions.
double largest_of_many(const drop_among_free_slip& d) { return d.dimension == 3 ? 0.5 * largest_ka : largest_ka; }

// Wave numbers up to ka = most: a quarter of an ellipse, or an eighth of an ellipsoid.
double wave_numbers(const drop_among_free_slip& d, double most) {
  double n = d.dimension == 3 ? pi / 6.0 : pi / 4.0;
  for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a) n *= 1.0 + most / (d.radius * unit_of(d, a));
  return n;
}

void check_inside(const drop_among_free_slip& d, std::span<const std::array<double, 3>> centres) {
  for (const auto& centre : centres)
    for (std::size_t a = 0; a < static_cast<std::size_t>(d.dimension); ++a)
      if (!(d.radius > 0.0 && d.length[a] > 0.0) ||
          (!around(d, a) && (centre[a] < d.radius || centre[a] > d.length[a] - d.radius)))
        foundation::fail_input("drop in a free-slip box: every drop must lie inside the box");
}

// m/s, of one drop of the surroundings' viscosity by the sum of the series.
double velocity_of(const drop_among_free_slip& d, double sum) {
  const bool deep = d.dimension == 3;
  const double volume = pi * d.radius * d.radius * (deep ? 4.0 / 3.0 * d.radius : 1.0);
  const double box = d.length[0] * d.length[1] * (deep ? d.length[2] : 1.0);
  return d.density_difference * d.gravity * volume / (d.viscosity * box) * sum;
}

}  // namespace

double terms_of_fall(const drop_among_free_slip& d) { return wave_numbers(d, largest_ka); }

double terms_of_mean_fall(const drop_among_free_slip& d, std::size_t centres) {
  const double phases = (around(d, 0) ? 2.0 : 1.0) * (d.dimension == 3 && around(d, 2) ? 2.0 : 1.0);
  return wave_numbers(d, largest_of_many(d)) * phases * static_cast<double>(centres);
}

double fall_velocity(const drop_among_free_slip& d) {
  const bool deep = d.dimension == 3;
  check_inside(d, std::span(&d.centre, 1));
  const double equal = velocity_of(
      d, sum_of(d, {waves(d, 0), waves(d, 1), deep ? waves(d, 2) : std::vector<wave>{{0.0, 1.0, {1.0}}}}, largest_ka));
  if (d.viscosity == d.drop_viscosity) return equal;
  const double ratio = d.drop_viscosity / d.viscosity;
  if (deep) {
    const drop one{d.radius, d.density_difference, d.gravity, d.viscosity, d.drop_viscosity},
        same{d.radius, d.density_difference, d.gravity, d.viscosity, d.viscosity};
    return equal + hadamard_rybczynski(one) - hadamard_rybczynski(same);
  }
  return equal + 0.25 * d.density_difference * d.gravity * d.radius * d.radius / d.viscosity *
                     (1.0 / (2.0 + 2.0 * ratio) - 0.25);
}

double mean_fall_velocity(const drop_among_free_slip& d, std::span<const std::array<double, 3>> centres) {
  if (d.viscosity != d.drop_viscosity)
    foundation::fail_input("drops in a free-slip box: their viscosity must be that of the surroundings");
  check_inside(d, centres);
  // Along each axis: wave numbers and N_k, and the wave at every centre.
  const double most = largest_of_many(d);
  const auto along = [&](std::size_t a) {
    std::vector<wave> all;
    if (a >= static_cast<std::size_t>(d.dimension)) {
      all.push_back({0.0, 1.0, std::vector<double>(centres.size(), 1.0)});
      return all;
    }
    const bool periodic = around(d, a);
    const double unit = unit_of(d, a);
    for (int m = 0; m * unit * d.radius <= most; ++m)
      for (const bool sine : {false, true}) {
        if (sine ? (m == 0 || !(a == 1 || periodic)) : a == 1) continue;
        wave w{m * unit, m == 0 ? 1.0 : 2.0, {}};
        for (const auto& centre : centres)
          w.value.push_back(sine ? std::sin(w.k * centre[a]) : std::cos(w.k * centre[a]));
        all.push_back(std::move(w));
      }
    return all;
  };
  return velocity_of(d, sum_of(d, {along(0), along(1), along(2)}, most)) / static_cast<double>(centres.size());
}

}  // namespace tetsuame::theory
