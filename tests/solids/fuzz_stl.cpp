// The fuzz entry: whatever the bytes, an STL file gives a closed surface with finite distances, or foundation::error of
// a bad input. libFuzzer calls it when configured with -DTETSUAME_FUZZ=ON; stl.cpp in the normal suite.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <foundation/error.hpp>
#include <solids/mesh.hpp>

using namespace tetsuame;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto read = solids::read_stl(std::string(reinterpret_cast<const char*>(data), size), "fuzzed.stl");
    solids::expect_closed(read, "fuzzed.stl");
    const solids::mesh surface(read, "fuzzed.stl");
    if (!std::isfinite(surface.at({0.1, 0.2, 0.3}).distance)) std::abort();
  } catch (const foundation::error& e) {
    if (e.status() != foundation::exit_status::bad_input) std::abort();
  }
  return 0;
}
