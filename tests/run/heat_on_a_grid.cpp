// A program without particles on the time loop: dT/dt = κ d²T/dx² on the cells of a rod, which ranks share in equal
// parts, with T = 0 at both ends and one arch of a sine at the start. It decays as exp(-κ π² t/L²).
#include <mpi.h>

#include <cmath>
#include <domain/communicator.hpp>
#include <foundation/exact_sum.hpp>
#include <namelist/schema.hpp>
#include <numbers>
#include <output/groups.hpp>
#include <run/simulation.hpp>

using namespace tetsuame;

namespace {

struct options {
  std::int64_t cells = 40;
  double length = 1.0, kappa = 1e-2;  // m, m2/s
  run::common_options common;
};

class rod : public run::simulation {
 public:
  rod(const domain::communicator& of, const options& o) : simulation(of, stages_, 1), o_(o), dx_(o.length / cells()) {
    const auto begin = [&](std::int64_t rank) { return o.cells / of.size * rank + std::min(rank, o.cells % of.size); };
    const std::int64_t first = begin(of.rank), last = begin(of.rank + 1);
    for (std::int64_t n = first; n < last; ++n) ids_.push_back(n);
    T_.assign(ids_.size() + 2, 0.0);  // with a ghost cell at each end
    for (std::size_t k = 0; k < ids_.size(); ++k) T_[k + 1] = std::sin(std::numbers::pi * place(k) / o.length);
  }

  // Rows of a checkpoint lie on ranks as cells do.
  bool begin(const output::checkpoint* saved, run::run_directory&) override {
    if (saved != nullptr) {
      const auto& T = saved->tables.at("rod").reals.at("Temperature");
      std::copy(T.begin(), T.end(), T_.begin() + 1);
    }
    return false;
  }
  run::state_arrays arrays() override { return {{{"T", T_.data() + 1, 0.0, 1.0}}, ids_.size()}; }

  bool evaluate(const run::evaluation& what, std::span<double* const> rate) override {
    if (what.of == run::purpose::check) return true;
    fill_ghost_cells();
    for (std::size_t k = 0; k < ids_.size(); ++k)
      rate[0][k] = o_.kappa * (T_[k] - 2.0 * T_[k + 1] + T_[k + 2]) / (dx_ * dx_);
    return true;
  }
  run::step_limits limits(bool) override {
    return {{*o_.common.time.diffusive * dx_ * dx_ / o_.kappa, "diffusion"}, 4.0 * o_.kappa / (dx_ * dx_)};
  }

  std::vector<output::history_column> columns() const override { return {{"temperature_mean", "K"}}; }
  run::history_line row(double) override { return {{mean()}}; }
  run::snapshot_contents snapshot() override {
    x_.resize(ids_.size());
    for (std::size_t k = 0; k < ids_.size(); ++k) x_[k] = place(k);
    output::particle_group g{0, ids_.size(), ids_.data(), {}, 1};
    g.columns.push_back({"Coordinates", "m", "centres of cells", {x_.data()}, true});
    g.columns.push_back({"Temperature", "K", "of a cell", {T_.data() + 1}});
    run::snapshot_contents all;
    all.header.dimension = 1;
    all.header.box_lengths = {o_.length, 0.0, 0.0};
    all.groups = {g};
    return all;
  }
  void report(const run::ending& end, run::summary& r) override {
    const double decay = o_.kappa * std::pow(std::numbers::pi / o_.length, 2);
    r.metrics["temperature_error"] = mean() / (2.0 / std::numbers::pi * std::exp(-decay * end.time)) - 1.0;
    output::particle_group g{0, ids_.size(), ids_.data(), {{"Temperature", "", "", {T_.data() + 1}}}, 1};
    if (end.failed == nullptr) r.state_hash = output::state_hash(ranks.comm, {g});
  }
  std::vector<output::table_view> save(output::checkpoint_globals&, std::vector<std::int64_t>&) override {
    return {{"rod", ids_.size(), ids_.data(), {{"Temperature", T_.data() + 1}}, {}}};
  }

 private:
  double cells() const { return static_cast<double>(o_.cells); }
  double place(std::size_t k) const { return (static_cast<double>(ids_[k]) + 0.5) * dx_; }  // m
  double mean() const {
    foundation::exact_sum sum;
    for (std::size_t k = 0; k < ids_.size(); ++k) sum.add(T_[k + 1]);
    return ranks.exact(sum) / cells();
  }
  // T = 0 half a cell beyond the last one.
  void fill_ghost_cells() {
    const std::size_t n = ids_.size();
    const int below = ranks.rank > 0 ? ranks.rank - 1 : MPI_PROC_NULL,
              above = ranks.rank + 1 < ranks.size ? ranks.rank + 1 : MPI_PROC_NULL;
    T_[0] = -T_[1];
    T_[n + 1] = -T_[n];
    MPI_Sendrecv(&T_[n], 1, MPI_DOUBLE, above, 0, &T_[0], 1, MPI_DOUBLE, below, 0, ranks.comm, MPI_STATUS_IGNORE);
    MPI_Sendrecv(&T_[1], 1, MPI_DOUBLE, below, 1, &T_[n + 1], 1, MPI_DOUBLE, above, 1, ranks.comm, MPI_STATUS_IGNORE);
  }

  foundation::stage_times stages_;
  const options& o_;
  double dx_;  // m
  std::vector<std::int64_t> ids_;
  std::vector<double> T_, x_;  // K, m
};

}  // namespace

int main(int argc, char** argv) {
  options o;
  o.common.time.method = "euler";
  const run::program_input own{.program = "heat_on_a_grid",
                               .restarts = true,
                               .declare =
                                   [&](namelist::schema& schema) {
                                     schema.group("rod", "a rod that cools at its ends");
                                     schema.add("rod", "cells", o.cells, {.minimum = 2.0, .meaning = "along the rod"});
                                     schema.add("rod", "length", o.length, namelist::positive("m", "of the rod"));
                                     schema.add("rod", "diffusivity", o.kappa, namelist::positive("m^2/s", "thermal"));
                                     run::declare(schema, o.common, {.particles = false});
                                   },
                               .complete =
                                   [&](const namelist::schema& schema) {
                                     run::resolve(schema, o.common);
                                     run::check_output(schema, o.common, {});
                                   }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    const auto ranks = domain::communicator::world();
    rod cooling(ranks, o);
    run::carry_out(cooling, o.common, line, resolved);
  });
}
