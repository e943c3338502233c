#include <cmath>
#include <integrators/stabilised.hpp>

namespace tetsuame::integrators {

namespace {

std::size_t at(int j) { return static_cast<std::size_t>(j); }

// T_j, T_j', T_j'' at x for j = 0 … s, by differentiating T_j = 2x T_(j-1) - T_(j-2).
struct chebyshev {
  std::vector<double> t, d, dd;
  chebyshev(int s, double x) : t(at(s + 1)), d(at(s + 1)), dd(at(s + 1)) {
    t[0] = 1.0;
    t[1] = x;
    d[1] = 1.0;
    for (std::size_t j = 2; j <= at(s); ++j) {
      t[j] = 2.0 * x * t[j - 1] - t[j - 2];
      d[j] = 2.0 * t[j - 1] + 2.0 * x * d[j - 1] - d[j - 2];
      dd[j] = 4.0 * d[j - 1] + 2.0 * x * dd[j - 1] - dd[j - 2];
    }
  }
};

constexpr double damping = 2.0 / 13.0;
double w_0(int s) { return 1.0 + damping / (static_cast<double>(s) * s); }

void fill_rkc2(recurrence& r) {
  const auto s = at(r.stages);
  const double w0 = w_0(r.stages);
  const chebyshev p(r.stages, w0);
  const double w1 = p.d[s] / p.dd[s];
  std::vector<double> b(s + 1);
  for (std::size_t j = 2; j <= s; ++j) b[j] = p.dd[j] / (p.d[j] * p.d[j]);
  b[0] = b[2];
  b[1] = 1.0 / w0;
  r.mu_tilde[1] = b[1] * w1;
  for (std::size_t j = 2; j <= s; ++j) {
    r.mu[j] = 2.0 * b[j] * w0 / b[j - 1];
    r.nu[j] = -b[j] / b[j - 2];
    r.mu_tilde[j] = 2.0 * b[j] * w1 / b[j - 1];
    r.gamma_tilde[j] = -(1.0 - b[j - 1] * p.t[j - 1]) * r.mu_tilde[j];
  }
  r.error_factor = 0.8;
}

void fill_rkl2(recurrence& r) {
  const auto s = at(r.stages);
  const double n = r.stages, w1 = 4.0 / (n * n + n - 2.0);
  std::vector<double> b(s + 1, 1.0 / 3.0);
  for (std::size_t j = 2; j <= s; ++j) {
    const auto x = static_cast<double>(j);
    b[j] = (x * x + x - 2.0) / (2.0 * x * (x + 1.0));
  }
  r.mu_tilde[1] = b[1] * w1;
  for (std::size_t j = 2; j <= s; ++j) {
    const auto x = static_cast<double>(j);
    r.mu[j] = (2.0 * x - 1.0) / x * b[j] / b[j - 1];
    r.nu[j] = -(x - 1.0) / x * b[j] / b[j - 2];
    r.mu_tilde[j] = r.mu[j] * w1;
    r.gamma_tilde[j] = -(1.0 - b[j - 1]) * r.mu_tilde[j];
  }
  const double p3 = (n * n + n - 6.0) / (n * n + n - 2.0) / 9.0;
  r.error_factor = (1.0 / 6.0 - p3) / (0.25 - p3);
}

int fewest(stabilised_method method) { return method == stabilised_method::rkc2 ? 2 : 3; }

}  // namespace

recurrence make_recurrence(stabilised_method method, int stages) {
  const std::size_t length = at(stages + 1);
  const std::vector<double> zeros(length);
  recurrence r{stages, stability_limit(method, stages), 0.0, zeros, zeros, zeros, zeros, zeros};
  method == stabilised_method::rkc2 ? fill_rkc2(r) : fill_rkl2(r);
  // The abscissae are what the recurrence makes of y' = 1.
  r.c[1] = r.mu_tilde[1];
  for (std::size_t j = 2; j < length; ++j)
    r.c[j] = r.mu[j] * r.c[j - 1] + r.nu[j] * r.c[j - 2] + r.mu_tilde[j] + r.gamma_tilde[j];
  return r;
}

double stability_limit(stabilised_method method, int stages) {
  const double s = stages;
  if (method == stabilised_method::rkl2) return 0.5 * (s * s + s - 2.0);
  const chebyshev p(stages, w_0(stages));
  return (w_0(stages) + 1.0) * p.dd[at(stages)] / p.d[at(stages)];
}

int stages_for(stabilised_method method, double z, int most) {
  // Just below what the limits' leading terms ask for; few candidates are left then.
  const double guess = method == stabilised_method::rkc2 ? std::sqrt(z / 0.66) - 2.0 : std::sqrt(2.0 * z) - 3.0;
  if (!(guess < most)) return most + 1;
  const int step = method == stabilised_method::rkc2 ? 1 : 2;
  int s = std::max(fewest(method), static_cast<int>(guess));
  if (step == 2 && s % 2 == 0) s -= 1;
  while (s <= most && !(stability_limit(method, s) >= z)) s += step;
  return s <= most ? s : most + 1;
}

int largest_stages(stabilised_method method, int most) {
  return method == stabilised_method::rkl2 && most % 2 == 0 ? most - 1 : most;
}

}  // namespace tetsuame::integrators
