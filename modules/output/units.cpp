#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <output/units.hpp>

namespace tetsuame::output {

namespace {

struct named_unit {
  std::string_view name;
  unit value;
  bool takes_prefix = false;
};

constexpr std::array names{
    named_unit{"m", {1.0, {1, 0, 0, 0}}, true},        named_unit{"g", {1e-3, {0, 1, 0, 0}}, true},
    named_unit{"s", {1.0, {0, 0, 1, 0}}, true},        named_unit{"K", {1.0, {0, 0, 0, 1}}, true},
    named_unit{"Pa", {1.0, {-1, 1, -2, 0}}, true},     named_unit{"J", {1.0, {2, 1, -2, 0}}, true},
    named_unit{"N", {1.0, {1, 1, -2, 0}}, true},       named_unit{"W", {1.0, {2, 1, -3, 0}}, true},
    named_unit{"bar", {1e5, {-1, 1, -2, 0}}, true},    named_unit{"dyn", {1e-5, {1, 1, -2, 0}}},
    named_unit{"erg", {1e-7, {2, 1, -2, 0}}},          named_unit{"min", {60.0, {0, 0, 1, 0}}},
    named_unit{"h", {3600.0, {0, 0, 1, 0}}},           named_unit{"d", {86400.0, {0, 0, 1, 0}}},
    named_unit{"yr", {3.15576e7, {0, 0, 1, 0}}, true}, named_unit{"dimensionless", {}},
};

struct prefix {
  std::string_view name;
  double value;
};
constexpr std::array prefixes{prefix{"n", 1e-9}, prefix{"u", 1e-6}, prefix{"\xc2\xb5", 1e-6},
                              prefix{"m", 1e-3}, prefix{"c", 1e-2}, prefix{"k", 1e3},
                              prefix{"M", 1e6},  prefix{"G", 1e9},  prefix{"T", 1e12}};

std::optional<unit> find(std::string_view word) {
  for (const auto& n : names)
    if (n.name == word) return n.value;
  for (const auto& p : prefixes)
    for (const auto& n : names)
      if (n.takes_prefix && word.size() == p.name.size() + n.name.size() && word.starts_with(p.name) &&
          word.ends_with(n.name))
        return unit{p.value * n.value.factor, n.value.powers};
  return {};
}

// A recursive descent. `rest` is what is still to read; failed() once it is no unit.
class parser {
 public:
  explicit parser(std::string_view text) : rest_(text) {}

  std::optional<unit> whole() {
    const auto found = product();
    skip_blanks();
    if (failed_ || !rest_.empty()) return {};
    return found;
  }

 private:
  unit product() {
    unit all = factor();
    while (!failed_) {
      skip_blanks();
      if (rest_.empty() || rest_.front() == ')') break;
      int sign = 1;
      if (take("/"))
        sign = -1;
      else if (!take("*"))
        take(".");
      all = times(all, factor(), sign);
    }
    return all;
  }

  unit factor() {
    skip_blanks();
    if (take("(")) {
      const unit inner = product();
      if (!take(")")) failed_ = true;
      return times({}, inner, power());
    }
    if (!rest_.empty() && std::isdigit(static_cast<unsigned char>(rest_.front()))) {
      unit number;
      const auto end = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number.factor);
      if (end.ec != std::errc() || !(number.factor > 0.0)) failed_ = true;
      rest_.remove_prefix(static_cast<std::size_t>(end.ptr - rest_.data()));
      return times({}, number, power());
    }
    const auto letters =
        std::find_if(rest_.begin(), rest_.end(), [](unsigned char c) { return !(std::isalpha(c) || c >= 0x80); });
    const auto length = static_cast<std::size_t>(letters - rest_.begin());
    const auto named = find(rest_.substr(0, length));
    rest_.remove_prefix(length);
    if (!named) failed_ = true;
    return times({}, named.value_or(unit{}), power());
  }

  // 1 where none is said.
  int power() {
    const bool marked = take("^") || take("**");
    std::size_t begin = 0;
    if (!rest_.empty() && (rest_.front() == '-' || rest_.front() == '+')) begin = 1;
    std::size_t end = begin;
    while (end < rest_.size() && std::isdigit(static_cast<unsigned char>(rest_[end]))) ++end;
    if (end == begin) {
      failed_ = failed_ || marked || begin == 1;
      return 1;
    }
    int value = 0;
    std::from_chars(rest_.data() + begin, rest_.data() + end, value);
    if (value > 9) failed_ = true;
    const bool negative = rest_.front() == '-';
    rest_.remove_prefix(end);
    return negative ? -value : value;
  }

  void skip_blanks() {
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
  }
  bool take(std::string_view sign) {
    if (!rest_.starts_with(sign) || (sign == "*" && rest_.starts_with("**"))) return false;
    rest_.remove_prefix(sign.size());
    return true;
  }

  std::string_view rest_;
  bool failed_ = false;
};

}  // namespace

unit times(const unit& a, const unit& b, int power) {
  unit c = a;
  c.factor *= std::pow(b.factor, power);
  for (std::size_t k = 0; k < c.powers.size(); ++k) c.powers[k] += power * b.powers[k];
  return c;
}

std::optional<unit> unit_of(std::string_view text) { return parser(text).whole(); }

std::string name_of(const std::array<int, 4>& powers) {
  constexpr std::array<std::string_view, 4> base{"m", "kg", "s", "K"};
  std::string above, below;
  for (const std::size_t k : {1, 0, 2, 3}) {
    const int p = powers[k];
    auto& text = p > 0 ? above : below;
    if (p == 0) continue;
    if (!text.empty()) text += ' ';
    text += base[k];
    if (std::abs(p) > 1) text += fmt::format("^{}", std::abs(p));
  }
  const bool several = below.find(' ') != std::string::npos;
  const std::string_view numerator = above.empty() ? "1" : std::string_view(above);
  return below.empty() ? std::string(numerator) : fmt::format("{}/{}", numerator, several ? "(" + below + ")" : below);
}

}  // namespace tetsuame::output
