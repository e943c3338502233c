// A snapshot, of this program or another, as the start of a box: its particles in SI units, numbered from 0 in the
// order of their IDs, checked one by one. What cannot be a start is refused, with field and particle
// (docs/start_files.md). Every rank reads all, so that all fail alike.
#pragma once

#include <array>
#include <cstdint>
#include <output/snapshot_file.hpp>
#include <run/options.hpp>
#include <string>
#include <vector>

namespace tetsuame::run {

// What the file is to be of.
struct start_box {
  int dimension = 2;
  std::array<double, 3> length{};  // m
  std::array<bool, 3> periodic{};
  std::array<std::array<bool, 2>, 3> open{};  // beyond these sides particles may lie as well
  double dx = 0.0;                            // m, the particle spacing
};

class start_file {
 public:
  // fields: those that it must have.
  start_file(const start_options& o, const start_box& box, const std::vector<std::string>& fields);

  bool is_of_this_program() const { return file_.is_of_this_program(); }
  std::size_t particles() const { return file_.particles(); }
  bool has(const char* name) const { return file_.find(name).has_value(); }
  bool has_mass_of_all() const { return file_.mass_of_all(box_.dimension).has_value(); }

  // By number; of vectors, one particle's components behind another's.
  std::vector<double> places() const;      // m, within the box, no two the same
  std::vector<double> velocities() const;  // m/s
  std::vector<double> densities() const;   // kg/m3, above 0
  std::vector<double> masses() const;      // kg (2-D: kg/m), above 0
  // K. A body that only conducts has a temperature but for a constant, so that it may be below 0.
  std::vector<double> temperatures(bool above_0) const;
  std::vector<double> energies() const;        // J/kg, internal
  std::vector<double> pressures() const;       // Pa
  std::vector<double> concentrations() const;  // amount per mass, not below 0
  // Of so many; of one, the file may have none. names: of each; what the file calls otherwise, or has not named, is
  // known by its number, one of `own`, which the problem has by itself.
  std::vector<std::int32_t> materials(std::int32_t number, const std::vector<std::string>& names = {},
                                      std::int32_t own = 2) const;
  // Bad input where a particle moves, of a start that is to be settled.
  void expect_at_rest(const std::vector<double>& velocities) const;

  // Refuses places where the particles, of such volumes (m^D), are packed far more closely than they can be: of another
  // unit than is said, in a corner of the box.
  void check_packing(const std::vector<double>& places, const std::vector<double>& volumes) const;
  // Refuses particles that have no other within reach (m, of each particle), and, where volumes say how much room they
  // take, those where others lie as well.
  void check_neighbours(const std::vector<double>& places, const std::vector<double>& volumes,
                        const std::vector<double>& reach, bool and_overlap) const;
  // What is so many times off is of another unit, not another state: a file in other units has densities that are off
  // by powers of ten, and compression and heat change those of a liquid in a planet by less.
  static constexpr double far_off = 3.0;

  // Bad input: of the particle with this number.
  [[noreturn]] void fail_at(std::size_t number, const std::string& what) const;
  std::string message_at(std::size_t number, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const { file_.fail(what); }

 private:
  std::size_t columns_of(const std::string& name) const;
  void check_fields(const std::vector<std::string>& fields) const;
  void check_dimension() const;
  void check_box() const;
  void check_apart(const std::vector<double>& places) const;
  std::string place_text(const std::vector<double>& places, std::size_t number) const;
  void order_by_id();
  std::vector<double> vectors(const char* name, const std::array<int, 4>& powers, bool beyond_is_zero) const;
  std::vector<double> numbers(const char* name, const std::array<int, 4>& powers) const;

  output::snapshot_file file_;
  start_box box_;
  std::vector<std::uint64_t> ids_;  // by number
  std::vector<std::size_t> row_;    // in the file, by number
};

}  // namespace tetsuame::run
