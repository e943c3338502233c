// The box and its start lattice as the input gives them: group &domain, the same in every program.
#pragma once

#include <array>
#include <cstdint>
#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::domain {

// Columns of ranks along x, as asked for.
struct rank_columns {
  std::int64_t number = 0;                  // 0: as the box's shape suggests
  std::string place = "&domain ranks_x: ";  // where that was said, for the message
};

struct options {
  std::int64_t dimension = 2;
  std::array<double, 3> length{};  // m
  std::array<std::int64_t, 3> particles{};
  std::array<bool, 3> periodic{};
  std::array<bool, 3> open{};  // on both sides nothing stands: the box is only where particles start
  rank_columns ranks_x{};
  double jitter = 0.0;  // of the particle spacing

  std::size_t axes() const { return static_cast<std::size_t>(dimension); }
  double dx() const { return length[0] / static_cast<double>(particles[0]); }  // m
  double lattice_particles() const;
};

// What a problem asks of its box.
struct demands {
  std::int64_t least_dimension = 2, least_particles = 1;  // along an axis
  std::string walls_below_and_above = "";                 // why there are walls; empty: y may be periodic
  bool follows_x = false;    // along y and z, 0 is allowed: as long as along x, and with its spacing
  bool lattice = true;       // particles start on one that fills the box
  bool jitters = true;       // the start lattice can be disturbed
  bool may_be_open = false;  // particles can do without anything at the sides
};
void declare(namelist::schema& schema, const demands& of_problem, options& o);

// Fills what follows from x, and checks: one spacing along all axes, and no more than 1e12 particles, beyond which an
// ID times a number of images, or a file's offset, would overflow. Fails with exit 2, placed at a key.
void resolve(const namelist::schema& schema, const demands& of_problem, options& o);
void check_number(const namelist::schema& schema, const options& o, double expected);

// A periodic box must be as wide as the halo, one between walls as the kernel's support. halo, support: m.
void check_widths(const namelist::schema& schema, const options& o, double halo, double support);

}  // namespace tetsuame::domain
