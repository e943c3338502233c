// The particles of a virtual run: places, kinds and the bins that find who is near whom.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <balance/cuts.hpp>
#include <cmath>
#include <cstdint>
#include <foundation/error.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <output/hash.hpp>
#include <output/snapshot_file.hpp>
#include <vector>
#include <virtual_ranks/options.hpp>

namespace tetsuame::virtual_ranks {

enum class kind : std::uint8_t { fluid, wall, marker, metal };

template <int D>
struct scene {
  std::array<double, D> length{};  // m
  double spacing = 0.0;            // m
  std::vector<std::array<double, D>> x;
  std::vector<kind> kinds;

  // Bins of the halo's width; particles stand in the order of their bins.
  std::array<std::int64_t, D> bins{};        // along each axis
  std::vector<std::size_t> first;            // of each bin; one more than bins
  std::vector<std::array<double, D>> blobs;  // centres at the start

  std::size_t bin(const std::array<std::int64_t, D>& i) const {
    std::int64_t b = 0;
    for (std::size_t a = D; a-- > 0;) b = b * bins[a] + i[a];
    return static_cast<std::size_t>(b);
  }
  std::size_t size() const { return x.size(); }
  double volume() const { return std::accumulate(length.begin(), length.end(), 1.0, std::multiplies<>()); }  // m^D
};

// In [0, 1), the same for the same numbers on any machine [SplitMix64, G. Steele et al., OOPSLA 2014].
inline double uniform_at(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  const auto mix = [](std::uint64_t z) { return output::mix(z + 0x9e3779b97f4a7c15U); };
  return static_cast<double>(mix(mix(mix(seed) ^ stream) ^ index) >> 11) * 0x1p-53;
}

// Box-Muller.
inline double normal_at(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  const double u = 1.0 - uniform_at(seed, stream, 2 * index), v = uniform_at(seed, stream, 2 * index + 1);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

constexpr std::uint64_t jitter_stream = 1, blob_stream = 16;

// Height of the bowl's surface above a point.
template <int D>
double ground(const distribution_options& o, const std::array<double, D>& x) {
  double r2 = 0.0;
  for (std::size_t a = 0; a < D; ++a)
    if (a != 1) r2 += (x[a] - 0.5 * o.length[a]) * (x[a] - 0.5 * o.length[a]);
  const double radius = o.bowl_radius * o.length[0];
  return o.length[1] * (o.bowl_bottom + (o.bowl_rim - o.bowl_bottom) * std::min(1.0, r2 / (radius * radius)));
}

// The kind of a particle there; none where the box is empty.
template <int D>
std::optional<kind> kind_at(const distribution_options& o, double reach, const std::array<double, D>& x) {
  if (o.kind != "bowl") return kind::fluid;
  const double surface = ground<D>(o, x);
  if (x[1] >= surface) return x[1] < o.water_level * o.length[1] ? std::optional(kind::fluid) : std::nullopt;
  // Seen straight up: near enough for a bowl this flat.
  const bool near = surface - x[1] < reach && surface < o.water_level * o.length[1];
  return near ? kind::marker : kind::wall;
}

// visit(i) for every index between two along each axis, these included; the first axis runs fastest.
template <int D, class F>
void visit_indices(const std::array<std::int64_t, D>& low, const std::array<std::int64_t, D>& high, const F& visit) {
  for (auto i = low; i[D - 1] <= high[D - 1];) {
    visit(i);
    for (std::size_t a = 0; ++i[a] > high[a] && a + 1 < D; ++a) i[a] = low[a];
  }
}

template <int D, class F>
void visit_lattice(const std::array<double, D>& length, double spacing, const F& visit) {
  std::array<std::int64_t, D> last;
  for (std::size_t a = 0; a < D; ++a) last[a] = std::max<std::int64_t>(1, std::llround(length[a] / spacing)) - 1;
  std::uint64_t k = 0;
  visit_indices<D>({}, last, [&](const std::array<std::int64_t, D>& i) {
    std::array<double, D> x{};
    for (std::size_t a = 0; a < D; ++a)
      x[a] = (static_cast<double>(i[a]) + 0.5) * length[a] / static_cast<double>(last[a] + 1);
    visit(k++, x);
  });
}

template <int D>
void fill(scene<D>& s, const distribution_options& o, double halo_width) {
  const double volume = s.volume();
  // The filled part of the box, on a lattice coarse enough to be quick.
  std::int64_t tried = 0, filled = 0;
  visit_lattice<D>(s.length, std::pow(volume / 2e5, 1.0 / D), [&](std::uint64_t, const std::array<double, D>& x) {
    ++tried;
    if (kind_at<D>(o, 0.0, x)) ++filled;
  });
  const double part = static_cast<double>(std::max<std::int64_t>(filled, 1)) / static_cast<double>(tried);
  s.spacing = std::pow(volume * part / static_cast<double>(o.particles), 1.0 / D);
  const auto seed = static_cast<std::uint64_t>(o.seed);
  visit_lattice<D>(s.length, s.spacing, [&](std::uint64_t k, std::array<double, D> x) {
    const auto found = kind_at<D>(o, halo_width * s.spacing, x);
    if (!found) return;
    for (std::size_t a = 0; a < D; ++a)
      x[a] = std::clamp(x[a] + o.jitter * s.spacing * (uniform_at(seed, jitter_stream + a, k) - 0.5), 0.0, s.length[a]);
    s.x.push_back(x);
    s.kinds.push_back(*found);
  });
  if (o.kind != "blobs") return;
  for (std::int64_t b = 0; b < o.blobs; ++b) {
    std::array<double, D> centre{};
    for (std::size_t a = 0; a < D; ++a) {
      const double u = uniform_at(seed, blob_stream + a, static_cast<std::uint64_t>(b));
      centre[a] = (a == 1 ? o.blob_height : 1.0) * o.length[a] * u;
    }
    s.blobs.push_back(centre);
  }
}

template <int D>
void read_positions(scene<D>& s, const output::snapshot_file& file, const std::string& group, kind as) {
  const auto values = file.read(group, "Coordinates", output::snapshot_file::length);
  for (std::size_t k = 0; k < values.size() / 3; ++k) {
    std::array<double, D> x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = values[3 * k + a];
    if (!std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); }))
      file.fail(": " + group + "/Coordinates holds values that are not finite");
    s.x.push_back(x);
    s.kinds.push_back(as);
  }
}

