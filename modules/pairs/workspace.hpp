// What every sum over neighbours works on: the particles, their decomposition, lists
// and kernel, the materials, and the place where faults are collected until all
// ranks can agree on one.
#pragma once

#include <cells/neighbour_list.hpp>
#include <domain/decomposition.hpp>
#include <eos/eos.hpp>
#include <foundation/stages.hpp>
#include <initializer_list>
#include <kernels/kernel.hpp>
#include <pairs/pairs.hpp>
#include <particles/storage.hpp>
#include <string>
#include <vector>

namespace tetsuame::pairs {

// The fault of the lowest particle ID seen since the last agreement.
struct fault {
  std::int64_t id = std::numeric_limits<std::int64_t>::max();
  std::string message;

  void report(std::int64_t particle, std::string text) {
    if (particle >= id) return;
    id = particle;
    message = std::move(text);
  }
};

template <int D>
struct workspace {
  particles::particles<D> s;
  domain::decomposition<D> d;
  std::vector<eos::any> materials;
  kernels::any<D> kernel = kernels::make<D>("quintic", 1.0);
  double dx = 0.0;             // m, spacing of the start lattice
  double lattice_sum = 1.0;    // of the kernel over the start lattice, times dx^D
  cells::neighbour_list list;  // rows: owned fluid; all its neighbours, itself excluded
  std::array<double, D> g{};   // m/s2
  fault first_fault;
  mutable foundation::stage_times times;

  double support() const {
    return std::visit([](const auto& k) { return k.support(); }, kernel);
  }
  std::array<const double*, D> x() const { return pointers<D>(s.x); }
  every fluid() const { return {s.fluid}; }

  void exchange_fluid(std::initializer_list<double*> fields) const {
    domain::exchange<D>(d.ranks, d.fluid_halo, std::span<double* const>(fields.begin(), fields.size()));
  }
  void exchange_walls(std::initializer_list<double*> fields) const {
    domain::exchange<D>(d.ranks, d.wall_halo, std::span<double* const>(fields.begin(), fields.size()));
  }
  void agree() {
    d.ranks.agree_on_fault(first_fault.id, first_fault.message, foundation::exit_status::calculation_failed);
  }

  // The terms' sums over the neighbours of all owned fluid particles, with the kernel the run chose.
  template <class Rows, class... Terms>
  void sum(const Rows& rows, const Terms&... terms) const {
    std::visit([&](const auto& k) { sum_over<D>(rows, list, x(), k, terms...); }, kernel);
  }
};

}  // namespace tetsuame::pairs
