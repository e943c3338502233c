#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <solids/extents.hpp>

namespace tetsuame::solids {

template <int D>
void expect_sizes(const std::vector<body<D>>& bodies, const point<D>& box) {
  constexpr double most = 1e9;  // boxes
  double longest = 0.0;
  for (std::size_t k = 0; k < D; ++k) longest = std::max(longest, box[k]);
  for (const auto& b : bodies)
    if (!(b.size() <= most * longest))
      foundation::fail_input(fmt::format(
          "body '{}' reaches {:.3g} m far, more than {:.0e} times the box, {:.3g} m: rounding would lose its "
          "wall particles; give it a smaller size, or a place nearer to the box",
          b.name(), b.size(), most, longest));
}

template <int D>
std::string extents_text(const std::vector<body<D>>& bodies, const point<D>& box) {
  std::string text;
  if constexpr (D == 3)
    for (const auto& b : bodies)
      for (const auto& p : b.pieces())
        for (const auto& face : p.bounds) {
          if (face.what != surface<3>::form::mesh) continue;
          const auto &low = face.triangles->low(), &high = face.triangles->high();
          text += fmt::format(
              "; the triangles of body '{}' reach from ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) m",
              b.name(), low[0], low[1], low[2], high[0], high[1], high[2]);
        }
  if (text.empty()) return text;
  return text + fmt::format(
                    ", and the box to ({:.4g}, {:.4g}, {:.4g}) m: is &solids scale missing (0.001 for a file in "
                    "millimetres), or the place another?",
                    box[0], box[1], D == 3 ? box[D - 1] : 0.0);
}

template void expect_sizes<2>(const std::vector<body<2>>&, const point<2>&);
template void expect_sizes<3>(const std::vector<body<3>>&, const point<3>&);
template std::string extents_text<2>(const std::vector<body<2>>&, const point<2>&);
template std::string extents_text<3>(const std::vector<body<3>>&, const point<3>&);

}  // namespace tetsuame::solids
