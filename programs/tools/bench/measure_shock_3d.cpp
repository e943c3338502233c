#include <bench/shock_rig.hpp>

void tetsuame::bench::measure_shock_3d(const request& asked, const std::function<void(const result&)>& take) {
  measure_scheme<3>(asked, take);
}
