// Errors against an exact solution, and the order of a scheme from a series of them.
#pragma once

#include <span>

namespace tetsuame::exact {

struct error_norms {
  double l1, l2, maximum;  // mean |e|, root of mean e^2, max |e|; unit of the values
};

// Of e = value - exact with weights > 0, such as the particles' volumes: sum w |e|/sum w and
// sqrt(sum w e^2/sum w). Sums are exact, so the order of particles does not matter. All of
// one length > 0, else fail_input; not-a-number in the values comes out as such.
error_norms norms(std::span<const double> value, std::span<const double> exact, std::span<const double> weight);
error_norms norms(std::span<const double> value, std::span<const double> exact);  // equal weights

struct order_fit {
  double order;      // slope of ln(error) against ln(spacing), by least squares
  double intercept;  // ln of the error at spacing 1
};

// At least two different spacings and as many errors, all > 0, else fail_input.
order_fit fit_order(std::span<const double> spacing, std::span<const double> error);

}  // namespace tetsuame::exact
