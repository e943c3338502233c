// history.csv: a time series, one line at a time, flushed, so that it can be watched
// while the run goes on. The first line names the columns with their units: time [s].
#pragma once

#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::output {

struct history_column {
  std::string name, units;  // without commas and line ends; units "1" if there are none
};

class history {
 public:
  // Collective. A new file; one of that name is replaced. The first column, "step", is
  // added to those given. Throws fail_file on every rank.
  static history start(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns);
  // Collective; after a restart from the given step. Lines of later steps, and a last
  // line cut short, are dropped, so that no step stands twice; without a file it starts
  // one. Throws fail_file on every rank, also if the columns are others.
  static history resume(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns,
                        std::int64_t step);

  // Collective. Values in the columns' order, of which rank 0's are written with all
  // their digits; then the text, if there is one, in quotes (it has none itself). Throws fail_file on every rank.
  void append(std::int64_t step, std::span<const double> values, const std::string& text = {});

 private:
  struct closer {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  history(MPI_Comm comm, const std::string& path);

  MPI_Comm comm_;
  std::string path_;
  std::unique_ptr<std::FILE, closer> file_;  // rank 0
};

}  // namespace tetsuame::output
