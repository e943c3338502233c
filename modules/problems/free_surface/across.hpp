// Images of places across periodic sides.
#pragma once

#include <free_surface/water.hpp>
#include <vector>

namespace tetsuame::free_surface {

// f(x) of a place and of its images across periodic sides nearer to it than `reach` (m).
template <int D, class F>
void for_each_across(const water<D>& f, const point& x, double reach, F&& at) {
  std::vector<point> all{x};
  for (std::size_t a = 0; a < D; ++a) {
    if (!f.o.domain.periodic[a]) continue;
    const double length = f.o.domain.length[a];
    for (std::size_t n = all.size(); n > 0; --n)
      for (const double by : {length, -length}) {
        point image = all[n - 1];
        image[a] += by;
        if (image[a] > -reach && image[a] < length + reach) all.push_back(image);
      }
  }
  for (const point& image : all) at(image);
}

}  // namespace tetsuame::free_surface
