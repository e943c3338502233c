// What the steps of this process (without output) cost in communication, for the metrics of summary.json.
#pragma once

#include <algorithm>
#include <array>
#include <domain/decomposition.hpp>
#include <foundation/waiting.hpp>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

namespace tetsuame::run {

class communication_meter {
 public:
  // Around each step.
  void begin() {
    const auto before = now();
    for (std::size_t k = 0; k < total_.size(); ++k) total_[k] -= before[k];
  }
  void end() {
    const auto after = now();
    for (std::size_t k = 0; k < total_.size(); ++k) total_[k] += after[k];
    ++steps_;
  }

  // Collective. NAME: mean over the ranks, NAME_max: the largest rank's; all but the halo's particles a step.
  template <int D>
  void describe(const domain::decomposition<D>& d, nlohmann::ordered_json& metrics) const {
    const auto put = [&](const std::string& name, double mine) {
      const auto all = d.ranks.every(mine);
      metrics[name] = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
      metrics[name + "_max"] = *std::max_element(all.begin(), all.end());
    };
    const double steps = std::max(1.0, static_cast<double>(steps_));
    put("waiting_seconds_per_step", total_[0] / steps);
    put("halo_messages_per_step", total_[1] / steps);
    put("halo_bytes_per_step", total_[2] / steps);
    put("migration_bytes_per_step", total_[3] / steps);
    put("fluid_halo_particles", received(d.ranks, d.fluid_halo));
    put("wall_halo_particles", received(d.ranks, d.wall_halo));
    metrics["collectives_per_step"] = total_[4] / steps;
  }

 private:
  // Ghosts that come from other ranks.
  template <int D>
  static double received(const domain::communicator& ranks, const domain::halo<D>& h) {
    double n = 0.0;
    for (const auto& s : h.from)
      if (s.rank != ranks.rank) n += static_cast<double>(s.count);
    return n;
  }

  // Since the process began: s waited, messages and bytes of halos, bytes of migration, collective operations.
  static std::array<double, 5> now() {
    const auto& s = foundation::sent;
    return {foundation::waited_seconds, static_cast<double>(s.halo_messages), static_cast<double>(s.halo_bytes),
            static_cast<double>(s.letter_bytes), static_cast<double>(s.collectives)};
  }

  std::array<double, 5> total_{};  // of the steps
  std::int64_t steps_ = 0;
};

}  // namespace tetsuame::run
