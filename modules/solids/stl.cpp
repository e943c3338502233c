// STL files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <foundation/error.hpp>
#include <limits>
#include <namelist/text.hpp>
#include <optional>
#include <solids/mesh.hpp>
#include <string_view>
#include <unordered_map>

namespace tetsuame::solids {

namespace {

using foundation::fail_input;
using place = std::array<double, 3>;
using facet = std::array<place, 3>;

// ---- text ---------------------------------------------------------------------------------

class text_reader {
 public:
  text_reader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::vector<facet> facets() {
    std::vector<facet> all;
    while (!ended()) read_solid(all);
    return all;
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
  [[noreturn]] void fail(const std::string& message) const {
    fail_input(fmt::format("{}:{}: {}", name_, line_, message));
  }

  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
  }
  bool ended() {
    skip_blanks();
    return at_ == text_.size();
  }
  // The next word; empty at the end.
  std::string_view word() {
    skip_blanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  std::string next_word() const {
    auto ahead = *this;
    return namelist::lower(ahead.word());
  }
  void expect(const char* wanted, std::size_t number) {
    const auto found = word();
    if (namelist::lower(found) == wanted) return;
    const auto of = number > 0 ? fmt::format("facet {}: ", number) : "";
    if (found.empty()) fail(fmt::format("{}expected '{}', and the file ends: it is broken off", of, wanted));
    fail(fmt::format("{}expected '{}', found '{}'", of, wanted, namelist::excerpt(found)));
  }

  // Behind solid or endsolid, to the end of the line; a facet may begin in the same line.
  void skip_name() {
    while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') {
      auto ahead = *this;
      if (namelist::lower(ahead.word()) == "facet" && ahead.next_word() == "normal") return;
      if (is_blank(text_[at_]))
        ++at_;
      else
        word();
    }
  }

  void read_solid(std::vector<facet>& all) {
    expect("solid", 0);
    skip_name();
    while (next_word() == "facet") all.push_back(read_facet(all.size() + 1));
    expect("endsolid", 0);
    skip_name();
  }

  facet read_facet(std::size_t number) {
    expect("facet", number);
    expect("normal", number);
    for (int k = 0; k < 3; ++k) word();
    expect("outer", number);
    expect("loop", number);
    facet f;
    for (auto& p : f) {
      expect("vertex", number);
      for (double& x : p) x = read_number(number);
    }
    if (next_word() == "vertex") fail(fmt::format("facet {} has more than three corners", number));
    expect("endloop", number);
    expect("endfacet", number);
    return f;
  }

  double read_number(std::size_t number) {
    const auto found = word();
    const auto x = namelist::to_real(found);
    if (!x || !std::isfinite(*x))
      fail(fmt::format("facet {}: expected a finite number, found '{}'", number, namelist::excerpt(found)));
    return *x;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0, line_ = 1;
};

// ---- binary: 80 bytes of a header, the number of facets, 50 bytes for each --------------------------

constexpr std::size_t head_bytes = 84, facet_bytes = 50;

std::size_t number_in(const std::string& bytes) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + 80, sizeof number);
  return number;
}

std::vector<facet> read_binary(const std::string& bytes, const std::string& name) {
  const std::size_t number = number_in(bytes), room = (bytes.size() - head_bytes) / facet_bytes;
  if (room < number)
    fail_input(fmt::format("{}: is damaged, or no STL file: its head tells of {} facets, and it ends within facet {}",
                           name, number, room + 1));
  // Some programs fill up the last block.
  if (bytes.find_first_not_of('\0', head_bytes + facet_bytes * number) != std::string::npos)
    fail_input(fmt::format("{}: is damaged, or no STL file: {} bytes follow the {} facets of which its head tells",
                           name, bytes.size() - head_bytes - facet_bytes * number, number));
  std::vector<facet> all(number);
  for (std::size_t n = 0; n < number; ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<float, 3> x;
      std::memcpy(x.data(), bytes.data() + head_bytes + facet_bytes * n + 12 * (k + 1), sizeof x);
      for (std::size_t a = 0; a < 3; ++a) {
        if (!std::isfinite(x[a]))
          fail_input(fmt::format("{}: facet {}: a coordinate of corner {} is {}, not a finite number", name, n + 1,
                                 k + 1, x[a]));
        all[n][k][a] = static_cast<double>(x[a]);
      }
    }
  return all;
}

// ---- one point for corners that are the same ----------------------------------------------

class welder {
 public:
  explicit welder(const std::vector<facet>& facets) {
    place high{};
    low_.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const auto& f : facets)
      for (const auto& p : f)
        for (std::size_t a = 0; a < 3; ++a) low_[a] = std::min(low_[a], p[a]), high[a] = std::max(high[a], p[a]);
    double extent = 0.0;
    for (std::size_t a = 0; a < 3; ++a) extent = std::max(extent, high[a] - low_[a]);
    reach_ = weld_tolerance * extent;
    cell_ = reach_ > 0.0 && std::isfinite(reach_) ? cells_in_reach * reach_ : 1.0;
  }

