#include "tree.hpp"

#include <algorithm>
#include <cmath>
#include <foundation/threads.hpp>
#include <gravity/near_field.hpp>
#include <gravity/nodes.hpp>
#include <gravity/opening.hpp>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tetsuame::gravity {

namespace {

using foundation::lanes;
using foundation::real;
using indices = std::vector<std::uint32_t>;

// What is beyond a leaf's last particle is copied as well, and not used.
template <class To>
[[gnu::always_inline]] inline void copy_leaf(const double* __restrict from, double origin, To* __restrict to,
                                             double limit = 1e300) {
#pragma GCC unroll 16
  for (std::size_t k = 0; k < leaf_size; k += lanes) {
    const real values = foundation::lesser(real(from + k, foundation::stdx::element_aligned) - origin, real(limit));
    foundation::stdx::static_simd_cast<foundation::stdx::rebind_simd_t<To, real>>(values).copy_to(
        to + k, foundation::stdx::element_aligned);
  }
}

}  // namespace

template <int D>
struct tree<D>::workspace {
  using far = far_field<D>;
  using local_set = typename far::set;
  // What becomes of a pair of nodes. From least_order on: multipoles of that order.
  static constexpr std::size_t same = 0, below = far::order + 1, divided = below + 1, near = divided + 1,
                               beyond_support = near + 1, fates = beyond_support + 1;
  // Nodes that a thread looks at: those for the parts of a node, a list for each depth, and those of each fate.
  struct scratch {
    std::vector<indices> candidates;
    std::array<indices, fates> lists;
    std::array<std::size_t, fates> sizes;
    indices current;
    source_list<D, real> sources;
    source_list<D, foundation::single> single_sources;
    std::vector<double> orders;

    std::span<const std::uint32_t> list(std::size_t fate) const { return std::span(lists[fate]).first(sizes[fate]); }
  };
  // A part of the tree whose particles are done by one thread: what acts on it and not on what is above it as a whole.
  struct task {
    std::uint32_t index;
    indices candidates;
    local_set local;
  };

  tree_options options;
  opening<D> open;
  double unit_acceleration = 1.0, unit_potential = 1.0;  // m/s², J/kg, of the tree's units
  node_tree<D> t;
  std::vector<std::uint32_t> wanted_before;  // targets among the particles before each, in the order of the tree
  std::vector<task> tasks;
  std::size_t first = 0, last = 0;
  const field<D>* to = nullptr;

  bool wanted(std::size_t index) const {
    return wanted_before[t.ranges[index].last] > wanted_before[t.ranges[index].first];
  }

  // Of two that are too close the larger is divided.
  std::size_t fate_of_close(std::uint32_t index, std::uint32_t other, bool soft) const {
    const double radius = t.nodes[index].radius, other_radius = t.nodes[other].radius;
    const bool other_whole = t.is_leaf(other);
    if (t.is_leaf(index)) return !other_whole ? divided : index == other ? same : soft ? near : beyond_support;
    return other_whole || radius > other_radius || (radius == other_radius && index <= other) ? below : divided;
  }

  // Sorts the candidates that act on a node by their fate; those that its parts look at are in `parts`.
  void sort_candidates(std::uint32_t index, std::span<const std::uint32_t> candidates, scratch& s,
                       indices& parts) const {
    s.sizes.fill(0);
    s.current.assign(candidates.begin(), candidates.end());
    while (!s.current.empty()) {
      const std::size_t n = s.current.size();
      for (std::size_t fate = 0; fate < fates; ++fate)
        if (s.lists[fate].size() < s.sizes[fate] + n + lanes) s.lists[fate].resize(2 * (s.sizes[fate] + n + lanes));
      s.sizes[divided] = 0;
      s.orders.resize(n + lanes);
      for (std::size_t k = 0; k < n; k += lanes) {
        std::array<const node<D>*, lanes> others;
        for (std::size_t lane = 0; lane < lanes; ++lane) others[lane] = &t.nodes[s.current[std::min(k + lane, n - 1)]];
        open.orders(t.nodes[index], others).copy_to(&s.orders[k], foundation::stdx::element_aligned);
      }
      std::array<std::uint32_t*, fates> ends;
      for (std::size_t fate = 0; fate < fates; ++fate) ends[fate] = s.lists[fate].data() + s.sizes[fate];
      // By themselves: the processor does not wait for the orders where it foresees a fate wrongly.
      for (std::size_t k = 0; k < n; ++k) {
        const std::uint32_t c = s.current[k];
        const auto order = static_cast<std::size_t>(s.orders[k]);
        const std::size_t fate = order <= far::order ? order : fate_of_close(index, c, order == far::order + 2);
        *ends[fate]++ = c;
      }
      for (std::size_t fate = 0; fate < fates; ++fate)
        s.sizes[fate] = static_cast<std::size_t>(ends[fate] - s.lists[fate].data());
      s.current.clear();
      for (const std::uint32_t c : s.list(divided)) {
        s.current.push_back(c + 1);
        s.current.push_back(static_cast<std::uint32_t>(t.second(c)));
      }
    }
    const auto kept = s.list(below);
    parts.assign(kept.begin(), kept.end());
  }

