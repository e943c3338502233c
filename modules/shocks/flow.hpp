// Gas with contacts and shocks, by one of the schemes of module schemes. One evaluation:
//   1. y, f, ∇·v, ∇×v over neighbours; ρ, and P, c of ρ and u (here of an ideal gas)
//        SSPH, GSPH   P = (γ - 1) ρ u, ρ = y         DISPH, GDISPH   P = (γ - 1) q, q = y; ρ = m q/U
//   2. second order: gradients of p, ρ, v; REMIX: of u, ρ, v, and the kernels' corrections
//   3. forces and power, artificial viscosity or Riemann problems
// Integrated: x, v, u, and α where it depends on time. Supports stay during a step; from one to the next they take a
// step of Newton's method (schemes/common.hpp). What a scheme conserves it does whatever h and f are, so they need not
// be converged.
#pragma once

#include <fmt/format.h>

#include <eos/caloric.hpp>
#include <march/problem.hpp>
#include <output/columns.hpp>
#include <schemes/disph.hpp>
#include <schemes/gdisph.hpp>
#include <schemes/gradients.hpp>
#include <schemes/gsph.hpp>
#include <schemes/remix.hpp>
#include <schemes/ssph.hpp>
#include <shocks/scene.hpp>
#include <simulation/state.hpp>
#include <variant>

namespace tetsuame::shocks {

template <int D>
using kernel_choice = std::variant<kernels::quintic_spline<D>, kernels::wendland_c4<D>>;

template <int D>
class flow : public march::problem {
 public:
  explicit flow(const options& o) : o_(o), setup_(make_setup(o)) {
    using particles::role;
    if (o.any_eos())
      for (const bool left : {true, false}) {
        const auto& q = o.shock;
        const eos::caloric& m = materials_.emplace_back(eos_of(left ? q.eos_l : q.eos_r));
        const double rho = left ? q.rho_l : q.rho_r;
        stiffening_.push_back(m.stiffening(rho, m.internal_energy(rho, left ? *q.temperature_l : *q.temperature_r)));
      }
    auto& s = w_.s;
    s.extras.push_back({"Support", "m", "support of the kernel at the start of the step", role::memory, {}});
    s.extras.push_back({"ListSupport", "m", "support when the neighbour lists were made", role::memory, {}});
    s.extras.push_back({"Alpha", "1", "of the artificial viscosity", role::integrated, {}});
    s.extras.push_back({"StartVolume", "m^D", "mass over density at the start", role::memory, {}});
    s.extras.push_back({"StartSum", "1", "sum of StartVolume W at the start", role::memory, {}});
    s.extras.push_back({"EvolvedDensity", "kg/m^D", "density by continuity", role::integrated, {}});
    const auto& line = kernels::find(o.march.kernel.name);
    support_over_dx_ = line.support_over_h * o.march.kernel.h_over_dx;
    support_over_h_ = line.support_over_h;
    target_ = std::pow(support_over_dx_, D);
    choose_kernel(o.march.kernel.name);
    domain::box<D> region;
    for (std::size_t a = 0; a < D; ++a) {
      region.length[a] = o.box.length[a];
      region.periodic[a] = o.box.periodic[a];
    }
    w_.dx = o.dx();
    skin_ = o.march.kernel.skin * w_.dx;
    w_.d = domain::decompose<D>(domain::communicator::world(), region, support_over_dx_ * w_.dx + skin_,
                                static_cast<int>(o.box.ranks_x));
    images_.sides = reflecting_walls<D>(region);
    place_particles();
  }

  const domain::communicator& ranks() const override { return w_.d.ranks; }
  std::size_t local_particles() const override { return w_.s.fluid; }
  std::size_t simd_lanes() const override { return pairs::lanes; }
  output::snapshot_header header() const override {
    output::snapshot_header header;
    header.dimension = D;
    for (std::size_t a = 0; a < D; ++a) {
      header.box_lengths[a] = w_.d.region.length[a];
      header.periodic[a] = w_.d.region.periodic[a];
    }
    return header;
  }

