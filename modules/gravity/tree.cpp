#include "tree.hpp"

#include <algorithm>
#include <cmath>
#include <foundation/threads.hpp>
#include <gravity/near_field.hpp>
#include <gravity/nodes.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

namespace tetsuame::gravity {

namespace {

using foundation::lanes;
using foundation::real;
using indices = std::vector<std::uint32_t>;

}  // namespace

template <int D>
struct tree<D>::workspace {
  using far = far_field<D>;
  using local_set = typename far::set;
  // Nodes that a thread looks at, a list for each depth; and what acts on the node at hand.
  struct scratch {
    std::vector<indices> candidates;
    indices stack, by_multipoles, near;
  };
  // A part of the tree whose particles are done by one thread: what acts on it and not on what is above it as a whole.
  struct task {
    std::uint32_t index;
    indices candidates;
    local_set local;
  };

  tree_options options;
  node_tree<D> t;
  std::vector<std::uint32_t> wanted_before;  // targets among the particles before each, in the order of keys
  std::vector<task> tasks;
  std::size_t first = 0, last = 0;
  const field<D>* to = nullptr;

  bool wanted(const node<D>& n) const { return wanted_before[n.last] > wanted_before[n.first]; }

  // Whether groups are far enough from each other for multipoles: the same seen from either.
  bool apart(const node<D>& a, const node<D>& b) const {
    const auto d = a.centre - b.centre;
    const double radii = a.radius + b.radius;
    const double least = std::max(radii / options.opening, radii + std::max(a.support, b.support));
    return dot(d, d) > least * least;
  }
  // The larger of two is divided first.
  bool divide_first(std::uint32_t a, std::uint32_t b) const {
    const auto &p = t.nodes[a], &q = t.nodes[b];
    if (node_tree<D>::is_leaf(p, a) || node_tree<D>::is_leaf(q, b)) return node_tree<D>::is_leaf(q, b);
    return p.radius > q.radius || (p.radius == q.radius && a < b);
  }

  // Sorts the candidates that act on a node: by multipoles, leaves that are near, and those that its parts look at.
  void sort_candidates(std::uint32_t index, const indices& candidates, scratch& s, indices& below) const {
    const auto& n = t.nodes[index];
    const bool leaf = node_tree<D>::is_leaf(n, index);
    s.by_multipoles.clear();
    s.near.clear();
    below.clear();
    for (const std::uint32_t candidate : candidates) {
      s.stack.assign(1, candidate);
      while (!s.stack.empty()) {
        const std::uint32_t c = s.stack.back();
        s.stack.pop_back();
        const auto& other = t.nodes[c];
        if (c != index && apart(n, other)) {
          s.by_multipoles.push_back(c);
        } else if (c == index ? !leaf : divide_first(index, c) && !leaf) {
          below.push_back(c);
        } else if (node_tree<D>::is_leaf(other, c)) {
          s.near.push_back(c);
        } else {
          s.stack.push_back(static_cast<std::uint32_t>(t.second(c)));
          s.stack.push_back(c + 1);
        }
      }
    }
  }

  void add_multipoles(const node<D>& n, const indices& sources, local_set& local) const {
    std::array<real, far::size> sum;
    sum.fill(0.0);
    for (std::size_t k = 0; k < sources.size(); k += lanes) {
      std::array<const double*, lanes> from;
      std::array<std::array<double, lanes>, D> distance;
      const std::size_t count = std::min(lanes, sources.size() - k);
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::uint32_t source = sources[k + std::min(lane, count - 1)];
        from[lane] = lane < count ? t.multipoles[source].data() : no_multipoles.data();
        for (std::size_t a = 0; a < D; ++a) distance[a][lane] = n.centre[a] - t.nodes[source].centre[a];
      }
      std::array<real, far::size> M;
      for (std::size_t i = 0; i < far::size; ++i) M[i] = real([&](auto lane) { return from[lane][i]; });
      far::multipole_to_local(M, foundation::vec<real, D>::of([&](std::size_t a) {
                                return real(distance[a].data(), foundation::stdx::element_aligned);
                              }),
                              sum);
    }
    for (std::size_t i = 0; i < far::size; ++i) local[i] += foundation::sum(sum[i]);
  }
  static constexpr local_set no_multipoles{};

