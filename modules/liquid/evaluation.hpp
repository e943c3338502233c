// The right-hand side of a liquid as a list of passes. A program names its modules (scheme_of.hpp):
//
//   volume    how Y and ΔV come about          gradient  the form of the pressure gradient
//   pressure  smoothed or not                  wall      the treatment unless the input says otherwise
//
// and has in this order
//   1  volume     ρ, V and Y of what is carried or summed, and what the equation of state says of them
//   2  walls      velocity, temperature, density and V behind walls; with markers f = ν∇²v + g of the fluid near them
//   3  pressure   Y behind walls, p, ΔV = Y/p; for Hosono's iteration all in one
//   4  walls      pressure behind walls
//   5  gradient   one sum: pressure force, continuity, viscosity, conduction
//   6  rates
// g with the input's forces (sources/fields.hpp).
#pragma once

#include <eos/caloric.hpp>
#include <liquid/rates.hpp>
#include <passes/evaluation.hpp>
#include <volume/density_sum.hpp>
#include <volume/hosono_iteration.hpp>
#include <volume/number_density.hpp>
#include <volume/our_method.hpp>
#include <volume/y_evolution.hpp>

namespace tetsuame::liquid {

// Where the internal energy is integrated: what u = 0 is of it, a field of the particles; 0 before it is known.
inline constexpr const char* start_energy = "StartInternalEnergy";

template <class Program, int D>
class list_of_passes {
 public:
  using volume_module = typename Program::volume;
  static constexpr volume::carries carried = volume_module::carried;
  using tied_continuity = typename continuity_of<typename Program::gradient, D>::type;

  list_of_passes(run::state<D>& of, volume_module& how, const volume::options& o, const volume::pressure_rule& rule)
      : box_(of),
        how_(how),
        smoothing_(o.smoothing),
        consistency_(o.consistency),
        symmetric_(o.stress == "symmetric"),
        rule_(rule) {
    if (!o.energy.internal()) return;
    start_energy_ = &particles::extra(s_, start_energy);
    for (const auto& material : of.w.materials) caloric_.emplace_back(material);
  }

  // The list is not complete yet: others may follow. viscosity_changes: it is written by an earlier pass. rates: the
  // integrated fields that the last pass serves.
  void declare(passes::evaluation<D>& e, const passes::fields& rates, bool viscosity_changes,
               std::function<liquid::rates<D>()> to) {
    const auto out = [this, to = std::move(to)] {
      auto all = to();
      all.heat = heat_.data();
      all.dlnrho = dlnrho_.data();
      return all;
    };
    auto& walls = box_.walls;
    walls.asks_near_no_slip = slip_counts_;
    walls.volume = &V_;
    walls.density = &density_of_walls();
    if (has_markers()) walls.declare_fields(s_);
    e.mirrored(walls::velocity(s_.v));
    e.mirrored(walls::temperature(s_.T));
    e.mirrored(walls::hydrostatic(s_.Y, s_.m, box_.w));
    e.mirrored(walls::hydrostatic(s_.p, s_.rho, box_.w));
    e.given({s_.m, s_.k});
    if (start_energy_ != nullptr) e.remembered({*start_energy_});
    if (!viscosity_changes) e.given({s_.eta});
    transport_ = viscosity_changes ? passes::fields{s_.eta} : passes::fields{};
    declare_volume(e, how_);
    declare_forces(e, rates, out);
  }

 private:
  static constexpr bool iterates = std::is_same_v<volume_module, volume::hosono_iteration>;
  static constexpr bool smooths = std::is_same_v<typename Program::pressure, volume::smoothed>;
  static constexpr bool carries_weight = std::is_same_v<volume_module, volume::y_evolution>;

