// Stabilised explicit Runge–Kutta methods of order 2 for diffusion, 'rkc2' (s >= 2 stages) and 'rkl2' (s >= 3 and odd,
// so that the highest modes are damped), with their error estimates: docs/theory/stabilised.md. One recurrence,
//   Y_j = (1 - mu_j - nu_j) Y_0 + mu_j Y_(j-1) + nu_j Y_(j-2) + dt (mu~_j F_(j-1) + gamma~_j F_0),  F_j = f(t + c_j dt,
//   Y_j)
#pragma once

#include <vector>

namespace tetsuame::integrators {

enum class stabilised_method { rkc2, rkl2 };

struct recurrence {
  int stages;
  double limit;           // largest dt * spectral radius
  double error_factor;    // K, of the error estimate
  std::vector<double> c;  // c[j], j = 0 … s
  std::vector<double> mu, nu, mu_tilde, gamma_tilde;
};

// stages >= 2 (rkc2), >= 3 (rkl2; even numbers work, but damp less).
recurrence make_recurrence(stabilised_method method, int stages);

// rkc2: (w_0 + 1) T_s''(w_0) / T_s'(w_0), about 0.65 s^2; rkl2: (s^2 + s - 2) / 2.
double stability_limit(stabilised_method method, int stages);

// The least number of stages, odd for rkl2, whose limit is at least z = dt * radius >= 0; more than
// `most` is told as most + 1.
int stages_for(stabilised_method method, double z, int most);

// `most`, or one less where the method wants an odd number.
int largest_stages(stabilised_method method, int most);

}  // namespace tetsuame::integrators
