// Blocks of water that touch side by side, each with a surface of its own, are one water when they start: p/ρ of an
// incompressible liquid at the moment in which it is set free (derived here; docs/theory/united_water.md),
//   p/ρ = g (Y - y),   ∇²Y = 0,   Y = y on the surface above,   ∂Y/∂n = 0 at walls, bodies, and sides that face the air
// Y: the height to which the water would rise, the surface's own where all of it is level. By the five or seven
// differences of the blocks' lattice, exact for a level surface; conjugate gradients otherwise.
#pragma once

#include <cstdint>
#include <free_surface/options.hpp>
#include <functional>
#include <vector>

namespace tetsuame::free_surface {

// Whether some block touches another from the side.
bool touch_sideways(const options& o, const parameters& p);

class united_surface {
 public:
  // What cells of the lattice hold water, and where bodies are: of the middle of a cell, of a face.
  using is_there = std::function<bool(const point&)>;
  united_surface(const options& o, const parameters& p, const is_there& is_water, const is_there& is_solid);

  // m, Y in the cell of x; `else_level` where its middle holds no water.
  double level(const point& x, double else_level) const;

 private:
  static constexpr std::uint32_t none = UINT32_MAX;
  struct face {
    std::uint32_t first, second;  // cells
  };
  struct opening {
    std::uint32_t cell;
    double level;  // m
  };
  std::size_t place_of(const std::array<std::size_t, 3>& cell) const {
    return (cell[2] * number_[1] + cell[1]) * number_[0] + cell[0];
  }
  point middle(const std::array<std::size_t, 3>& cell) const;
  void number_cells(const is_there& is_water);
  void find_faces(const is_there& is_solid);
  bool find_level_waters();
  void solve();
  std::vector<double> times_matrix(const std::vector<double>& Y) const;

  std::size_t axes_;
  std::array<bool, 3> periodic_;
  double dx_;                          // m
  std::array<std::size_t, 3> number_;  // of cells of the box's lattice
  std::vector<std::uint32_t> cell_;    // at a place of the lattice: which of those with water, or none
  std::vector<double> Y_;              // m, of cells with water
  std::vector<face> faces_;
  std::vector<opening> openings_;
};

}  // namespace tetsuame::free_surface