  bool has_markers() const {
    return std::visit([](auto t) { return decltype(t)::has_markers; }, box_.treatment);
  }
  // Of Y the density follows from the pressure, which the walls come before; tied it is known.
  bool counts_for_walls() const { return carries_weight && !tied_; }
  particles::array& density_of_walls() { return counts_for_walls() ? counted_density_ : s_.rho; }
  // Y = p ΔV has a sense only where p > 0; tied, ΔV = m/ρ and nothing is divided by p.
  bool volumes_by_pressure() const { return smooths && !tied_; }
  passes::fields material() { return {s_.p_eos, s_.K_T, s_.alpha, s_.c_V, s_.c}; }
  // A rule for pressures may ask where a particle is.
  passes::fields with_places(passes::fields reads) {
    if (rule_) reads.add({s_.x});
    return reads;
  }
  volume::wall_context<D> around() { return {box_.treatment, box_.walls, smoothing_, V_, rule_}; }
  void check(passes::evaluation<D>& e, const char* stage, particles::array& values, const char* what,
             const char* unit = "Pa") {
    e.whole(stage, {.reads = {values}},
            [this, &values, what, unit] { volume::require_positive(box_.w, values, what, unit); });
  }

  // ---- volumes ----------------------------------------------------------------------------

  // T of ρ and the internal energy, where that is integrated. The first evaluation of all knows T, and the density that
  // the scheme has of the start.
  void find_temperature(passes::evaluation<D>& e) {
    if (start_energy_ == nullptr) return;
    e.each("volume", {.reads = {s_.rho, s_.u}, .updates = {s_.T, *start_energy_}}, [this](std::size_t i) {
      const auto& material = caloric_[static_cast<std::size_t>(s_.material[i])];
      double& start = (*start_energy_)[i];
      if (start == 0.0)
        start = material.internal_energy(s_.rho[i], s_.T[i]) - s_.u[i];
      else
        s_.T[i] = material.temperature(s_.rho[i], start + s_.u[i]);
    });
  }

  // V = m/ρ, Y = p^ V.
  void weigh_by_density(passes::evaluation<D>& e) {
    find_temperature(e);
    e.each("volume", {.reads = with_places({s_.rho, s_.T, s_.m}), .writes = {V_, s_.Y, material()}},
           [this](std::size_t first, std::size_t last) { volume::weights_by_density(box_.w, V_, first, last, rule_); });
  }
  void volumes_by_number(passes::evaluation<D>& e, particles::array& V, particles::array& density) {
    e.sum("volume", {.writes = {V}}, [this, &V](const pairs::row_range& rows) {
      volume::volumes_by_number(box_.w, rows, box_.w.lattice_sum, V.data());
    });
    e.each("volume", {.reads = {s_.m, V}, .writes = {density}},
           [this, &V, &density](std::size_t i) { density[i] = s_.m[i] / V[i]; });
  }

