// The input of `balance`.
#pragma once

#include <algorithm>
#include <array>
#include <balance/balancer.hpp>
#include <cmath>
#include <cstdint>
#include <foundation/error.hpp>
#include <namelist/schema.hpp>
#include <output/snapshot_file.hpp>
#include <string>
#include <vector>
#include <virtual_ranks/zoltan.hpp>

namespace tetsuame::virtual_ranks {

using namelist::between;

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

inline void declare(namelist::schema& schema, distribution_options& o) {
  const std::string group = "distribution";
  schema.group(group, "where the particles are, and of which kind");
  schema.add(group, "kind", o.kind,
             {.choices = {"bowl", "blobs", "uniform", "snapshot"},
              .meaning = "water in a bowl of wall particles; metal blobs at the bottom of a magma ocean; fluid "
                         "everywhere; a snapshot of ours"});
  schema.add(group, "dimension", o.dimension, between(2, 3, "of space; y is up"));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add(group, std::string("length_") + "xyz"[a], o.length[a],
               {.unit = "m", .minimum = 1e-100, .maximum = 1e100, .meaning = "edge of the box"});
  schema.add(group, "particles", o.particles, between(1, 2e9, "about how many of all kinds"));
  schema.add(group, "jitter", o.jitter,
             between(0.0, 1.0, "random displacement, full width, in spacings of the lattice"));
  schema.add(group, "seed", o.seed, {.meaning = "of the jitter and of the blobs' places"});
  const auto part = [](std::string meaning) { return between(0.0, 1.0, std::move(meaning)); };
  schema.add(group, "bowl_bottom", o.bowl_bottom, part("bowl: height of the paraboloid's lowest point, of length_y"));
  schema.add(group, "bowl_rim", o.bowl_rim, part("bowl: height of its rim and of the ground around it, of length_y"));
  schema.add(group, "bowl_radius", o.bowl_radius, part("bowl: distance of the rim from the axis, of length_x"));
  schema.add(group, "water_level", o.water_level, part("bowl: height of the water's surface, of length_y"));
  schema.add(group, "blobs", o.blobs, between(0, 1e6, "blobs: how many"));
  schema.add(group, "blob_radius", o.blob_radius, part("blobs: of length_x"));
  schema.add(group, "blob_height", o.blob_height, part("blobs: centres lie below this height, of length_y"));
  schema.add(group, "fall", o.fall,
             {.unit = "m", .minimum = 0.0, .meaning = "blobs: way down per step; they rest on the bottom"});
  schema.add(group, "file", o.file, {.meaning = "snapshot: path; PartType0 counts as fluid, PartType1 as marker"});
}

struct cost_options {
  double fluid = 2e-6, wall = 5e-7, marker = 1e-6, metal = 4e-6;  // s
  double halo = 2e-8, latency = 2e-6;                             // s
  double halo_width = 3.8;                                        // of the spacing
  double migrate = 4e-7, list = 1e-7;                             // s
};

inline void declare(namelist::schema& schema, cost_options& o) {
  const std::string group = "cost";
  schema.group(group, "modelled time of a rank's step");
  const auto seconds = [](std::string meaning) {
    return namelist::key_info{.unit = "s", .minimum = 0.0, .meaning = std::move(meaning)};
  };
  schema.add(group, "fluid", o.fluid, seconds("computing, for each fluid particle"));
  schema.add(group, "wall", o.wall, seconds("computing, for each wall particle out of the fluid's reach"));
  schema.add(group, "marker", o.marker, seconds("computing, for each wall particle with a virtual marker"));
  schema.add(group, "metal", o.metal, seconds("computing, for each metal particle"));
  schema.add(group, "halo", o.halo, seconds("communication, for each particle of the halo"));
  schema.add(group, "latency", o.latency, seconds("communication, for each neighbouring rank"));
  schema.add(group, "halo_width", o.halo_width, between(0.1, 100.0, "reach of a particle, in spacings"));
  schema.add(group, "migrate", o.migrate, seconds("of a move: for each particle that a rank sends or receives"));
  schema.add(group, "list", o.list,
             seconds("of a move: for each particle of the fullest rank, beyond the new lists due anyway"));
}

struct machine_options {
  std::int64_t ranks = 484, ranks_x = 0;
  double slow_fraction = 0.0, slow_factor = 1.1;
  std::string slow_pattern = "random";
  double noise = 0.0;
  std::int64_t seed = 1;
};

inline void declare(namelist::schema& schema, machine_options& o) {
  const std::string group = "machine";
  schema.group(group, "the virtual ranks");
  schema.add(group, "ranks", o.ranks, between(1, 1 << 20, "how many"));
  schema.add(group, "ranks_x", o.ranks_x, between(0, 1 << 20, "columns along x, which must divide ranks; 0: chosen"));
  schema.add(group, "slow_fraction", o.slow_fraction, between(0.0, 1.0, "part of the ranks that compute slowly"));
  schema.add(group, "slow_factor", o.slow_factor,
             between(0.01, 100.0, "computing time of a slow rank, of a usual one's"));
  schema.add(group, "slow_pattern", o.slow_pattern,
             {.choices = {"random", "first"}, .meaning = "which ranks are slow: any, or the first of them"});
  schema.add(group, "noise", o.noise, between(0.0, 1.0, "relative standard deviation of the measured times"));
  schema.add(group, "seed", o.seed, {.meaning = "of the noise and of the slow ranks' choice"});
}

struct schedule_options {
  std::string start = "equal_counts", move = "when_worth";
  std::int64_t steps = 5000, steps_between = 100, updates = 1000000, horizon = 0;
};

inline void declare(namelist::schema& schema, schedule_options& o) {
  const std::string group = "schedule";
  schema.group(group, "start and course of the modelled run");
  schema.add(group, "start", o.start,
             {.choices = {"equal_counts", "equal_size"},
              .meaning = "first cuts: as many particles for each rank, or as much room"});
  schema.add(group, "move", o.move,
             {.choices = {"when_worth", "always"}, .meaning = "whether a decision weighs gain against cost"});
  schema.add(group, "steps", o.steps, between(1, 1e12, "time steps of the run"));
  schema.add(group, "steps_between", o.steps_between, between(1, 1e12, "time steps from one decision to the next"));
  schema.add(group, "updates", o.updates, between(0, 1e6, "decisions at most; a decision may be to stay"));
  schema.add(group, "horizon", o.horizon,
             between(0, 1e12, "steps whose gain is set against the cost of a move; 0: steps_between"));
}

// Dimension and box of the snapshot o.file.
inline void read_box(const namelist::schema& schema, distribution_options& o) {
  const output::snapshot_file file(o.file, schema.where("distribution", "file") + ": &distribution file: ");
  o.dimension = file.dimension().value_or(3) == 3 ? 3 : 2;
  const auto axes = static_cast<std::size_t>(o.dimension);
  const auto [lengths, size] = file.of_box();
  auto edges = lengths ? *lengths : size.value_or(std::vector<double>{});
  if (edges.size() == 1) edges.assign(axes, edges[0]);
  if (edges.size() < axes) file.fail(": Header tells no box: expected BoxLengths or BoxSize");
  if (std::any_of(edges.begin(), edges.begin() + o.dimension, [](double v) { return !(v > 0.0); }))
    file.fail(": the box of its Header has no size");
  std::copy_n(edges.begin(), o.dimension, o.length.begin());
}

// A lattice of about so many particles must have a row along each edge.
inline void check_shape(const namelist::schema& schema, const distribution_options& d) {
  const auto end = d.length.begin() + d.dimension;
  const auto longest = std::max_element(d.length.begin(), end);
  if (*longest > 1e4 * *std::min_element(d.length.begin(), end))
    schema.fail("distribution", std::string("length_") + "xyz"[longest - d.length.begin()],
                "expected at most 1e4 times the box's shortest edge");
}

struct options {
  distribution_options distribution;
  cost_options cost;
  machine_options machine;
  schedule_options schedule;
  std::vector<std::string> compare;
  balance::balancer_options balancer;
};

inline void declare(namelist::schema& schema, options& o) {
  declare(schema, o.distribution);
  declare(schema, o.cost);
  declare(schema, o.machine);
  declare(schema, o.schedule);
  balance::declare(schema, o.balancer);
  schema.group("compare", "other partitioners on the same particles and costs (Zoltan)");
  schema.add(
      "compare", "methods", o.compare,
      {.maximum_size = 2, .meaning = with_zoltan ? "any of 'rcb', 'hsfc'; or 'none'" : "'none': built without Zoltan"});
}

// Checks, and takes dimension and box of a snapshot from its file. Throws fail_input and fail_file.
inline void complete(const namelist::schema& schema, options& o) {
  const auto& d = o.distribution;
  o.distribution.place = schema.where("distribution", "particles") + ": &distribution particles: ";
  if (o.machine.ranks_x > 0 && o.machine.ranks % o.machine.ranks_x != 0)
    schema.fail("machine", "ranks_x", "must divide the number of ranks, " + std::to_string(o.machine.ranks));
  if (d.kind == "snapshot" && d.file.empty()) schema.fail("distribution", "file", "a snapshot is to be read: which?");
  if (d.kind == "snapshot") read_box(schema, o.distribution);
  check_shape(schema, d);
  if (d.kind == "bowl" && !(d.bowl_bottom < d.bowl_rim))
    schema.fail("distribution", "bowl_bottom", "must be lower than bowl_rim");
  if (d.kind == "bowl" && (d.water_level > d.bowl_rim))
    schema.fail("distribution", "water_level", "must not be higher than bowl_rim");
  if (d.kind == "bowl" && !(d.bowl_radius > 0.0)) schema.fail("distribution", "bowl_radius", "must be > 0");
  if (d.fall > 0.0 && d.kind != "blobs") schema.fail("distribution", "fall", "only blobs fall");
  std::erase_if(o.compare, [](const std::string& name) { return name.empty() || name == "none"; });
  if (o.compare.size() == 2 && o.compare[0] == o.compare[1]) schema.fail("compare", "methods", "names one twice");
  for (const auto& name : o.compare)
    if (!with_zoltan)
      schema.fail("compare", "methods", "'" + name + "': this program is built without Zoltan; expected 'none'");
    else if (name != "rcb" && name != "hsfc")
      schema.fail("compare", "methods", "'" + name + "': expected 'rcb' or 'hsfc'");
  if (o.schedule.horizon == 0) o.schedule.horizon = o.schedule.steps_between;
}

}  // namespace tetsuame::virtual_ranks
