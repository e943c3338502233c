#include "nodes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <foundation/threads.hpp>
#include <gravity/softening.hpp>

namespace tetsuame::gravity {

namespace {

using foundation::lanes;
using foundation::real;

constexpr double smallest_edge = 1e-200;  // m; its inverse times a cell's index is a number
constexpr std::size_t block_size = 512;   // particles, of which entries and sums stay in the cache

template <int D>
double distance(const foundation::vec<double, D>& a, const foundation::vec<double, D>& b) {
  const auto d = a - b;
  return std::sqrt(dot(d, d));
}

const real lane_numbers([](auto lane) { return static_cast<double>(lane); });

// A radius that was rounded down may leave a particle outside.
constexpr double rounding = 1.0 + 1e-14;

// The power of two next above, for lengths and masses above 0.
double unit_of(double value) {
  return value > 0.0 ? std::ldexp(1.0, std::clamp(std::ilogb(value) + 1, -1000, 1000)) : 1.0;
}

// Targets that are in a register together are near each other.
constexpr std::size_t register_size = leaf_size / 2;

// Nodes of a block of n particles, and the particles of its first part: whole leaves.
std::size_t nodes_of_block(std::size_t n) { return 2 * ((n + leaf_size - 1) / leaf_size) - 1; }
std::size_t first_part(std::size_t n) {
  const std::size_t leaves = (n + leaf_size - 1) / leaf_size;
  return leaves / 2 * leaf_size;
}

}  // namespace

template <int D>
std::size_t node_tree<D>::box::longest_axis() const {
  std::size_t longest = 0;
  for (std::size_t a = 1; a < D; ++a)
    if (high[a] - low[a] > high[longest] - low[longest]) longest = a;
  return longest;
}
template <int D>
void node_tree<D>::box::include(const box& other) {
  for (std::size_t a = 0; a < D; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

template <int D>
template <class Position>
auto node_tree<D>::bounds(std::size_t first, std::size_t last, const Position& position) -> box {
  box b{position(first), position(first)};
  for (std::size_t k = first + 1; k < last; ++k) b.include({position(k), position(k)});
  return b;
}

// Differences of numbers that are within a factor of 2 of each other are exact [P. H. Sterbenz (1974)]: a cloud far
// from the origin is moved close to it, which makes all that follows more precise.
template <int D>
void node_tree<D>::set_frame(const box& all) {
  length = unit_of(all.edge());
  for (std::size_t a = 0; a < D; ++a) {
    origin[a] = 0.0;
    if (all.low[a] > 0.0 && all.high[a] <= 2.0 * all.low[a]) origin[a] = all.low[a];
    if (all.high[a] < 0.0 && all.low[a] >= 2.0 * all.high[a]) origin[a] = all.high[a];
  }
}

template <int D>
bool node_tree<D>::sort_range(const cloud<D>& particles, std::size_t first, std::size_t last) {
  const auto position = [&](std::size_t k) {
    std::array<double, D> at;
    for (std::size_t a = 0; a < D; ++a) at[a] = particles.x[a][keys_[k].index];
    return at;
  };
  const box b = bounds(first, last, position);
  const cube<D> c{b.low, b.edge()};
  if (last - first == particles.n) set_frame(b);
  const bool extended = c.edge > smallest_edge;
  const std::size_t n = last - first;
  foundation::for_chunks(n, foundation::chunk_of_values(n), n > foundation::values_worth_threads,
                         [&](std::size_t from, std::size_t to) {
                           for (std::size_t k = first + from; k < first + to; ++k)
                             keys_[k].key = extended ? c.key(position(k)) : 0;
                         });
  sort_keys(std::span(keys_).subspan(first, n), particles.id, buffer_);
  return extended;
}

// Where the keys' highest bit that differs changes. Particles of one cell get new keys within it; those at one place
// are halved.
template <int D>
std::size_t node_tree<D>::division(const cloud<D>& particles, std::size_t first, std::size_t last) {
  if (keys_[first].key == keys_[last - 1].key && !sort_range(particles, first, last)) return first + (last - first) / 2;
  const auto bit = std::bit_floor(keys_[first].key ^ keys_[last - 1].key);
  const auto part = std::span(keys_).subspan(first, last - first);
  const auto middle = std::ranges::partition_point(part, [bit](const sorted_key& k) { return (k.key & bit) == 0; });
  return first + static_cast<std::size_t>(middle - part.begin());
}

// Nodes above blocks, and room for those of each block.
template <int D>
void node_tree<D>::divide(const cloud<D>& particles, std::size_t first, std::size_t last) {
  const std::size_t index = ranges.size(), n = last - first;
  ranges.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last), 0});
  if (n <= block_size) {
    blocks_.push_back(static_cast<std::uint32_t>(index));
    ranges.resize(index + nodes_of_block(n));
  } else {
    above_.push_back(static_cast<std::uint32_t>(index));
    const std::size_t middle = division(particles, first, last);
    divide(particles, first, middle);
    divide(particles, middle, last);
  }
  ranges[index].end = static_cast<std::uint32_t>(ranges.size());
}

