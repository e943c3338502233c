#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "stl.hpp"

namespace tetsuame::solids {

triangles cube() {
  triangles all;
  for (std::uint32_t n = 0; n < 8; ++n)
    all.points.push_back(
        {static_cast<double>(n & 1U), static_cast<double>(n >> 1 & 1U), static_cast<double>(n >> 2 & 1U)});
  // Counterclockwise from outside.
  constexpr std::uint32_t sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) {
    all.corners.push_back({s[0], s[1], s[2]});
    all.corners.push_back({s[0], s[2], s[3]});
  }
  return all;
}

triangles ball(int level) {
  triangles all;
  all.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  all.corners = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (; level > 0; --level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(all.points.size()));
      if (is_new) {
        const auto &p = all.points[a], &q = all.points[b];
        std::array<double, 3> m{p[0] + q[0], p[1] + q[1], p[2] + q[2]};
        const double length = std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
        for (double& x : m) x /= length;
        all.points.push_back(m);
      }
      return at->second;
    };
    decltype(all.corners) cut;
    for (const auto& [a, b, c] : all.corners) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const std::array<std::uint32_t, 3>& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        cut.push_back(t);
    }
    all.corners = cut;
  }
  return all;
}

std::string ascii(const triangles& of) {
  std::string text = "solid written\n";
  for (const auto& t : of.corners) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const auto k : t)
      text += fmt::format("      vertex {} {} {}\n", of.points[k][0], of.points[k][1], of.points[k][2]);
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid written\n";
}

std::string binary(const triangles& of) {
  std::string bytes(80, ' ');
  const auto put = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  put(static_cast<std::uint32_t>(of.corners.size()));
  for (const auto& t : of.corners) {
    for (int k = 0; k < 3; ++k) put(0.0F);
    for (const auto k : t)
      for (const double x : of.points[k]) put(static_cast<float>(x));
    put(std::uint16_t{0});
  }
  return bytes;
}

}  // namespace tetsuame::solids
