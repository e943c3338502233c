#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gas/convergence.hpp>
#include <gas/setups.hpp>
#include <output/directory.hpp>
#include <run/simulation.hpp>
#include <sstream>

namespace tetsuame::gas {

namespace {

namespace fs = std::filesystem;
using foundation::exit_status;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream all;
  all << file.rdbuf();
  return all.str();
}

// On all, what rank 0 reads: summary.json of the folder; null: none that can be read.
nlohmann::ordered_json summary_in(const fs::path& folder) {
  const auto ranks = domain::communicator::world();
  const auto text = ranks.broadcast(ranks.rank == 0 ? text_of(folder / "summary.json") : "");
  auto j = nlohmann::ordered_json::parse(text, nullptr, false);
  return j.is_object() ? j : nlohmann::ordered_json(nullptr);
}

bool completed(const nlohmann::ordered_json& summary) {
  return summary.is_object() && run::has_completed(summary.value("status", ""));
}

// On all: what rank 0 sees.
template <class Test>
bool seen(const Test& test) {
  const auto ranks = domain::communicator::world();
  return ranks.broadcast(ranks.rank == 0 && test() ? "yes" : "") == "yes";
}

bool has_checkpoint(const fs::path& folder) {
  return seen([&] {
    return fs::is_directory(folder) && !output::numbered_files(folder.string(), "checkpoint_", ".h5").empty();
  });
}

bool is_done(const fs::path& folder, const std::string& resolved) {
  return completed(summary_in(folder)) && seen([&] { return text_of(folder / "resolved.nml") == resolved; });
}

// The limit of the wall clock is that of all runs together.
void run_within(run::common_options o, std::chrono::steady_clock::time_point began,
                const std::function<void(const run::common_options&)>& run) {
  const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  auto& limit = o.run.wall_clock_limit;
  if (limit > 0.0) limit = std::max(limit - spent, 1e-3);
  run(o);
}

level level_in(const fs::path& folder, const options& o) {
  const auto summary = summary_in(folder);
  level l{o.domain.particles[0]};
  if (!summary.is_object()) return l.message = "its summary.json cannot be read", l;
  l.time = summary.value("time", 0.0);
  l.message = summary.value("message", "");
  if (completed(summary)) l.errors = summary.at("errors");
  return l;
}

// A run that fails is a level without errors; one that is interrupted interrupts all.
void run_one(const coarser_input& in, const run::command_line& line, std::chrono::steady_clock::time_point began,
             const maker& make) {
  try {
    run_within(in.values.common, began,
               [&](const run::common_options& rest) { run::carry_out(*make(in.values, {}), rest, line, in.resolved); });
  } catch (const foundation::error& e) {
    const std::string which = fmt::format("with {} particles along x: {}", in.values.domain.particles[0], e.what());
    if (e.status() != exit_status::calculation_failed) throw foundation::error(e.status(), which);
    if (domain::communicator::world().rank == 0) fmt::print(stderr, "{}: {}\n", line.program, which);
  }
}

std::optional<double> order(const std::vector<const level*>& used, const char* name) {
  fitted_line line;
  for (const level* l : used) {
    const auto& e = l->errors.at(name);
    if (e.is_number() && e.get<double>() > 0.0)
      line.add(std::log(static_cast<double>(l->particles_x)), std::log(e.get<double>()));
  }
  return line.n >= 2.0 ? std::optional(-line.slope()) : std::nullopt;
}

}  // namespace

std::vector<coarser_input> coarser_inputs(const namelist::schema& schema, options& o) {
  std::vector<coarser_input> all;
  const auto finest = o.domain.particles;
  const std::int64_t coarser = o.shock.coarser;
  o.shock.coarser = 0;
  for (std::int64_t k = coarser; k > 0; --k) {
    for (std::size_t a = 0; a < 3; ++a) o.domain.particles[a] = finest[a] >> k;
    std::ostringstream resolved;
    schema.write_resolved(resolved);
    all.push_back({o, resolved.str()});
  }
  o.domain.particles = finest;
  o.shock.coarser = coarser;
  return all;
}

void run_all(const options& o, const std::string& resolved, const std::vector<coarser_input>& coarser,
             const run::command_line& line, const maker& make) {
  if (coarser.empty() || line.plan) return run::carry_out(*make(o, {}), o.common, line, resolved);
  using mode = output::directory_mode;
  const auto ranks = domain::communicator::world();
  const auto began = std::chrono::steady_clock::now();
  output::open_directory(ranks.comm, line.output,
                         !line.restart.empty() ? mode::restart
                         : line.force          ? mode::force
                                               : mode::fresh);
  std::vector<level> levels;
  for (std::size_t n = 0; n < coarser.size(); ++n) {
    const auto folder = fs::path(line.output) / fmt::format("coarser_{}", coarser.size() - n);
    if (line.restart.empty() || !is_done(folder, coarser[n].resolved)) {
      auto coarse = line;
      coarse.output = folder.string();
      coarse.force = line.restart.empty() || !has_checkpoint(folder);
      coarse.restart = coarse.force ? "" : "latest";
      run_one(coarser[n], coarse, began, make);
    }
    levels.push_back(level_in(folder, coarser[n].values));
  }
  // The directory is open, with the coarser runs in it; one that stopped among these has no checkpoint of its own yet.
  auto own = line;
  if (line.restart.empty() || (line.restart == "latest" && !has_checkpoint(line.output))) {
    own.restart.clear();
    own.force = true;
  }
  run_within(o.common, began,
             [&](const run::common_options& rest) { run::carry_out(*make(o, levels), rest, own, resolved); });
}

nlohmann::ordered_json convergence(std::vector<level> levels, const level& finest) {
  constexpr std::array<const char*, 3> names{"density_l1", "velocity_l1", "pressure_l1"};
  levels.push_back(finest);
  nlohmann::ordered_json j{{"particles_x", nlohmann::ordered_json::array()}};
  nlohmann::ordered_json left_out = nlohmann::ordered_json::array();
  std::vector<const level*> used;
  for (const level& l : levels) {
    j["particles_x"].push_back(l.particles_x);
    for (const char* name : names)
      j[name].push_back(l.errors.is_object() ? l.errors.at(name) : nlohmann::ordered_json(nullptr));
    const bool same_time = std::abs(l.time - finest.time) <= 1e-9 * finest.time;
    if (l.errors.is_object() && same_time)
      used.push_back(&l);
    else
      left_out.push_back(
          {{"particles_x", l.particles_x},
           {"why", l.errors.is_object() ? fmt::format("its errors are those at t = {:.6g} s", l.time) : l.message}});
  }
  for (const char* name : names) {
    const auto p = order(used, name);
    j["order"][name] = p ? nlohmann::ordered_json(*p) : nlohmann::ordered_json(nullptr);
  }
  j["left_out"] = left_out;
  return j;
}

}  // namespace tetsuame::gas
