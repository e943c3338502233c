// What each program consists of: A to F [S0, table 1], F with pattern 2, Y [S2, improved DISPH], N, and standard SPH to
// stand beside.
#pragma once

#include <gradient/pattern_1.hpp>
#include <gradient/pattern_2.hpp>
#include <volume/density_sum.hpp>
#include <volume/hosono_iteration.hpp>
#include <volume/number_density.hpp>
#include <volume/our_method.hpp>
#include <volume/y_evolution.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::programs {

// How Y and ΔV come about; smoothed or not; the walls unless the input says otherwise; the form of the gradient.
template <class Volume, class Pressure, class Wall, class Gradient = gradient::pattern_1>
struct scheme {
  using volume = Volume;
  using pressure = Pressure;
  using wall = Wall;
  using gradient = Gradient;
};

struct disph_a : scheme<volume::hosono_iteration, volume::smoothed, walls::virtual_marker> {
  static constexpr const char* name = "disph_a";
};
struct disph_b : scheme<volume::hosono_iteration, volume::smoothed, walls::none> {
  static constexpr const char* name = "disph_b";
};
struct disph_c : scheme<volume::our_method, volume::smoothed, walls::virtual_marker> {
  static constexpr const char* name = "disph_c";
};
struct disph_d : scheme<volume::our_method, volume::smoothed, walls::none> {
  static constexpr const char* name = "disph_d";
};
struct disph_e : scheme<volume::our_method, volume::smoothed, walls::virtual_marker, gradient::pattern_2> {
  static constexpr const char* name = "disph_e";
};
struct disph_f : scheme<volume::our_method, volume::non_smoothed, walls::virtual_marker> {
  static constexpr const char* name = "disph_f";
};
struct disph_f2 : scheme<volume::our_method, volume::non_smoothed, walls::virtual_marker, gradient::pattern_2> {
  static constexpr const char* name = "disph_f2";
};
struct disph_y : scheme<volume::y_evolution, volume::smoothed, walls::virtual_marker> {
  static constexpr const char* name = "disph_y";
};
struct disph_n : scheme<volume::number_density, volume::non_smoothed, walls::mirror> {
  static constexpr const char* name = "disph_n";
};
struct ssph : scheme<volume::density_sum, volume::non_smoothed, walls::mirror> {
  static constexpr const char* name = "ssph";
};

}  // namespace tetsuame::programs