template <int D>
void read(scene<D>& s, const distribution_options& o) {
  const output::snapshot_file file(o.file, "");
  for (const auto& [group, as] : {std::pair{"PartType0", kind::fluid}, std::pair{"PartType1", kind::marker}}) {
    const auto of_places = file.find("Coordinates", group);
    if (!of_places) continue;  // a snapshot without walls
    if (!of_places->is_of_numbers() || of_places->shape.size() != 2 || of_places->shape[1] != 3)
      file.fail(fmt::format(": {}/Coordinates is not an array of three columns", group));
    read_positions(s, file, group, as);
  }
  if (s.x.empty()) file.fail(": no PartType0/Coordinates");
  // Positions begin at the box's corner in our snapshots; walls outside belong to the outermost cells.
  const auto fluid = std::max<std::ptrdiff_t>(std::count(s.kinds.begin(), s.kinds.end(), kind::fluid), 1);
  s.spacing = std::pow(s.volume() / static_cast<double>(fluid), 1.0 / D);
}

// Along an axis; what lies outside the box goes to the outermost.
template <int D>
std::int64_t bin_along(const scene<D>& s, std::size_t axis, double x) {
  const auto i = static_cast<std::int64_t>(x / s.length[axis] * static_cast<double>(s.bins[axis]));
  return std::clamp<std::int64_t>(i, 0, s.bins[axis] - 1);
}

template <int D>
void sort_into_bins(scene<D>& s, double halo_width) {
  const double width = halo_width * s.spacing;  // m
  std::size_t all = 1;
  for (std::size_t a = 0; a < D; ++a) {
    s.bins[a] = std::clamp<std::int64_t>(static_cast<std::int64_t>(s.length[a] / width), 1, 1 << 20);
    all *= static_cast<std::size_t>(s.bins[a]);
  }
  std::vector<std::size_t> bin(s.size());
  s.first.assign(all + 1, 0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    std::array<std::int64_t, D> at{};
    for (std::size_t a = 0; a < D; ++a) at[a] = bin_along(s, a, s.x[i][a]);
    bin[i] = s.bin(at);
    ++s.first[bin[i] + 1];
  }
  std::partial_sum(s.first.begin(), s.first.end(), s.first.begin());
  auto next = s.first;
  std::vector<std::array<double, D>> x(s.size());
  std::vector<kind> kinds(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    const std::size_t to = next[bin[i]]++;
    x[to] = s.x[i];
    kinds[to] = s.kinds[i];
  }
  s.x.swap(x);
  s.kinds.swap(kinds);
}

