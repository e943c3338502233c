// Spheres in contact (discrete element method), in a plane or in space: m dv/dt = Σ F + m g, I dω/dt = Σ T.
#pragma once

#include <dem/near_rows.hpp>
#include <domain/partners.hpp>
#include <granular/measures.hpp>
#include <granular/options.hpp>
#include <liquid/sums.hpp>
#include <memory>
#include <numbers>
#include <passes/evaluation.hpp>
#include <run/particle_simulation.hpp>
#include <run/start.hpp>

namespace tetsuame::granular {

template <int D>
class problem : public run::particle_simulation<D> {
 public:
  using base = run::particle_simulation<D>;
  using base::ranks;
  static constexpr std::size_t turns = dem::turns<D>;

  explicit problem(const options& o) : base(world_, o.common), o_(o), walls_(o.walls<D>()), contacts_(o.table, walls_) {
    set_up();
    place_grains();
    if (!walls_.gate) may_rest_from_ = fall_time(o.rest_speed);
    history_.reset({world_.w.s.id.data(), world_.w.s.fluid});
    world_.partners = {&history_};
    declare_evaluation();
    this->about.push_back(fmt::format("grains: {}, radii up to {:.4g} m; steps of {:.3g} of the limit by {}, {:.4g} s",
                                      world_.fluid_total, o.largest_radius,
                                      o.common.time.dt.value_or(*o.common.time.cfl * o.step_limit) / o.step_limit,
                                      o.step_limit_is, o.step_limit));
  }

  std::vector<integrators::field> fields() override { return evaluation_.fields(); }
  void sum_rates(std::span<double* const> rate) override { evaluation_.run(rate); }
  integrators::step_limit largest_step() override { return {*o_.common.time.cfl * o_.step_limit, o_.step_limit_is}; }

  // Grains that are out of an open side by a radius leave the run.
  bool let_particles_pass() override {
    auto& s = world_.w.s;
    std::vector<std::uint32_t> stay;
    foundation::exact_sum below;
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (!is_out(i)) {
        stay.push_back(static_cast<std::uint32_t>(i));
      } else if (s.x[1][i] < o_.flux_height) {
        below.add(s.m[i]);
      }
    const std::int64_t gone = ranks.sum(static_cast<std::int64_t>(s.fluid - stay.size()));
    if (gone == 0) return false;
    left_ += gone;
    mass_left_below_ += ranks.exact(below);
    contacts_.keep(s, history_);
    has_lists_ = false;  // what contacts keep is with the grains
    particles::reorder(s, 0, std::span<const std::uint32_t>(stay));
    history_.reorder(stay);
    particles::allocate(s, stay.size(), 0, 0, 0);
    return true;
  }
  bool set_time(double t) override {
    kept_at_ = t;
    return false;
  }
  bool complete_step(std::int64_t) override {
    contacts_.commit();
    auto all = latest_;
    if (is_impact()) share(all);
    record_.add(all, world_.state_time, is_impact());
    return false;
  }
  // Bodies that move end lists too, and no frame moves with what is beside them.
  run::apart moved() override {
    auto all = walls_.bodies.empty() ? base::moved() : run::apart_of<D>(world_.w.s.fluid, {}, [&](auto a, auto i) {
      return world_.w.s.x[a][i] - world_.w.s.x_list[a][i];
    });
    all.numbers[run::apart::at_least] =
        std::max(all.numbers[run::apart::at_least], largest_of_walls([&](std::size_t n, double extent) {
                   return walls_.way(n, world_.list_time, world_.state_time, extent);
                 }));
    return all;
  }
  run::apart speed() override {
    auto all = walls_.bodies.empty()
                   ? base::speed()
                   : run::apart_of<D>(world_.w.s.fluid, {}, [&](auto a, auto i) { return world_.w.s.v[a][i]; });
    all.numbers[run::apart::at_least] = std::max(
        all.numbers[run::apart::at_least],
        largest_of_walls([&](std::size_t n, double extent) { return walls_.speed(n, world_.state_time, extent); }));
    return all;
  }

