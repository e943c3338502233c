// residuals.csv: the course of Hosono's iteration in every evaluation of the right-hand side.
#pragma once

#include <domain/communicator.hpp>
#include <memory>
#include <output/history.hpp>
#include <string>
#include <vector>
#include <volume/hosono_options.hpp>

namespace tetsuame::simulation {

class residual_file {
 public:
  static residual_file start(const domain::communicator& ranks, const std::string& path) {
    return residual_file(output::history::start(ranks.comm, path, columns()));
  }
  static residual_file resume(const domain::communicator& ranks, const std::string& path, std::int64_t step) {
    return residual_file(output::history::resume(ranks.comm, path, columns(), step));
  }
  void append(std::int64_t step, const std::vector<volume::residual_record>& records) {
    for (const auto& r : records)
      file_.append(step, std::array{static_cast<double>(r.evaluation), static_cast<double>(r.iteration), r.residual});
  }

 private:
  explicit residual_file(output::history file) : file_(std::move(file)) {}
  static std::vector<output::history_column> columns() {
    return {{"evaluation", "1"}, {"iteration", "1"}, {"residual", "1"}};
  }
  output::history file_;
};

}  // namespace tetsuame::simulation