  void declare_volume(passes::evaluation<D>& e, volume::our_method&) {
    if (tied_) volumes_by_number(e, counted_volume_, counted_density_);
    weigh_by_density(e);
    if (!tied_) check(e, "volume", s_.p_eos, "the equation of state's pressure p");
    walls_and_pressure(e);
  }
  void walls_and_pressure(passes::evaluation<D>& e) {
    if (smooths && has_markers()) return smooth_with_walls(e);
    declare_walls(e);
    find_pressure(e);
  }
  void declare_volume(passes::evaluation<D>& e, volume::number_density&) {
    volumes_by_number(e, V_, s_.rho);
    find_temperature(e);
    e.each("volume", {.reads = with_places({s_.rho, s_.T}), .writes = {material()}},
           [this](std::size_t first, std::size_t last) { volume::equation_of_state(box_.w, first, last, rule_); });
    e.each("volume", {.reads = {s_.p_eos, V_}, .writes = {s_.Y}},
           [this](std::size_t i) { s_.Y[i] = s_.p_eos[i] * V_[i]; });
    declare_walls(e);
    find_pressure(e);
  }
  // The sums' masses: none behind walls.
  void declare_volume(passes::evaluation<D>& e, volume::density_sum&) {
    e.each(
        "volume", {.reads = {s_.m}, .writes = {fluid_mass_}},
        [this](std::size_t i) { fluid_mass_[i] = i < s_.first_wall() ? s_.m[i] : 0.0; }, true);
    e.sum("volume", {.at_neighbours = {fluid_mass_}, .writes = {s_.rho}}, [this](const pairs::row_range& rows) {
      box_.w.sum(rows, volume::mass_sum<D>{fluid_mass_.data(), volume::self_value(box_.w), 1.0 / box_.w.lattice_sum,
                                           s_.rho.data()});
    });
    weigh_by_density(e);
    declare_walls(e);
    find_pressure(e);
  }
  // Volumes and densities by number for the walls' viscous term; the true ones follow from Y.
  void declare_volume(passes::evaluation<D>& e, volume::y_evolution&) {
    if (tied_) return volumes_by_weight(e);
    check(e, "volume", s_.Y, "the weight Y", "J");
    volumes_by_number(e, V_, counted_density_);
    declare_walls(e);
    e.sum("pressure", {.at_neighbours = {s_.Y}, .writes = {s_.p}},
          [this](const pairs::row_range& rows) { volume::smooth_by_lattice(box_.w, smoothing_.normalise, rows); });
    volume_elements(e);
    e.each("volume", {.reads = {s_.m, s_.dV}, .writes = {s_.rho}},
           [this](std::size_t i) { s_.rho[i] = s_.m[i] / s_.dV[i]; });
    e.each("volume", {.reads = with_places({s_.rho, s_.T}), .writes = {material()}},
           [this](std::size_t first, std::size_t last) { volume::equation_of_state(box_.w, first, last, rule_); });
  }
  void volumes_by_weight(passes::evaluation<D>& e) {
    volumes_by_number(e, counted_volume_, counted_density_);
    e.each("volume", {.reads = {s_.Y, s_.T, s_.m, counted_density_}, .writes = {s_.rho}},
           [this](std::size_t first, std::size_t last) {
             volume::density_by_weight(box_.w, counted_density_, first, last);
           });
    check(e, "volume", s_.rho, "the density whose p dV is Y", "kg/m3");
    e.each("volume", {.reads = with_places({s_.rho, s_.T}), .writes = {material()}},
           [this](std::size_t first, std::size_t last) { volume::equation_of_state(box_.w, first, last, rule_); });
    e.each("volume", {.reads = {s_.m, s_.rho}, .writes = {V_}}, [this](std::size_t i) { V_[i] = s_.m[i] / s_.rho[i]; });
    walls_and_pressure(e);
  }
  // The iteration brings what it finds to the ghosts itself.
  void declare_volume(passes::evaluation<D>& e, volume::hosono_iteration&) {
    auto& guess = particles::extra(s_, volume::density_guess);
    e.remembered({guess});
    e.each("volume", {.reads = {guess}, .writes = {s_.rho}}, [this, &guess](std::size_t i) { s_.rho[i] = guess[i]; });
    weigh_by_density(e);
    check(e, "volume", s_.p_eos, "the start value's pressure p");
    declare_walls(e);
    const passes::fields found{s_.rho, s_.Y, V_, material()};
    e.whole("pressure",
            {.at_neighbours = {s_.rho, s_.T, V_, s_.Y, passes::of_gravity(box_)},
             .writes = {s_.p, s_.dV},
             .updates = found,
             .spreads = {s_.p, s_.dV, found}},
            [this] {
              box_.w.agree();
              how_.determine(box_.w, around());
            });
  }

  // ---- pressures --------------------------------------------------------------------------

  void find_pressure(passes::evaluation<D>& e) {
    if constexpr (smooths) {
      e.sum("pressure", {.at_neighbours = {s_.Y, V_}, .writes = {s_.p}},
            [this](const pairs::row_range& rows) { volume::smooth(box_.w, V_, smoothing_.normalise, rows); });
      volume_elements(e);
    } else {
      e.each("pressure", {.reads = {s_.p_eos}, .writes = {s_.p}}, [this](std::size_t i) { s_.p[i] = s_.p_eos[i]; });
    }
  }
  // ΔV = Y/p, for which the smoothed pressure has to be positive; tied, ΔV is there.
  void volume_elements(passes::evaluation<D>& e) {
    if (tied_) return;
    check(e, "pressure", s_.p, "the smoothed pressure p");
    e.each("pressure", {.reads = {s_.Y, s_.p}, .writes = {s_.dV}},
           [this](std::size_t i) { s_.dV[i] = s_.Y[i] / s_.p[i]; });
  }
  // Y is known beforehand: the fluid near markers is summed in one sweep with f, the rest while ghosts travel, and what
  // wall particles add comes at last.
  void smooth_with_walls(passes::evaluation<D>& e) {
    e.sum(
        "pressure", {.at_neighbours = {s_.Y, V_}, .writes = {s_.p}},
        [this](const pairs::row_range&, passes::rows which) {
          const auto& walls = box_.walls;
          if (which != passes::rows::border) volume::smooth(box_.w, V_, smoothing_.normalise, walls.interior_apart);
          if (which != passes::rows::interior) volume::smooth(box_.w, V_, smoothing_.normalise, walls.border_apart);
        },
        false);
    auto uses = kinematics();
    uses.at_neighbours.add({s_.Y});
    uses.updates = {s_.p};
    e.walls("walls", uses, [this] {
      std::visit(
          [this]<class Treatment>(Treatment t) {
            if constexpr (Treatment::has_markers) {
              if (smoothing_.normalise)
                volume::smooth_with_acceleration<D, true>(box_.w, around(), t);
              else
                volume::smooth_with_acceleration<D, false>(box_.w, around(), t);
            }
          },
          box_.treatment);
    });
    weights_of_walls(e);
    e.sum("pressure", {.at_neighbours = {s_.Y}, .updates = {s_.p}},
          [this](const pairs::row_range&, passes::rows which) {
            if (which == passes::rows::interior) return;
            if (smoothing_.normalise)
              volume::smooth_over_walls<D, true>(box_.w, box_.walls);
            else
              volume::smooth_over_walls<D, false>(box_.w, box_.walls);
          });
    volume_elements(e);
  }

