// Creeping flow about one round drop in a two-dimensional box, by finite differences: the terminal
// velocity that a cylinder has only because the box is finite. Method: docs/theory/drop.md.
#pragma once

namespace tetsuame::theory {

enum class sides { no_slip, free_slip, periodic };

struct drop_in_box {
  double width, height;               // m
  double radius, x, y;                // m, centre from the lower left corner; the drop must lie inside the box
  double viscosity, drop_viscosity;   // Pa s, outside and inside
  double density_difference;          // kg/m^3, drop minus surroundings
  double gravity;                     // m/s^2, towards -y
  sides left_right = sides::no_slip;  // both side walls
  sides floor_lid = sides::no_slip;   // floor and lid; periodic: only with periodic sides, and the
                                      // mean flow of drop and surroundings together is zero
};

// Fall velocity, m/s, downward positive: mean of -v over the drop's area, on `cells` cells, 8 or more, across the width
// and as many per metre, rounded, over the height. Error with 8 cells in the radius, falling as cells^-2: 1e-3
// for equal viscosities; else falling as 1/cells, 2 % at a viscosity ratio of 0.1 or 10 and 5 % at 100.
// fail_calculation: the matrix could not be factorised.
double fall_velocity(const drop_in_box& box, int cells);

// Extrapolated from `cells` and 2 `cells` by these powers; with 6 cells in the radius at `cells`, 5e-3 for ratios
// from 0.1 to 10.
double fall_velocity_extrapolated(const drop_in_box& box, int cells);

}  // namespace tetsuame::theory
