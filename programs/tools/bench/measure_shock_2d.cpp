#include <bench/shock_rig.hpp>

void tetsuame::bench::measure_shock_2d(const request& asked, const std::function<void(const result&)>& take) {
  measure_scheme<2>(asked, take);
}