  // The first point that is near enough, or this one.
  std::uint32_t number_of(const place& p) {
    std::array<std::int64_t, 3> from, to;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = p[a] - low_[a];
      from[a] = cell_of(x - reach_), to[a] = cell_of(x + reach_);
    }
    std::optional<std::uint32_t> found;
    for (auto i = from[0]; i <= to[0]; ++i)
      for (auto j = from[1]; j <= to[1]; ++j)
        for (auto k = from[2]; k <= to[2]; ++k)
          if (const auto cell = cells_.find(key({i, j, k})); cell != cells_.end())
            for (const auto n : cell->second)
              if (near(points[n], p) && (!found || n < *found)) found = n;
    if (found) return *found;
    const auto n = static_cast<std::uint32_t>(points.size());
    points.push_back(p);
    cells_[key({cell_of(p[0] - low_[0]), cell_of(p[1] - low_[1]), cell_of(p[2] - low_[2])})].push_back(n);
    return n;
  }

  std::vector<place> points;

 private:
  static constexpr double cells_in_reach = 64.0;  // so that few points are near the border of a cell

  // Far corners, which the solid may not have, share the last one.
  std::int64_t cell_of(double x) const {
    return static_cast<std::int64_t>(std::clamp(std::floor(x / cell_), -1.0, 1e6));
  }
  static std::uint64_t key(const std::array<std::int64_t, 3>& of) {
    std::uint64_t all = 0;
    for (const auto k : of) all = (all << 21) | static_cast<std::uint64_t>(k + 1);
    return all;
  }
  bool near(const place& a, const place& b) const {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) <= reach_;
  }

  place low_;
  double reach_, cell_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

void expect_near(const std::vector<facet>& facets, const std::string& name) {
  constexpr double farthest = 1e12;  // beyond which volumes might overflow
  for (std::size_t n = 0; n < facets.size(); ++n)
    for (const auto& p : facets[n])
      for (const double x : p)
        if (!(std::abs(x) <= farthest))
          fail_input(
              fmt::format("{}: facet {}: a corner is at {:g}; expected: at most {:g}", name, n + 1, x, farthest));
}

std::vector<facet> facets_of(const std::string& bytes, const std::string& name) {
  std::string_view text = bytes;
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  const bool says_solid = namelist::lower(text.substr(begin, 5)) == "solid";
  // A binary file's head may begin with "solid" as well.
  const bool exact = bytes.size() >= head_bytes && bytes.size() == head_bytes + facet_bytes * number_in(bytes);
  if (says_solid && !exact && text.find('\0') == std::string_view::npos) return text_reader(text, name).facets();
  if (bytes.size() < head_bytes || (text.find('\0') == std::string_view::npos && !exact))
    fail_input(name + ": is no STL file: it begins with another word than 'solid', and is not binary");
  return read_binary(bytes, name);
}

}  // namespace

triangles read_stl(const std::string& bytes, const std::string& name) {
  const auto facets = facets_of(bytes, name);
  if (facets.empty()) fail_input(name + ": holds no facets");
  expect_near(facets, name);
  welder all(facets);
  triangles surface;
  for (std::size_t n = 0; n < facets.size(); ++n) {
    std::array<std::uint32_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = all.number_of(facets[n][k]);
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    surface.corners.push_back(corners);
    surface.facets.push_back(static_cast<std::uint32_t>(n + 1));
  }
  surface.points = std::move(all.points);
  return surface;
}

}  // namespace tetsuame::solids
