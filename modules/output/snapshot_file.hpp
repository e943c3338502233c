// A snapshot in GADGET's layout, of this program or another, as its reader needs it: its fluid in SI units, its box.
//
// Units are those of a dataset's attribute `units`; else of its factor to cgs, as GADGET-4, AREPO, SWIFT and EAGLE
// write it; else of the file's unit system, which SWIFT writes into a group Units, GADGET-4 into Parameters and others
// into Header. A dataset without any is refused, as is what is not understood: cosmological units, a snapshot in
// several files, particles of other types.
#pragma once

#include <array>
#include <optional>
#include <output/stored_file.hpp>
#include <output/units.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tetsuame::output {

class snapshot_file {
 public:
  static constexpr const char* fluid = "PartType0";

  // place: where the input names the file, before every message of a content that cannot be taken (fail_input).
  snapshot_file(const std::string& path, std::string place);

  bool is_of_this_program() const;       // of any version: it says by which
  std::optional<int> dimension() const;  // as the file says
  // None: there is no such dataset. Of the fluid SWIFT's names are known too: Densities for Density.
  std::optional<stored_dataset> find(std::string_view name, const std::string& group = fluid) const;
  std::size_t particles() const { return particles_; }  // of the fluid

  // m, along each axis. BoxLengths are in m; BoxSize is in the file's unit of length, and one number is that of the
  // longest edge. Either or both may be there.
  struct box {
    std::optional<std::vector<double>> lengths, size;
  };
  box of_box() const;

  // A dataset of the group in SI units, by rows. powers: of what it should be (units.hpp).
  std::vector<double> read(const std::string& group, const std::string& name, const std::array<int, 4>& powers) const;
  // kg (in fewer than three dimensions for each metre of depth), of all particles, where the header tells it.
  std::optional<double> mass_of_all(int dimension) const;
  stored_file::integers identities() const;
  std::vector<double> plain(const std::string& name) const;  // without a unit
  // What the values of a field of the fluid number, by its attribute `names`; empty: it has none.
  std::vector<std::string> names_of(const std::string& name) const;

  [[noreturn]] void fail(const std::string& what) const;  // bad input: what of the file
  // Fails where a field of the fluid that is there is not one of numbers, with a row for each particle.
  void expect_sound(const char* name) const;

  static constexpr std::array<int, 4> length{1, 0, 0, 0}, velocity{1, 0, -1, 0}, density{-3, 1, 0, 0},
      temperature{0, 0, 0, 1}, energy{2, 0, -2, 0}, pressure{-1, 1, -2, 0};
  static constexpr std::array<int, 4> mass(int dimension) { return {dimension - 3, 1, 0, 0}; }

 private:
  std::optional<std::vector<double>> numbers(const std::string& object, const std::string& name) const;
  std::optional<double> number(const std::string& object, const std::string& name) const;
  void check_header() const;
  void check_layout() const;
  void check_shapes();
  std::optional<double> system_factor(const std::array<int, 4>& powers) const;
  double factor_of(const std::string& dataset, const std::array<int, 4>& powers) const;

  std::string place_;
  stored_file file_;
  std::vector<stored_dataset> datasets_;
  std::size_t particles_ = 0;
  std::string first_;  // the field that says how many
};

}  // namespace tetsuame::output
