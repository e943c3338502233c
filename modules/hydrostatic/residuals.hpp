// residuals.csv: the course of Hosono's iteration in every evaluation of the right-hand side.
#pragma once

#include <output/history.hpp>
#include <vector>
#include <volume/hosono_options.hpp>

namespace tetsuame::hydrostatic {

class residual_file {
 public:
  explicit residual_file(output::history& table) : table_(table) {}
  static std::vector<output::history_column> columns() {
    return {{"evaluation", "1"}, {"iteration", "1"}, {"residual", "1"}};
  }
  void append(std::int64_t step, const std::vector<volume::residual_record>& records) {
    for (const auto& r : records)
      table_.append(step, std::array{static_cast<double>(r.evaluation), static_cast<double>(r.iteration), r.residual});
  }

 private:
  output::history& table_;
};

}  // namespace tetsuame::hydrostatic
