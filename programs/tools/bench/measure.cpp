#include <malloc.h>
#include <omp.h>

#include <algorithm>
#include <bench/rig.hpp>
#include <cstdlib>
#include <liquid/scheme_of.hpp>

namespace tetsuame::bench {

bool is_scheme(const std::string& name) {
  return std::find(scheme_names.begin(), scheme_names.end(), name) != scheme_names.end();
}

const liquid::program& program_of(const std::string& name) {
  // transport is program C where viscosity and conductivity are each particle's own.
  static const auto c = liquid::describe<programs::disph_c>(), f = liquid::describe<programs::disph_f>(),
                    n = liquid::describe<programs::disph_n>();
  return name == "program_f" ? f : name == "number_density" ? n : c;
}

double memory_needed(const request& asked) {
  // The lists of clusters; all else, with what is sorted while lists are made. Ghosts and walls add to small cases
  // only.
  const double list = asked.dimension == 2 ? 45.0 : 220.0;
  return static_cast<double>(asked.particles()) * (list + 800.0);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double heap_bytes() {
  const auto info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

std::vector<result> time_steps(const result& found, const request& asked, const std::function<void()>& make_lists,
                               const std::function<void()>& step, foundation::stage_times& times) {
  std::vector<result> all(asked.threads.size(), found);
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].threads = asked.threads[k];
    if (double load = 0.0; getloadavg(&load, 1) == 1) all[k].load_average = load;
  }
  struct record {
    // s: to make lists, with what the step after that takes longer than others; s; and s an ordinary step of a round
    // with its share of the lists.
    std::vector<double> lists, steps, rounds;
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
      const double making = time_of([&] { make_lists(); }), after = time_of([&] { step(); });
      times.clear();
      const auto start = clock::now();
      std::vector<double> these;
      do these.push_back(time_of([&] { step(); }));
      while (since(start) < turn || these.size() < 3);
      for (const auto& [name, s] : times.seconds()) seconds[name] += s;
      steps.insert(steps.end(), these.begin(), these.end());
      const double ordinary = median(these);
      lists.push_back(making + std::max(0.0, after - ordinary));
      rounds.push_back(ordinary + lists.back() / static_cast<double>(asked.steps_a_list));
    }

  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& [lists, steps, rounds, seconds] = records[k];
    result& r = all[k];
    const double ordinary = median(steps);
    r.list_seconds = median(lists);
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
  return all;
}

}  // namespace tetsuame::bench
