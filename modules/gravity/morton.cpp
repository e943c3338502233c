#include "morton.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace tetsuame::gravity {

namespace {

// Moves bit n of c to bit 2 n, or 3 n.
std::uint64_t spread(std::uint64_t c, std::integral_constant<int, 2>) {
  c = (c | c << 16) & 0x0000ffff0000ffff;
  c = (c | c << 8) & 0x00ff00ff00ff00ff;
  c = (c | c << 4) & 0x0f0f0f0f0f0f0f0f;
  c = (c | c << 2) & 0x3333333333333333;
  return (c | c << 1) & 0x5555555555555555;
}
std::uint64_t spread(std::uint64_t c, std::integral_constant<int, 3>) {
  c = (c | c << 32) & 0x001f00000000ffff;
  c = (c | c << 16) & 0x001f0000ff0000ff;
  c = (c | c << 8) & 0x100f00f00f00f00f;
  c = (c | c << 4) & 0x10c30c30c30c30c3;
  return (c | c << 2) & 0x1249249249249249;
}

constexpr int digit_bits = 11, digits = 6;
constexpr std::size_t radix = std::size_t{1} << digit_bits;

std::size_t digit(std::uint64_t key, int place) { return key >> (place * digit_bits) & (radix - 1); }

void sort_by_id(std::span<sorted_key> equal, const std::uint64_t* id) {
  std::ranges::sort(equal, [id](const sorted_key& a, const sorted_key& b) {
    return id ? id[a.index] < id[b.index] : a.index < b.index;
  });
}

}  // namespace

template <int D>
std::uint64_t cube<D>::key(const std::array<double, D>& x) const {
  constexpr double cells = static_cast<double>(std::uint64_t{1} << bits);
  std::uint64_t key = 0;
  for (std::size_t a = 0; a < D; ++a) {
    const double cell = std::clamp((x[a] - low[a]) / edge * cells, 0.0, cells - 1.0);
    key |= spread(static_cast<std::uint64_t>(cell), std::integral_constant<int, D>{}) << (D - 1 - a);
  }
  return key;
}

void sort_keys(std::span<sorted_key> all, const std::uint64_t* id, std::vector<sorted_key>& buffer) {
  if (all.size() < 2 * radix) {
    std::ranges::sort(all, {}, &sorted_key::key);
  } else {
    std::vector<std::uint32_t> counts(digits * radix, 0);
    for (const auto& one : all)
      for (int place = 0; place < digits; ++place) ++counts[place * radix + digit(one.key, place)];
    buffer.resize(std::max(buffer.size(), all.size()));
    std::span from = all, to = std::span(buffer).first(all.size());
    for (int place = 0; place < digits; ++place) {
      const auto count = std::span(counts).subspan(place * radix, radix);
      if (count[digit(from[0].key, place)] == all.size()) continue;  // all alike
      std::uint32_t before = 0;
      for (auto& c : count) before += std::exchange(c, before);
      for (const auto& one : from) to[count[digit(one.key, place)]++] = one;
      std::swap(from, to);
    }
    if (from.data() != all.data()) std::ranges::copy(from, all.begin());
  }
  for (std::size_t first = 0; first < all.size();) {
    std::size_t last = first + 1;
    while (last < all.size() && all[last].key == all[first].key) ++last;
    if (last - first > 1) sort_by_id(all.subspan(first, last - first), id);
    first = last;
  }
}

template struct cube<2>;
template struct cube<3>;

}  // namespace tetsuame::gravity