  // ---- walls ------------------------------------------------------------------------------

  passes::access kinematics() {
    passes::access uses{.reads = passes::of_gravity(box_),
                        .at_neighbours = {s_.v, s_.T, density_of_walls(), V_, transport_},
                        .gives = {s_.v, s_.T, density_of_walls(), V_, transport_}};
    for (auto* f : box_.walls.f)
      if (f != nullptr) uses.writes.add({*f});
    uses.spreads = uses.writes;
    return uses;
  }
  void declare_walls(passes::evaluation<D>& e) {
    std::visit(
        [&]<class Treatment>(Treatment t) {
          if constexpr (!Treatment::has_particles) return;
          auto uses = kinematics();
          if constexpr (!Treatment::has_markers)
            uses.gives.add(volumes_by_pressure() ? passes::fields{s_.p, s_.dV} : passes::fields{s_.p});
          e.walls("walls", uses, [this, t] {
            t.kinematics(box_.w, box_.walls);
            if (counts_for_walls())  // for snapshots
              std::copy(counted_density_.begin() + static_cast<std::ptrdiff_t>(s_.first_wall()), counted_density_.end(),
                        s_.rho.begin() + static_cast<std::ptrdiff_t>(s_.first_wall()));
          });
        },
        box_.treatment);
    weights_of_walls(e);
  }
  void weights_of_walls(passes::evaluation<D>& e) {
    passes::fields f;
    for (auto* component : box_.walls.f)
      if (component != nullptr) f.add({*component});
    const bool particles = passes::behind<D>(box_) == passes::behind_walls::particles;
    if (particles && !iterates)
      e.walls("walls", {.reads = f, .at_neighbours = {s_.Y}, .gives = {s_.Y}}, [this] { around().weights(box_.w); });
  }

  // ---- forces and rates -------------------------------------------------------------------

  template <class Out>
  void declare_forces(passes::evaluation<D>& e, const passes::fields& rates, const Out& out) {
    if (has_markers())
      e.walls("walls",
              {.at_neighbours = {s_.p, s_.dV},
               .gives = volumes_by_pressure() ? passes::fields{s_.p, s_.dV} : passes::fields{s_.p}},
              [this] { std::visit([this](auto t) { t.pressures(box_.w, box_.walls); }, box_.treatment); });
    e.whole("gradient", {.writes = {heat_}, .accumulates = {s_.v, s_.u}}, [this, out] { begin_forces(box_, out()); });
    e.sum("gradient",
          {.at_neighbours = {s_.v, s_.T, s_.p, s_.dV, s_.eta, s_.k},
           .writes = {dlnrho_},
           .updates = {heat_},
           .accumulates = {s_.v, s_.u}},
          [this, out](const pairs::row_range& rows) {
            if (tied_)
              sum_forces<typename Program::gradient, D, tied_continuity>(box_, out(), rows, symmetric_);
            else
              sum_forces<typename Program::gradient>(box_, out(), rows, symmetric_);
          });
    if (slip_counts_) declare_slip(e);
    if (tied_) tie(e);
    if (tied_ && smooths) smooth_continuity(e);
    passes::access uses{
        .reads = {s_.v, s_.T, s_.rho, s_.p, s_.dV, s_.m, material(), heat_, dlnrho_, passes::of_sources(box_)},
        .rates = rates};
    e.each("rates", uses, [this, out](std::size_t first, std::size_t last) {
      const auto to = out();
      for (std::size_t i = first; i < last; ++i) finish_rates<volume_module>(box_.w, to, i, tied_);
    });
  }

