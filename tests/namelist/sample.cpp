#include "sample.hpp"

#include <fmt/format.h>

#include <bit>

using namespace tetsuame;

namelist::schema schema_of(sample& to) {
  namelist::schema result;
  result.group("sample", "one key of each kind");
  result.add("sample", "r", to.r);
  result.add("sample", "r2", to.r2);
  result.add("sample", "ra", to.ra, {.maximum_size = 8});
  result.add("sample", "inf", to.inf);
  result.add("sample", "i", to.i);
  result.add("sample", "j", to.j);
  result.add("sample", "ia", to.ia, {.maximum_size = 8});
  result.add("sample", "flag", to.flag);
  result.add("sample", "flag2", to.flag2);
  result.add("sample", "s", to.s);
  result.add("sample", "t", to.t);
  result.add("sample", "sa", to.sa, {.maximum_size = 4});
  return result;
}

namespace {

std::string hexadecimal(double x) { return fmt::format(" {:016X}", std::bit_cast<std::uint64_t>(x)); }

// Fortran's texts here have 24 bytes, of which blanks at the end do not count.
std::string hexadecimal(const std::string& text) {
  std::string shown = text.substr(0, 24);
  shown.erase(shown.find_last_not_of(' ') + 1);
  std::string result = "string ";
  for (const char c : shown) result += fmt::format("{:02X}", static_cast<unsigned char>(c));
  return result + '\n';
}

}  // namespace

std::string printed(const sample& values) {
  std::string result = "reals" + hexadecimal(values.r) + hexadecimal(values.r2) + hexadecimal(values.inf);
  for (const double x : values.ra) result += hexadecimal(x);
  result += fmt::format("\nintegers {} {}", values.i, values.j);
  for (const std::int64_t k : values.ia) result += fmt::format(" {}", k);
  result += fmt::format("\nlogicals {} {}\n", values.flag ? 'T' : 'F', values.flag2 ? 'T' : 'F');
  result += hexadecimal(values.s) + hexadecimal(values.t);
  for (const std::string& text : values.sa) result += hexadecimal(text);
  return result;
}