  std::vector<output::history_column> measured_columns() const override {
    return {{"kinetic_energy", "J"}, {"rotational_energy", "J"}, {"potential_energy", "J"}, {"elastic_energy", "J"},
            {"speed_max", "m/s"},    {"contacts", "1"},          {"overlap_max", "1"},      {"centre_x", "m"},
            {"centre_y", "m"},       {"mass_below", "kg"},       {"momentum_x", "kg m/s"},  {"momentum_y", "kg m/s"},
            {"momentum_z", "kg m/s"}};
  }
  std::vector<double> measure(double t) override {
    const auto& s = world_.w.s;
    const auto g = gravity();
    foundation::exact_sum elastic, contacts;
    contacts_.add_energy(s, contacts, elastic);
    const auto [kinetic, turning, potential, mass, mx, my, below] =
        liquid::exact_sums<7>(world_, [&](std::size_t i, const auto& add) {
          double v2 = 0.0, w2 = 0.0, height = 0.0;
          for (std::size_t a = 0; a < D; ++a) {
            v2 += s.v[a][i] * s.v[a][i];
            height -= g[a] * s.x[a][i];
          }
          for (std::size_t a = 0; a < turns; ++a) w2 += spin_[a][i] * spin_[a][i];
          add(0.5 * s.m[i] * v2, 0.2 * s.m[i] * radius_[i] * radius_[i] * w2, s.m[i] * height, s.m[i],
              s.m[i] * s.x[0][i], s.m[i] * s.x[1][i], s.x[1][i] < o_.flux_height ? s.m[i] : 0.0);
        });
    const auto momentum = liquid::exact_sums<3>(world_, [&](std::size_t i, const auto& add) {
      add(s.m[i] * s.v[0][i], s.m[i] * s.v[1][i], D == 3 ? s.m[i] * s.v[D - 1][i] : 0.0);
    });
    fastest_ = ranks.maximum(run::largest_speed(world_));
    const double fallen = below + mass_left_below_;
    discharge_.add(t, fallen);
    if (walls_.gate && !walls_.opened && fastest_ < walls_.gate->at_rest && t > fall_time(walls_.gate->at_rest)) {
      walls_.opened = t;
      double top = 0.0;
      for (std::size_t i = 0; i < s.fluid; ++i) top = std::max(top, s.x[1][i] + radius_[i]);
      may_rest_from_ = t + ranks.maximum(top) / solids::norm<D>(walls_.gate->velocity);
    }
    return {kinetic,
            turning,
            potential,
            ranks.exact(elastic),
            fastest_,
            ranks.exact(contacts),
            ranks.maximum(fullest_),
            mass > 0.0 ? mx / mass : 0.0,
            mass > 0.0 ? my / mass : 0.0,
            o_.flux_height > 0.0 ? fallen : 0.0,
            momentum[0],
            momentum[1],
            momentum[2]};
  }
  bool steady() const override {
    const bool may = (!walls_.gate || walls_.opened) && world_.state_time > may_rest_from_;
    return o_.rest_speed > 0.0 && may && fastest_ < o_.rest_speed;
  }

  std::vector<output::particle_group> particle_groups(std::vector<particles::array>& made) override {
    const auto& s = world_.w.s;
    auto g = output::group_of(s, 0, 0, s.fluid);
    output::add_quantity(g, "Masses", {s.m.data()});
    output::add_quantity(g, "Radius", {radius_.data()});
    output::add_quantity(g, "Density", {output::make_array(made, s.fluid, [&](std::size_t i) { return density(i); })});
    output::add_quantity(
        g, "Pressure",
        {output::make_array(made, s.fluid, [&](std::size_t i) { return contacts_.virial(i) / volume(i); })});
    output::add_quantity(g, "Temperature", {output::make_array(made, s.fluid, [](std::size_t) { return 0.0; })});
    output::add_quantity(g, "SmoothingLength",
                         {output::make_array(made, s.fluid, [&](std::size_t i) { return radius_[i]; })});
    output::add_quantity(g, "CoordinationNumber", {output::make_array(made, s.fluid, [&](std::size_t i) {
                           return static_cast<double>(contacts_.coordination(i));
                         })});
    std::vector<const double*> spin;
    for (std::size_t a = 0; a < turns; ++a) spin.push_back(spin_[a].data());
    if constexpr (D == 2)
      output::add_quantity(g, "AngularVelocity", spin);
    else
      output::add_quantity(g, "Spin", spin);
    output::add_quantity(
        g, "Material",
        {output::make_array(made, s.fluid, [&](std::size_t i) { return static_cast<double>(s.material[i]); })});
    return {g};
  }

