// What every sum over neighbours works on: the particles, their decomposition, lists
// and kernel, the materials, and the place where faults are collected until all
// ranks can agree on one.
#pragma once

#include <fmt/format.h>

#include <cells/neighbour_list.hpp>
#include <domain/decomposition.hpp>
#include <eos/eos.hpp>
#include <foundation/stages.hpp>
#include <initializer_list>
#include <kernels/kernel.hpp>
#include <optional>
#include <pairs/pairs.hpp>
#include <particles/named_fields.hpp>
#include <particles/storage.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tetsuame::pairs {

// The fault seen first since the last agreement: of the earliest stage of an evaluation, there of the lowest
// particle ID. What a later stage sees may follow from it.
struct fault {
  static constexpr int bits_of_id = 48;
  std::int64_t stage = 0;
  std::int64_t key = std::numeric_limits<std::int64_t>::max();  // stage, then ID
  std::string message;

  void report(std::int64_t particle, std::string text) {
    const std::int64_t now = (stage << bits_of_id) + particle;
    if (now >= key) return;
    key = now;
    message = std::move(text);
  }
};

// For messages.
template <int D>
std::string describe_position(const particles::particles<D>& s, std::size_t i) {
  std::string text = fmt::format("particle {} at (", s.id[i]);
  for (std::size_t a = 0; a < D; ++a) text += fmt::format("{}{:.6g}", a > 0 ? ", " : "", s.x[a][i]);
  return text + ") m";
}

// Whether a term is compiled for a kernel: for all, or for those of its type `kernels`.
template <class Term, class Kernel>
constexpr bool is_compiled_for() {
  if constexpr (requires { typename Term::kernels; })
    return kernels::has<typename Term::kernels, Kernel>;
  else
    return true;
}

template <int D>
struct workspace {
  particles::particles<D> s;
  domain::decomposition<D> d;
  std::vector<eos::any> materials;
  kernels::any<D> kernel = kernels::make<D>("quintic", 1.0);
  double dx = 0.0;             // m, spacing of the start lattice
  double lattice_sum = 1.0;    // of the kernel over the start lattice, times dx^D
  cells::neighbour_list list;  // of clusters of the owned fluid
  std::array<double, D> g{};   // m/s2, uniform gravity
  // Gravity that differs by particle, which a pass writes (gravity/gravity.hpp), or with forces of the input
  // (sources/fields.hpp): m/s2. Heat that these supply, W/kg; null: none.
  particles::vector_field<D> accelerations{};
  bool gravity_varies = false;
  particles::array* heating = nullptr;
  std::array<double, D> frame{};  // m/s, the velocity of all together at the start, where nothing stands still
  std::optional<double> uniform_transport;  // Pa s: the viscosity, where all share it and none conducts
  fault first_fault;
  mutable foundation::stage_times times;

  double support() const {
    return std::visit([](const auto& k) { return k.support(); }, kernel);
  }
  std::array<const double*, D> x() const { return pointers<D>(s.x); }
  // m/s2, of particle i along axis a.
  double gravity(std::size_t a, std::size_t i) const { return gravity_varies ? accelerations[a][i] : g[a]; }
  // m2/s2, of gravity that varies, beside g: what the acceleration of j adds to p/ρ from there on to i.
  double forced(std::size_t j, std::size_t i) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < D; ++a) sum += (accelerations[a][j] - g[a]) * (s.x[a][i] - s.x[a][j]);
    return sum;
  }

  // The owned fluid stands in layers: clusters before `border` have neighbours among the owned fluid alone, and
  // those from `border` on have none before `core`. Both are 0 where no other rank sends ghosts to wait for.
  std::size_t core = 0, border = 0;
  row_range fluid() const { return {0, s.fluid, 0, s.total()}; }
  row_range interior() const { return {0, border, 0, s.fluid}; }
  row_range at_border() const { return {border, s.fluid, core, s.total()}; }

  void end_fluid() const { domain::end_exchange(d.ranks, d.fluid_halo); }
  void exchange_fluid(std::initializer_list<double*> fields) const {
    domain::exchange<D>(d.ranks, d.fluid_halo, std::span<double* const>(fields.begin(), fields.size()));
  }
  void exchange_walls(std::initializer_list<double*> fields) const {
    domain::exchange<D>(d.ranks, d.wall_halo, std::span<double* const>(fields.begin(), fields.size()));
  }
  // A vector field and others, in one message a neighbour.
  template <class Components>
  void exchange_walls(Components& vectors, std::initializer_list<double*> fields) const {
    std::vector<double*> all(fields);
    for (std::size_t a = 0; a < D; ++a) all.push_back(vectors[a].data());
    domain::exchange<D>(d.ranks, d.wall_halo, std::span<double* const>(all));
  }
  // Collective: throws the fault of all ranks, which is then forgotten.
  void agree() {
    const fault found = std::exchange(first_fault, fault{});
    first_fault.stage = found.stage;
    d.ranks.agree_on_fault(found.key, found.message, foundation::exit_status::calculation_failed);
  }

  // What pairs are computed in, before lists are made.
  void compute_pairs_in(bool single_precision) {
    list.interleave = single_precision ? neighbours<single>::interleave : 1;
  }
  bool single_pairs() const { return list.interleave != 1; }

  // The terms' sums over the neighbours of these rows, with the kernel and the precision the run chose.
  template <class Rows, class... Terms>
  void sum(const Rows& rows, const Terms&... terms) const {
    sum_by(list, rows, terms...);
  }
  // Over those neighbours that a list of its own names.
  template <class Rows, class... Terms>
  void sum_by(const cells::neighbour_list& some, const Rows& rows, const Terms&... terms) const {
    std::visit([&](const auto& k) { sum_with(k, some, rows, terms...); }, kernel);
  }
  // Of terms some of which need W and some F.
  template <class Rows, class... Terms>
  void sum_in_common(const Rows& rows, const Terms&... terms) const {
    std::visit([&](const auto& k) { sum_with(kernels::in_common(k), list, rows, terms...); }, kernel);
  }

 private:
  template <class Kernel, class Rows, class... Terms>
  void sum_with(const Kernel& k, const cells::neighbour_list& some, const Rows& rows, const Terms&... terms) const {
    if constexpr (!(is_compiled_for<Terms, Kernel>() && ...)) {
      throw std::logic_error("a sum is not compiled for the kernel");
    } else {
      if constexpr ((takes<Terms, single> && ...))
        if (single_pairs()) {
          const unit<single> lengths(k.support());
          return sum_in<D>(lengths, rows, some, {x(), frame}, Kernel(k.support() * lengths.to(-1)), terms...);
        }
      sum_over<D>(rows, some, {x(), frame}, k, terms...);
    }
  }
};

}  // namespace tetsuame::pairs
