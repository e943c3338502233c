// Forces and heat of &sources in an evaluation of the right-hand side: a pass that writes, at the time of the state,
//   a = g + K (m/s2) and J (W/kg)
// for the particles, from which rates take them (pairs::workspace::gravity, ::heating), and walls the weight of what
// stands before them; and what both have supplied since the start, integrated with the state,
//   dw/dt = K·v,  dq/dt = J  (J/kg)
// by which budgets of energy close. What is not given has neither pass nor field.
#pragma once

#include <fmt/format.h>
#include <omp.h>

#include <domain/communicator.hpp>
#include <foundation/agree.hpp>
#include <foundation/exact_sum.hpp>
#include <nlohmann/json.hpp>
#include <passes/evaluation.hpp>
#include <sources/options.hpp>

namespace tetsuame::sources {

template <int D>
class fields {
 public:
  fields() = default;
  fields(const fields&) = delete;  // passes refer to it
  fields& operator=(const fields&) = delete;

  // The fields, and the pass. Before the rules of what stands behind walls and before all passes. Collective: what is
  // not finite at the start's particles is bad input.
  void declare(const all& given, run::state<D>& box, passes::evaluation<D>& e) {
    declare(given, box);
    declare_pass(e);
  }
  // The fields alone.
  void declare(const all& given, run::state<D>& box) {
    if (!given.any()) return;
    box_ = &box;
    given_ = given;
    for (int n = 0; n < omp_get_max_threads(); ++n) of_thread_.push_back(given.another());
    auto& w = box.w;
    if (given.forces()) {
      w.accelerations = particles::declare_vector<D>(w.s, "AccelerationFromOutside", "m/s^2", particles::role::derived);
      w.gravity_varies = true;
    }
    if (given.heats()) w.heating = &particles::declare(w.s, "HeatingFromOutside", "W/kg", particles::role::derived);
    check_start();
  }
  void declare_pass(passes::evaluation<D>& e) {
    if (box_ == nullptr) return;
    auto& w = box_->w;
    const passes::fields written = passes::of_sources(*box_);
    passes::fields read{w.s.x};
    if (given_.by_temperature()) read.add({w.s.T});
    e.each("sources", {.reads = read, .writes = written},
           [this](std::size_t first, std::size_t last) { write(first, last); });
    e.check(
        "sources", written, [this](std::size_t i) { return !not_finite(i); },
        [this](std::size_t i) { return text_of(*not_finite(i)); });
  }

  // Of all that stands behind walls, in its place: bodies and their images carry on what fluid weighs beside them.
  void write_behind_walls() const {
    if (box_ == nullptr) return;
    write(box_->w.s.first_wall(), box_->w.s.total());
  }

  // What they supply is integrated behind all that the problem does. scale: J/kg, by which steps with error control
  // judge it.
  void account(passes::evaluation<D>& e, double scale) {
    if (box_ == nullptr) return;
    auto& w = box_->w;
    if (force()) {
      work_ = &particles::declare(w.s, "WorkOfForces", "J/kg", particles::role::integrated);
      const std::size_t k = e.integrate(*work_, {.name = "work of forces", .scale = scale});
      e.each("rates", {.reads = {w.s.v, w.accelerations}, .rates = {*work_}}, [&w, &e, k](std::size_t i) {
        double power = 0.0;
        for (std::size_t a = 0; a < D; ++a) power += (w.accelerations[a][i] - w.g[a]) * w.s.v[a][i];
        e.rate(k)[i] = power;
      });
    }
    if (heat()) {
      heat_ = &particles::declare(w.s, "HeatSupplied", "J/kg", particles::role::integrated);
      const std::size_t k = e.integrate(*heat_, {.name = "heat supplied", .scale = scale});
      e.each("rates", {.reads = {*w.heating}, .rates = {*heat_}},
             [&w, &e, k](std::size_t i) { e.rate(k)[i] = (*w.heating)[i]; });
    }
  }

