#include "tree.hpp"

#include <algorithm>
#include <cmath>
#include <foundation/threads.hpp>
#include <gravity/near_field.hpp>
#include <gravity/nodes.hpp>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tetsuame::gravity {

namespace {

using foundation::lanes;
using foundation::real;
using indices = std::vector<std::uint32_t>;

constexpr std::size_t registers = leaf_size / lanes > 0 ? leaf_size / lanes : 1;

}  // namespace

template <int D>
struct tree<D>::workspace {
  using far = far_field<D>;
  using local_set = typename far::set;
  static constexpr std::size_t least_order = 2;
  // Square of the inverse of (extent/R)^(order + 1) at most: where nearer masses are stronger by far, the potential of
  // the others counts all the same.
  static constexpr double coarsest = 1e4;
  // What becomes of a pair of nodes. From least_order on: multipoles of that order.
  static constexpr std::size_t same = 0, below = far::order + 1, divided = below + 1, near = divided + 1,
                               beyond_support = near + 1, fates = beyond_support + 1;
  // Nodes that a thread looks at: those for the parts of a node, a list for each depth, and those of each fate.
  struct scratch {
    std::vector<indices> candidates;
    std::array<indices, fates> lists;
    std::array<std::size_t, fates> sizes;
    indices current;

    std::span<const std::uint32_t> list(std::size_t fate) const { return std::span(lists[fate]).first(sizes[fate]); }
  };
  // A part of the tree whose particles are done by one thread: what acts on it and not on what is above it as a whole.
  struct task {
    std::uint32_t index;
    indices candidates;
    local_set local;
  };

  tree_options options;
  double per_opening = 1.0, per_tolerance = 1.0;
  node_tree<D> t;
  std::vector<std::uint32_t> wanted_before;  // targets among the particles before each, in the order of the tree
  std::vector<task> tasks;
  std::size_t first = 0, last = 0;
  const field<D>* to = nullptr;

  bool wanted(std::size_t index) const {
    return wanted_before[t.ranges[index].last] > wanted_before[t.ranges[index].first];
  }

