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

constexpr double smallest_edge = 1e-200;  // m; the inverse of the distance's square is a number

template <int D>
double distance(const foundation::vec<double, D>& a, const foundation::vec<double, D>& b) {
  const auto d = a - b;
  return std::sqrt(dot(d, d));
}

const real lane_numbers([](auto lane) { return static_cast<double>(lane); });

// A radius that was rounded down may leave a particle outside.
constexpr double rounding = 1.0 + 1e-14;

}  // namespace

template <int D>
auto node_tree<D>::bounds(const cloud<D>& particles, std::size_t first, std::size_t last) const -> box {
  box b;
  for (std::size_t a = 0; a < D; ++a) {
    b.low[a] = b.high[a] = particles.x[a][order[first].index];
    for (std::size_t k = first + 1; k < last; ++k) {
      const double at = particles.x[a][order[k].index];
      b.low[a] = std::min(b.low[a], at);
      b.high[a] = std::max(b.high[a], at);
    }
  }
  return b;
}

template <int D>
bool node_tree<D>::sort_range(const cloud<D>& particles, std::size_t first, std::size_t last) {
  const box b = bounds(particles, first, last);
  cube<D> c{b.low, 0.0};
  for (std::size_t a = 0; a < D; ++a) c.edge = std::max(c.edge, b.high[a] - b.low[a]);
  const bool extended = c.edge > smallest_edge;
  const auto keys = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      const std::size_t i = order[k].index;
      std::array<double, D> at;
      for (std::size_t a = 0; a < D; ++a) at[a] = particles.x[a][i];
      order[k].key = extended ? c.key(at) : 0;
    }
  };
  const std::size_t n = last - first;
  foundation::for_chunks(n, foundation::chunk_of_values(n), n > foundation::values_worth_threads,
                         [&](std::size_t from, std::size_t to) { keys(first + from, first + to); });
  sort_keys(std::span(order).subspan(first, n), particles.id, buffer_);
  return extended;
}

// Where the keys' highest bit that differs changes. Particles of one cell get new keys within it; those at one place
// are halved.
template <int D>
std::size_t node_tree<D>::division(const cloud<D>& particles, std::size_t first, std::size_t last) {
  if (order[first].key == order[last - 1].key && !sort_range(particles, first, last)) return first + (last - first) / 2;
  const auto bit = std::bit_floor(order[first].key ^ order[last - 1].key);
  const auto begin = order.begin();
  return static_cast<std::size_t>(std::partition_point(begin + static_cast<std::ptrdiff_t>(first),
                                                       begin + static_cast<std::ptrdiff_t>(last),
                                                       [bit](const sorted_key& k) { return (k.key & bit) == 0; }) -
                                  begin);
}

template <int D>
void node_tree<D>::divide(const cloud<D>& particles, std::size_t first, std::size_t last, std::size_t leaf) {
  const std::size_t index = nodes.size();
  nodes.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last), 0, 0.0, 0.0, 0.0, {}});
  if (last - first > leaf) {
    const std::size_t middle = division(particles, first, last);
    divide(particles, first, middle, leaf);
    divide(particles, middle, last, leaf);
  }
  nodes[index].end = static_cast<std::uint32_t>(nodes.size());
}

template <int D>
void node_tree<D>::gather(const cloud<D>& particles) {
  const std::size_t n = particles.n;
  for (auto* one : {&mass, &inverse_support}) one->resize(n + lanes, 0.0);
  for (auto& one : x) one.resize(n + lanes, 0.0);
  foundation::for_all(n, [&](std::size_t k) {
    const std::size_t i = order[k].index;
    for (std::size_t a = 0; a < D; ++a) x[a][k] = particles.x[a][i];
    mass[k] = particles.mass[i];
    inverse_support[k] = gravity::inverse_support(particles.support[i]);
  });
}

