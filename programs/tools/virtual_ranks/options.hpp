// The input of `balance`.
#pragma once

#include <array>
#include <balance/balancer.hpp>
#include <cstdint>
#include <namelist/schema.hpp>
#include <string>
#include <vector>

namespace tetsuame::virtual_ranks {

struct distribution_options {
  std::string kind = "bowl";
  std::int64_t dimension = 2;
  std::array<double, 3> length{2.0, 1.0, 2.0};  // m
  std::int64_t particles = 1000000;
  std::string place;    // where that was said, for messages
  double jitter = 1.0;  // of the spacing
  std::int64_t seed = 1;
  double bowl_bottom = 0.1, bowl_rim = 0.6, bowl_radius = 0.45, water_level = 0.3;
  std::int64_t blobs = 12;
  double blob_radius = 0.05, blob_height = 0.25, fall = 0.0;
  std::string file;
};

struct cost_options {
  double fluid = 2e-6, wall = 5e-7, marker = 1e-6, metal = 4e-6;  // s
  double halo = 2e-8, latency = 2e-6;                             // s
  double halo_width = 3.8;                                        // of the spacing
  double migrate = 4e-7, list = 1e-7;                             // s
};

struct machine_options {
  std::int64_t ranks = 484, ranks_x = 0;
  double slow_fraction = 0.0, slow_factor = 1.1;
  std::string slow_pattern = "random";
  double noise = 0.0;
  std::int64_t seed = 1;
};

struct schedule_options {
  std::string start = "equal_counts", move = "when_worth";
  std::int64_t steps = 5000, steps_between = 100, updates = 1000000, horizon = 0;
};

struct options {
  distribution_options distribution;
  cost_options cost;
  machine_options machine;
  schedule_options schedule;
  std::vector<std::string> compare;
  balance::balancer_options balancer;
};

void declare(namelist::schema& schema, options& o);
// Checks, and takes dimension and box of a snapshot from its file. Throws fail_input and fail_file.
void complete(const namelist::schema& schema, options& o);

}  // namespace tetsuame::virtual_ranks
