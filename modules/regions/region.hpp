// Regions as a start asks for them: what they say of a place.
#pragma once

#include <array>
#include <optional>
#include <regions/expression.hpp>
#include <regions/options.hpp>

namespace tetsuame::regions {

using place = std::array<double, 3>;  // m; 0 beyond the dimension

// What regions say of a place; nothing: it is as it was.
struct values {
  std::optional<std::int32_t> material;
  std::optional<double> temperature, density, pressure, energy;  // K, kg/m3, Pa, J/kg
  std::array<std::optional<double>, 3> velocity;                 // m/s
};

// Names of what values there are; nothing else is evaluated.
enum class what : std::uint8_t { temperature, density, pressure, energy, velocity_x, velocity_y, velocity_z };
inline constexpr std::size_t number_of_values = 7;

struct region {
  std::string name;
  std::optional<solids::body<2>> flat;  // neither: everywhere
  std::optional<solids::body<3>> deep;
  std::vector<expression> conditions;
  std::optional<std::int32_t> material;
  std::array<std::optional<expression>, number_of_values> value;
};

class all {
 public:
  all() = default;
  // Fails at &region's key where something is no region. box: m, and the spacing.
  all(const namelist::schema& schema, const abilities& of_problem, options o, int dimension,
      const std::array<double, 3>& box, double spacing);

  bool any() const { return !regions_.empty(); }
  std::size_t size() const { return regions_.size(); }
  const std::string& name(std::size_t n) const { return regions_[n].name; }
  bool give_material(std::int32_t material) const;
  bool give(what w) const;

  // T: K, there before. Counts a place for each region that it lies in. Fails, with bad_input, where a value is none:
  // not finite, not above 0.
  values at(const place& x, double T, std::vector<std::int64_t>& counts) const;
  // Fails where a region has no place of the start: counts of all ranks.
  void expect_used(const std::vector<std::int64_t>& counts) const;

 private:
  std::vector<double> variables(const place& x, double T) const;
  bool holds(const region& r, const place& x, const std::vector<double>& of) const;
  [[noreturn]] void fail(const region& r, const std::string& message) const;

  std::string where_;  // "file:line"
  std::array<double, 3> box_{};
  double spacing_ = 0.0;
  bool above_0_ = true;  // temperatures
  std::vector<region> regions_;
};

}  // namespace tetsuame::regions
