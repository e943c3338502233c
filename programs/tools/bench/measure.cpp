#include <malloc.h>

#include <algorithm>
#include <bench/measure.hpp>

namespace tetsuame::bench {

bool is_scheme(const std::string& name) {
  return std::find(scheme_names.begin(), scheme_names.end(), name) != scheme_names.end();
}

void measure(const request& asked, const std::function<void(const result&)>& take) {
  const bool plane = asked.dimension == 2;
  if (is_scheme(asked.name))
    (plane ? measure_shock_2d : measure_shock_3d)(asked, take);
  else
    (plane ? measure_2d : measure_3d)(asked, take);
}

double memory_needed(const request& asked) {
  // Entries of 4 bytes within support and skin (3.8 spacings), and up to twice the arrays while
  // particles are sorted and lists made. Ghosts and walls add to small cases only.
  const double list = 4.0 * (asked.dimension == 2 ? 49.0 : 234.0);
  return static_cast<double>(asked.particles()) * (list + 1000.0);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double heap_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

}  // namespace tetsuame::bench
