#include <bench/rig.hpp>

void tetsuame::bench::measure_3d(const request& asked, const std::function<void(const result&)>& take) {
  measure_in<3>(asked, take);
}
