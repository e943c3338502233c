// Stabilised explicit Runge–Kutta methods of order 2 for diffusion: s stages reach a step of
// about s^2 times forward Euler's.
//   'rkc2'  Chebyshev polynomials, damping 2/13 [B. P. Sommeijer, L. F. Shampine, J. G. Verwer,
//           J. Comput. Appl. Math. 88, 315 (1998)], s >= 2
//   'rkl2'  Legendre polynomials [C. D. Meyer, D. S. Balsara, T. D. Aslam, J. Comput. Phys. 257,
//           594 (2014)], s >= 3 and odd, as they advise: so the highest modes are damped
// Both are one recurrence, F_j = f(t + c_j dt, Y_j),
//   Y_0 = y,  Y_1 = Y_0 + mu~_1 dt F_0,
//   Y_j = (1 - mu_j - nu_j) Y_0 + mu_j Y_(j-1) + nu_j Y_(j-2) + dt (mu~_j F_(j-1) + gamma~_j F_0),
// and y_(n+1) = Y_s. On y' = lambda y it gives P(dt lambda) y with |P| <= 1 on [-limit, 0].
//
// Error estimate: K [ y_n - y_(n+1) + dt/2 (F_n + F_(n+1)) ], no evaluation beyond the rate of the next
// step. On y' = lambda y, with z = dt lambda and P = 1 + z + z^2/2 + p_3 z^3 + …, the bracket is
// (1/4 - p_3) z^3 + O(z^4) and the local error (1/6 - p_3) z^3 + O(z^4).
//   rkc2: K = 4/5, as published: of the right order, 1.8 times the local error as s grows (p_3 -> 1/10);
//   rkl2: K = (1/6 - p_3) / (1/4 - p_3), the local error itself to leading order (derived here), where
//         p_3 = b_s w_1^3 L_s'''(1) / 6 = (1/9) (s^2 + s - 6) / (s^2 + s - 2), so K -> 2/5.
#pragma once

#include <vector>

namespace tetsuame::integrators {

enum class stabilised_method { rkc2, rkl2 };

struct recurrence {
  int stages;
  double limit;           // largest dt * spectral radius
  double error_factor;    // K
  std::vector<double> c;  // c[j], j = 0 … s
  std::vector<double> mu, nu, mu_tilde, gamma_tilde;
};

// stages >= 2 (rkc2), >= 3 (rkl2; even numbers work, but damp less); std::invalid_argument else.
recurrence make_recurrence(stabilised_method method, int stages);

// rkc2: (w_0 + 1) T_s''(w_0) / T_s'(w_0), about 0.65 s^2; rkl2: (s^2 + s - 2) / 2.
double stability_limit(stabilised_method method, int stages);

// The least number of stages, odd for rkl2, whose limit is at least z = dt * radius >= 0; more than
// `most` is told as most + 1.
int stages_for(stabilised_method method, double z, int most);

// `most`, or one less where the method wants an odd number.
int largest_stages(stabilised_method method, int most);

}  // namespace tetsuame::integrators
