// Surfaces of triangles, and the STL files that hold them.
#pragma once

#include <solids/mesh.hpp>
#include <string>

namespace tetsuame::solids {

triangles cube();           // [0, 1]³
triangles ball(int level);  // the unit sphere, by an octahedron whose triangles are cut in four `level` times
std::string ascii(const triangles& of);
std::string binary(const triangles& of);

}  // namespace tetsuame::solids
