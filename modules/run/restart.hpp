// The integrator's memory in a checkpoint, and back.
#pragma once

#include <integrators/explicit_integrator.hpp>
#include <output/checkpoint.hpp>
#include <string>

namespace tetsuame::run {

inline void save(const integrators::explicit_memory& memory, output::checkpoint_globals& g) {
  const auto& st = memory.statistics;
  g.reals["time"] = memory.t;
  g.reals["next_dt"] = memory.next_dt;
  g.reals["previous_error"] = memory.previous_error;
  g.reals["previous_dt"] = memory.previous_dt;
  g.reals["radius"] = st.radius;
  g.reals["last_dt"] = st.last_dt;
  g.integers["steps"] = st.steps;
  g.integers["attempts"] = st.attempts;
  g.integers["rejections"] = st.rejections;
  g.integers["unevaluable"] = st.unevaluable;
  g.integers["evaluations"] = st.evaluations;
  for (const auto& [name, count] : st.limited_by) g.integers["limited_by " + name] = count;
}

inline integrators::explicit_memory integrator_memory(const output::checkpoint_globals& g) {
  integrators::explicit_memory memory;
  memory.t = g.reals.at("time");
  memory.next_dt = g.reals.at("next_dt");
  memory.previous_error = g.reals.at("previous_error");
  auto& st = memory.statistics;
  memory.previous_dt = g.reals.at("previous_dt");
  st.radius = g.reals.at("radius");
  st.last_dt = g.reals.at("last_dt");
  st.next_dt = memory.next_dt;
  st.steps = g.integers.at("steps");
  st.attempts = g.integers.at("attempts");
  st.rejections = g.integers.at("rejections");
  st.unevaluable = g.integers.at("unevaluable");
  st.evaluations = g.integers.at("evaluations");
  for (const auto& [name, count] : g.integers)
    if (name.starts_with("limited_by ")) st.limited_by[name.substr(11)] = count;
  return memory;
}

}  // namespace tetsuame::run
