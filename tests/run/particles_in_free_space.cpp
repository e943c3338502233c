// A program of particles without physics and without a box: half of a ball of particles flies apart, at a speed that
// goes with the distance from the middle, the other half hardly moves, and one starts far away. Each sums a kernel over
// its neighbours and integrates the sum, which at the end is held against sums over all particles.
#include <mpi.h>

#include <cmath>
#include <domain/options.hpp>
#include <foundation/exact_sum.hpp>
#include <namelist/schema.hpp>
#include <run/amounts.hpp>
#include <run/particle_simulation.hpp>
#include <run/start.hpp>

using namespace tetsuame;

namespace {

constexpr int D = 3;

const domain::demands demands{.least_dimension = 3, .jitters = true, .may_be_open = true};

struct options {
  domain::options domain;
  run::common_options common;
  double radii = 1e4, rate = 1.0;  // of one particle's start; 1/s
  double drift = 0.0;              // m/s, of all along x
  bool compare = true;             // with sums over all particles
};

struct world : run::state<D> {
  particles::array& sum = particles::declare(w.s, "Sum", "1", particles::role::integrated);
};

// In [-1, 1), of a particle's ID and a salt.
double noise(std::int64_t id, std::uint64_t salt) {
  const auto z = (static_cast<std::uint64_t>(id) + 1) * 0x9e3779b97f4a7c15U + salt * 0xd1342543de82ef95U;
  return static_cast<double>(output::mix(z) >> 11) * 0x1p-52 - 1.0;
}

double kernel_of(double r2, double support) {
  const double q = 1.0 - r2 / (support * support);
  return q > 0.0 ? q * q * q : 0.0;
}

// Of all ranks, one rank's behind the other's.
std::vector<double> of_all(const domain::communicator& ranks, const std::vector<double>& mine) {
  const int n = static_cast<int>(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(ranks.size)), starts(counts.size(), 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, ranks.comm);
  for (std::size_t r = 1; r < counts.size(); ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<double> all(static_cast<std::size_t>(starts.back() + counts.back()));
  MPI_Allgatherv(mine.data(), n, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, ranks.comm);
  return all;
}

run::memory_need need_of(const options& o) {
  const double ball = o.domain.lattice_particles() * std::acos(-1.0) / 6.0;
  return run::need_of(ball, run::allocated{particles::bytes_each(world().w.s), D + 1.0}, o.common.kernel, D);
}

class cloud : public run::particle_simulation<D> {
 public:
  cloud(world& of, const options& o) : particle_simulation(of, o.common), world_(of), o_(o) {
    about.push_back("particles in free space");
  }

  std::vector<integrators::field> fields() override {
    auto& s = box.w.s;
    const double L = o_.domain.length[0];
    return {{"x", s.x[0].data(), 0.0, L},
            {"y", s.x[1].data(), 0.0, L},
            {"z", s.x[2].data(), 0.0, L},
            {"Sum", world_.sum.data(), 0.0, 1.0}};
  }
  integrators::step_limit largest_step() override { return {0.1 / o_.rate, "expansion"}; }

  std::vector<output::history_column> measured_columns() const override {
    return {{"particles", "1"}, {"farthest", "m"}, {"sum", "1"}};
  }
  std::vector<double> measure(double) override {
    const auto& s = box.w.s;
    foundation::exact_sum sum;
    double farthest = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      sum.add(world_.sum[i]);
      for (std::size_t a = 0; a < D; ++a) farthest = std::max(farthest, std::abs(s.x[a][i]));
    }
    return {static_cast<double>(ranks.sum(static_cast<std::int64_t>(s.fluid))), ranks.maximum(farthest),
            ranks.exact(sum)};
  }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& made) override {
    const auto& s = box.w.s;
    auto g = output::group_of(s, 0, 0, s.fluid);
    for (const char* name : {"Masses", "Density", "Pressure", "Temperature", "SmoothingLength", "Material"})
      output::add_quantity(g, name, {output::make_array(made, s.fluid, [](auto) { return 0.0; })});
    return {g};
  }