  void report_results(double, run::summary& r) override {
    auto& m = r.metrics;
    foundation::exact_sum contacts, elastic;
    contacts_.add_energy(world_.w.s, contacts, elastic);
    m["contacts"] = ranks.exact(contacts);
    m["particles_lost"] = lost();
    m["particles_left"] = left_;
    m["step_over_limit"] = o_.common.time.dt.value_or(*o_.common.time.cfl * o_.step_limit) / o_.step_limit;
    record_.report(ranks, m);
    report_impact(m);
    report_heap(m);
    m["discharge_rate"] = discharge_.rate().has_value() ? nlohmann::ordered_json(*discharge_.rate()) : nullptr;
    m["gate_opened"] = walls_.opened ? nlohmann::ordered_json(*walls_.opened) : nullptr;
  }

  void save_globals(output::checkpoint_globals& g) const override {
    base::save_globals(g);
    record_.save(ranks, g);
    discharge_.save(g);
    g.integers["grains_left"] = left_;
    g.reals["mass_left_below"] = mass_left_below_;
    g.reals["fastest"] = fastest_;
    g.reals["may_rest_from"] = may_rest_from_;
    if (walls_.opened) g.reals["gate_opened"] = *walls_.opened;
  }
  void restore_globals(const output::checkpoint_globals& g) override {
    base::restore_globals(g);
    record_.restore(g);
    discharge_.restore(g);
    left_ = g.integers.at("grains_left");
    mass_left_below_ = g.reals.at("mass_left_below");
    fastest_ = g.reals.at("fastest");
    may_rest_from_ = g.reals.at("may_rest_from");
    if (g.reals.contains("gate_opened")) walls_.opened = g.reals.at("gate_opened");
    kept_at_ = g.reals.at("time");
  }
  std::vector<output::table_view> further_tables() override {
    contacts_.keep(world_.w.s, history_);
    pairs_ = domain::table_of(ranks, history_);
    output::table_view t{"contacts", pairs_.ids.size(), pairs_.ids.data(), {}, {}};
    for (std::size_t k = 0; k < pairs_.values.size(); ++k)
      t.reals.emplace_back("Memory_" + std::to_string(k), pairs_.values[k].data());
    t.integers = {{"Grain", pairs_.owner.data()}, {"Partner", pairs_.partner.data()}};
    return {t};
  }
  void read_further_tables(const output::checkpoint& saved) override {
    const auto& t = saved.tables.at("contacts");
    pairs_ = {};
    pairs_.owner = t.integers.at("Grain");
    pairs_.partner = t.integers.at("Partner");
    for (std::size_t k = 0; k < dem::contact_memory<D>::size; ++k)
      pairs_.values.push_back(t.reals.at("Memory_" + std::to_string(k)));
    domain::read_table(world_.w.d, {world_.w.s.id.data(), world_.w.s.fluid}, pairs_, history_);
  }

 protected:
  void make_lists(bool as_they_were) override {
    auto& s = world_.w.s;
    if (std::exchange(has_lists_, true)) contacts_.keep(s, history_);
    auto& w = world_.w;
    const double reach = w.support() + world_.skin;
    run::rebuild_by(
        world_, as_they_were,
        [&] {
          return run::list_lengths{cells::cell_edge(w.dx), reach};
        },
        [&](const run::list_lengths&, const cells::grid<D>& grid) {
          cells::make_list<D>(w.list, grid, s.x, s.fluid, cells::one_reach{reach});
          w.exchange_fluid({radius_.data()});
          contacts_.find_pairs(s, radius_.data(), dem::near_rows<D>(s, radius_.data(), w.list, world_.skin + drawn_),
                               world_.skin + 2.0 * drawn_, world_.list_time);
        });
    particles::clear_derived(s);
    contacts_.remember(s, radius_.data(), history_);
    if (std::exchange(is_start_, false) && !as_they_were) check_start();
  }

