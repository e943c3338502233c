// One measured case, and what is asked for: the part of bench that does not depend on the dimension.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <foundation/stages.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tetsuame::bench {

struct request {
  std::string name;           // one of case_names
  int dimension;              // 2 or 3
  std::int64_t side;          // particles along each axis
  std::vector<int> threads;   // measured in turns, on the same particles
  double seconds;             // to spend on each number of threads, the start not counted
  std::int64_t steps_a_list;  // over how many steps the making of lists is spread
  std::string precision;      // of pairs: double or single

  std::int64_t particles() const { return dimension == 2 ? side * side : side * side * side; }
};

// Of the hydrostatic programs and of program shock (rig.hpp).
inline const std::vector<std::string> scheme_names{"ssph", "disph", "gsph", "gdisph", "remix"};
inline const std::vector<std::string> case_names{"program_c", "program_f", "number_density", "transport", "ssph",
                                                 "disph",     "gsph",      "gdisph",         "remix"};
inline bool is_scheme(const std::string& name) {
  return std::find(scheme_names.begin(), scheme_names.end(), name) != scheme_names.end();
}

struct result {
  std::string name, precision;
  int dimension = 0;
  std::int64_t particles = 0;
  int threads = 0;
  int passes = 0;                               // over the lists in one right-hand side
  double neighbours = 0.0;                      // a particle, in the kernel's support
  double list_entries = 0.0;                    // a particle, the skin's included, padding not
  double step_seconds = 0.0;                    // of one Euler step, its share of list making included
  double list_seconds = 0.0;                    // to make the lists once, ghosts and sorting included
  std::map<std::string, double> stages;         // shares of step_seconds, their sum is 1
  double speedup_over_first = 1.0;              // over the first number of threads: median of the turns' ratios
  double bytes_per_particle = 0.0;              // all memory in use but the lists
  double list_bytes_per_particle = 0.0;         // fluid's neighbour lists
  std::optional<double> speedup_over_scalar;    // of the two sums of program C
  double scalar_ns_per_pair = 0.0;              // of one core's time, both sums, where there is a speed-up
  std::optional<double> deviation_from_scalar;  // largest difference, relative to the field's largest value
  double load_average = 0.0;                    // of the machine, one minute, before the case

  double updates_per_second() const { return static_cast<double>(particles) / step_seconds; }
  double pairs_per_second() const { return updates_per_second() * neighbours; }
  double ns_per_pair() const { return 1e9 * threads / pairs_per_second(); }  // of one core's time
};

// Measures the case for each number of threads; one file a dimension: they take long to compile. fail_calculation if
// engine and scalar reference disagree.
std::vector<result> measure_2d(const request& asked);
std::vector<result> measure_3d(const request& asked);

double median(std::vector<double> values);

using clock = std::chrono::steady_clock;
inline double since(clock::time_point start) { return std::chrono::duration<double>(clock::now() - start).count(); }
double time_of(auto&& work) {
  const auto start = clock::now();
  work();
  return since(start);
}

// A result for each number of threads. Rounds, in each of which every number of threads has its turn: new lists, the
// step that finds them new, ordinary steps. What the first step takes more than an ordinary one (what is kept while
// lists live) is charged to the lists. They take turns, so that what else the machine does falls on all of them.
std::vector<result> time_steps(const result& found, const request& asked, const std::function<void()>& make_lists,
                               const std::function<void()>& step, foundation::stage_times& times);

}  // namespace tetsuame::bench
