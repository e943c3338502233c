// An evaluation of dy/dt as a list of passes. A problem declares what is integrated and the passes, once:
//
//   e.integrate(s.T, {.name = "T", .scale = 1.0});
//   e.given({s.k, s.dV});                                                      // they change with the lists alone
//   e.sum("conduction", {.at_neighbours = {s.T, s.k, s.dV}, .writes = {heat}},
//         [&](const auto& rows) { w.sum(rows, diffusion::conduction<D>{…}); });
//   e.each("rates", {.reads = {heat}, .rates = {s.T}}, [&](std::size_t i) { e.rate(0)[i] = heat[i] / volume; });
//   e.complete();
//
// and run() carries them out: exchanges between ranks, ghosts, images and interior rows first follow from what the
// passes read and write (schedule.hpp).
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <integrators/explicit_integrator.hpp>
#include <passes/schedule.hpp>
#include <run/lists.hpp>
#include <span>
#include <walls/images.hpp>

namespace tetsuame::passes {

// What the time integration is told of a field (integrators::field).
struct integrated {
  std::string name;
  double absolute_tolerance = 0.0, scale = 0.0;            // the field's unit
  const double *common = nullptr, *common_rate = nullptr;  // of all values, and of their rates
  field* previous_rate = nullptr;
};

// What stands behind the walls of a box: images, particles that passes give values, or nothing.
enum class behind_walls { images, particles, nothing };
template <int D>
behind_walls behind(const run::state<D>& box) {
  if (box.mirrors()) return behind_walls::images;
  const bool stands = std::visit([](auto t) { return decltype(t)::has_particles; }, box.treatment);
  return stands ? behind_walls::particles : behind_walls::nothing;
}

// What rates read of gravity and of the input's sources where a pass writes them (pairs/workspace.hpp).
template <int D>
fields of_sources(const run::state<D>& box) {
  fields all;
  if (box.w.gravity_varies) all.add({box.w.accelerations});
  if (box.w.heating != nullptr) all.add({*box.w.heating});
  return all;
}
// Of gravity alone.
template <int D>
fields of_gravity(const run::state<D>& box) {
  return box.w.gravity_varies ? fields{box.w.accelerations} : fields{};
}

template <int D>
class evaluation {
 public:
  explicit evaluation(run::state<D>& of) : box_(of) {}
  evaluation(const evaluation&) = delete;  // passes refer to it
  evaluation& operator=(const evaluation&) = delete;

  // ---- declarations -----------------------------------------------------------------------

  // Before what is integrated: whose rates of the step before are kept, for methods of time integration that need them;
  // 'ab2' those of all, 'kdk' those of all but positions.
  enum class kept { none, all_but_positions, all };
  void keep_rates(kept which) { kept_rates_ = which; }
  // In the order of the rates.
  // Returns its place among these.
  std::size_t integrate(field& f, integrated about) {
    known_.integrated.add({f});
    auto& s = box_.w.s;
    const bool is_position = std::ranges::any_of(s.x, [&](const field& x) { return &x == &f; });
    if (kept_rates_ == kept::all || (kept_rates_ == kept::all_but_positions && !is_position))
      about.previous_rate =
          &particles::declare(s, "EarlierRate_" + std::to_string(states_.size()), "", particles::role::memory);
    states_.push_back({&f, nullptr, std::move(about)});
    return states_.size() - 1;
  }
  // Numbers that are not the particles', as of bodies: on one rank, an array a component.
  std::size_t integrate_numbers(std::vector<double>& values, integrated about) {
    states_.push_back({nullptr, &values, std::move(about)});
    return states_.size() - 1;
  }
  // Positions and velocities. tolerances: absolute, m and m/s, and the scale of velocities, m/s.
  struct motion {
    double position_tolerance = 0.0, velocity_tolerance = 0.0, speed = 0.0;
    bool frame_of_velocities = false;
  };
  void integrate_motion(const motion& how) {
    auto& w = box_.w;
    constexpr std::array<const char*, 3> axis{"x", "y", "z"};
    for (std::size_t a = 0; a < D; ++a)
      integrate(w.s.x[a], {axis[a], how.position_tolerance, w.dx, nullptr, &w.frame[a]});
    for (std::size_t a = 0; a < D; ++a)
      integrate(w.s.v[a], {std::string("v") + axis[a], how.velocity_tolerance, how.speed,
                           how.frame_of_velocities ? &w.frame[a] : nullptr});
    moves();
  }
  // Positions are among what is integrated.
  void moves() { known_.positions = {box_.w.s.x}; }
  void given(const fields& some) { known_.given.add(some); }
  void remembered(const fields& some) { known_.remembered.add(some); }
  // Positions and velocities, where they are not integrated here.
  void remembered_motion() {
    remembered({box_.w.s.x, box_.w.s.v});
    moves();
  }
  // How fields go on behind mirrors; those that are not named are even.
  void mirrored(const walls::mirrored_fields& some) {
    parities_.insert(parities_.end(), some.begin(), some.end());
    for (const auto& f : some) {
      auto& by = known_.image_by[f.values];
      by.clear();
      if (f.density != nullptr) by.push_back(f.density);
      for (const field* component : f.accelerations)
        if (component != nullptr) by.push_back(component);
    }
  }

