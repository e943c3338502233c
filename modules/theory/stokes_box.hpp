// Creeping flow about one round drop in a two-dimensional box, by finite differences: the terminal
// velocity that a cylinder has only because the box is finite. Method: docs/theory/drop.md.
#pragma once

namespace tetsuame::theory {

enum class sides { no_slip, free_slip, periodic };

struct drop_in_box {
  double width, height;               // m
  double radius, x, y;                // m, centre from the lower left corner; the drop must not touch a wall
  double viscosity, drop_viscosity;   // Pa s, outside and inside
  double density_difference;          // kg/m^3, drop minus surroundings
  double gravity;                     // m/s^2, towards -y
  sides left_right = sides::no_slip;  // both side walls
  sides floor_lid = sides::no_slip;   // floor and lid; periodic: only with periodic sides, and the
                                      // mean flow of drop and surroundings together is zero
};

// Fall velocity, m/s, downward positive: mean of -v over the drop's area, on `cells` cells across the width
// and as many per metre, rounded, over the height. The error falls as cells^-2 or a little slower, 1e-3 at
// 16 cells in the radius. fail_input: geometry; fail_calculation: the matrix could not be factorised.
double fall_velocity(const drop_in_box& box, int cells);

// Extrapolated from `cells` and 2 `cells`, taking the error as cells^-2.
double fall_velocity_extrapolated(const drop_in_box& box, int cells);

}  // namespace tetsuame::theory