  void report_results(double, run::summary& r) override {
    const auto& s = box.w.s;
    double outside = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      bool inside = true;
      for (std::size_t a = 0; a < D; ++a) inside = inside && s.x[a][i] >= 0.0 && s.x[a][i] < o_.domain.length[a];
      outside += inside ? 0.0 : 1.0;
    }
    if (o_.compare) r.errors = {{"sum", largest_error()}};
    r.metrics["particles"] = ranks.sum(static_cast<std::int64_t>(s.fluid));
    r.metrics["outside_of_the_box"] = ranks.sum(static_cast<std::int64_t>(outside));
    r.metrics["lists_made"] = lists_made_;
    r.metrics["most_on_a_rank"] = ranks.maximum(static_cast<double>(s.fluid));
    r.metrics["resident_bytes"] = run::resident_bytes(ranks);
    r.metrics["needed_bytes"] = need_of(o_).total();
  }

 protected:
  void sum_rates(std::span<double* const> rate) override {
    auto& w = box.w;
    domain::exchange<D>(w.d.ranks, w.d.fluid_halo, {}, &w.s.x);
    for (std::size_t a = 0; a < D; ++a) std::copy_n(w.s.v[a].begin(), w.s.fluid, rate[a]);
    foundation::for_all(w.s.fluid, [&](std::size_t i) { rate[D][i] = sum_of(i); });
  }
  void make_lists(bool as_they_were) override {
    run::rebuild(box, as_they_were);
    ++lists_made_;
  }

 private:
  // Of the sums over neighbours, beside those over all particles of all ranks.
  double largest_error() const {
    const auto& s = box.w.s;
    std::vector<double> mine;
    for (std::size_t i = 0; i < s.fluid; ++i)
      for (std::size_t a = 0; a < D; ++a) mine.push_back(s.x[a][i]);
    const auto all = of_all(ranks, mine);
    const double support = box.w.support();
    double worst = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const auto x = cells::position<D>(s.x, i);
      double sum = 0.0;
      for (std::size_t k = 0; k < all.size(); k += D) {
        double r2 = 0.0;
        for (std::size_t a = 0; a < D; ++a) r2 += (x[a] - all[k + a]) * (x[a] - all[k + a]);
        sum += r2 == 0.0 ? 0.0 : kernel_of(r2, support);
      }
      worst = std::max(worst, std::abs(sum - sum_of(i)));
    }
    return ranks.maximum(worst);
  }
  // In the order of the list.
  double sum_of(std::size_t i) const {
    const auto& w = box.w;
    const double support = w.support();
    double sum = 0.0;
    w.list.for_each(i / pairs::lanes, [&](std::uint32_t j, std::uint32_t of_lanes, auto...) {
      if ((of_lanes >> i % pairs::lanes & 1U) == 0) return;
      double r2 = 0.0;
      for (const auto& x : w.s.x) r2 += (x[i] - x[j]) * (x[i] - x[j]);
      sum += kernel_of(r2, support);
    });
    return sum;
  }

  world& world_;
  const options& o_;
  std::int64_t lists_made_ = 0;
};

// A ball in the box, whose middle one particle leaves.
void set_up(world& box, const domain::communicator& ranks, const options& o) {
  box.treatment = walls::none{};
  run::set_up_empty<D>(box, ranks, o.domain, {}, o.common.kernel, 0.0);
  run::lattice_block<D> lattice;
  std::array<double, D> middle;
  for (std::size_t a = 0; a < D; ++a) {
    lattice.number[a] = o.domain.particles[a];
    lattice.spacing[a] = box.w.dx;
    middle[a] = 0.5 * o.domain.length[a];
  }
  const double radius = middle[0];
  const auto from_middle = [&](const std::array<double, D>& x) {
    return std::hypot(x[0] - middle[0], x[1] - middle[1], x[2] - middle[2]);
  };
  run::place_lattices<D>(box, {lattice}, o.domain.jitter, [&](const auto& x) { return from_middle(x) < radius; });
  auto& s = box.w.s;
  box.fluid_total = ranks.sum(static_cast<std::int64_t>(s.fluid));
  const std::int64_t leaves = lattice.particles() / 2;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const bool flies = noise(s.id[i], 0) > 0.0;
    for (std::size_t a = 0; a < D; ++a) {
      s.v[a][i] =
          o.rate * (flies ? s.x[a][i] - middle[a] : 0.05 * box.w.dx * noise(s.id[i], 1 + a)) + (a == 0 ? o.drift : 0.0);
      if (s.id[i] == leaves) s.x[a][i] = middle[a] + (a == 1 ? -0.5 : 1.0) * o.radii * radius;
    }
    s.m[i] = 1.0;
  }
}

}  // namespace

int main(int argc, char** argv) {
  options o;
  o.domain.dimension = D;
  o.domain.length = {27.0, 27.0, 27.0};
  o.domain.particles = {27, 27, 27};
  o.domain.open = {true, true, true};
  o.common.time.method = "order_2";
  const auto complete = [&](const namelist::schema& schema) {
    run::resolve(schema, o.common);
    domain::resolve(schema, demands, o.domain);
    const double dx = o.domain.dx(), support = run::support_over_dx(o.common.kernel) * dx;
    domain::check_widths(schema, o.domain, support + o.common.kernel.skin * dx, support);
    run::check_output(schema, o.common, o.domain, {});
  };
  const run::program_input own{
      .program = "particles_in_free_space",
      .restarts = true,
      .declare =
          [&](namelist::schema& schema) {
            domain::declare(schema, demands, o.domain);
            schema.group("cloud", "a ball of particles, half of which fly apart");
            schema.add("cloud", "radii", o.radii, {.meaning = "at which one particle starts"});
            schema.add("cloud", "drift", o.drift, {.unit = "m/s", .meaning = "of all along x"});
            schema.add("cloud", "compare", o.compare, {.meaning = "sums with those over all particles, at the end"});
            schema.add("cloud", "rate", o.rate, namelist::positive("1/s", "of expansion"));
            run::declare(schema, o.common, {});
          },
      .complete = complete,
      .need = [&] { return need_of(o); }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    const auto ranks = domain::communicator::world();
    world box;
    set_up(box, ranks, o);
    cloud flies(box, o);
    run::carry_out(flies, o.common, line, resolved);
  });
}
