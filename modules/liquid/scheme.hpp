// A scheme for liquids, as problems see it: what it carries, and its rates. What it consists of, a program names
// (scheme_of.hpp).
#pragma once

#include <functional>
#include <liquid/right_hand_side.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <output/checkpoint.hpp>
#include <run/run_directory.hpp>

namespace tetsuame::liquid {

template <int D>
class scheme {
 public:
  virtual ~scheme() = default;

  // ρ, Y or nothing is integrated beside x, v, T and u.
  virtual volume::carries carried() const = 0;
  // When the particles of the start are in their places, with ρ, T and m.
  virtual void begin(run::state<D>& box) = 0;
  // ρ where it is remembered.
  virtual void recall_density(run::state<D>&) const {}
  virtual void evaluate(run::state<D>& box, const rates<D>& out) = 0;

  // As of run::problem.
  virtual void keep_memory(run::state<D>&) {}
  virtual void begin_tables(run::run_directory&) {}
  virtual void complete_step(std::int64_t /*step*/) {}
  virtual void fail(const foundation::error&, std::int64_t /*step*/, run::summary&) {}
  virtual void report(const run::state<D>&, nlohmann::ordered_json& /*metrics*/) const {}
  virtual void save(output::checkpoint_globals&) const {}
  virtual void restore(const output::checkpoint_globals&) {}
};

// A program that runs liquids: its name, the walls it has unless the input says otherwise, and its scheme.
struct program {
  const char* name;
  const char* wall;
  bool iterates;           // for Y, to a tolerance
  bool remembers_density;  // ρ is known before an evaluation, from what is carried or remembered
  std::function<std::unique_ptr<scheme<2>>(const volume::options&)> in_2d;
  std::function<std::unique_ptr<scheme<3>>(const volume::options&)> in_3d;
};

}  // namespace tetsuame::liquid
