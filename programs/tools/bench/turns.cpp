#include <omp.h>

#include <algorithm>
#include <bench/turns.hpp>
#include <cstdlib>

namespace tetsuame::bench {

std::vector<result> with_threads(const result& found, const std::vector<int>& threads) {
  std::vector<result> all;
  for (const int n : threads) {
    all.push_back(found);
    all.back().threads = n;
    if (double load = 0.0; getloadavg(&load, 1) == 1) all.back().load_average = load;
  }
  return all;
}

void time_steps(std::vector<result>& all, const request& asked, const timed& work) {
  struct record {
    std::vector<double> lists, steps, rounds;  // s, s, and s an ordinary step of a round with its share of the lists
    std::map<std::string, double> seconds;
  };
  std::vector<record> records(all.size());
  constexpr std::size_t fewest = 3, most = 25;
  const double turn = asked.seconds / 10.0;
  const auto begin = clock::now();
  for (std::size_t n = 0; n < fewest || (n < most && since(begin) < asked.seconds * static_cast<double>(all.size()));
       ++n)
    for (std::size_t k = 0; k < all.size(); ++k) {
      omp_set_num_threads(all[k].threads);
      auto& [lists, steps, rounds, seconds] = records[k];
      lists.push_back(time_of([&] { work.make_lists(); }) + time_of([&] { work.step(); }));
      work.times.clear();
      const auto start = clock::now();
      std::vector<double> these;
      do these.push_back(time_of([&] { work.step(); }));
      while (since(start) < turn || these.size() < 3);
      for (const auto& [name, s] : work.times.seconds()) seconds[name] += s;
      steps.insert(steps.end(), these.begin(), these.end());
      const double ordinary = median(these);
      rounds.push_back(ordinary + std::max(0.0, lists.back() - ordinary) / static_cast<double>(asked.steps_a_list));
    }

  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& [lists, steps, rounds, seconds] = records[k];
    result& r = all[k];
    const double ordinary = median(steps);
    r.list_seconds = std::max(0.0, median(lists) - ordinary);
    const double lists_a_step = r.list_seconds / static_cast<double>(asked.steps_a_list);
    r.step_seconds = ordinary + lists_a_step;
    std::vector<double> ratios;
    for (std::size_t n = 0; n < rounds.size(); ++n) ratios.push_back(records[0].rounds[n] / rounds[n]);
    r.speedup_over_first = median(ratios);

    double total = 0.0, staged = 0.0;
    for (const double s : steps) total += s;
    for (const auto& [name, s] : seconds) staged += s;
    seconds["rest"] = std::max(0.0, total - staged);  // displacements, the largest speed, the walls' last guard
    total = std::max(total, staged);
    for (const auto& [name, s] : seconds) r.stages[name] = s / total * ordinary / r.step_seconds;
    r.stages["lists"] = lists_a_step / r.step_seconds;
  }
}

}  // namespace tetsuame::bench
