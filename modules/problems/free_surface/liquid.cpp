#include <cmath>
#include <foundation/threads.hpp>
#include <free_surface/liquid.hpp>

namespace tetsuame::free_surface {

namespace {

double power(double s, std::int64_t n) {
  double product = 1.0;
  for (std::int64_t k = 0; k < n; ++k) product *= s;
  return product;
}

double stiffness(const liquid& w) { return w.sound * w.sound * w.density / static_cast<double>(w.exponent); }

}  // namespace

double liquid::pressure(double rho) const { return stiffness(*this) * (power(rho / density, exponent) - 1.0); }

double liquid::density_at(double p) const {
  return density * std::pow(1.0 + p / stiffness(*this), 1.0 / static_cast<double>(exponent));
}

double liquid::density_beneath(double gd) const {
  const double of_sound = gd / (sound * sound), n = static_cast<double>(exponent) - 1.0;
  return density * (exponent == 1 ? std::exp(of_sound) : std::pow(1.0 + n * of_sound, 1.0 / n));
}

double liquid::elastic_energy(double rho) const {
  const double s = rho / density;
  if (exponent == 1) return sound * sound * (std::log(s) + 1.0 / s - 1.0);
  const double n = static_cast<double>(exponent);
  return stiffness(*this) / density * (power(s, exponent - 1) / (n - 1.0) + 1.0 / s - n / (n - 1.0));
}

void find_pressures(const liquid& water, std::size_t first, std::size_t last, const double* rho, const double* m,
                    double* p, double* V) {
  foundation::for_all(last - first, [&](std::size_t k) {
    const std::size_t i = first + k;
    p[i] = water.pressure(rho[i]);
    V[i] = m[i] / rho[i];
  });
}

}  // namespace tetsuame::free_surface
