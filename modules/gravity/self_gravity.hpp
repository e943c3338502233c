// Self-gravity as a pass: the acceleration and the potential of all particles of the run, of all ranks, by the tree
// (tree.hpp). Every rank gathers the whole cloud, 48 bytes a particle, and builds the same tree.
#pragma once

#include <algorithm>
#include <domain/communicator.hpp>
#include <gravity/direct.hpp>
#include <gravity/tree.hpp>
#include <numeric>
#include <optional>
#include <passes/evaluation.hpp>
#include <vector>

namespace tetsuame::gravity {

template <int D>
class self {
 public:
  explicit self(const tree_options& options) : options_(options), tree_(options) {}
  self(const self&) = delete;  // the pass refers to it
  self& operator=(const self&) = delete;

  // Declares the fields, once a run. support: m, of each particle, from where its field is Newton's. keeps: the
  // acceleration found last stays with the particles.
  void declare(run::state<D>& box, particles::array& support, bool keeps) {
    box_ = &box;
    support_ = &support;
    auto& w = box.w;
    w.accelerations = particles::declare_vector<D>(w.s, "GravitationalAcceleration", "m/s^2", particles::role::derived);
    potential_ = &particles::declare(w.s, "GravitationalPotential", "J/kg", particles::role::derived);
    w.gravity_varies = true;
    if (!keeps) return;
    kept_.emplace(particles::declare_vector<D>(w.s, "EarlierRate_gravity", "m/s^2", particles::role::memory));
  }
  void declare_pass(passes::evaluation<D>& e) {
    auto& w = box_->w;
    e.whole("gravity", {.reads = {w.s.x, w.s.m, *support_}, .writes = {w.accelerations, *potential_}},
            [this] { find(); });
  }

  // Where it is kept: that of each owned particle, m/s²; null where it is not.
  double* kept(std::size_t axis) const { return kept_ ? (*kept_)[axis].data() : nullptr; }
  // Collective. Where nothing has moved since the last time, the field is what it was.
  void update() {
    std::swap(cloud_, before_);
    gather();
    const std::size_t n = box_->w.s.fluid;
    if (found_[0].size() != n || !(cloud_ == before_)) {
      for (auto& values : found_) values.resize(n);
      field<D> to{{}, found_[D].data()};
      for (std::size_t a = 0; a < D; ++a) to.acceleration[a] = found_[a].data();
      tree_(cloud_.view(), cloud_.first, cloud_.first + n, to);
    }
    if (kept_)
      for (std::size_t a = 0; a < D; ++a) std::ranges::copy(found_[a], (*kept_)[a].begin());
  }
  // By how much the following evaluations take the acceleration; 0: it is not found.
  void weigh(double weight) { weight_ = weight; }
  const particles::array& potential() const { return *potential_; }

  // Collective. |a - a_direct|/|a_direct| of the last evaluation: the median, and what 99 % are below. Of every n-th
  // particle by ID, 500 or so.
  struct errors {
    double median, most;
  };
  errors against_direct_sum() {
    const auto& s = box_->w.s;
    const auto& ranks = box_->w.d.ranks;
    gather();
    const gathered all_by_id = in_order_of_ids();
    const auto every = static_cast<std::int64_t>(std::max<std::size_t>(1, cloud_.id.size() / 500));
    std::vector<double> found;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      if (s.id[i] % every != 0) continue;
      std::array<double, D> a;
      double phi, difference = 0.0, size = 0.0;
      field<D> to{{}, &phi};
      for (std::size_t k = 0; k < D; ++k) to.acceleration[k] = &a[k];
      const auto place = static_cast<std::size_t>(
          std::ranges::lower_bound(all_by_id.id, static_cast<std::uint64_t>(s.id[i])) - all_by_id.id.begin());
      direct<D>(all_by_id.view(), options_.gravitational_constant, place, place + 1, to);
      for (std::size_t k = 0; k < D; ++k) {
        difference += std::pow(box_->w.accelerations[k][i] - a[k], 2);
        size += a[k] * a[k];
      }
      if (size > 0.0) found.push_back(std::sqrt(difference / size));
    }
    const auto counts = ranks.every(static_cast<double>(found.size()));
    std::vector<double> all;
    collect(found, counts, all);
    if (all.empty()) return {0.0, 0.0};
    std::ranges::sort(all);
    return {all[all.size() / 2], all[std::min(all.size() - 1, all.size() * 99 / 100)]};
  }