  // f(i), or f(first, last).
  template <class F>
  void each(const char* stage, access uses, F f, bool everywhere = false) {
    pass p{stage, pass::kind::each, std::move(uses), everywhere};
    if constexpr (std::is_invocable_v<F, std::size_t>)
      p.each = [f = std::move(f)](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) f(i);
      };
    else
      p.each = std::move(f);
    list_.push_back(std::move(p));
  }
  // f(row_range), or f(row_range, rows). sees_walls: what stands behind walls is among the neighbours.
  template <class F>
  void sum(const char* stage, access uses, F f, bool sees_walls = true) {
    pass p{stage, pass::kind::sum, std::move(uses), false, sees_walls};
    if constexpr (std::is_invocable_v<F, const pairs::row_range&>)
      p.sum = [f = std::move(f)](const pairs::row_range& r, rows) { f(r); };
    else
      p.sum = std::move(f);
    list_.push_back(std::move(p));
  }
  void walls(const char* stage, access uses, std::function<void()> f) {
    list_.push_back({.stage = stage, .of = pass::kind::walls, .uses = std::move(uses), .once = std::move(f)});
  }
  void whole(const char* stage, access uses, std::function<void()> f) {
    list_.push_back({.stage = stage, .of = pass::kind::whole, .uses = std::move(uses), .once = std::move(f)});
  }

  // ok(i) of the owned particles; else text(i) and the particle's place are a fault.
  template <class Ok, class Text>
  void check(const char* stage, const fields& reads, Ok ok, Text text) {
    whole(stage, {.reads = reads}, [this, ok, text] {
      const auto& s = box_.w.s;
      bool good = true;
#pragma omp parallel for schedule(static) reduction(&& : good) if (s.fluid > foundation::values_worth_threads)
      for (std::size_t i = 0; i < s.fluid; ++i) good = good && ok(i);
      if (good) return;
      for (std::size_t i = 0; i < s.fluid; ++i)
        if (!ok(i)) box_.w.first_fault.report(s.id[i], text(i) + ": " + pairs::describe_position(s, i));
    });
  }

  // Refuses a list that does not fit together, and finds the order of its steps.
  void complete(behind_walls what) {
    known_.images = what == behind_walls::images;
    known_.any_walls = what != behind_walls::nothing;
    known_.name = [this](const field* f) { return name_of(f); };
    steps_ = schedule(list_, known_);
  }
  std::string describe() const { return passes::describe(steps_, list_, known_); }

  // ---- evaluations ------------------------------------------------------------------------