  void add_multipoles(const node<D>& n, const scratch& s, local_set& local) const {
    std::array<real, far::size> sum;
    sum.fill(0.0);
    detail::unroll<far::order + 1 - least_order>(
        [&](auto k) { add_order<k + least_order>(n, s.list(k + least_order), sum); });
    for (std::size_t i = 0; i < far::size; ++i) local[i] += foundation::sum(sum[i]);
  }
  // A register of sources at a time; the last one is filled up with multipoles of 0.
  template <std::size_t order>
  [[gnu::noinline]] void add_order(const node<D>& n, std::span<const std::uint32_t> sources,
                                   std::array<real, far::size>& sum) const {
    constexpr std::size_t size = expansion<D, order>::size;
    for (std::size_t k = 0; k < sources.size(); k += lanes) {
      std::array<const double*, lanes> from;
      std::array<const node<D>*, lanes> at;
      const std::size_t count = std::min(lanes, sources.size() - k);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::uint32_t source = sources[k + std::min(lane, count - 1)];
        from[lane] = lane < count ? t.multipoles[source].data() : no_multipoles.data();
        at[lane] = &t.nodes[source];
      }
      std::array<real, far::size> M;
      foundation::vec<real, D> d;
      for (std::size_t i = 0; i < size; ++i) M[i] = real([&](auto lane) { return from[lane][i]; });
      for (std::size_t a = 0; a < D; ++a)
        d[a] = real(n.centre[a]) - real([&](auto lane) { return at[lane]->centre[a]; });
      far::template multipole_to_local<order>(M, d, sum);
    }
  }
  static constexpr local_set no_multipoles{};

  // Leaf by leaf: the node's own particles, those that may be within supports, the others.
  template <class R>
  near_sums<D, leaf_size> sum_near(std::uint32_t index, scratch& s, source_list<D, R>& sources) const {
    sources.reserve((1 + s.sizes[near] + s.sizes[beyond_support]) * leaf_size);
    sources.size = 0;
    const auto append = [&](std::uint32_t c) {
      const std::size_t from = t.ranges[c].first, at = sources.size;
      for (std::size_t a = 0; a < D; ++a) copy_leaf(&t.x[a][from], t.nodes[index].centre[a], &sources.x[a][at]);
      copy_leaf(&t.mass[from], 0.0, &sources.mass[at]);
      copy_leaf(&t.inverse_support[from], 0.0, &sources.inverse_support[at], no_support<R>);
      sources.size += t.particles(c);
    };
    append(index);
    for (const std::uint32_t c : s.list(near)) append(c);
    const std::size_t soft_end = sources.size;
    for (const std::uint32_t c : s.list(beyond_support)) append(c);
    return sum_pairs<D, R, leaf_size>(sources, t.particles(index), soft_end);
  }
  void finish_leaf(std::uint32_t index, const local_set& local, scratch& s) const {
    near_sums<D, leaf_size> sums;
    if constexpr (D == 3) {
      sums =
          options.tolerance < double_pairs_below ? sum_near(index, s, s.sources) : sum_near(index, s, s.single_sources);
    } else {
      sums = sum_near(index, s, s.sources);
    }
    const auto [begin, end, after] = t.ranges[index];
    for (std::size_t k = begin; k < end; k += lanes) {
      foundation::vec<real, D> u;
      for (std::size_t a = 0; a < D; ++a)
        u[a] = real(&t.x[a][k], foundation::stdx::element_aligned) - t.nodes[index].centre[a];
      const auto far_part = far::evaluate(local, u);
      for (std::size_t lane = 0; lane < std::min<std::size_t>(lanes, end - k); ++lane)
        write(k + lane, k + lane - begin, sums, far_part, lane);
    }
  }

  // In 3-D expansions are of 1/r, potentials are of -1/r. In 2-D ln r is that of the tree's unit, so that the other
  // particles' mass counts.
  void write(std::size_t k, std::size_t at, const near_sums<D, leaf_size>& sums, const harmonic<D, real>& h,
             std::size_t lane) const {
    const std::size_t i = t.order[k];
    if (i < first || i >= last) return;
    const double sign = D == 3 ? -1.0 : 1.0;
    for (std::size_t a = 0; a < D; ++a)
      to->acceleration[a][i - first] = unit_acceleration * (sums.pull[a][at] - sign * h.gradient[a][lane]);
    double potential = sums.potential[at] + sign * h.value[lane];
    if constexpr (D == 2) potential += std::log(t.length) * (t.nodes[0].mass - t.mass[k]);
    to->potential[i - first] = unit_potential * potential;
  }

  // Everything that acts on a node's particles; `depth` counts from the task.
  void walk(std::uint32_t index, std::size_t depth, const local_set& inherited, scratch& s) const {
    if (!wanted(index)) return;
    if (s.candidates.size() < depth + 2) s.candidates.resize(depth + 2);
    auto local = inherited;
    sort_candidates(index, s.candidates[depth], s, s.candidates[depth + 1]);
    add_multipoles(t.nodes[index], s, local);
    if (t.is_leaf(index)) return finish_leaf(index, local, s);
    for (const std::size_t part : {std::size_t{index} + 1, t.second(index)})
      walk(static_cast<std::uint32_t>(part), depth + 1, moved(index, part, local), s);
  }
  local_set moved(std::size_t from, std::size_t part, const local_set& local) const {
    local_set result{};
    far::local_to_local(local, t.nodes[part].centre - t.nodes[from].centre, result);
    return result;
  }

  // The same for the top of the tree, whose parts become tasks.
  void prepare(std::uint32_t index, std::size_t most, const indices& candidates, const local_set& inherited,
               scratch& s) {
    if (!wanted(index)) return;
    if (t.particles(index) <= most || t.is_leaf(index)) {
      tasks.push_back({index, candidates, inherited});
      return;
    }
    auto local = inherited;
    indices parts;
    sort_candidates(index, candidates, s, parts);
    add_multipoles(t.nodes[index], s, local);
    for (const std::size_t part : {std::size_t{index} + 1, t.second(index)})
      prepare(static_cast<std::uint32_t>(part), most, parts, moved(index, part, local), s);
  }

  void mark_targets() {
    const std::size_t n = t.order.size();
    wanted_before.resize(n + 1);
    wanted_before[0] = 0;
    for (std::size_t k = 0; k < n; ++k)
      wanted_before[k + 1] = wanted_before[k] + (t.order[k] >= first && t.order[k] < last);
  }

  void run() {
    tasks.clear();
    mark_targets();
    const double strength_of_unit = strength<D>(options.gravitational_constant) * t.unit_mass;
    unit_potential = D == 3 ? strength_of_unit / t.length : strength_of_unit;
    unit_acceleration = unit_potential / t.length;
    scratch top;
    const std::size_t n = t.order.size(), most = std::max<std::size_t>(n / 256, 256);
    prepare(0, most, indices{0}, local_set{}, top);
    foundation::for_chunks(tasks.size(), 1, tasks.size() > 4, [&](std::size_t from, std::size_t end) {
      scratch s;
      s.candidates.resize(1);
      for (std::size_t k = from; k < end; ++k) {
        s.candidates[0] = std::move(tasks[k].candidates);
        walk(tasks[k].index, 0, tasks[k].local, s);
      }
    });
  }
};

template <int D>
tree<D>::tree(const tree_options& options) : w_(std::make_unique<workspace>()) {
  if (!(options.opening > 0.0 && options.opening < 1.0))
    throw std::invalid_argument("gravity: the opening angle must be above 0 and below 1");
  if (!(options.tolerance > 0.0)) throw std::invalid_argument("gravity: the tolerance must be above 0");
  w_->options = options;
  w_->open = {1.0 / options.opening, 1.0 / options.tolerance};
}
template <int D>
tree<D>::tree(tree&&) noexcept = default;
template <int D>
tree<D>& tree<D>::operator=(tree&&) noexcept = default;
template <int D>
tree<D>::~tree() = default;

template <int D>
void tree<D>::operator()(const cloud<D>& particles, std::size_t first, std::size_t last, const field<D>& to) {
  check(particles);
  auto& w = *w_;
  w.t.build(particles);
  if (first >= last) return;
  w.first = first;
  w.last = last;
  w.to = &to;
  w.run();
}

template class tree<2>;
template class tree<3>;

}  // namespace tetsuame::gravity