template <int D>
void node_tree<D>::halve(std::size_t index, entry* entries, std::size_t first, std::size_t last) {
  const std::size_t n = last - first;
  ranges[index] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
                   static_cast<std::uint32_t>(index + nodes_of_block(n))};
  const auto by_place = [](const entry& p, const entry& q) { return p.place < q.place; };
  if (n <= register_size) return std::sort(entries, entries + n, by_place);
  const auto axis = bounds(0, n, [entries](std::size_t k) { return entries[k].x; }).longest_axis();
  const std::size_t middle = n <= leaf_size ? register_size : first_part(n);
  std::nth_element(entries, entries + middle, entries + n, [axis](const entry& p, const entry& q) {
    return p.x[axis] < q.x[axis] || (p.x[axis] == q.x[axis] && p.place < q.place);
  });
  if (n <= leaf_size) {
    std::sort(entries, entries + middle, by_place);
    return std::sort(entries + middle, entries + n, by_place);
  }
  halve(index + 1, entries, first, first + middle);
  halve(index + 1 + nodes_of_block(middle), entries + middle, first + middle, last);
}

template <int D>
void node_tree<D>::fill_block(const cloud<D>& particles, std::size_t index, std::vector<entry>& entries) {
  const auto [first, last, end] = ranges[index];
  entries.resize(last - first);
  for (std::size_t k = first; k < last; ++k) {
    entries[k - first].place = static_cast<std::uint32_t>(k);
    for (std::size_t a = 0; a < D; ++a) entries[k - first].x[a] = particles.x[a][keys_[k].index];
  }
  halve(index, entries.data(), first, last);
  for (std::size_t k = first; k < last; ++k) order[k] = keys_[entries[k - first].place].index;
  gather(particles, first, last);
  for (std::size_t k = end; k-- > index;) is_leaf(k) ? sum_leaf(k) : sum_parts(k);
}

template <int D>
void node_tree<D>::gather(const cloud<D>& particles, std::size_t first, std::size_t last) {
  for (std::size_t k = first; k < last; ++k) {
    const std::size_t i = order[k];
    for (std::size_t a = 0; a < D; ++a) x[a][k] = (particles.x[a][i] - origin[a]) / length;
    mass[k] = particles.mass[i] / unit_mass;
    inverse_support[k] = gravity::inverse_support<real>(particles.support[i] / length);
  }
}

template <int D>
void node_tree<D>::tell_box(std::size_t index) {
  const auto& b = boxes_[index];
  for (std::size_t a = 0; a < D; ++a) {
    nodes[index].middle[a] = 0.5 * (b.low[a] + b.high[a]);
    nodes[index].half[a] = 0.5 * (b.high[a] - b.low[a]) * rounding;
  }
}

template <int D>
void node_tree<D>::sum_leaf(std::size_t index) {
  auto& n = nodes[index];
  auto& b = boxes_[index];
  const auto [first, last, end] = ranges[index];
  double least_inverse = no_support<real>;
  const auto base = foundation::vec<double, D>::of([&, at = first](std::size_t a) { return x[a][at]; });
  auto moment = foundation::zero<double, D>();
  n.mass = 0.0;
  b = {base.c, base.c};
  for (std::size_t k = first; k < last; ++k) {
    n.mass += mass[k];
    least_inverse = std::min(least_inverse, inverse_support[k]);
    for (std::size_t a = 0; a < D; ++a) {
      moment[a] += mass[k] * (x[a][k] - base[a]);
      b.low[a] = std::min(b.low[a], x[a][k]);
      b.high[a] = std::max(b.high[a], x[a][k]);
    }
  }
  tell_box(index);
  n.support = least_inverse < no_support<real> ? 1.0 / least_inverse : 0.0;
  for (std::size_t a = 0; a < D; ++a)
    n.centre[a] = n.mass > 0.0 ? base[a] + moment[a] / n.mass : 0.5 * b.low[a] + 0.5 * b.high[a];
  std::array<real, far::full> sums;
  sums.fill(0.0);
  real largest = 0.0, sixth = 0.0;
  for (std::size_t k = first; k < last; k += lanes) {
    const auto within = lane_numbers < real(static_cast<double>(last - k));
    const auto load = [&](const std::vector<double>& from) {
      return foundation::select(within, real(&from[k], foundation::stdx::element_aligned), real(0.0));
    };
    foundation::vec<real, D> s;
    for (std::size_t a = 0; a < D; ++a) s[a] = foundation::select(within, load(x[a]) - n.centre[a], real(0.0));
    const real m = load(mass), s2 = dot(s, s);
    far::add_mass(sums, s, m);
    largest = foundation::greater(largest, s2);
    sixth += m * (s2 * s2 * s2);
  }
  std::array<double, far::full> all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = foundation::sum(sums[i]);
  multipoles[index].fill(0.0);
  far::fold(all, multipoles[index]);
  double r2 = 0.0;
  for (std::size_t lane = 0; lane < lanes; ++lane) r2 = std::max(r2, static_cast<double>(largest[lane]));
  n.radius = std::sqrt(r2) * rounding;
  n.spread = n.mass > 0.0 ? std::sqrt(std::cbrt(foundation::sum(sixth) / n.mass)) : 0.0;
}

