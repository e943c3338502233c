// How large bodies are beside the box that they stand in.
#pragma once

#include <solids/body.hpp>
#include <string>

namespace tetsuame::solids {

// Fails where a coordinate or radius of a body is more than a billion times the box, which must be finite: the place of
// its surface in the box is then known to a ten-millionth of the box at best, and beyond that wall particles are lost.
template <int D>
void expect_sizes(const std::vector<body<D>>& bodies, const point<D>& box);

// For messages: from where to where the triangles of files reach, and the box; empty where there are none.
template <int D>
std::string extents_text(const std::vector<body<D>>& bodies, const point<D>& box);

}  // namespace tetsuame::solids
