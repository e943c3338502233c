// The tables plan prints and the file it writes for machines.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetsuame::plan {

using json = nlohmann::ordered_json;

// Rows of texts in aligned columns: the first left, as is the last; `right` says which are set right.
struct table {
  std::string title;
  std::vector<std::vector<std::string>> rows;  // the first is the head, if has_head
  std::vector<bool> right;
  bool has_head = false;
  void print() const;
};

// Four digits: 1000, 2.673e-07, 0.0843
std::string number(double value);
// "1 h 12 min", "35 s", "2.1 d"
std::string duration(double seconds);

// fail_file if it cannot be written.
void write_json(const std::string& path, const json& all);

}  // namespace tetsuame::plan