template <int D>
void node_tree<D>::sum_leaf(std::size_t index) {
  auto& n = nodes[index];
  auto& b = boxes_[index];
  double least_inverse = no_support;
  const auto base = foundation::vec<double, D>::of([&](std::size_t a) { return x[a][n.first]; });
  auto moment = foundation::zero<double, D>();
  n.mass = 0.0;
  for (std::size_t a = 0; a < D; ++a) b.low[a] = b.high[a] = base[a];
  for (std::size_t k = n.first; k < n.last; ++k) {
    n.mass += mass[k];
    least_inverse = std::min(least_inverse, inverse_support[k]);
    for (std::size_t a = 0; a < D; ++a) {
      moment[a] += mass[k] * (x[a][k] - base[a]);
      b.low[a] = std::min(b.low[a], x[a][k]);
      b.high[a] = std::max(b.high[a], x[a][k]);
    }
  }
  n.support = least_inverse < no_support ? 1.0 / least_inverse : 0.0;
  for (std::size_t a = 0; a < D; ++a)
    n.centre[a] = n.mass > 0.0 ? base[a] + moment[a] / n.mass : 0.5 * b.low[a] + 0.5 * b.high[a];
  std::array<real, far_field<D>::full> sums;
  sums.fill(0.0);
  real largest = 0.0;
  for (std::size_t k = n.first; k < n.last; k += lanes) {
    const auto within = lane_numbers < real(static_cast<double>(n.last - k));
    const auto load = [&](const std::vector<double>& from) {
      return real(&from[k], foundation::stdx::element_aligned);
    };
    const auto s = foundation::vec<real, D>::of(
        [&](std::size_t a) { return foundation::select(within, load(x[a]) - n.centre[a], real(0.0)); });
    far_field<D>::add_mass(sums, s, foundation::select(within, load(mass), real(0.0)));
    largest = foundation::greater(largest, dot(s, s));
  }
  std::array<double, far_field<D>::full> all;
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = foundation::sum(sums[i]);
  multipoles[index].fill(0.0);
  far_field<D>::fold(all, multipoles[index]);
  double r2 = 0.0;
  for (std::size_t lane = 0; lane < lanes; ++lane) r2 = std::max(r2, static_cast<double>(largest[lane]));
  n.radius = std::sqrt(r2) * rounding;
}

template <int D>
void node_tree<D>::sum_parts(std::size_t index) {
  const std::size_t parts[] = {index + 1, second(index)};
  auto &n = nodes[index], &p = nodes[parts[0]], &q = nodes[parts[1]];
  const double part = (p.mass + q.mass) > 0.0 ? q.mass / (p.mass + q.mass) : 0.5;
  n.mass = p.mass + q.mass;
  n.support = std::max(p.support, q.support);
  n.centre = p.centre + part * (q.centre - p.centre);
  auto& b = boxes_[index];
  double corner2 = 0.0;
  for (std::size_t a = 0; a < D; ++a) {
    b.low[a] = std::min(boxes_[parts[0]].low[a], boxes_[parts[1]].low[a]);
    b.high[a] = std::max(boxes_[parts[0]].high[a], boxes_[parts[1]].high[a]);
    const double far = std::max(n.centre[a] - b.low[a], b.high[a] - n.centre[a]);
    corner2 += far * far;
  }
  n.radius = std::sqrt(corner2) * rounding;
  multipoles[index].fill(0.0);
  double reach = 0.0;
  for (const std::size_t one : parts) {
    reach = std::max(reach, (distance(n.centre, nodes[one].centre) + nodes[one].radius) * rounding);
    far_field<D>::multipole_to_multipole(multipoles[one], nodes[one].centre - n.centre, multipoles[index]);
  }
  n.radius = std::min(n.radius, reach);
}

// Parts of some hundreds of particles by themselves, on threads, then what is above them.
template <int D>
void node_tree<D>::sum_all() {
  boxes_.resize(nodes.size());
  multipoles.resize(nodes.size());
  std::vector<std::uint32_t> parts, above;
  for_each_part(
      512, [&](std::size_t k) { parts.push_back(static_cast<std::uint32_t>(k)); },
      [&](std::size_t k) { above.push_back(static_cast<std::uint32_t>(k)); });
  foundation::for_chunks(parts.size(), 4, parts.size() > 8, [&](std::size_t from, std::size_t to) {
    for (std::size_t p = from; p < to; ++p)
      for (std::size_t k = nodes[parts[p]].end; k-- > parts[p];) is_leaf(nodes[k], k) ? sum_leaf(k) : sum_parts(k);
  });
  for (std::size_t k = above.size(); k-- > 0;) sum_parts(above[k]);
}

template <int D>
void node_tree<D>::build(const cloud<D>& particles, std::size_t leaf) {
  nodes.clear();
  order.resize(particles.n);
  if (particles.n == 0) return;
  foundation::for_all(particles.n, [&](std::size_t i) { order[i] = {0, static_cast<std::uint32_t>(i)}; });
  sort_range(particles, 0, particles.n);
  divide(particles, 0, particles.n, leaf);
  gather(particles);
  sum_all();
}

template struct node_tree<2>;
template struct node_tree<3>;

}  // namespace tetsuame::gravity