template <int D>
void node_tree<D>::sum_parts(std::size_t index) {
  const std::size_t parts[] = {index + 1, second(index)};
  auto &n = nodes[index], &p = nodes[parts[0]], &q = nodes[parts[1]];
  n.mass = p.mass + q.mass;
  const double share = n.mass > 0.0 ? q.mass / n.mass : 0.5;
  n.support = std::max(p.support, q.support);
  n.centre = p.centre + share * (q.centre - p.centre);
  auto& b = boxes_[index];
  b = boxes_[parts[0]];
  b.include(boxes_[parts[1]]);
  tell_box(index);
  double corner2 = 0.0, reach = 0.0, sixth = 0.0;
  for (std::size_t a = 0; a < D; ++a) {
    const double far_end = std::max(n.centre[a] - b.low[a], b.high[a] - n.centre[a]);
    corner2 += far_end * far_end;
  }
  multipoles[index].fill(0.0);
  for (const std::size_t one : parts) {
    const auto& part = nodes[one];
    const double d = distance(n.centre, part.centre);
    reach = std::max(reach, (d + part.radius) * rounding);
    const double squared = d * d + part.spread * part.spread;
    sixth += part.mass * (squared * squared * squared);
    far::multipole_to_multipole(multipoles[one], part.centre - n.centre, multipoles[index]);
  }
  n.radius = std::min(std::sqrt(corner2) * rounding, reach);
  n.spread = n.mass > 0.0 ? std::sqrt(std::cbrt(sixth / n.mass)) : 0.0;
}

// No particle of one part is farther from one of the other than their farthest ends.
template <int D>
void node_tree<D>::bound_fields() {
  nodes[0].per_field = 0.0;  // a sum of fields first
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const double field = nodes[k].per_field;
    if (!is_leaf(k)) {
      auto &p = nodes[k + 1], &q = nodes[second(k)];
      const double ends = distance(p.centre, q.centre) + p.radius + q.radius;
      const double farthest = std::max({ends, p.support, q.support, 1e-100}),
                   per = D == 3 ? 1.0 / (farthest * farthest) : 1.0 / farthest;
      p.per_field = field + q.mass * per;
      q.per_field = field + p.mass * per;
    }
    nodes[k].per_field = 1.0 / std::max(field, 1e-200);
  }
}

template <int D>
void node_tree<D>::build(const cloud<D>& particles) {
  const std::size_t n = particles.n;
  for (auto* list : {&blocks_, &above_}) list->clear();
  nodes.clear();
  ranges.clear();
  order.resize(n);
  keys_.resize(n);
  if (n == 0) return;
  double heaviest = 0.0;
  for (std::size_t i = 0; i < n; ++i) heaviest = std::max(heaviest, particles.mass[i]);
  unit_mass = unit_of(heaviest);
  foundation::for_all(n, [&](std::size_t i) { keys_[i] = {0, static_cast<std::uint32_t>(i)}; });
  sort_range(particles, 0, n);
  divide(particles, 0, n);
  nodes.resize(ranges.size());
  boxes_.resize(ranges.size());
  multipoles.resize(ranges.size());
  for (auto* one : {&mass, &inverse_support}) one->resize(n + leaf_size, 0.0);
  for (auto& one : x) one.resize(n + leaf_size, 0.0);
  foundation::for_chunks(blocks_.size(), 4, blocks_.size() > 8, [&](std::size_t from, std::size_t to) {
    std::vector<entry> entries;
    for (std::size_t k = from; k < to; ++k) fill_block(particles, blocks_[k], entries);
  });
  for (std::size_t k = above_.size(); k-- > 0;) sum_parts(above_[k]);
  bound_fields();
}

template struct node_tree<2>;
template struct node_tree<3>;

}  // namespace tetsuame::gravity