  void finish_leaf(std::uint32_t index, const local_set& local, const scratch& s) const {
    const auto& n = t.nodes[index];
    source_arrays<D> all{{}, t.mass.data(), t.inverse_support.data()};
    for (std::size_t a = 0; a < D; ++a) all.x[a] = t.x[a].data();
    for (std::size_t k = n.first; k < n.last; k += lanes) {
      target_registers<D, 1> targets(all, k);
      for (const std::uint32_t c : s.near) {
        const auto& other = t.nodes[c];
        if (c == index)
          targets.template add<true, true>(all, other.first, other.last);
        else if (beyond_supports(n, other))
          targets.template add<false>(all, other.first, other.last);
        else
          targets.template add<true>(all, other.first, other.last);
      }
      auto u = targets.x[0];
      for (std::size_t a = 0; a < D; ++a) u[a] -= n.centre[a];
      write(k, std::min<std::size_t>(lanes, n.last - k), targets, far::evaluate(local, u));
    }
  }
  static bool beyond_supports(const node<D>& a, const node<D>& b) {
    const auto d = a.centre - b.centre;
    const double least = (a.radius + b.radius + std::max(a.support, b.support)) * (1.0 + 1e-12);
    return dot(d, d) > least * least;
  }

  // In 3-D expansions are of 1/r, potentials are of -1/r.
  void write(std::size_t k, std::size_t count, const target_registers<D, 1>& targets,
             const harmonic<D, real>& h) const {
    const double factor = strength<D>(options.gravitational_constant), sign = D == 3 ? -1.0 : 1.0;
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::size_t i = t.order[k + lane].index;
      if (i < first || i >= last) continue;
      for (std::size_t a = 0; a < D; ++a)
        to->acceleration[a][i - first] = factor * (targets.pull[0][a][lane] - sign * h.gradient[a][lane]);
      to->potential[i - first] = factor * (targets.potential[0][lane] + sign * h.value[lane]);
    }
  }

  // Everything that acts on a node's particles; `depth` counts from the task.
  void walk(std::uint32_t index, std::size_t depth, const local_set& inherited, scratch& s) const {
    if (!wanted(t.nodes[index])) return;
    if (s.candidates.size() < depth + 2) s.candidates.resize(depth + 2);
    auto local = inherited;
    sort_candidates(index, s.candidates[depth], s, s.candidates[depth + 1]);
    add_multipoles(t.nodes[index], s.by_multipoles, local);
    if (node_tree<D>::is_leaf(t.nodes[index], index)) return finish_leaf(index, local, s);
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
    const auto& n = t.nodes[index];
    if (!wanted(n)) return;
    if (n.last - n.first <= most || node_tree<D>::is_leaf(n, index)) {
      tasks.push_back({index, candidates, inherited});
      return;
    }
    auto local = inherited;
    indices below;
    sort_candidates(index, candidates, s, below);
    add_multipoles(n, s.by_multipoles, local);
    for (const std::size_t part : {std::size_t{index} + 1, t.second(index)})
      prepare(static_cast<std::uint32_t>(part), most, below, moved(index, part, local), s);
  }

  void mark_targets() {
    const std::size_t n = t.order.size();
    wanted_before.resize(n + 1);
    wanted_before[0] = 0;
    for (std::size_t k = 0; k < n; ++k)
      wanted_before[k + 1] = wanted_before[k] + (t.order[k].index >= first && t.order[k].index < last);
  }

  void run() {
    tasks.clear();
    mark_targets();
    scratch top;
    const std::size_t n = t.order.size(), most = std::max<std::size_t>(n / 256, 256);
    prepare(0, most, {0}, local_set{}, top);
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
  if (options.leaf == 0) throw std::invalid_argument("gravity: a leaf needs room for a particle");
  w_->options = options;
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
  w.t.build(particles, w.options.leaf);
  if (first >= last) return;
  w.first = first;
  w.last = last;
  w.to = &to;
  w.run();
}

template class tree<2>;
template class tree<3>;

}  // namespace tetsuame::gravity