 private:
  // Of all ranks, one behind the other; this rank's begin at `first`.
  struct gathered {
    std::array<std::vector<double>, D> x;
    std::vector<double> mass, support;
    std::vector<std::uint64_t> id;
    std::size_t first = 0;
    bool operator==(const gathered&) const = default;
    cloud<D> view() const {
      cloud<D> all{{}, mass.data(), support.data(), id.data(), id.size()};
      for (std::size_t a = 0; a < D; ++a) all.x[a] = x[a].data();
      return all;
    }
  };

  template <class T>
  void collect(std::span<const T> mine, const std::vector<double>& counts, std::vector<T>& all) const {
    const auto& ranks = box_->w.d.ranks;
    std::vector<int> number, begin;
    int total = 0;
    for (const double n : counts) {
      number.push_back(static_cast<int>(n));
      begin.push_back(total);
      total += number.back();
    }
    all.resize(static_cast<std::size_t>(total));
    const auto type = std::is_same_v<T, double> ? MPI_DOUBLE : MPI_UINT64_T;
    MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), type, all.data(), number.data(), begin.data(), type,
                   ranks.comm);
  }
  void collect(const std::vector<double>& mine, const std::vector<double>& counts, std::vector<double>& all) const {
    collect(std::span<const double>(mine), counts, all);
  }

  void gather() {
    const auto& s = box_->w.s;
    const auto& ranks = box_->w.d.ranks;
    const auto counts = ranks.every(static_cast<double>(s.fluid));
    const auto of = [&](const particles::array& a) { return std::span<const double>(a.data(), s.fluid); };
    for (std::size_t a = 0; a < D; ++a) collect(of(s.x[a]), counts, cloud_.x[a]);
    collect(of(s.m), counts, cloud_.mass);
    collect(of(*support_), counts, cloud_.support);
    const std::vector<std::uint64_t> id(s.id.begin(), s.id.begin() + static_cast<std::ptrdiff_t>(s.fluid));
    collect(std::span<const std::uint64_t>(id), counts, cloud_.id);
    cloud_.first = static_cast<std::size_t>(
        std::accumulate(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(ranks.rank), 0.0));
  }
  // Direct sums are then the same on any number of ranks.
  gathered in_order_of_ids() const {
    std::vector<std::size_t> order(cloud_.id.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t k) { return cloud_.id[k]; });
    gathered sorted;
    const auto take = [&](const auto& from, auto& to) {
      for (const std::size_t k : order) to.push_back(from[k]);
    };
    for (std::size_t a = 0; a < D; ++a) take(cloud_.x[a], sorted.x[a]);
    take(cloud_.mass, sorted.mass);
    take(cloud_.support, sorted.support);
    take(cloud_.id, sorted.id);
    return sorted;
  }
  void find() {
    auto& w = box_->w;
    if (weight_ == 0.0) {
      for (std::size_t a = 0; a < D; ++a) std::ranges::fill(w.accelerations[a], 0.0);
      return;
    }
    update();
    for (std::size_t a = 0; a < D; ++a)
      std::ranges::transform(found_[a], w.accelerations[a].begin(), [this](double g) { return weight_ * g; });
    std::ranges::copy(found_[D], potential_->begin());
  }

  const tree_options options_;
  double weight_ = 1.0;
  tree<D> tree_;
  gathered cloud_, before_;
  std::array<std::vector<double>, D + 1> found_;  // acceleration and potential of this rank's particles
  run::state<D>* box_ = nullptr;
  particles::array* support_ = nullptr;
  particles::array* potential_ = nullptr;
  std::optional<particles::vector_field<D>> kept_;
};

}  // namespace tetsuame::gravity