  bool force() const { return given_.forces(); }
  bool heat() const { return given_.heats(); }
  // Collective. J (2-D: J/m), of all particles since the start; 0 of what is not given, or not accounted for.
  double work_of_forces() const { return total(work_); }
  double heat_supplied() const { return total(heat_); }
  double supplied() const { return work_of_forces() + heat_supplied(); }

  // Collective. Metrics of what is given.
  void tell(nlohmann::ordered_json& metrics) const {
    if (force()) metrics["work_of_forces"] = work_of_forces();
    if (heat()) metrics["heat_of_sources"] = heat_supplied();
  }

  // m/s2, K along an axis at a place and a temperature where no particle is, at the time of the state; on any thread.
  double force_at(std::size_t axis, const std::array<double, 3>& x, double temperature = 0.0) const {
    return force() ? mine().at(axis, x, 0.0, temperature, box_->state_time) : 0.0;
  }

 private:
  static constexpr std::size_t J = all::heat;

  const all& mine() const { return of_thread_[static_cast<std::size_t>(omp_get_thread_num())]; }
  double value(const all& by, std::size_t component, std::size_t i) const {
    const auto& s = box_->w.s;
    std::array<double, 3> x{};
    for (std::size_t a = 0; a < D; ++a) {
      const double L = box_->w.d.region.length[a];
      x[a] = s.x[a][i];
      if (box_->w.d.region.periodic[a] && !(x[a] >= 0.0 && x[a] < L)) x[a] -= L * std::floor(x[a] / L);
    }
    return by.at(component, x, s.material[i], s.T[i], box_->state_time);
  }
  // to[i] = of_all + the component.
  void fill(const all& by, std::size_t component, double of_all, particles::array& to, std::size_t first,
            std::size_t last) const {
    if (first == last) return;
    if (by.uniform(component)) {
      const double everywhere = of_all + by.at(component, {}, 0.0, 0.0, box_->state_time);
      for (std::size_t i = first; i < last; ++i) to[i] = everywhere;
    } else {
      for (std::size_t i = first; i < last; ++i) to[i] = of_all + value(by, component, i);
    }
  }
  void write(std::size_t first, std::size_t last) const {
    const auto& w = box_->w;
    const all& by = mine();
    for (std::size_t a = 0; a < D && force(); ++a) fill(by, a, w.g[a], w.accelerations[a], first, last);
    if (heat()) fill(by, J, 0.0, *w.heating, first, last);
  }

  // The component.
  std::optional<std::size_t> not_finite(std::size_t i) const {
    const auto& w = box_->w;
    for (std::size_t a = 0; a < D && force(); ++a)
      if (!std::isfinite(w.accelerations[a][i])) return a;
    if (heat() && !std::isfinite((*w.heating)[i])) return J;
    return {};
  }
  std::string text_of(std::size_t component) const {
    return fmt::format("{} is not finite at t = {:.6g} s", given_.describe(component), box_->state_time);
  }
  void check_start() const {
    const auto& s = box_->w.s;
    std::string fault;
    for (std::size_t i = 0; i < s.fluid && fault.empty(); ++i)
      for (std::size_t k = 0; k < all::number && fault.empty(); ++k)
        if (given_.gives(k) && !std::isfinite(value(given_, k, i)))
          fault = text_of(k) + ": " + pairs::describe_position(s, i);
    foundation::agree(box_->w.d.ranks.comm, fault, foundation::exit_status::bad_input);
  }

  double total(const particles::array* of) const {
    if (of == nullptr) return 0.0;
    const auto& s = box_->w.s;
    foundation::exact_sum sum;
    for (std::size_t i = 0; i < s.fluid; ++i) sum.add(s.m[i] * (*of)[i]);
    return box_->w.d.ranks.exact(sum);
  }

  run::state<D>* box_ = nullptr;
  all given_;
  std::vector<all> of_thread_;
  particles::array *work_ = nullptr, *heat_ = nullptr;
};

}  // namespace tetsuame::sources