  // The orders of the multipoles by which a node and four others act on each other, the same seen from either; above P
  // if they are too close. The error of the force of a on particles
  // anywhere in b is about m_a/R^(D-1) ((spread of a + radius of b)/R)^order.
  real orders_for(const node<D>& a, const std::array<const node<D>*, lanes>& others) const {
    const auto load = [&](auto member) { return real([&](auto lane) { return member(*others[lane]); }); };
    real d2 = 0.0;
    for (std::size_t k = 0; k < D; ++k) {
      const real d = load([k](const node<D>& b) { return b.centre[k]; }) - a.centre[k];
      d2 += d * d;
    }
    const real radius = load([](const node<D>&b) { return b.radius; }), radii = radius + a.radius;
    const real support = foundation::greater(load([](const node<D>& b) { return b.support; }), real(a.support));
    const real least = foundation::greater(radii * per_opening, radii + support);
    const real extent =
        foundation::greater(load([](const node<D>& b) { return b.spread; }) + a.radius, radius + a.spread);
    const real scale = foundation::greater(load([](const node<D>& b) { return b.per_field; }) * a.mass,
                                           load([](const node<D>& b) { return b.mass; }) * a.per_field) *
                       per_tolerance;
    const real ratio2 = extent * extent / d2, most = D == 3 ? d2 * d2 : d2;
    real error2 = foundation::greater(scale * scale, coarsest * ratio2 * most) * ratio2 * ratio2,
         order = static_cast<double>(least_order);
    detail::unroll<far::order + 1 - least_order>([&](auto) {
      order += foundation::select(error2 < most, real(0.0), real(1.0));
      error2 *= ratio2;
    });
    return foundation::select(least * least < d2, order, real(static_cast<double>(far::order + 1)));
  }
  // Of two that are too close the larger is divided.
  std::size_t fate_of_close(std::uint32_t index, std::uint32_t other) const {
    const auto &a = t.nodes[index], &b = t.nodes[other];
    const bool whole = t.is_leaf(index), other_whole = t.is_leaf(other);
    if (whole && other_whole) return index == other ? same : beyond_supports(a, b) ? beyond_support : near;
    if (whole || (!other_whole && (a.radius < b.radius || (a.radius == b.radius && other < index)))) return divided;
    return below;
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
      for (std::size_t k = 0; k < n; k += lanes) {
        std::array<const node<D>*, lanes> others;
        for (std::size_t lane = 0; lane < lanes; ++lane) others[lane] = &t.nodes[s.current[std::min(k + lane, n - 1)]];
        const real orders = orders_for(t.nodes[index], others);
        for (std::size_t lane = 0; lane < std::min(lanes, n - k); ++lane) {
          const std::uint32_t c = s.current[k + lane];
          auto fate = static_cast<std::size_t>(static_cast<double>(orders[lane]));
          if (fate > far::order || c == index) fate = c == index && !t.is_leaf(c) ? below : fate_of_close(index, c);
          s.lists[fate][s.sizes[fate]++] = c;
        }
      }
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

  void finish_leaf(std::uint32_t index, const local_set& local, const scratch& s) const {
    source_arrays<D> all{{}, t.mass.data(), t.inverse_support.data()};
    for (std::size_t a = 0; a < D; ++a) all.x[a] = t.x[a].data();
    const auto [begin, end, after] = t.ranges[index];
    for (std::size_t k = begin; k < end; k += registers * lanes) {
      std::array<target_register<D>, registers> targets;
      for (std::size_t r = 0; r < registers; ++r) targets[r].start(all, std::min<std::size_t>(k + r * lanes, end - 1));
      const auto span_of = [this](std::uint32_t c) { return std::pair(t.ranges[c].first, t.ranges[c].last); };
      add_sources<true, true>(targets, all, begin, end);
      add_sources<false>(targets, all, s.list(beyond_support), span_of);
      add_sources<true>(targets, all, s.list(near), span_of);
      for (std::size_t r = 0; r < registers && k + r * lanes < end; ++r) {
        const std::size_t at = k + r * lanes;
        foundation::vec<real, D> u;
        for (std::size_t a = 0; a < D; ++a) u[a] = targets[r].x[a] - t.nodes[index].centre[a];
        write(at, std::min<std::size_t>(lanes, end - at), targets[r], far::evaluate(local, u));
      }
    }
  }
  static bool beyond_supports(const node<D>& a, const node<D>& b) {
    const auto d = a.centre - b.centre;
    const double least = (a.radius + b.radius + std::max(a.support, b.support)) * (1.0 + 1e-12);
    return dot(d, d) > least * least;
  }

  // In 3-D expansions are of 1/r, potentials are of -1/r. In 2-D ln r is that of the tree's unit, so that the other
  // particles' mass counts.
  void write(std::size_t k, std::size_t count, const target_register<D>& targets, const harmonic<D, real>& h) const {
    const double sign = D == 3 ? -1.0 : 1.0, strength_here = strength<D>(options.gravitational_constant) * t.unit_mass;
    const double per_length = 1.0 / t.length, force = strength_here * (D == 3 ? per_length * per_length : per_length);
    const double energy = strength_here * (D == 3 ? per_length : 1.0);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::size_t i = t.order[k + lane];
      if (i < first || i >= last) continue;
      for (std::size_t a = 0; a < D; ++a)
        to->acceleration[a][i - first] = force * (targets.pull[a][lane] - sign * h.gradient[a][lane]);
      double potential = targets.potential[lane] + sign * h.value[lane];
      if constexpr (D == 2) potential += std::log(t.length) * (t.nodes[0].mass - t.mass[k + lane]);
      to->potential[i - first] = energy * potential;
    }
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
  w_->per_opening = 1.0 / options.opening;
  w_->per_tolerance = 1.0 / options.tolerance;
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
