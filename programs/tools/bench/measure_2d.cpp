#include <bench/rig.hpp>

std::vector<tetsuame::bench::result> tetsuame::bench::measure_2d(const request& asked) { return measure_in<2>(asked); }
