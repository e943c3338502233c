// run.log: what the run said, line by line, with the seconds since it began. Rank 0 writes.
#pragma once

#include <mpi.h>

#include <chrono>
#include <output/file.hpp>
#include <string>

namespace tetsuame::output {

class run_log {
 public:
  // Collective; a file that is there is continued. Throws fail_file on every rank.
  run_log(MPI_Comm comm, const std::string& path);

  // Any rank may call it, rank 0's text counts. Never throws: a full disk costs the
  // lines, not the run (what matters goes to other files, which do tell).
  void write(const std::string& text);

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  stream file_;
};

}  // namespace tetsuame::output