 private:
  // A box without a lattice: the spacing is the largest diameter, which is also how far lists look.
  void set_up() {
    auto& w = world_.w;
    drawn_ = o_.table.farthest_drawn(o_.largest_radius);
    w.dx = 2.0 * o_.largest_radius + drawn_;
    w.kernel = kernels::make<D>(o_.common.kernel.name, o_.common.kernel.h_over_dx * w.dx);
    w.lattice_sum = 1.0;
    world_.skin = o_.common.kernel.skin * w.dx;
    w.d = domain::decompose<D>(domain::communicator::world(), domain::box_of<D>(o_.domain), w.support() + world_.skin,
                               o_.domain.ranks_x);
  }
  void place_grains() {
    auto& s = world_.w.s;
    const auto cell = world_.w.d.cell();
    std::vector<grain> here;
    for_each_grain(o_, [&](const grain& one) {
      std::array<double, D> x;
      std::copy_n(one.x.begin(), D, x.begin());
      if (world_.w.d.within(cell, x)) here.push_back(one);
      ++world_.fluid_total;
    });
    run::make_room(s, here.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
      const auto& one = here[i];
      s.id[i] = one.id;
      s.material[i] = one.material;
      radius_[i] = one.radius;
      const double V = 4.0 / 3.0 * std::numbers::pi * one.radius * one.radius * one.radius;
      s.m[i] = o_.table.materials[static_cast<std::size_t>(one.material)].density * V;
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] = one.x[a];
        s.v[a][i] = one.v[a];
      }
      for (std::size_t a = 0; a < turns; ++a) spin_[a][i] = one.spin[D == 2 ? 2 : a];
    }
  }
  // Grains that overlap too much, or are inside of a body.
  void check_start() {
    const auto& s = world_.w.s;
    const auto deepest = contacts_.deepest(s, radius_.data(), 0.0);
    std::pair<std::int64_t, std::string> fault;
    const auto place = [&](std::size_t i) { return pairs::describe_position(s, i); };
    if (deepest.radii > o_.overlap_limit)
      fault = {s.id[deepest.grain],
               fmt::format("grain {} overlaps {} by {:.3g} of its radius at the start, {}: at most {} are allowed "
                           "(overlap_limit)",
                           s.id[deepest.grain], deepest.wall ? "a wall" : fmt::format("grain {}", deepest.partner),
                           deepest.radii, place(deepest.grain), o_.overlap_limit)};
    for (std::size_t i = 0; i < s.fluid && fault.second.empty(); ++i) {
      const auto x = solids::point<D>::of([&](std::size_t a) { return s.x[a][i]; });
      for (std::size_t b = 0; b < walls_.bodies.size(); ++b)
        if (walls_.bodies[b].solid(walls_.pose_of(b, 0.0).to_body(x)))
          fault = {s.id[i], fmt::format("grain {} is inside of body '{}' at the start, {}", s.id[i],
                                        walls_.bodies[b].name(), place(i))};
    }
    ranks.agree_on_fault(fault.first, fault.second, foundation::exit_status::bad_input);
  }

  // One grain, or two: their contact is a single impact.
  bool is_impact() const { return world_.fluid_total <= 2; }
  // What any rank has of the only contact.
  void share(dem::contact_measures& m) const {
    constexpr double least = -std::numeric_limits<double>::infinity();
    std::array<double, 6> all{least, m.force, least, 0.0, 0.0, 0.0};
    if (m.any) {
      all[0] = m.overlap;
      all[2] = m.approach;
      for (std::size_t a = 0; a < 3; ++a) all[3 + a] = m.normal[a] + 2.0;
    }
    ranks.maximum(all);
    m.force = all[1];
    m.any = all[0] > least;
    if (!m.any) return;
    m.overlap = all[0];
    m.approach = all[2];
    for (std::size_t a = 0; a < 3; ++a) m.normal[a] = all[3 + a] - 2.0;
  }
  // s, in which what falls freely is clearly faster than this.
  double fall_time(double speed) const { return o_.g > 0.0 ? 2.0 * speed / o_.g : 0.0; }
  // value(wall, m: no point of the box is farther from a body's pivot in it).
  template <class Value>
  double largest_of_walls(const Value& value) const {
    double most = 0.0, extent = 0.0;
    for (const double l : world_.w.d.region.length) extent += l;
    for (std::size_t n = 0; n < walls_.size(); ++n) most = std::max(most, value(n, extent));
    return most;
  }

  solids::point<D> gravity() const {
    auto g = foundation::zero<double, D>();
    const double angle = o_.incline * std::numbers::pi / 180.0;
    g[0] = o_.g * std::sin(angle);
    g[1] = -o_.g * std::cos(angle);
    return g;
  }
  double volume(std::size_t i) const { return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_[i], 3); }
  double density(std::size_t i) const { return world_.w.s.m[i] / volume(i); }

  void declare_evaluation() {
    auto& e = evaluation_;
    auto& s = world_.w.s;
    e.keep_rates(passes::evaluation<D>::kept::all_but_positions);
    e.integrate_motion({});
    std::array<std::size_t, turns> of_spin;
    constexpr std::array<const char*, 3> names{"wx", "wy", "wz"};
    for (std::size_t a = 0; a < turns; ++a) of_spin[a] = e.integrate(spin_[a], {names[D == 2 ? 2 : a]});
    // The velocities in the middle of a step follow from the rates that were kept at its start.
    e.given({s.m, radius_});
    passes::fields kept;
    for (std::size_t a = 0; a < D; ++a) kept.add({e.kept_field(s.v[a])});
    for (std::size_t a = 0; a < turns; ++a) kept.add({e.kept_field(spin_[a])});
    e.remembered(kept);
    // Ghosts over a periodic border have the places of their images.
    passes::fields places;
    for (std::size_t a = 0; a < D; ++a)
      if (world_.w.d.region.periodic[a]) places.add({own_place_[a]});
    if (!places.empty())
      e.whole("places", {.reads = {s.x}, .writes = places}, [this, &s] {
        for (std::size_t a = 0; a < D; ++a)
          if (world_.w.d.region.periodic[a]) std::copy_n(s.x[a].begin(), s.fluid, own_place_[a].begin());
      });
    e.whole("contacts", {.at_neighbours = {s.x, places, s.v, spin_, kept, s.m, radius_}, .rates = {s.x, s.v, spin_}},
            [this, &s, of_spin] {
              dem::grain_fields<D> f{s, {}, radius_.data(), {}, spin_.read(), {}, {}, {}, {}, gravity()};
              for (std::size_t a = 0; a < D; ++a) {
                f.period[a] = world_.w.d.region.length[a];
                f.own_place[a] = world_.w.d.region.periodic[a] ? own_place_[a].data() : nullptr;
                std::copy_n(s.v[a].begin(), s.fluid, evaluation_.rate(a));
                f.acceleration[a] = evaluation_.rate(D + a);
                f.kept_acceleration[a] = evaluation_.kept_rate(s.v[a]).data();
              }
              for (std::size_t a = 0; a < turns; ++a) {
                f.spin_rate[a] = evaluation_.rate(of_spin[a]);
                f.kept_spin_rate[a] = evaluation_.kept_rate(spin_[a]).data();
              }
              const bool tells = this->evaluating().of != run::purpose::step;
              const double dt = world_.state_time - kept_at_;  // since what contacts keep
              const auto found = contacts_.evaluate(f, world_.state_time, dt, tells);
              if (!tells) latest_ = found;
              fullest_ = found.relative_overlap;
              if (found.relative_overlap > 1.0) {
                const std::size_t i = contacts_.deepest_grain();
                world_.w.first_fault.report(
                    s.id[i],
                    "a grain is deeper in what it touches than its radius: the step is too long for "
                    "its speed, or the contact too soft, " +
                        pairs::describe_position(s, i));
              }
            });
    e.complete(passes::behind_walls::nothing);
  }
  // ---- what is told at the end --------------------------------------------------------------

  // m, by which the centre of grain i is out of the box at the sides that this chooses; below 0: inside.
  template <class Chosen>
  double out(std::size_t i, const Chosen& chosen) const {
    const auto& region = world_.w.d.region;
    double farthest = -std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < D; ++a) {
      if (region.periodic[a]) continue;
      const double x = world_.w.s.x[a][i];
      if (chosen(o_.boundary[2 * a])) farthest = std::max(farthest, -x);
      if (chosen(o_.boundary[2 * a + 1])) farthest = std::max(farthest, x - region.length[a]);
    }
    return farthest;
  }
  bool is_out(std::size_t i) const {
    return out(i, [](const std::string& side) { return side == "open"; }) > radius_[i];
  }
  // Grains that have gone through a wall.
  std::int64_t lost() const {
    std::int64_t n = 0;
    for (std::size_t i = 0; i < world_.w.s.fluid; ++i)
      n += out(i, [](const std::string& side) { return side == "wall"; }) > 0.0 ? 1 : 0;
    return ranks.sum(n);
  }

  // Of one grain, or two: speeds along and across the line of the contact, after over before.
  void report_impact(nlohmann::ordered_json& m) const {
    for (const char* name : {"restitution_normal", "restitution_tangential", "spin"}) m[name] = nullptr;
    if (world_.fluid_total > 2) return;
    // Rows of doubles: number, velocity, spin; of all ranks.
    constexpr std::size_t width = 1 + D + turns;
    std::vector<double> rows(2 * width, 0.0);
    const auto& s = world_.w.s;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      double* row = rows.data() + static_cast<std::size_t>(s.id[i]) * width;
      row[0] = 1.0;
      for (std::size_t a = 0; a < D; ++a) row[1 + a] = s.v[a][i];
      for (std::size_t a = 0; a < turns; ++a) row[1 + D + a] = spin_[a][i];
    }
    ranks.sum(rows);
    const auto normal = record_.normal();
    if (!normal) return;
    std::array<solids::point<D>, 2> before{foundation::zero<double, D>(), foundation::zero<double, D>()};
    for_each_grain(o_, [&](const grain& one) {
      for (std::size_t a = 0; a < D; ++a) before[static_cast<std::size_t>(one.id)][a] = one.v[a];
    });
    const auto relative = [](const auto& v) {
      return solids::point<D>::of([&](std::size_t a) { return v[0][a] - v[1][a]; });
    };
    const std::array after{solids::point<D>::of([&](std::size_t a) { return rows[1 + a]; }),
                           solids::point<D>::of([&](std::size_t a) { return rows[width + 1 + a]; })};
    const auto n = solids::point<D>::of([&](std::size_t a) { return (*normal)[a]; });
    const auto u = relative(before), w = relative(after);
    const double u_n = foundation::dot(u, n), w_n = foundation::dot(w, n);
    const auto u_t = u - u_n * n, w_t = w - w_n * n;
    if (u_n != 0.0) m["restitution_normal"] = -w_n / u_n;
    if (const double u2 = foundation::dot(u_t, u_t); u2 > 1e-24 * foundation::dot(u, u))
      m["restitution_tangential"] = foundation::dot(w_t, u_t) / u2;
    double spin2 = 0.0;
    for (std::size_t a = 0; a < turns; ++a) {
      spin2 += rows[1 + D + a] * rows[1 + D + a];
      m[D == 2 ? "spin_z" : std::array{"spin_x", "spin_y", "spin_z"}[a]] = rows[1 + D + a];
    }
    m["spin"] = std::sqrt(spin2);
    for (std::size_t a = 0; a < D; ++a) m[std::array{"velocity_x", "velocity_y", "velocity_z"}[a]] = rows[1 + a];
  }

  // Of grains that were piled up: the farthest along x, and the slope of what is left (measures.hpp).
  void report_heap(nlohmann::ordered_json& m) const {
    m["run_out"] = m["repose_angle"] = m["repose_angle_error"] = nullptr;
    if (world_.fluid_total < 50) return;
    const auto& s = world_.w.s;
    heap_profile heap(o_.domain.length[0], 4.0 * o_.largest_radius);
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (const auto n = contacts_.coordination(i); n > 0) heap.add(s.x[0][i], s.x[1][i], radius_[i], n > 1);
    heap.share(ranks);
    m["run_out"] = heap.run_out();
    if (const auto slope = heap.slope()) {
      m["repose_angle"] = slope->angle;
      m["repose_angle_error"] = slope->error;
    }
  }

  const options& o_;
  run::state<D> world_;
  particles::array& radius_ = particles::declare(world_.w.s, "Radius", "m", particles::role::constant);
  particles::vector_field<turns> spin_ =
      particles::declare_vector<turns>(world_.w.s, "Spin", "1/s", particles::role::integrated);
  particles::vector_field<D> own_place_ =
      particles::declare_vector<D>(world_.w.s, "OwnPlace", "m", particles::role::derived);
  passes::evaluation<D> evaluation_{world_};
  dem::wall_set<D> walls_;
  dem::contacts<D> contacts_;
  particles::partners history_{dem::contact_memory<D>::size};
  particles::pair_table pairs_;  // of the last checkpoint or hash
  bool has_lists_ = false, is_start_ = true;
  std::int64_t left_ = 0;         // grains, through open sides, on all ranks
  double mass_left_below_ = 0.0;  // kg, of these below flux_height
  double drawn_ = 0.0;            // m, by which a contact that adheres lasts longer than surfaces touch
  double fullest_ = 0.0;          // of the last evaluation, in radii
  double kept_at_ = 0.0, fastest_ = 0.0, may_rest_from_ = 0.0;  // s, of what contacts keep; m/s; s
  dem::contact_measures latest_;                                // of the last step
  contact_record record_;
  discharge discharge_;
};

}  // namespace tetsuame::granular