  // What the walls' own places make of continuity, where these are of no slip.
  void declare_slip(passes::evaluation<D>& e) {
    e.walls("gradient", {.at_neighbours = {s_.v, s_.dV}, .updates = {dlnrho_}},
            [this] { walls::add_continuity_of_slip<D, tied_continuity>(box_.w, box_.walls, slip_, s_.dV, dlnrho_); });
  }

  void tie(passes::evaluation<D>& e) {
    e.each("gradient", {.reads = {counted_density_, s_.rho, material()}, .updates = {dlnrho_}},
           [this](std::size_t i) { dlnrho_[i] += volume::tie(box_.w, consistency_.rate, counted_density_[i], i); });
  }
  // Forces of the smoothed pressure do work Σ_i p_i ΔV_i θ_i, θ the sum of continuity. With p_i = Σ_j Y_j W_ij that is
  // Σ_j Y_j (Σ_i ΔV_i θ_i W_ij): what compresses particle j is the smoothed θ, or energy is lost.
  void smooth_continuity(passes::evaluation<D>& e) {
    e.each("gradient", {.reads = {s_.dV, dlnrho_}, .writes = {expansion_}},
           [this](std::size_t i) { expansion_[i] = s_.dV[i] * dlnrho_[i]; });
    if (passes::behind<D>(box_) == passes::behind_walls::particles)
      e.walls("walls", {.at_neighbours = {expansion_}, .gives = {expansion_}},
              [this] { volume::even_behind_walls(box_.w, box_.walls, box_.treatment, expansion_); });
    e.sum("gradient", {.at_neighbours = {expansion_, s_.dV}, .updates = {dlnrho_}},
          [this](const pairs::row_range& rows) {
            volume::smooth(box_.w, expansion_, s_.dV, smoothing_.normalise, rows, dlnrho_);
          });
  }

  particles::array& declare_if(bool needed, const char* name, const char* unit) {
    return particles::declare_if(needed, s_, name, unit, particles::role::derived);
  }

  run::state<D>& box_;
  volume_module& how_;
  const volume::smoothing_options smoothing_;
  const volume::consistency_options consistency_;
  const bool symmetric_;  // viscous stress
  const volume::pressure_rule& rule_;
  const bool tied_ = carried != volume::carries::nothing && consistency_.ties();
  particles::particles<D>& s_ = box_.w.s;
  passes::fields transport_;
  // J/kg, of u = 0; null: T is integrated. The materials by density and energy.
  particles::array* start_energy_ = nullptr;
  std::vector<eos::caloric> caloric_;
  // ΔV itself, where no pressure changes it.
  particles::array& V_ = volumes_by_pressure() ? declare_if(true, "VolumeBeforePressure", "m^D") : s_.dV;
  particles::array& heat_ = declare_if(true, "FrictionHeating", "W");
  particles::array& dlnrho_ = declare_if(true, "LogDensityRate", "1/s");
  particles::array& counted_density_ = declare_if(carries_weight || tied_, "DensityByNumber", "kg/m^3");
  particles::array& counted_volume_ = declare_if(tied_, "VolumeByNumber", "m^D");
  const bool slip_counts_ = tied_ && box_.walls.any_no_slip();
  particles::vector_field<D> slip_ =
      particles::declare_vector_if<D>(slip_counts_, s_, "WallSlip", "m/s", particles::role::derived);
  particles::array& expansion_ = declare_if(tied_ && smooths, "ExpansionRate", "m^D/s");
  particles::array& fluid_mass_ = declare_if(std::is_same_v<volume_module, volume::density_sum>, "FluidMass", "kg");
};

}  // namespace tetsuame::liquid
