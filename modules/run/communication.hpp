// What the steps of this process (without output) cost in communication, for the metrics of summary.json.
#pragma once

#include <algorithm>
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
    sent_before_ = foundation::sent;
    waited_before_ = foundation::waited_seconds;
  }
  void end() {
    const auto& now = foundation::sent;
    halo_messages_ += now.halo_messages - sent_before_.halo_messages;
    halo_bytes_ += now.halo_bytes - sent_before_.halo_bytes;
    letter_bytes_ += now.letter_bytes - sent_before_.letter_bytes;
    collectives_ += now.collectives - sent_before_.collectives;
    waited_ += foundation::waited_seconds - waited_before_;
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
    const auto a_step = [&](double value) { return steps_ > 0 ? value / static_cast<double>(steps_) : 0.0; };
    put("waiting_seconds_per_step", a_step(waited_));
    put("halo_messages_per_step", a_step(static_cast<double>(halo_messages_)));
    put("halo_bytes_per_step", a_step(static_cast<double>(halo_bytes_)));
    put("migration_bytes_per_step", a_step(static_cast<double>(letter_bytes_)));
    put("fluid_halo_particles", received(d.ranks, d.fluid_halo));
    put("wall_halo_particles", received(d.ranks, d.wall_halo));
    metrics["collectives_per_step"] = a_step(static_cast<double>(collectives_));
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

  foundation::traffic sent_before_;
  double waited_before_ = 0.0, waited_ = 0.0;  // s
  std::int64_t halo_messages_ = 0, halo_bytes_ = 0, letter_bytes_ = 0, collectives_ = 0, steps_ = 0;
};

}  // namespace tetsuame::run
