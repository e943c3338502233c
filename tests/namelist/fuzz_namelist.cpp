// The fuzz entry: whatever the bytes, the reader gives values or foundation::error, and
// values it accepts survive being written and read again. libFuzzer calls it when
// configured with -DTETSUAME_FUZZ=ON; test_mutations.cpp in the normal suite.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <foundation/error.hpp>
#include <namelist/schema.hpp>
#include <sstream>

using namespace tetsuame;

namespace {

struct options {
  double r = 1.0;
  std::int64_t i = 2, n = 3;
  bool flag = false;
  std::string s = "abc", method = "euler";
  std::optional<double> o, oi;
  std::vector<double> ra{1.0, 2.0}, sparse;
  std::vector<std::int64_t> ia;
  std::vector<std::string> sa{"x"};
};

namelist::schema schema_of(options& to) {
  namelist::schema result;
  result.group("sample", "");
  result.add("sample", "r", to.r, {.minimum = -1e300, .exclusive_minimum = true});
  result.add("sample", "i", to.i);
  result.add("sample", "n", to.n, {.maximum = 1000});
  result.add("sample", "flag", to.flag);
  result.add("sample", "s", to.s);
  result.add("sample", "method", to.method, {.choices = {"euler", "adaptive"}});
  result.group("lists", "");
  result.add("lists", "o", to.o);
  result.add("lists", "oi", to.oi);
  result.add("lists", "ra", to.ra, {.maximum_size = 20});
  result.add("lists", "sparse", to.sparse, {.maximum_size = 20, .sparse = true});
  result.add("lists", "ia", to.ia);
  result.add("lists", "sa", to.sa);
  return result;
}

std::string resolved(const namelist::document& input) {
  options o;
  namelist::schema s = schema_of(o);
  s.read(input);
  std::ostringstream out;
  s.write_resolved(out);
  return out.str();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::string first;
  try {
    first = resolved(namelist::parse_text(text, "input"));
  } catch (const foundation::error&) {
  }
  // Outside the try: what was accepted once must be accepted again, with the same values.
  if (!first.empty() && resolved(namelist::parse_text(first, "resolved")) != first) std::abort();
  try {
    namelist::document empty;
    empty.set(text);
    resolved(empty);
  } catch (const foundation::error&) {
  }
  return 0;
}
