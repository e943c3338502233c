// Forces and heat from outside as the input gives them: group &sources, with numbers or expressions of x, y, z (m),
// t (s), material, T (K), length_x, length_y, length_z, spacing (m), pi and &constants. The notes' K_i and
// J_i [S0, S2]:
//
//   &constants  name = 'a', 'period'  value = 0.5, 1.2 /
//   &sources  force_x = 'a*sin(2*pi*t/period)'  heating = 'material == 0 ? 5e-12 : 0' /
//
// material: 0, 1, … as snapshots have it. T: the particle's temperature, where the problem has one.
#pragma once

#include <regions/expression.hpp>
#include <regions/options.hpp>

namespace tetsuame::sources {

// What a problem takes: one without an equation of energy has no use for heat, one without motion none for forces.
struct abilities {
  bool force = true, heating = true, temperature = true;
};

struct options {
  std::array<std::string, 3> force;  // m/s2; empty: none
  std::string heating;               // W/kg
  bool temperature = true;           // whether expressions may use T
};

void declare(namelist::schema& schema, const abilities& of_problem, options& o);

// What the input gives, one expression a component.
class all {
 public:
  static constexpr std::size_t heat = 3, number = 4;  // components: of the force, then of heat

  all() = default;
  // Checked; needs the schema for errors alone.
  all(const namelist::schema& schema, const options& o, const regions::constants& named, int dimension,
      const std::array<double, 3>& box, double spacing);

  bool forces() const { return value_[0] || value_[1] || value_[2]; }
  bool heats() const { return value_[heat].has_value(); }
  bool any() const { return forces() || heats(); }
  bool gives(std::size_t component) const { return value_[component].has_value(); }
  // Whether some component is a function of the temperature.
  bool by_temperature() const;
  // Bad input if so: of a state whose temperature follows from another variable once forces and heat are known.
  void refuse_temperature(const namelist::schema& schema, const std::string& why) const;
  // Whether it is the same everywhere.
  bool uniform(std::size_t component) const { return !gives(component) || uniform_[component]; }
  // m/s2 or W/kg, 0 of what is not given; may be not finite. By one thread at a time, as those of copies made by
  // another().
  double at(std::size_t component, const std::array<double, 3>& x, double material, double temperature, double t) const;
  all another() const { return {text_, constants_, box_, spacing_}; }
  // "&sources force_x = '1/x'", for messages.
  std::string describe(std::size_t component) const;

 private:
  all(const std::array<std::string, number>& texts, const std::map<std::string, double>& constants,
      const std::array<double, 3>& box, double spacing);

  std::array<std::string, number> text_;
  std::map<std::string, double> constants_;
  std::array<double, 3> box_{};
  double spacing_ = 0.0;
  std::array<std::optional<regions::expression>, number> value_;
  std::array<bool, number> uniform_{};
};

}  // namespace tetsuame::sources
