#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <plan/table.hpp>

namespace tetsuame::plan {

void table::print() const {
  std::vector<std::size_t> width;
  for (const auto& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k == width.size()) width.push_back(0);
      width[k] = std::max(width[k], row[k].size());
    }
  fmt::print("{}\n", title);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    std::string line = " ";
    for (std::size_t k = 0; k < rows[n].size(); ++k)
      line += k < right.size() && right[k] ? fmt::format(" {:>{}}", rows[n][k], width[k])
                                           : fmt::format(" {:<{}}", rows[n][k], width[k]);
    line.erase(line.find_last_not_of(' ') + 1);
    fmt::print("{}\n", line);
    if (n == 0 && has_head) {
      std::size_t all = 1;
      for (const std::size_t w : width) all += w + 1;
      fmt::print("  {}\n", std::string(all - 2, '-'));
    }
  }
  fmt::print("\n");
}

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string duration(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  if (seconds < 3600.0) return fmt::format("{:.3g} min", seconds / 60.0);
  if (seconds < 86400.0) return fmt::format("{:.3g} h", seconds / 3600.0);
  if (seconds < 365.25 * 86400.0) return fmt::format("{:.3g} days", seconds / 86400.0);
  return fmt::format("{:.3g} years", seconds / (365.25 * 86400.0));
}

void write_json(const std::string& path, const json& all) {
  std::ofstream file(path);
  file << all.dump(1) << '\n';
  file.close();
  if (!file) foundation::fail_file(path + ": cannot be written; is there space, and may you write there?");
}

}  // namespace tetsuame::plan