  std::vector<integrators::field> fields() const {
    std::vector<integrators::field> all;
    const auto& s = box_.w.s;
    for (const auto& [f, numbers, about] : states_) {
      integrators::field one{about.name, f ? f->data() : numbers->data(), about.absolute_tolerance, about.scale};
      if (about.common) one.common = *about.common;
      if (about.common_rate) one.common_rate = *about.common_rate;
      if (about.previous_rate) one.previous_rate = about.previous_rate->data();
      if (numbers) one.number = numbers->size();
      for (std::size_t a = 0; a < D; ++a)
        if (f == &s.x[a]) one.velocity = place_of(s.v[a]);
      all.push_back(std::move(one));
    }
    return all;
  }
  // While run() is under way: dy/dt of the k-th integrated field, of the owned particles.
  double* rate(std::size_t k) const { return rates_[k]; }
  std::span<double* const> rates() const { return rates_; }
  // Where rates are kept: the last one of a velocity, m/s², of the owned particles.
  const field& kept_acceleration(std::size_t axis) const { return kept_rate(box_.w.s.v[axis]); }
  const field& kept_rate(const field& of) const { return kept_field(of); }
  field& kept_field(const field& of) const { return *states_[place_of(of)].about.previous_rate; }

  // Collective. Faults go to the workspace, those of earlier passes first.
  void run(std::span<double* const> rates) {
    rates_ = rates;
    auto& fault = box_.w.first_fault;
    const std::int64_t first = fault.stage;
    for (const auto& s : steps_) {
      if (!s.passes.empty()) fault.stage = first + static_cast<std::int64_t>(s.passes.front());
      carry_out(s);
    }
    fault.stage = first + static_cast<std::int64_t>(list_.size());
  }

 private:
  void carry_out(const step& s) {
    using enum step::kind;
    auto& w = box_.w;
    const foundation::stage timed(w.times, s.passes.empty() ? "halo" : list_[s.passes.front()].stage);
    if (s.of == begin_exchange) {
      std::vector<double*> arrays;
      for (field* f : s.fields) arrays.push_back(f->data());
      domain::begin_exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(arrays),
                                s.positions ? &w.s.x : nullptr);
    }
    if (s.of == end_exchange) {
      w.end_fluid();
      if (s.positions && box_.mirrors()) walls::move_images(box_.walls, w.s);
    }
    if (s.of == each) carry_out_each(s);
    if (s.of == sum)
      list_[s.passes.front()].sum(s.which == rows::all        ? w.fluid()
                                  : s.which == rows::interior ? w.interior()
                                                              : w.at_border(),
                                  s.which);
    if (s.of == images) {
      walls::mirrored_fields all;
      for (field* f : s.fields) all.push_back(parity_of(f));
      walls::fill_images(box_.walls, w.s, all);
    }
    if (s.of == once) list_[s.passes.front()].once();
  }
  // One loop, in parts that stay in the cache from one pass to the next.
  void carry_out_each(const step& s) {
    constexpr std::size_t part = 1024;
    const auto& p = box_.w.s;
    const std::size_t first = s.where == step::block::owned    ? 0
                              : s.where == step::block::ghosts ? p.fluid
                                                               : p.first_wall(),
                      last = s.where == step::block::owned    ? p.fluid
                             : s.where == step::block::ghosts ? p.first_wall()
                                                              : p.total();
    const std::size_t n = last - first;
    foundation::for_chunks(n, part, n > foundation::values_worth_threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; at += part)
        for (const std::size_t i : s.passes) list_[i].each(first + at, first + std::min(end, at + part));
    });
  }
  walls::mirrored parity_of(field* f) const {
    for (const auto& known : parities_)
      if (known.values == f) return known;
    return {f};
  }
  std::string name_of(const field* f) const {
    std::string name = "a field that is not among the particles'";
    particles::for_each_field<D>(box_.w.s, [&](const particles::field_info& info, const auto& components) {
      for (std::size_t k = 0; k < components.size(); ++k)
        if (components[k] == f) name = components.size() == 1 ? info.name : fmt::format("{}_{}", info.name, k);
    });
    return name;
  }

  std::size_t place_of(const field& wanted) const {
    const auto found = std::ranges::find(states_, &wanted, [](const auto& state) { return state.values; });
    return static_cast<std::size_t>(found - states_.begin());
  }

  struct state_field {
    field* values;                 // of particles; or
    std::vector<double>* numbers;  // others
    integrated about;
  };
  run::state<D>& box_;
  std::vector<state_field> states_;
  kept kept_rates_ = kept::none;
  known_fields known_;
  walls::mirrored_fields parities_;
  std::vector<pass> list_;
  std::vector<step> steps_;
  std::span<double* const> rates_;
};

}  // namespace tetsuame::passes
