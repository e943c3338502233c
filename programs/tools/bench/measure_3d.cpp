#include <bench/rig.hpp>

std::vector<tetsuame::bench::result> tetsuame::bench::measure_3d(const request& asked) { return measure_in<3>(asked); }
