// Units as texts say them: "kg/m^3", "g cm**-3", "km s-1", "W/(m K)".
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace tetsuame::output {

// factor: of SI in one of it. powers: of metre, kilogram, second and kelvin.
struct unit {
  double factor = 1.0;
  std::array<int, 4> powers{};

  friend bool operator==(const unit&, const unit&) = default;
};

unit times(const unit& a, const unit& b, int power = 1);  // a b^power

// None where the text is no unit of these: m, g, s, K, Pa, J, N, W, with SI prefixes, and bar, dyn, erg, min, h, d, yr;
// numbers; products by a blank, '*' or '.', quotients by '/', which holds for the next factor or parenthesis; powers by
// '^', '**' or a number right behind. "1" and "dimensionless" are a number's.
std::optional<unit> unit_of(std::string_view text);

// Of SI, with these powers: "kg/m^3". "1" without any.
std::string name_of(const std::array<int, 4>& powers);

}  // namespace tetsuame::output