// Kinds after so many steps; true if any has changed. Only falling blobs change theirs.
template <int D>
bool move_blobs(scene<D>& s, const distribution_options& o, std::int64_t steps) {
  if (s.blobs.empty() || (steps > 0 && o.fall == 0.0)) return false;
  const double radius = o.blob_radius * o.length[0];
  auto centres = s.blobs;
  for (auto& c : centres) {
    c[1] = std::max(c[1] - o.fall * static_cast<double>(steps), std::min(c[1], radius));
  }
  std::vector<kind> kinds(s.size(), kind::fluid);
  // Only the bins that a blob meets.
  for (const auto& c : centres) {
    std::array<std::int64_t, D> low{}, high{};
    for (std::size_t a = 0; a < D; ++a) {
      low[a] = bin_along(s, a, c[a] - radius);
      high[a] = bin_along(s, a, c[a] + radius);
    }
    visit_indices<D>(low, high, [&](const std::array<std::int64_t, D>& at) {
      const std::size_t bin = s.bin(at);
      for (std::size_t i = s.first[bin]; i < s.first[bin + 1]; ++i) {
        double r2 = 0.0;
        for (std::size_t a = 0; a < D; ++a) r2 += (s.x[i][a] - c[a]) * (s.x[i][a] - c[a]);
        if (r2 < radius * radius) kinds[i] = kind::metal;
      }
    });
  }
  const bool changed = kinds != s.kinds;
  s.kinds.swap(kinds);
  return changed;
}

// Throws fail_input (no particle, an unfit snapshot) and fail_file.
template <int D>
scene<D> make_scene(const distribution_options& o, double halo_width) {
  scene<D> s;
  for (std::size_t a = 0; a < D; ++a) s.length[a] = o.length[a];
  if (o.kind == "snapshot")
    read(s, o);
  else
    fill(s, o, halo_width);
  if (s.x.empty()) foundation::fail_input(o.place + "the distribution has none: use more, or a fuller bowl");
  sort_into_bins(s, halo_width);
  move_blobs(s, o, 0);
  return s;
}

// Cuts with as many particles in each cell, as far as whole particles allow.
template <int D>
balance::cuts<D> equal_count_cuts(const scene<D>& s, const std::array<int, D>& counts) {
  auto c = balance::equal_cuts<D>(counts, s.length);
  std::vector<std::size_t> order(s.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  using iterator = std::vector<std::size_t>::iterator;
  const auto split = [&](auto&& self, std::size_t axis, std::size_t g, iterator begin, iterator end) -> void {
    const auto less = [&](std::size_t i, std::size_t j) { return s.x[i][axis] < s.x[j][axis]; };
    std::sort(begin, end, less);
    const auto n = static_cast<std::size_t>(end - begin), parts = static_cast<std::size_t>(counts[axis]);
    double* cut = c.group(axis, g);
    const auto border = [&](std::size_t k) { return begin + static_cast<std::ptrdiff_t>(n * k / parts); };
    for (std::size_t k = 1; k < parts; ++k) {
      const auto at = border(k);
      if (n == 0) break;  // the cuts stay equal
      const double above = at == end ? c.group(axis, g)[parts] : s.x[*at][axis];
      const double below = at == begin ? above : s.x[*(at - 1)][axis];
      cut[k] = std::clamp(0.5 * (below + above), cut[0], cut[parts]);
    }
    if (axis + 1 == D) return;
    for (std::size_t k = 0; k < parts; ++k) self(self, axis + 1, g * parts + k, border(k), border(k + 1));
  };
  split(split, 0, 0, order.begin(), order.end());
  return c;
}

}  // namespace tetsuame::virtual_ranks
