// The same case at coarser resolutions, and the order of convergence: the least squares' slope p of
//   ln |error| = ln C - p ln N,   N particles along x: N, N/2, …, N/2^coarser
#pragma once

#include <functional>
#include <gas/setups.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <run/command_line.hpp>
#include <run/simulation.hpp>
#include <string>
#include <vector>

namespace tetsuame::gas {

// A run as it ended.
struct level {
  std::int64_t particles_x = 0;
  double time = 0.0;                        // s, at the end
  nlohmann::ordered_json errors = nullptr;  // as in summary.json; null: it did not complete
  std::string message = {};                 // how it ended
};

// One input at 1/2^k of its resolution.
struct coarser_input {
  options values;
  std::string resolved;  // as a namelist
};
std::vector<coarser_input> coarser_inputs(const namelist::schema& schema, options& o);

// Collective. The coarser runs one after the other in OUTPUT/coarser_k, whole runs of their own, then the one asked
// for. With --restart: those that completed are taken as they are, the others continue from their last checkpoint, or
// start.
using maker = std::function<std::unique_ptr<run::simulation>(const options&, const std::vector<level>& coarser)>;
void run_all(const options& o, const std::string& resolved, const std::vector<coarser_input>& coarser,
             const run::command_line& line, const maker& make);

// The problem in one, two and three dimensions, each compiled by itself (programs/shock).
std::unique_ptr<run::simulation> make_1d(const options& o, const std::vector<level>& coarser);
std::unique_ptr<run::simulation> make_2d(const options& o, const std::vector<level>& coarser);
std::unique_ptr<run::simulation> make_3d(const options& o, const std::vector<level>& coarser);
// With a start that is no test of make_setup.
std::unique_ptr<run::simulation> make_2d(const options& o, setup start);
std::unique_ptr<run::simulation> make_3d(const options& o, setup start);

// For summary.json: by level, and the orders. A level without errors, or at another time, is named and left out.
nlohmann::ordered_json convergence(std::vector<level> levels, const level& finest);

}  // namespace tetsuame::gas
