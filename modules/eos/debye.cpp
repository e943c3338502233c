#include <array>
#include <cmath>
#include <eos/debye.hpp>

namespace tetsuame::eos {

namespace {

// Bernoulli's numbers of even index from the second, each over (2k)! (2k + 3): 3/y^3 times the integral of
// t^3/(e^t - 1) = t^2 (1 - t/2 + sum B_2k t^2k/(2k)!). With y <= 1 the next one would be 1e-18.
constexpr std::array<double, 9> series{1.0 / 6.0 / 2.0 / 5.0,
                                       -1.0 / 30.0 / 24.0 / 7.0,
                                       1.0 / 42.0 / 720.0 / 9.0,
                                       -1.0 / 30.0 / 40320.0 / 11.0,
                                       5.0 / 66.0 / 3628800.0 / 13.0,
                                       -691.0 / 2730.0 / 479001600.0 / 15.0,
                                       7.0 / 6.0 / 87178291200.0 / 17.0,
                                       -3617.0 / 510.0 / 20922789888000.0 / 19.0,
                                       43867.0 / 798.0 / 6402373705728000.0 / 21.0};

double integral(double y) {
  if (y <= 1.0) {
    double sum = 0.0;
    for (std::size_t k = series.size(); k-- > 0;) sum = (sum + series[k]) * y * y;
    return 1.0 - 0.375 * y + 3.0 * sum;
  }
  // The whole integral, pi^4/15, less that from y on, term by term of 1/(e^t - 1) = sum e^-nt.
  constexpr double whole = 6.493939402266829;
  double rest = 0.0;
  for (int n = 1; n * y < 40.0; ++n) {
    const double m = n * y;
    rest += std::exp(-m) * (m * (m * (m + 3.0) + 6.0) + 6.0) / (static_cast<double>(n) * n * n * n);
  }
  return 3.0 * (whole - rest) / (y * y * y);
}

}  // namespace

debye_point debye(double theta, double T) {
  const double y = theta / T, D = integral(y), occupied = y < 700.0 ? y / std::expm1(y) : 0.0;
  return {3.0 * D, 3.0 * std::log(-std::expm1(-y)) - D, 12.0 * D - 9.0 * occupied};
}

}  // namespace tetsuame::eos
