// Measured curves that a run is held against: a table of numbers, its first column the time.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tetsuame::free_surface {

struct table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  // Of the column of that name; none: there is none.
  std::optional<std::size_t> place(const std::string& name) const;
};

// Lines of numbers with commas between them, beneath a line of names; lines that begin with # are passed over. Throws
// fail_input, with file and line.
table read_table(const std::string& path);

}  // namespace tetsuame::free_surface
