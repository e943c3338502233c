#include <bench/rig.hpp>

void tetsuame::bench::measure_2d(const request& asked, const std::function<void(const result&)>& take) {
  measure_in<2>(asked, take);
}