  std::vector<integrators::field> fields() override {
    auto& s = w_.s;
    constexpr std::array<const char*, 3> axis{"x", "y", "z"};
    std::vector<integrators::field> all;
    for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 0.0, w_.dx});
    for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, speed_scale_});
    all.push_back({"u", s.u.data(), 0.0, speed_scale_ * speed_scale_});
    if (has_alpha()) all.push_back({"alpha", alpha().data(), 0.0, 1.0});
    if (o_.evolves_density()) all.push_back({"density", evolved().data(), 0.0, density_scale_});
    return all;
  }

  // ---- right-hand side --------------------------------------------------------------------

  bool evaluable() override {
    const auto& s = w_.s;
    double least = std::numeric_limits<double>::infinity();
    if (o_.any_eos()) return true;
    for (std::size_t i = 0; i < s.fluid; ++i) least = std::min(least, s.u[i]);
    return ranks().minimum(least) > 0.0;
  }

  void evaluate(std::span<double* const> rate) override {
    std::visit([&](const auto& unit) { evaluate_with(unit); }, unit_);
    combine(rate);
    w_.agree();
  }

  integrators::step_limit largest_step() override {
    const auto& s = w_.s;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double spacing = S_[i] / support_over_dx_, signal = std::max(signal_[i], 2.0 * sound_speed(i));
      least = std::min(least, 2.0 * spacing / signal);
    }
    return {*o_.march.time.cfl * ranks().minimum(least), "sound"};
  }
  double diffusion_radius() override { return 0.0; }

  void keep_memory() override {
    next_supports();
    std::copy_n(support().begin(), w_.s.fluid, S_.begin());
  }

  bool complete_step() override {
    const std::int64_t crossings = ranks().sum(images::reflect(images_, w_.s));
    crossings_ += crossings;
    return crossings > 0;
  }

  // A part of the skin is for supports to grow, the rest for particles to move.
  double moved() override {
    const auto& s = w_.s;
    double growth = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) growth = std::max(growth, support()[i] - list_support()[i]);
    const bool no_room = ranks().maximum(growth) >= room_to_grow() * (1.0 - 1e-9);
    return no_room ? std::max(displacement(), allowance()) : displacement();
  }
  double allowance() const override { return 0.5 * (skin_ - room_to_grow()); }
  double speed() override {
    const auto& s = w_.s;
    double v2 = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double sum = 0.0;
      for (std::size_t a = 0; a < D; ++a) sum += s.v[a][i] * s.v[a][i];
      v2 = std::max(v2, sum);
    }
    return std::sqrt(ranks().maximum(v2));
  }

  void rebuild(bool as_they_were) override {
    make_lists(as_they_were);
    if (settled_ || as_they_were) {
      settled_ = true;
      return;
    }
    // The start lattice's supports are those of an endless lattice: next to a jump they are not yet the right ones.
    settled_ = true;
    for (int round = 0; round < 4; ++round) {
      for (int k = 0; k < 5; ++k) std::visit([&](const auto& unit) { find_supports(unit); }, unit_);
      make_lists(false);
    }
    if (!o_.weighs_volume()) return;
    // With the sums of the start a particle's density is at first what the input says, at contacts too.
    std::visit([&](const auto& unit) { find_densities(unit); }, unit_);
    std::copy_n(y_.begin(), w_.s.fluid, start_sum().begin());
  }

  // ---- measures ---------------------------------------------------------------------------

  std::vector<output::history_column> columns() const override {
    std::vector<output::history_column> all{
        {"kinetic_energy", "J"}, {"internal_energy", "J"}, {"momentum_x", "kg m/s"}, {"density_max", "kg/m^3"}};
    for (const trace& t : setup_.traces) all.push_back({t.name, t.unit});
    return all;
  }
  std::vector<double> row(double time) override {
    const totals now = sum_up();
    if (!first_) first_ = now;
    double densest = 0.0;
    for (std::size_t i = 0; i < w_.s.fluid; ++i) densest = std::max(densest, told_density()[i]);
    std::vector<double> all{now.kinetic, now.internal, now.momentum[0], ranks().maximum(densest)};
    std::vector<double> sample{time};
    for (const trace& t : setup_.traces) sample.push_back(t.value(particles_seen()));
    all.insert(all.end(), sample.begin() + 1, sample.end());
    samples_.push_back(std::move(sample));
    return all;
  }

  bool set_time(double t) override {
    time_ = t;
    return false;
  }

  std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) override {
    const auto& s = w_.s;
    auto g = output::fluid_in_motion(s);
    extra.assign(setup_.exact ? 3 + D : 1, particles::array(s.fluid));
    for (std::size_t i = 0; i < s.fluid; ++i) extra[0][i] = S_[i] / support_over_h_;
    const auto scalar = [&](const char* name, const char* unit, const char* about, const particles::array& a) {
      g.columns.push_back({name, unit, about, {a.data()}, false});
    };
    scalar("Masses", "kg", "mass", s.m);
    scalar("Density", "kg/m^3", "mass density", told_density());
    scalar("Pressure", "Pa", "pressure", s.p);
    scalar("InternalEnergy", "J/kg", "specific internal energy", s.u);
    if (o_.any_eos()) scalar("Temperature", "K", "temperature", s.T);
    scalar("SmoothingLength", "m", "smoothing length h", extra[0]);
    if (has_alpha()) scalar("ArtificialViscosity", "1", "alpha", alpha());
    if (setup_.exact) {
      for (std::size_t i = 0; i < s.fluid; ++i) {
        const state right = setup_.exact(place(i), time_);
        extra[1][i] = right.rho;
        extra[2][i] = right.p;
        for (std::size_t a = 0; a < D; ++a) extra[3 + a][i] = right.v[a];
      }
      scalar("DensityReference", "kg/m^3", "exact mass density at this place", extra[1]);
      scalar("PressureReference", "Pa", "exact pressure at this place", extra[2]);
      g.columns.push_back(output::vector_column("VelocitiesReference", "m/s", "exact velocity at this place",
                                                std::span(extra).subspan(3)));
    }
    return {g};
  }

  void report(double t, simulation::summary& r) override {
    const totals now = sum_up();
    double momentum = 0.0;
    for (std::size_t a = 0; a < D; ++a)
      if (a != 1 || o_.shock.gravity == 0.0)
        momentum = std::max(momentum, std::abs(now.momentum[a] - first_->momentum[a]) / now.momentum_scale);
    r.conservation = {{"mass", now.mass / first_->mass - 1.0},
                      {"momentum", momentum},
                      {"energy", now.energy() / first_->energy() - 1.0}};
    r.metrics["test"] = o_.shock.test;
    r.metrics["scheme"] = o_.shock.scheme;
    for (const auto& [name, value] : setup_.known) r.metrics[name] = value;
    if (setup_.measures)
      for (const auto& [name, value] : setup_.measures(particles_seen(), samples_)) r.metrics[name] = value;
    r.metrics["wall_crossings"] = crossings_;
    if (setup_.exact) r.errors = errors(t);
    r.stages = w_.times.seconds();
  }

  std::string hash() override {
    const auto& s = w_.s;
    output::particle_group g{0, s.fluid, s.id.data(), {}};
    const auto add = [&](const char* name, const particles::array& a) {
      g.columns.push_back({name, "", "", {a.data()}, false});
    };
    for (const auto& component : s.x) add("x", component);
    for (const auto& component : s.v) add("v", component);
    add("u", s.u);
    add("m", s.m);
    add("rho", s.rho);
    add("p", s.p);
    if (o_.any_eos()) add("T", s.T);
    return output::state_hash(ranks().comm, {g});
  }

  output::table_view particles_table(std::vector<std::int64_t>& materials) override {
    return simulation::checkpoint_table(w_.s, materials);
  }
  void read_particles(const output::table& t) override { simulation::fluid_from_checkpoint(t, w_.s); }
  void save(output::checkpoint_globals& g) const override {
    g.integers["crossings"] = crossings_;
    if (!first_) return;
    std::vector<double> all{first_->mass, first_->kinetic, first_->internal, first_->potential, first_->momentum_scale};
    all.insert(all.end(), first_->momentum.begin(), first_->momentum.end());
    g.blobs["first_totals"] = all;
    std::vector<double>& flat = g.blobs["samples"];
    for (const auto& line : samples_) flat.insert(flat.end(), line.begin(), line.end());
  }
  void restore(const output::checkpoint_globals& g) override {
    crossings_ = g.integers.at("crossings");
    const auto& all = g.blobs.at("first_totals");
    first_.emplace(totals{all[0], all[1], all[2], all[3], all[4], {}});
    std::copy_n(all.begin() + 5, D, first_->momentum.begin());
    const auto& flat = g.blobs.at("samples");
    const auto width = static_cast<std::ptrdiff_t>(1 + setup_.traces.size());
    for (auto line = flat.begin(); line != flat.end(); line += width) samples_.emplace_back(line, line + width);
  }

 private:
  static constexpr std::size_t G = static_cast<std::size_t>(D) * (D + 2);      // gradients
  static constexpr std::size_t R = 2 + static_cast<std::size_t>(D) * (D + 2);  // m_0, A, B and gradients of A, B

  particles::array& support() { return w_.s.extras[0].values; }
  particles::array& list_support() { return w_.s.extras[1].values; }
  particles::array& alpha() { return w_.s.extras[2].values; }
  particles::array& start_volume() { return w_.s.extras[3].values; }
  particles::array& start_sum() { return w_.s.extras[4].values; }
  particles::array& evolved() { return w_.s.extras[5].values; }
  const particles::array& told_density() const { return o_.shock.density == "mass" ? mass_density_ : w_.s.rho; }
  bool has_alpha() const { return !o_.godunov() && !o_.evolves_density() && o_.shock.switch_of_alpha; }
  double room_to_grow() const { return 0.25 * skin_; }
  // c² = γ (p + p_inf)/ρ = γ (γ - 1)(u - p_inf/ρ)
  double sound_speed(std::size_t i) const {
    if (o_.any_eos()) return caloric_of(i).at(w_.s.rho[i], w_.s.u[i]).c;
    const double thermal = stiffness_[i] > 0.0 ? w_.s.u[i] - stiffness_[i] / w_.s.rho[i] : w_.s.u[i];
    return std::sqrt(gamma_[i] * (gamma_[i] - 1.0) * std::max(thermal, 0.0));
  }

  void choose_kernel(const std::string& name) {
    bool found = false;
    [&]<std::size_t... k>(std::index_sequence<k...>) {
      ((std::variant_alternative_t<k, kernel_choice<D>>::name == name ? (unit_.template emplace<k>(1.0), found = true)
                                                                      : false),
       ...);
    }
    (std::make_index_sequence<std::variant_size_v<kernel_choice<D>>>{});
    if (!found) foundation::fail_input("&kernel name: this program has 'quintic' and 'wendland_c4'");
  }

  // ---- start and lists --------------------------------------------------------------------

  void place_particles() {
    auto& s = w_.s;
    struct start {
      std::int64_t id;
      point x;
      double volume;
    };
    std::vector<start> mine;
    std::int64_t id = 0;
    double fastest = 0.0, densest = 0.0;
    for_each_start<D>(setup_, [&](const point& x, double volume) {
      const state now = setup_.start(x);
      double v2 = std::pow(start_of(now).c, 2);
      for (const double v : now.v) v2 += v * v;
      fastest = std::max(fastest, v2);
      densest = std::max(densest, now.rho);
      std::array<double, D> place;
      std::copy_n(x.begin(), D, place.begin());
      if (w_.d.within(w_.d.cell(), place)) mine.push_back({id, x, volume});
      ++id;
    });
    fluid_total_ = id;
    speed_scale_ = std::sqrt(fastest);
    density_scale_ = densest;
    particles::allocate(s, mine.size(), 0, 0, 0);
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const auto& p = mine[i];
      const state now = setup_.start(p.x);
      s.id[i] = p.id;
      s.material[i] = now.material;
      s.m[i] = now.rho * p.volume;
      s.u[i] = start_of(now).u;
      s.rho[i] = evolved()[i] = now.rho;
      start_volume()[i] = p.volume;
      start_sum()[i] = 1.0;
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] = p.x[a];
        s.v[a][i] = now.v[a];
      }
      support()[i] = support_over_dx_ * std::pow(p.volume, 1.0 / D);
      alpha()[i] = o_.shock.switch_of_alpha ? o_.shock.alpha_min : o_.shock.alpha;
    }
  }

  // As images::rebuild, with supports of the particles' own.
  void make_lists(bool as_they_were) {
    auto& s = w_.s;
    const foundation::stage timed(w_.times, "lists");
    const auto exchange_positions = [&] {
      for (std::size_t a = 0; a < D; ++a)
        std::swap_ranges(s.x[a].begin(), s.x[a].begin() + static_cast<std::ptrdiff_t>(s.fluid), s.x_list[a].begin());
    };
    particles::allocate(s, s.fluid, 0, 0, 0);
    if (as_they_were)
      exchange_positions();
    else
      domain::wrap(w_.d.region, s);
    domain::migrate(w_.d, s);
    if (!as_they_were) std::copy_n(support().begin(), s.fluid, list_support().begin());
    double most = 0.0;
    foundation::exact_sum all;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      most = std::max(most, list_support()[i]);
      all.add(list_support()[i]);
    }
    most = ranks().maximum(most);
    const double mean = ranks().exact(all) / static_cast<double>(fluid_total_);
    const double edge = cells::cell_edge(mean + skin_);
    const auto cells_of_fluid = cells::make_grid<D>(s.x, s.id, s.fluid, edge);
    std::vector<std::size_t> order(cells_of_fluid.members.begin(), cells_of_fluid.members.end());
    particles::reorder(s, 0, std::span<const std::size_t>(order));
    if (!as_they_were)
      for (std::size_t a = 0; a < D; ++a) std::copy_n(s.x[a].begin(), s.fluid, s.x_list[a].begin());
    w_.d.width = (most + skin_) * (1.0 + 1e-6);
    for (std::size_t a = 0; a < D; ++a)
      if (w_.d.region.periodic[a] && w_.d.width > w_.d.region.length[a])
        foundation::fail_calculation("a particle's kernel has grown wider than the periodic box");
    domain::make_halo<D>(w_.d, s, 0, s.fluid, s.fluid, w_.d.fluid_halo,
                         [&](std::size_t ghosts) { particles::allocate(s, s.fluid, ghosts, 0, 0); });
    images::make(images_, s, fluid_total_, most + skin_);
    for (auto* a : {&gamma_, &stiffness_}) a->assign(s.total() + 1, 0.0);
    for (std::size_t i = 0; i < s.fluid; ++i) std::tie(gamma_[i], stiffness_[i]) = gas_of(s.material[i]);
    gamma_[s.null()] = o_.shock.gamma;
    kind_.assign(s.total() + 1, 0.0);
    const bool two = o_.any_eos() || gas_of(0) != gas_of(1);
    for (std::size_t i = 0; i < s.fluid; ++i) kind_[i] = two ? s.material[i] : 0;
    const std::array<double*, 6> fixed{s.m.data(),    list_support().data(), start_volume().data(),
                                       gamma_.data(), stiffness_.data(),     kind_.data()};
    domain::exchange<D>(w_.d.ranks, w_.d.fluid_halo, std::span<double* const>(fixed));
    foundation::for_all(images_.source.size(), [&](std::size_t r) {
      for (double* a : fixed) a[s.first_wall() + r] = a[images_.source[r]];
    });
    images::make_list<D>(w_, list_support(), skin_, edge);
    if (as_they_were) exchange_positions();
    for (auto* a : {&S_, &per_S_, &weight_, &slope_, &correction_, &dissipation_}) a->assign(s.total() + 1, 0.0);
    for (auto* a : {&y_, &f_, &z_, &divergence_, &curl_, &number_, &number_volume_, &count_, &count_slope_, &power_,
                    &signal_, &mass_density_})
      a->resize(s.fluid);
    for (auto& a : force_) a.resize(s.fluid);
    if (o_.evolves_density()) {
      for (auto& a : reproducing_) a.assign(s.total() + 1, 0.0);
      density_rate_.resize(s.fluid);
    }
    if (o_.second_order() || o_.evolves_density())
      for (auto& a : gradient_) a.assign(s.total() + 1, 0.0);
    std::copy_n(support().begin(), s.fluid, S_.begin());
    std::fill(signal_.begin(), signal_.end(), 0.0);
    refresh_state();
  }

  point place(std::size_t i) const {
    point x{};
    for (std::size_t a = 0; a < D; ++a) x[a] = w_.s.x[a][i];
    return x;
  }

  double displacement() const {
    const auto& s = w_.s;
    double largest = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double r2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) r2 += (s.x[a][i] - s.x_list[a][i]) * (s.x[a][i] - s.x_list[a][i]);
      largest = r2 > largest || r2 != r2 ? r2 : largest;
    }
    return std::sqrt(ranks().maximum(largest));
  }

  // ---- one evaluation ---------------------------------------------------------------------

  // f(image, its source, which velocities and slopes along an axis change sign)
  template <class F>
  void for_each_image(F&& f) {
    const auto& s = w_.s;
    foundation::for_all(images_.source.size(), [&](std::size_t r) {
      std::array<double, D> sign;
      sign.fill(1.0);
      images::for_each_mirror(images_, r, [&](const images::side<D>& wall) { sign[wall.axis] = -sign[wall.axis]; });
      f(s.first_wall() + r, images_.source[r], sign);
    });
  }

  template <class... Terms>
  void sum(const Terms&... terms) {
    const double nearest = 1e-9 * support_over_dx_ * w_.dx;
    pairs::sum_over<D>(w_.fluid(), w_.list, w_.x(), schemes::distances_only{nearest}, terms...);
  }

  // x, v, u of ghosts and images, and everyone's weight.
  void refresh_state() {
    auto& s = w_.s;
    const foundation::stage timed(w_.times, "halo");
    std::array<double*, D + 1> state;
    for (std::size_t a = 0; a < D; ++a) state[a] = s.v[a].data();
    state[D] = s.u.data();
    domain::exchange<D>(w_.d.ranks, w_.d.fluid_halo, std::span<double* const>(state), &s.x);
    images::move(images_, s);
    for_each_image([&](std::size_t i, std::size_t j, const std::array<double, D>& sign) {
      for (std::size_t a = 0; a < D; ++a) s.v[a][i] = sign[a] * s.v[a][j];
      s.u[i] = s.u[j];
    });
    foundation::for_all(s.total(), [&](std::size_t i) {
      weight_[i] = o_.weighs_energy() ? s.m[i] * s.u[i] : o_.weighs_volume() ? start_volume()[i] : s.m[i];
    });
  }

  template <class Kernel>
  void find_supports(const Kernel& unit) {
    sum(schemes::number_density<Kernel>{unit, support().data(), count_.data(), count_slope_.data()});
    next_supports();
  }

  // By no more than the lists allow.
  void next_supports() {
    foundation::for_all(w_.s.fluid, [&](std::size_t i) {
      const double S = support()[i], next = schemes::next_support(S, count_[i], count_slope_[i], target_);
      support()[i] = std::min(next, list_support()[i] + room_to_grow());
    });
  }

  template <class Kernel>
  schemes::density<D, Kernel> densities_of(const Kernel& unit) {
    auto& s = w_.s;
    return {unit,
            weight_.data(),
            s.m.data(),
            pairs::pointers<D>(s.v),
            S_.data(),
            {y_.data(), f_.data(), z_.data(), divergence_.data(), curl_.data(), number_.data(), mass_density_.data(),
             count_.data(), count_slope_.data()}};
  }

  template <class Kernel>
  void find_densities(const Kernel& unit) {
    const foundation::stage timed(w_.times, "densities");
    auto& s = w_.s;
    sum(densities_of(unit));
    const bool energy = o_.weighs_energy(), volume = o_.weighs_volume(), own_pressure = !o_.godunov();
    const bool with_f = o_.shock.scheme != "gsph" && !(o_.density_independent() && o_.shock.support_terms == "number");
    const bool with_z = o_.density_independent() && !with_f;
    const bool part_of_star = o_.shock.star_pressure == "balsara";
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (!(!o_.evolves_density() || evolved()[i] > 0.0)) {
        w_.first_fault.report(s.id[i], fmt::format("the density of particle {} is not above 0", s.id[i]));
        break;
      } else if (!((s.u[i] > 0.0 || o_.any_eos()) && y_[i] > 0.0 && std::isfinite(y_[i]))) {
        w_.first_fault.report(
            s.id[i], fmt::format("the internal energy of particle {} is {:.3g} J/kg, not above 0", s.id[i], s.u[i]));
        break;
      }
    foundation::for_all(s.fluid, [&](std::size_t i) {
      // dU = -p dV with V = k w/y
      const double k = volume ? start_sum()[i] : 1.0;
      s.rho[i] = o_.evolves_density() ? evolved()[i]
                 : energy             ? y_[i] / s.u[i]
                 : volume             ? s.m[i] * y_[i] / (k * weight_[i])
                                      : y_[i];
      if (o_.any_eos()) {
        const eos::caloric_state now = caloric_of(i).at(s.rho[i], s.u[i]);
        s.p[i] = now.p;
        s.T[i] = now.T;
        s.c[i] = now.c;
        // The stiffened gas with K_S and K_S' (riemann/states.hpp)
        stiffness_[i] = s.rho[i] * now.c * now.c / gamma_[i] - now.p;
      } else {
        s.p[i] = (gamma_[i] - 1.0) * (energy ? y_[i] : s.rho[i] * s.u[i]) - gamma_[i] * stiffness_[i];
        s.c[i] = sound_speed(i);
      }
      number_volume_[i] = 1.0 / number_[i];
      s.dV[i] = o_.evolves_density() ? s.m[i] / s.rho[i] : number_volume_[i];
      per_S_[i] = 1.0 / S_[i];
      slope_[i] = (with_f ? f_[i] : 1.0) * (own_pressure ? s.p[i] : 1.0) * k / (y_[i] * y_[i]);
      correction_[i] = with_z ? z_[i] : 0.0;
      const bool switched = o_.shock.balsara || part_of_star || o_.evolves_density();
      const double balsara =
          switched ? schemes::balsara_factor(divergence_[i], curl_[i], s.c[i], S_[i] / support_over_h_) : 1.0;
      dissipation_[i] = o_.evolves_density() ? balsara
                        : own_pressure       ? alpha()[i] * balsara
                        : part_of_star       ? balsara
                                             : 1.0;
    });
    if (o_.any_eos())
      for (std::size_t i = 0; i < s.fluid; ++i)
        if (!(s.c[i] > 0.0)) {
          w_.first_fault.report(
              s.id[i],
              fmt::format("particle {} has no sound at {:.4g} kg/m^3 and {:.4g} J/kg: '{}' does not reach there",
                          s.id[i], s.rho[i], s.u[i], eos::about(caloric_of(i).material()).name));
          break;
        }
    per_S_[s.null()] = slope_[s.null()] = 0.0;
    const std::array<double*, 9> all{correction_.data(), s.rho.data(),        s.p.data(),
                                     s.c.data(),         s.dV.data(),         per_S_.data(),
                                     slope_.data(),      dissipation_.data(), stiffness_.data()};
    domain::exchange<D>(w_.d.ranks, w_.d.fluid_halo, std::span<double* const>(all));
    for_each_image([&](std::size_t i, std::size_t j, const auto&) {
      for (double* a : all) a[i] = a[j];
    });
  }

  template <class Kernel>
  void find_gradients(const Kernel& unit) {
    const foundation::stage timed(w_.times, "gradients");
    auto& s = w_.s;
    schemes::gradients<D, Kernel> term{
        unit,      s.dV.data(), o_.evolves_density() ? s.u.data() : s.p.data(), s.rho.data(), pairs::pointers<D>(s.v),
        S_.data(), {}};
    std::array<double*, G> all;
    for (std::size_t k = 0; k < G; ++k) all[k] = term.out[k] = gradient_[k].data();
    sum(term);
    domain::exchange<D>(w_.d.ranks, w_.d.fluid_halo, std::span<double* const>(all));
    for_each_image([&](std::size_t i, std::size_t j, const std::array<double, D>& sign) {
      for (std::size_t k = 0; k < D + 2; ++k)
        for (std::size_t b = 0; b < D; ++b) {
          const double of_field = k < 2 ? 1.0 : sign[k - 2];
          all[D * k + b][i] = of_field * sign[b] * all[D * k + b][j];
        }
    });
  }

  // The kernels' corrections.
  template <class Kernel>
  void find_corrections(const Kernel& unit) {
    const foundation::stage timed(w_.times, "corrections");
    schemes::reproducing<D, Kernel> term{unit, w_.s.dV.data(), per_S_.data(), {}};
    std::array<double*, R> all;
    for (std::size_t k = 0; k < R; ++k) all[k] = reproducing_[k].data();
    term.out.m0 = all[0];
    term.out.A = all[1];
    for (std::size_t a = 0; a < D; ++a) {
      term.out.B[a] = all[2 + a];
      term.out.grad_A[a] = all[2 + D + a];
    }
    for (std::size_t k = 0; k < term.out.grad_B.size(); ++k) term.out.grad_B[k] = all[2 + 2 * D + k];
    sum(term);
    domain::exchange<D>(w_.d.ranks, w_.d.fluid_halo, std::span<double* const>(all));
    for_each_image([&](std::size_t i, std::size_t j, const std::array<double, D>& sign) {
      all[0][i] = all[0][j];
      all[1][i] = all[1][j];
      for (std::size_t a = 0; a < D; ++a) {
        term.out.B[a][i] = sign[a] * term.out.B[a][j];
        term.out.grad_A[a][i] = sign[a] * term.out.grad_A[a][j];
        for (std::size_t b = 0; b < D; ++b)
          term.out.grad_B[D * a + b][i] = sign[a] * sign[b] * term.out.grad_B[D * a + b][j];
      }
    });
  }

  template <class Kernel>
  void find_forces(const Kernel& unit) {
    const foundation::stage timed(w_.times, "forces");
    auto& s = w_.s;
    schemes::gas<D> gas{pairs::pointers<D>(s.v),
                        s.m.data(),
                        weight_.data(),
                        s.rho.data(),
                        s.p.data(),
                        s.c.data(),
                        slope_.data(),
                        correction_.data(),
                        per_S_.data(),
                        dissipation_.data(),
                        gamma_.data(),
                        stiffness_.data(),
                        {},
                        {},
                        {},
                        o_.shock.limiter == "minmod" ? 1.0 : 2.0,
                        o_.shock.solver == "exact"};
    for (std::size_t b = 0; b < D; ++b) {
      gas.grad_p[b] = gradient_[b].data();
      gas.grad_rho[b] = gradient_[D + b].data();
    }
    for (std::size_t k = 0; k < gas.grad_v.size(); ++k) gas.grad_v[k] = gradient_[2 * D + k].data();
    schemes::rates<D> out{{}, power_.data(), signal_.data()};
    for (std::size_t a = 0; a < D; ++a) out.force[a] = force_[a].data();
    if (o_.shock.scheme == "ssph") return sum(schemes::ssph<D, Kernel>{unit, gas, out});
    if (o_.shock.scheme == "disph") return sum(schemes::disph<D, Kernel>{unit, gas, out});
    if (o_.evolves_density()) {
      const auto at = [&](std::size_t k) { return static_cast<const double*>(reproducing_[k].data()); };
      schemes::reproducing_fields<D> kernel;
      kernel.A = at(1);
      for (std::size_t a = 0; a < D; ++a) {
        kernel.B[a] = at(2 + a);
        kernel.grad_A[a] = at(2 + D + a);
      }
      for (std::size_t k = 0; k < kernel.grad_B.size(); ++k) kernel.grad_B[k] = at(2 + 2 * D + k);
      return sum(schemes::remix<D, Kernel>{unit, gas, kernel, s.dV.data(), s.u.data(), at(0), kind_.data(),
                                           support_over_dx_, out, density_rate_.data()});
    }
    const bool second = o_.second_order();
    if (o_.shock.scheme == "gsph")
      return second ? sum(schemes::gsph<D, Kernel, true>{unit, gas, out})
                    : sum(schemes::gsph<D, Kernel, false>{unit, gas, out});
    return second ? sum(schemes::gdisph<D, Kernel, true>{unit, gas, out})
                  : sum(schemes::gdisph<D, Kernel, false>{unit, gas, out});
  }

  template <class Kernel>
  void evaluate_with(const Kernel& unit) {
    refresh_state();
    find_densities(unit);
    if (o_.evolves_density()) find_corrections(unit);
    if (o_.second_order() || o_.evolves_density()) find_gradients(unit);
    find_forces(unit);
  }

  void combine(std::span<double* const> rate) {
    const auto& s = w_.s;
    foundation::for_all(s.fluid, [&](std::size_t i) {
      for (std::size_t a = 0; a < D; ++a) {
        rate[a][i] = s.v[a][i];
        rate[D + a][i] = force_[a][i] / s.m[i];
      }
      if constexpr (D > 1) rate[D + 1][i] -= o_.shock.gravity;
      rate[2 * D][i] = power_[i] / s.m[i];
      if (o_.evolves_density()) rate[2 * D + 1][i] = density_rate_[i];
      if (!has_alpha()) return;
      const auto& q = o_.shock;
      rate[2 * D + 1][i] =
          schemes::alpha_rate(alpha()[i], q.alpha_min, q.alpha, divergence_[i], s.c[i], S_[i] / support_over_h_);
    });
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (!std::isfinite(rate[D][i] + rate[2 * D][i])) {
        w_.first_fault.report(s.id[i], fmt::format("a rate is not finite at particle {}", s.id[i]));
        break;
      }
  }

  // ---- measures ---------------------------------------------------------------------------

  struct totals {
    double mass, kinetic, internal, potential, momentum_scale;
    std::array<double, D> momentum;
    double energy() const { return kinetic + internal + potential; }
  };
  totals sum_up() const {
    const auto& s = w_.s;
    foundation::exact_sum mass, kinetic, internal, potential, scale;
    std::array<foundation::exact_sum, D> momentum;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double v2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        v2 += s.v[a][i] * s.v[a][i];
        momentum[a].add(s.m[i] * s.v[a][i]);
      }
      mass.add(s.m[i]);
      kinetic.add(0.5 * s.m[i] * v2);
      internal.add(s.m[i] * s.u[i]);
      if constexpr (D > 1) potential.add(s.m[i] * o_.shock.gravity * s.x[1][i]);
      scale.add(s.m[i] * (std::sqrt(v2) + sound_speed(i)));
    }
    totals t{ranks().exact(mass),      ranks().exact(kinetic), ranks().exact(internal),
             ranks().exact(potential), ranks().exact(scale),   {}};
    for (std::size_t a = 0; a < D; ++a) t.momentum[a] = ranks().exact(momentum[a]);
    return t;
  }

  view particles_seen() const {
    const auto& s = w_.s;
    view seen{ranks(),          s.fluid, {}, {}, s.m.data(), told_density().data(), s.p.data(), number_volume_.data(),
              s.material.data()};
    for (std::size_t a = 0; a < D; ++a) {
      seen.x[a] = s.x[a].data();
      seen.v[a] = s.v[a].data();
    }
    return seen;
  }

  // Means of |value - exact| over the volume of the particles measured.
  nlohmann::ordered_json errors(double t) const {
    const auto& s = w_.s;
    foundation::exact_sum volume, rho, v, p;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const point x = place(i);
      if (setup_.measured && !setup_.measured(x, t)) continue;
      const state right = setup_.exact(x, t);
      double dv2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) dv2 += (s.v[a][i] - right.v[a]) * (s.v[a][i] - right.v[a]);
      const double V = number_volume_[i];
      volume.add(V);
      rho.add(V * std::abs(told_density()[i] - right.rho));
      v.add(V * std::sqrt(dv2));
      p.add(V * std::abs(s.p[i] - right.p));
    }
    const double all = ranks().exact(volume);
    return {{"density_l1", ranks().exact(rho) / all},
            {"velocity_l1", ranks().exact(v) / all},
            {"pressure_l1", ranks().exact(p) / all}};
  }

  const eos::caloric& caloric_of(std::size_t i) const {
    return materials_[w_.s.material[i] == setup_.material_l ? 0 : 1];
  }

  struct start_state {
    double u, c;  // J/kg, m/s
  };
  start_state start_of(const state& now) const {
    if (o_.any_eos()) {
      const bool left = now.material == setup_.material_l;
      const eos::caloric& m = materials_[left ? 0 : 1];
      const double u = m.internal_energy(now.rho, left ? *o_.shock.temperature_l : *o_.shock.temperature_r);
      return {u, m.at(now.rho, u).c};
    }
    const auto [gamma, stiffness] = gas_of(now.material);
    return {(now.p + gamma * stiffness) / ((gamma - 1.0) * now.rho), std::sqrt(gamma * (now.p + stiffness) / now.rho)};
  }

  // gamma and p_infinity; with an equation of state K_S' of the start, and p_infinity follows the state
  std::pair<double, double> gas_of(std::int32_t material) const {
    const auto& q = o_.shock;
    if (o_.any_eos()) return {stiffening_[material == setup_.material_l ? 0 : 1], 0.0};
    return material == setup_.material_l ? std::pair{*q.gamma_l, q.p_infinity_l}
                                         : std::pair{*q.gamma_r, q.p_infinity_r};
  }

  const options& o_;
  const setup setup_;
  std::vector<eos::caloric> materials_;  // left, right; none: gases
  std::vector<double> stiffening_;       // K_S' of each
  pairs::workspace<D> w_;
  images::image_set<D> images_;
  kernel_choice<D> unit_ = kernels::quintic_spline<D>(1.0);  // support 1
  double support_over_dx_ = 0.0, support_over_h_ = 0.0, target_ = 0.0, skin_ = 0.0, speed_scale_ = 0.0,
         density_scale_ = 0.0;
  std::int64_t fluid_total_ = 0, crossings_ = 0;
  double time_ = 0.0;  // s, of the state
  bool settled_ = false;
  std::optional<totals> first_;
  samples samples_;

  particles::array S_, per_S_, weight_, slope_, dissipation_;  // of all particles
  particles::array y_, f_, divergence_, curl_, number_, number_volume_, count_, count_slope_, power_, signal_,
      mass_density_;
  particles::array z_, correction_, gamma_, stiffness_;  // correction_, gamma_, stiffness_: of all particles
  std::array<particles::array, D> force_;
  std::array<particles::array, G> gradient_;
  std::array<particles::array, R> reproducing_;
  particles::array kind_, density_rate_;  // kind_: of all particles, which material
};

}  // namespace tetsuame::shocks
