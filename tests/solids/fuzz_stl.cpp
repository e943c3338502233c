// The fuzz entry: whatever the bytes, an STL file gives a closed surface with finite distances, or foundation::error of
// a bad input. libFuzzer calls it when configured with -DTETSUAME_FUZZ=ON; stl.cpp in the normal suite.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <foundation/error.hpp>
#include <solids/motion.hpp>

using namespace tetsuame;

namespace {

template <class Work>
void expect_no_other_error(Work&& work) {
  try {
    work();
  } catch (const foundation::error& e) {
    if (e.status() != foundation::exit_status::bad_input) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  expect_no_other_error([&] {
    const auto read = solids::read_stl(bytes, "fuzzed.stl");
    solids::expect_closed(read, "fuzzed.stl");
    const solids::mesh surface(read, "fuzzed.stl");
    if (!std::isfinite(surface.at({0.1, 0.2, 0.3}).distance)) std::abort();
  });
  expect_no_other_error([&] {
    const solids::prescribed<2> motion({{0.0, 0.0}}, {{1.0}}, solids::read_motion({bytes, "fuzzed.csv"}, 2));
    motion.rate_at(0.5);
  });
  return 0;
}
