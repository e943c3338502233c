// How fast this machine is, from what bench measured (docs/performance.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tetsuame::plan {

struct speed_options {
  std::string bench = "output/bench/bench.json";
  bool bench_given = false;        // then it must be there
  std::string kind = "transport";  // the case of bench
  int threads = 0;                 // 0: as many as were measured at most
  int dimension = 2;
};

struct measured_speed {
  double updates_per_second;
  std::string kind;
  int threads, dimension;
  std::int64_t particles;  // of the record
  double load_average;
  std::string processor;
};

// The record of that case, dimension and number of threads nearest in size (by ratio); none if there is no
// file. fail_file if the file is damaged, fail_input if it was asked for and has no such record.
std::optional<measured_speed> read_speed(const speed_options& o, double particles);

}  // namespace tetsuame::plan
