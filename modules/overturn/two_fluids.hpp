// Two fluids of different density under gravity, compressible and viscous, in a box: metal over silicate, or a drop.
//
//   dx/dt = v,   m dv/dt = pressure + viscosity (terms.hpp) + m g
//   volume number_density [after Hu & Adams 2006]:  ΔV_i = s/Σ_j W_ij,  ρ = m/ΔV;  s: the sum over the start lattice
//     With pattern 1 and p = p̂ the pressure force is -∂U/∂x_i of U = Σ m u(ρ), walls that mirror included: no energy
//     is made or lost between fluid particles, and no density drifts. p <= 0 is harmless: nothing is divided by p.
//   reference pressure p_r(y) = ρ_l g (L_y - y), ρ_l the lightest density: p - p_r in the forces, and -ΔV ∇p_r.
//     The potential is then U + Σ p_r ΔV; the sum stands for an integral over the box, a constant, and so does nothing
//     but on a lattice, which is elastic in proportion to its pressure (docs/theory/kernels.md): now to p - p_r. That
//     is not negative, wherever the two fluids lie: under tension a lattice is unstable.
//   volume our_method [S0]:  ρ by continuity, with δ-SPH on the dynamic pressure (δ = 0: the notes' programs)
//   pressure: p̂, or Σ Y W, normalised or not;  ΔV in the forces: the volume's own, or Y/p
//   temperature: constant, or dT/dt = γ_th T dlnρ/dt + (friction + conduction)/(m c_V);
//     or out of the heat content, dh/dt = (friction + conduction)/m, with which material 0 melts (melting/enthalpy.hpp)
//   surface tension between the materials: surface_tension.hpp
//   variable inertia: where η is above η_x, ξ² dv/dt = forces/m with ξ² = η/η_x (docs/theory/relaxation.md). Creeping
//     flow is the same, and viscosity asks for the steps of η_x.
//
// Walls are mirror images (images/images.hpp) of the same volume; behind floor and lid p goes on with ρ g. No-slip
// images have the reversed velocity. The mirror in two sides stands behind a corner.
//
// Starts: every particle of the same volume, mass by the column at rest (column.hpp).
#pragma once

#include <algorithm>
#include <diffusion/conduction.hpp>
#include <images/scene.hpp>
#include <march/problem.hpp>
#include <output/columns.hpp>
#include <overturn/growth.hpp>
#include <overturn/lattice.hpp>
#include <overturn/options.hpp>
#include <overturn/surface_tension.hpp>
#include <simulation/state.hpp>
#include <theory/radial_exchange.hpp>
#include <volume/shape.hpp>

namespace tetsuame::overturn {

// A measure over time: lines of history that the summary looks back on.
struct record {
  std::vector<double> time, mode, centroid, fall;          // s; m; m; m/s
  std::vector<double> stretch;                             // of a drop: 1
  std::vector<double> bodies, largest_body;                // of metal (find_bodies); share of it
  std::vector<double> in_metal, partition, equilibration;  // of an element: means over the metal; 0 to 1
};

template <int D>
class two_fluids : public march::problem {
 public:
  two_fluids(problem_kind kind, const options& o, const parameters& p) : kind_(kind), o_(o), p_(p) {
    auto& w = world_.w;
    auto& s = w.s;
    s.extras.push_back(
        {"Dissipated", "J/kg", "specific heat of friction since the start", particles::role::integrated, {}});
    s.extras.push_back({"StartDensity", "kg/m^3", "density at the start, at rest", particles::role::constant, {}});
    s.extras.push_back({"StartTemperature", "K", "temperature at the start", particles::role::constant, {}});
    enthalpy_ = o.temperature_law == "enthalpy";
    melts_ = o.melting.curve != "none";
    if (enthalpy_) {
      heat_at_ = s.extras.size();
      s.extras.push_back({"Enthalpy", "J/kg", "heat content, c T and latent", particles::role::integrated, {}});
      s.extras.push_back({"StartEnthalpy", "J/kg", "that of the start", particles::role::constant, {}});
    }
    if (o.element.name != "none") {
      dissolved_ = true;
      element_at_ = s.extras.size();
      s.extras.push_back({"Concentration", "1", "of the element, amount per mass", particles::role::integrated, {}});
    }
    s.keeps_start = true;
    const auto& d = o.domain;
    images::options walls;
    walls.slip = o.walls.sides;
    walls.sides[2].slip = o.walls.floor;
    walls.sides[3].slip = o.walls.lid == "free_surface" ? "free_slip" : o.walls.lid;
    const std::array<bool, 3> periodic{d.periodic[0], false, d.periodic[2]};
    images::set_up(world_, domain::communicator::world(), {d.length, d.particles, periodic, d.ranks_x}, walls,
                   o.march.kernel.name, o.march.kernel.h_over_dx, o.march.kernel.skin, 0.0, 0.0);
    if (o.walls.lid == "free_surface")
      std::erase_if(world_.images.sides, [](const auto& side) { return side.axis == 1 && side.inward < 0.0; });
    w.materials = {(*p.material)[0], (*p.material)[1]};
    w.g[1] = -o.gravity;
    carried_ = o.scheme.volume == "our_method";
    smoothed_ = o.scheme.pressure == "smoothed";
    first_pattern_ = o.scheme.gradient == "pattern_1";
    from_weight_ = o.scheme.volume_element == "from_weight";
    warms_ = o.temperature_law == "adiabatic";
    self_ = std::visit([](const auto& k) { return k.self(); }, w.kernel);
    h_ = o.march.kernel.h_over_dx * w.dx;
    tense_ = o.surface_tension > 0.0;
    place_fluid();
    if (o.scheme.reference_pressure == "lightest") {
      double lightest = std::numeric_limits<double>::infinity();
      for (const std::size_t n : {0, 1}) lightest = std::min(lightest, on_curve(n, o.p_top).density);
      reference_slope_ = -o.gravity * lightest;
      reference_floor_ = -reference_slope_ * d.length[1];
    }
    limit_ = limit();
  }

  const domain::communicator& ranks() const override { return world_.w.d.ranks; }
  std::size_t local_particles() const override { return world_.w.s.fluid; }
  std::size_t simd_lanes() const override { return pairs::lanes; }
  output::snapshot_header header() const override { return images::snapshot_header(world_); }
  std::vector<std::string> about() const override { return p_.lines; }

  std::vector<integrators::field> fields() override {
    auto& s = world_.w.s;
    constexpr std::array<const char*, 3> axis{"x", "y", "z"};
    const double fast = 1e-2 * fastest_sound_;
    std::vector<integrators::field> all;
    for (std::size_t a = 0; a < D; ++a) all.push_back({axis[a], s.x[a].data(), 0.0, world_.w.dx});
    for (std::size_t a = 0; a < D; ++a) all.push_back({std::string("v") + axis[a], s.v[a].data(), 0.0, fast});
    all.push_back({"u", s.u.data(), 0.0, fast * fast});
    all.push_back({"q", dissipated().data(), 0.0, fast * fast});
    if (carried_) all.push_back({"rho", s.rho.data(), 0.0, p_.base->at(0.0).density});
    if (warms_) all.push_back({"T", s.T.data(), 0.0, o_.temperature});
    if (dissolved_)
      all.push_back(
          {"c", element().data(), 0.0, std::max(o_.element.concentration_silicate, o_.element.concentration_metal)});
    if (enthalpy_) all.push_back({"h", content().data(), 0.0, 1e3 * o_.temperature});
    return all;
  }

  // ---- right-hand side --------------------------------------------------------------------

  void evaluate(std::span<double* const> rate) override {
    refresh_motion();
    find_volumes();
    if (enthalpy_) find_phases();
    if (dissolved_) find_partition();
    if (tense_) find_tension();
    find_pressures();
    sum_over_neighbours();
    combine(rate);
    world_.w.agree();
  }

  integrators::step_limit largest_step() override { return limit_; }
  double diffusion_radius() override { return radius_; }

  bool complete_step() override {
    const std::int64_t crossings = ranks().sum(images::reflect(world_.images, world_.w.s));
    crossings_ += crossings;
    return crossings > 0;
  }

  // From one line of the history to the next, as far as the run goes on: the same lines in a continued run.
  std::string refine(double) override {
    const bool fell = dissipated_now_ < dissipated_most_ * (1.0 - 1e-6);
    dissipated_most_ = std::max(dissipated_most_, dissipated_now_);
    if (!fell || !fourth_order()) return {};
    take_second_order();
    return "the energy dissipated fell: the viscous sum is of second order from here on";
  }

  double moved() override { return images::moved_since_lists(world_); }
  double allowance() const override { return 0.5 * world_.skin; }
  double speed() override {
    const auto& s = world_.w.s;
    double v2 = 0.0;
    for (std::size_t i = 0; i < s.fluid; ++i) v2 = std::max(v2, speed2(i));
    return std::sqrt(ranks().maximum(v2));
  }

  void rebuild(bool as_they_were) override {
    auto& w = world_.w;
    auto& s = w.s;
    images::rebuild(world_, as_they_were);
    w.exchange_fluid({s.m.data()});
    for (std::size_t i = 0; i < s.total(); ++i) {
      const auto& m = o_.material[static_cast<std::size_t>(s.material[i])];
      s.eta[i] = m.viscosity;
      s.k[i] = o_.conductivity;
    }
    for (auto* all : scratch())
      if (all->size() < s.total() + 1) all->resize(s.total() + 1);
    if (tense_)
      for (std::size_t i = 0; i < s.total(); ++i) metal_[i] = s.material[i] == 1 ? 1.0 : 0.0;
    stress_[s.null()] = factor_[s.null()] = squared_volume_[s.null()] = 0.0;
    partition_[s.null()] = 1.0;
  }

  // ---- measures ---------------------------------------------------------------------------

  std::vector<output::history_column> columns() const override {
    const std::string J = D == 2 ? "J/m" : "J";
    std::vector<output::history_column> all{{"centroid", "1"},
                                            {"v_rms", "m/s"},
                                            {"kinetic", J},
                                            {"potential", J},
                                            {"elastic", J},
                                            {"dissipated", J},
                                            {"thermal", J},
                                            {"energy_residual", "1"},
                                            {"mode_amplitude", "m"},
                                            {"fall_velocity", "m/s"},
                                            {"density_ratio_min", "1"},
                                            {"density_ratio_max", "1"},
                                            {"pressure_min", "Pa"}};
    if (tense_) all.push_back({"surface", J});
    if (kind_ == problem_kind::drop) {
      if (!many()) all.push_back({"stretch", "1"});
      all.push_back({"bodies", "1"});
      all.push_back({"largest_body", "1"});
    }
    if (tense_ && kind_ == problem_kind::drop) all.push_back({"laplace_pressure", "Pa"});
    if (dissolved_)
      for (const char* name : {"element", "concentration_metal", "partition_coefficient", "equilibration"})
        all.push_back({name, name == std::string("element") ? (D == 2 ? "kg/m" : "kg") : "1"});
    if (enthalpy_)
      for (const auto& [name, unit] : {std::pair{"heat", J.c_str()},
                                       {"heat_residual", "1"},
                                       {"melt_fraction", "1"},
                                       {"metal_depth", "m"},
                                       {"metal_below", "1"}})
        all.push_back({name, unit});
    return all;
  }

  std::vector<double> row(double t) override {
    const auto& s = world_.w.s;
    foundation::exact_sum kinetic, mass, potential, elastic, heat, thermal, volume, squares, metal_mass, metal_y,
        metal_volume, metal_v, shape, shape2, amount, in_metal, partition, content_gain, exchanged, melt, lower_mass,
        metal_below, surface, along, across, inside, inside_p, outside, outside_p;
    const double y_drop = kind_ == problem_kind::drop ? centre_of_metal() : 0.0;
    double fastest2 = 0.0;
    double metal_low = o_.domain.length[1];
    double low = std::numeric_limits<double>::infinity(), high = 0.0, p_low = low;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double v2 = speed2(i), V = s.m[i] / s.rho[i];
      fastest2 = std::max(fastest2, v2 / (s.c[i] * s.c[i]));
      mass.add(s.m[i]);
      kinetic.add(0.5 * s.m[i] * inertia_of(i) * v2);
      potential.add(s.m[i] * o_.gravity * s.x[1][i]);
      elastic.add(s.m[i] * (warms_ ? s.u[i] : elastic_energy(i)) + reference_pressure(s.x[1][i]) * V);
      heat.add(s.m[i] * dissipated()[i]);
      thermal.add(s.m[i] * s.c_V[i] * (s.T[i] - T_start(i)));
      volume.add(V);
      squares.add(V * v2);
      if (dissolved_) {
        amount.add(s.m[i] * element()[i]);
        if (is_metal(i)) {
          in_metal.add(s.m[i] * element()[i]);
          partition.add(s.m[i] * partition_[i]);
        }
      }
      if (tense_) {
        surface.add(o_.surface_tension * V * area_[i]);
        // Out of reach of the other material: what is above the column at rest.
        if (area_[i] == 0.0) {
          const double excess = V * (s.p_eos[i] - p_.base->at(s.x[1][i]).pressure);
          (is_metal(i) ? inside : outside).add(V);
          (is_metal(i) ? inside_p : outside_p).add(excess);
        }
      }
      if (kind_ == problem_kind::drop && !many() && is_metal(i)) {
        double x = s.x[0][i] - *o_.centre[0];
        if (o_.domain.periodic[0]) x = std::remainder(x, o_.domain.length[0]);
        across.add(s.m[i] * x * x);
        along.add(s.m[i] * (s.x[1][i] - y_drop) * (s.x[1][i] - y_drop));
      }
      if (is_metal(i)) {
        metal_mass.add(s.m[i]);
        metal_y.add(s.m[i] * s.x[1][i]);
        metal_volume.add(V);
        metal_v.add(-V * s.v[1][i]);
        metal_low = std::min(metal_low, s.x[1][i]);
        metal_below.add(s.x[1][i] < p_.interface ? s.m[i] : 0.0);
      }
      if (enthalpy_) {
        // What the temperature and the melt that the run shows hold, not what was integrated.
        const double gain = s.m[i] * (s.c_V[i] * s.T[i] + latent(i) * melt_[i] - content_start()[i]);
        content_gain.add(gain);
        exchanged.add(std::abs(gain));
        if (!is_metal(i)) {
          lower_mass.add(s.m[i]);
          melt.add(s.m[i] * melt_[i]);
        }
      }
      low = std::min(low, s.rho[i] / rho_start()[i]);
      high = std::max(high, s.rho[i] / rho_start()[i]);
      p_low = std::min(p_low, s.p_eos[i]);
      if (p_.mode) {
        std::array<double, D> lattice;
        for (std::size_t a = 0; a < D; ++a) lattice[a] = s.x_start[a][i];
        const auto m = mode_at(lattice);
        for (std::size_t a = 0; a < D; ++a) {
          shape.add(s.m[i] * m[a] * (s.x[a][i] - lattice[a]));
          shape2.add(s.m[i] * m[a] * m[a]);
        }
      }
    }
    const auto total = [&](const foundation::exact_sum& sum) { return ranks().exact(sum); };
    const double E[] = {total(kinetic), total(potential), total(elastic) - reference_integral(), total(heat)};
    surface_ = tense_ ? total(surface) : 0.0;
    const double energy = E[0] + E[1] + E[2] + E[3] + surface_;
    if (!energy_start_) {
      energy_start_ = energy;
      mass_start_ = total(mass);
    }
    dissipated_now_ = E[3];
    mass_drift_ = total(mass) / mass_start_ - 1.0;
    const double residual = (energy - *energy_start_) / energy_scale();
    residual_ = residual;
    residual_max_ = std::max(residual_max_, std::abs(residual));
    v_rms_ = std::sqrt(total(squares) / total(volume));
    if (v_rms_ > v_rms_max_) {
      v_rms_max_ = v_rms_;
      v_rms_max_time_ = t;
    }
    const double y = total(metal_y) / total(metal_mass), fall = total(metal_v) / total(metal_volume);
    density_min_ = std::min(density_min_, ranks().minimum(low));
    density_max_ = std::max(density_max_, ranks().maximum(high));
    pressure_min_ = std::min(pressure_min_, ranks().minimum(p_low));
    mach_max_ = std::max(mach_max_, std::sqrt(ranks().maximum(fastest2)));
    const double amplitude = p_.mode ? total(shape) / total(shape2) : 0.0;
    record_.time.push_back(t);
    record_.mode.push_back(amplitude);
    record_.centroid.push_back(y);
    record_.fall.push_back(fall);
    const double all_mass = total(mass), metal = total(metal_mass);
    std::vector<double> values{y / o_.domain.length[1],
                               v_rms_,
                               E[0],
                               E[1],
                               E[2],
                               E[3],
                               total(thermal),
                               residual,
                               amplitude,
                               fall,
                               ranks().minimum(low),
                               ranks().maximum(high),
                               ranks().minimum(p_low)};
    if (tense_) values.push_back(surface_);
    if (kind_ == problem_kind::drop) {
      if (!many()) {
        const double a = total(along), b = total(across);
        record_.stretch.push_back((a - b) / (a + b));
        values.push_back(record_.stretch.back());
      }
      find_bodies();
      values.push_back(record_.bodies.back());
      values.push_back(record_.largest_body.back());
      drop_volume_ = total(metal_volume) / static_cast<double>(p_.places.size());
      if (!fraction_start_) fraction_start_ = total(metal_volume) / total(volume);
      if (tense_) {
        laplace_pressure_ = total(inside_p) / total(inside) - total(outside_p) / total(outside);
        values.push_back(laplace_pressure_);
      }
    }
    if (dissolved_) {
      const double there = total(amount), c = total(in_metal) / metal, P = total(partition) / metal;
      if (!element_start_) {
        element_start_ = there;
        metal_start_ = {metal, total(metal_volume), all_mass, total(volume)};
      }
      element_error_ = std::max(element_error_, std::abs(there / *element_start_ - 1.0));
      for (const auto& [a, value] :
           {std::pair{&record_.in_metal, c}, {&record_.partition, P}, {&record_.equilibration, equilibration(c, P)}})
        a->push_back(value);
      for (const double v : {there, c, P, record_.equilibration.back()}) values.push_back(v);
    }
    if (enthalpy_) {
      const double gain = total(content_gain), moved = total(exchanged);
      heat_residual_ = moved > 0.0 ? (gain - E[3]) / moved : 0.0;
      melt_fraction_ = total(melt) / total(lower_mass);
      metal_depth_ = p_.interface - ranks().minimum(metal_low);
      metal_below_ = total(metal_below) / total(metal_mass);
      for (const double v : {gain, heat_residual_, melt_fraction_, metal_depth_, metal_below_}) values.push_back(v);
    }
    return values;
  }

  std::vector<output::particle_group> snapshot(std::vector<particles::array>& extra) override {
    const auto& s = world_.w.s;
    auto g = output::fluid_in_motion(s);
    extra.assign(1, particles::array(s.fluid));
    for (std::size_t i = 0; i < s.fluid; ++i) extra[0][i] = is_metal(i) ? 1.0 : 0.0;
    const auto add = [&](const char* name, const char* unit, const char* about, const particles::array& a) {
      g.columns.push_back({name, unit, about, {a.data()}, false});
    };
    add("Masses", D == 2 ? "kg/m" : "kg", "mass", s.m);
    add("Density", "kg/m^3", "mass density", s.rho);
    add("Pressure", "Pa", "pressure in the forces", s.p);
    add("Temperature", "K", "temperature", s.T);
    add("Volume", D == 2 ? "m^2" : "m^3", "volume element", s.dV);
    add("Metal", "1", "1: the denser material of the start, or the drop", extra[0]);
    add("DensityReference", "kg/m^3", "density at the start, at rest", rho_start());
    if (dissolved_) add("Concentration", "1", "of the element, amount per mass", element());
    if (enthalpy_) {
      add("Viscosity", "Pa s", "dynamic viscosity", s.eta);
      add("MeltFraction", "1", "liquid part of the lower material; 0 in the metal", melt_);
    }
    return {g};
  }

  void report(double, simulation::summary& r) override {
    auto& j = r.metrics;
    const double L = o_.domain.length[1];
    const auto or_null = [](const std::optional<double>& v) {
      return v ? nlohmann::ordered_json(*v) : nlohmann::ordered_json(nullptr);
    };
    if (kind_ == problem_kind::rayleigh_taylor) {
      // Linear: less than 0.03 wavelengths high; the start has gone by a fifth.
      const double most = p_.mode ? 0.03 * 2.0 * std::numbers::pi / p_.mode->k / record_.mode.front() : 0.0;
      const auto fit = p_.mode ? fit_growth(record_.time, record_.mode, 1.2, std::min(20.0, most)) : std::nullopt;
      j["growth_rate"] = fit ? nlohmann::ordered_json(fit->rate) : nlohmann::ordered_json(nullptr);
      j["growth_rate_uncertainty"] = fit ? nlohmann::ordered_json(fit->uncertainty) : nlohmann::ordered_json(nullptr);
      j["growth_rate_theory"] = or_null(p_.growth);
      j["growth_rate_incompressible"] = or_null(p_.growth_incompressible);
      j["mode_amplitude"] = record_.mode.back();
    } else {
      const auto fall_measured = many() ? fall_between() : fall_at(o_.measure_at * L);
      j["fall_velocity"] = or_null(fall_measured);
      j["fall_velocity_theory"] = or_null(p_.theory_fall);
      if (many()) {
        j["fall_velocity_alone"] = or_null(p_.fall_alone);
        j["fall_velocity_array"] = or_null(p_.fall_array);
        j["hindered_settling_factor"] = or_null(p_.hindered);
        j["volume_fraction"] = *fraction_start_;
        j["bodies_start"] = record_.bodies.front();
      } else {
        j["stretch"] = record_.stretch.back();
      }
      j["bodies"] = record_.bodies.back();
      j["largest_body"] = record_.largest_body.back();
      if (tense_) {
        const auto number_or_null = [](double v) {
          return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr);
        };
        const double radius = o_.radius, fall = fall_measured.value_or(record_.fall.back());
        const double rho = p_.base->at(o_.measure_at * L).density;
        j["laplace_pressure"] = number_or_null(laplace_pressure_);
        j["laplace_pressure_theory"] = (D - 1) * o_.surface_tension / radius_by_volume();
        if (!many()) {
          j["oscillation_period"] = or_null(oscillation_period());
          j["oscillation_period_theory"] = p_.oscillation_period;
        }
        j["bond_number"] = p_.bond_number;
        j["weber_number"] = rho * fall * fall * 2.0 * radius / o_.surface_tension;
        j["reynolds_number"] = rho * std::abs(fall) * 2.0 * radius / o_.material[0].viscosity;
        j["surface_excess"] = surface_ / (o_.surface_tension * number_of_drops() * round_surface(radius_by_volume()));
      }
    }
    j["metal_centroid"] = record_.centroid.back() / L;
    for (const double fall : {0.1, 0.2, 0.3})
      j["time_of_fall_" + fmt::format("{:.1f}", fall)] = or_null(time_of_fall(fall * L));
    j["viscous_order"] = fourth_order() ? 4 : 2;
    j["v_rms"] = v_rms_;
    j["v_rms_max"] = v_rms_max_;
    j["v_rms_max_time"] = v_rms_max_time_;
    j["mach_max"] = mach_max_;
    j["energy_residual"] = residual_;
    j["energy_residual_max"] = residual_max_;
    j["density_ratio_min"] = density_min_;
    j["density_ratio_max"] = density_max_;
    j["pressure_min"] = pressure_min_;
    if (dissolved_) {
      j["element_mass_error"] = element_error_;
      j["concentration_metal"] = record_.in_metal.back();
      j["partition_coefficient"] = record_.partition.back();
      j["equilibration"] = record_.equilibration.back();
      j["equilibration_time"] = or_null(when_equilibrated(record_.equilibration));
      if (kind_ == problem_kind::drop && metal_start_[0] > 0.0) {
        const auto reference = equilibration_at_rest();
        j["equilibration_reference"] = reference.back();
        j["equilibration_time_reference"] = or_null(when_equilibrated(reference));
      }
    }
    if (enthalpy_) {
      j["melt_fraction"] = melt_fraction_;
      j["melt_fraction_conducted"] = or_null(p_.melt_conducted);
      j["heat_residual"] = heat_residual_;
      j["metal_depth"] = metal_depth_;
      j["metal_below"] = metal_below_;
    }
    j["wall_crossings"] = crossings_;
    j["particles_lost"] = world_.fluid_total - ranks().sum(static_cast<std::int64_t>(world_.w.s.fluid));
    j["spurious_shear_modulus"] = p_.spurious_modulus;
    j["neighbours"] = static_cast<double>(ranks().sum(static_cast<std::int64_t>(world_.w.list.pairs))) /
                      static_cast<double>(world_.fluid_total);
    r.conservation = {{"mass", mass_drift_}, {"momentum", nullptr}, {"energy", residual_}};
    r.stages = world_.w.times.seconds();
  }

  std::string hash() override {
    const auto& s = world_.w.s;
    output::particle_group g{0, s.fluid, s.id.data(), {}};
    const auto add = [&](const particles::array& a) { g.columns.push_back({"", "", "", {a.data()}, false}); };
    for (const auto& a : s.x) add(a);
    for (const auto& a : s.v) add(a);
    add(s.T);
    add(s.u);
    add(dissipated());
    add(s.m);
    if (carried_) add(s.rho);
    if (enthalpy_) add(content());
    if (dissolved_) add(element());
    return output::state_hash(ranks().comm, {g});
  }

  output::table_view particles_table(std::vector<std::int64_t>& materials) override {
    return simulation::checkpoint_table(world_.w.s, materials);
  }
  void read_particles(const output::table& t) override { simulation::fluid_from_checkpoint(t, world_.w.s); }
  void save(output::checkpoint_globals& g) const override {
    g.integers["wall_crossings"] = crossings_;
    g.blobs["time"] = record_.time;
    g.blobs["mode"] = record_.mode;
    g.blobs["centroid"] = record_.centroid;
    g.blobs["fall"] = record_.fall;
    g.blobs["stretch"] = record_.stretch;
    g.blobs["bodies"] = record_.bodies;
    g.blobs["largest_body"] = record_.largest_body;
    if (dissolved_) {
      g.blobs["in_metal"] = record_.in_metal;
      g.blobs["partition"] = record_.partition;
      g.blobs["equilibration"] = record_.equilibration;
      g.blobs["element"] = {element_start_.value_or(0.0),
                            element_error_,
                            metal_start_[0],
                            metal_start_[1],
                            metal_start_[2],
                            metal_start_[3]};
    }
    g.blobs["measures"] = {energy_start_.value_or(0.0),
                           residual_,
                           residual_max_,
                           v_rms_,
                           v_rms_max_,
                           v_rms_max_time_,
                           density_min_,
                           density_max_,
                           pressure_min_,
                           mass_start_,
                           mass_drift_,
                           heat_residual_,
                           melt_fraction_,
                           metal_depth_,
                           metal_below_,
                           dissipated_now_,
                           dissipated_most_,
                           mach_max_,
                           surface_,
                           drop_volume_,
                           laplace_pressure_,
                           fraction_start_.value_or(0.0),
                           second_order_ ? 1.0 : 0.0};
  }
  void restore(const output::checkpoint_globals& g) override {
    crossings_ = g.integers.at("wall_crossings");
    record_ = {g.blobs.at("time"),
               g.blobs.at("mode"),
               g.blobs.at("centroid"),
               g.blobs.at("fall"),
               g.blobs.at("stretch"),
               g.blobs.at("bodies"),
               g.blobs.at("largest_body"),
               {},
               {},
               {}};
    if (dissolved_) {
      record_.in_metal = g.blobs.at("in_metal");
      record_.partition = g.blobs.at("partition");
      record_.equilibration = g.blobs.at("equilibration");
      const auto& e = g.blobs.at("element");
      element_start_ = e[0];
      element_error_ = e[1];
      metal_start_ = {e[2], e[3], e[4], e[5]};
    }
    const auto& m = g.blobs.at("measures");
    energy_start_ = m[0];
    std::array<double*, 20> to{&residual_,        &residual_max_,  &v_rms_,        &v_rms_max_,   &v_rms_max_time_,
                               &density_min_,     &density_max_,   &pressure_min_, &mass_start_,  &mass_drift_,
                               &heat_residual_,   &melt_fraction_, &metal_depth_,  &metal_below_, &dissipated_now_,
                               &dissipated_most_, &mach_max_,      &surface_,      &drop_volume_, &laplace_pressure_};
    for (std::size_t k = 0; k < to.size(); ++k) *to[k] = m[k + 1];
    if (kind_ == problem_kind::drop) fraction_start_ = m[to.size() + 1];
    if (m[to.size() + 2] != 0.0) take_second_order();
  }

 private:
  particles::array& dissipated() { return world_.w.s.extras[0].values; }
  const particles::array& dissipated() const { return world_.w.s.extras[0].values; }
  bool is_metal(std::size_t i) const { return world_.w.s.material[i] == 1; }
  double speed2(std::size_t i) const {
    double v2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) v2 += world_.w.s.v[a][i] * world_.w.s.v[a][i];
    return v2;
  }
  particles::array& rho_start() { return world_.w.s.extras[1].values; }
  const particles::array& rho_start() const { return world_.w.s.extras[1].values; }
  double T_start(std::size_t i) const { return world_.w.s.extras[2].values[i]; }
  particles::array& content() { return world_.w.s.extras[heat_at_].values; }
  const particles::array& content() const { return world_.w.s.extras[heat_at_].values; }
  particles::array& content_start() { return world_.w.s.extras[heat_at_ + 1].values; }
  const particles::array& content_start() const { return world_.w.s.extras[heat_at_ + 1].values; }
  particles::array& element() { return world_.w.s.extras[element_at_].values; }
  const particles::array& element() const { return world_.w.s.extras[element_at_].values; }
  double inertia_of(std::size_t i) const { return enthalpy_ ? inertia_[i] : 1.0; }
  double latent(std::size_t i) const { return melts_ && !is_metal(i) ? o_.melting.latent_heat : 0.0; }
  melting::heat_content contents(std::size_t i, double p) const {
    if (!melts_ || is_metal(i)) return {world_.w.s.c_V[i], 0.0};
    const auto [T_s, T_l] = melting_range(o_.melting, p);
    return {world_.w.s.c_V[i], o_.melting.latent_heat, T_s, T_l};
  }

  // ---- start ------------------------------------------------------------------------------

  // Of the growing mode with unit amplitude: displacement (m/m) of the particle that rests at x.
  std::array<double, D> mode_at(const std::array<double, D>& x) const {
    const auto m = theory::at(*p_.mode, x[1] - p_.interface);
    const double k = p_.mode->k, z = D == 3 ? x[2 % D] : 0.0;
    const double cx = std::cos(p_.k_x * x[0]), sx = std::sin(p_.k_x * x[0]);
    const double cz = std::cos(p_.k_z * z), sz = std::sin(p_.k_z * z);
    std::array<double, D> u;
    u[0] = m.displacement_x * p_.k_x / k * sx * cz;
    u[1] = m.displacement_y * cx * cz;
    if (D == 3) u[2 % D] = m.displacement_x * p_.k_z / k * cx * sz;
    return u;
  }

  // Where the growing mode takes what rests at x, followed along its field in four Runge-Kutta steps: a displacement by
  // amplitude times field at once would change volumes in second order, by some 2 % at 0.02 of the height, and start
  // with a bang.
  std::array<double, D> carried_along(const std::array<double, D>& x) const {
    constexpr int steps = 4;
    const double ds = o_.amplitude / steps;
    const auto beyond = [](std::array<double, D> at, double s, const std::array<double, D>& u) {
      for (std::size_t a = 0; a < D; ++a) at[a] += s * u[a];
      return at;
    };
    auto to = x;
    for (int k = 0; k < steps; ++k) {
      const auto k1 = mode_at(to), k2 = mode_at(beyond(to, 0.5 * ds, k1)), k3 = mode_at(beyond(to, 0.5 * ds, k2)),
                 k4 = mode_at(beyond(to, ds, k3));
      for (std::size_t a = 0; a < D; ++a) to[a] += ds * (k1[a] + 2.0 * k2[a] + 2.0 * k3[a] + k4[a]) / 6.0;
    }
    return to;
  }

  std::int32_t material_at(const std::array<double, D>& x) const {
    if (kind_ == problem_kind::drop) {
      // In units of the half axes, whose product is that of a round drop.
      if (many()) {
        std::array<double, 3> at{};
        std::copy(x.begin(), x.end(), at.begin());
        return std::any_of(p_.places.begin(), p_.places.end(),
                           [&](const auto& c) { return distance(box_of(o_.domain), at, c) < o_.radius; });
      }
      double r2 = 0.0, most = 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        const double half = o_.radius * std::pow(o_.elongation, a == 1 ? 1.0 - 1.0 / D : -1.0 / D);
        const double d = (x[a] - *o_.centre[a]) / half;
        r2 += d * d;
        most = std::max(most, std::abs(d));
      }
      if (o_.shape == "square")
        return most < 0.5 * (D == 2 ? std::sqrt(std::numbers::pi) : std::cbrt(4.0 / 3.0 * std::numbers::pi)) ? 1 : 0;
      return r2 < 1.0 ? 1 : 0;
    }
    double height = p_.interface;
    if (o_.start == "coloured")
      height = *o_.interface + o_.amplitude * std::cos(p_.k_x * x[0]) * std::cos(p_.k_z * (D == 3 ? x[2 % D] : 0.0));
    return x[1] > height && x[1] < p_.pond_top ? 1 : 0;
  }

  // Of every row of the start lattice, both materials at its pressure: that of the column, or, of several drops, of all
  // that lies above, metal too. Their weight is then held, but for what makes them fall; with the column's pressure it
  // would come as sound, at several times the speed of the fall.
  std::vector<std::array<place, 2>> rows_at_rest() {
    auto& s = world_.w.s;
    const double dx = world_.w.dx;
    const auto& lower = p_.base->lower();
    const barotropic drop = curve_of(1);
    const auto& upper = kind_ == problem_kind::drop ? drop : p_.base->upper();
    const auto number = static_cast<std::size_t>(o_.domain.particles[1]);
    std::vector<std::int64_t> metal(number, 0);
    for (std::size_t i = 0; i < s.fluid; ++i) {
      std::array<double, D> x;
      for (std::size_t a = 0; a < D; ++a) x[a] = s.x[a][i];
      s.material[i] = material_at(x);
      metal[static_cast<std::size_t>(x[1] / dx)] += is_metal(i) ? 1 : 0;
    }
    std::vector<std::array<place, 2>> rows(number);
    const double in_row = static_cast<double>(world_.fluid_total) / static_cast<double>(number);
    double above = o_.p_top;  // Pa, at the row's upper edge
    for (std::size_t row = number; row-- > 0;) {
      double pressure = p_.base->at((static_cast<double>(row) + 0.5) * dx).pressure;
      if (many()) {
        const double share = static_cast<double>(ranks().sum(metal[row])) / in_row;
        double weight = 0.0;  // Pa, of half the row, at the pressure in its middle
        for (int k = 0; k < 4; ++k)
          weight = 0.5 * dx * o_.gravity *
                   (share * at_pressure(upper, above + weight).density +
                    (1.0 - share) * at_pressure(lower, above + weight).density);
        pressure = above + weight;
        above = pressure + weight;
      }
      rows[row] = {at_pressure(lower, pressure), at_pressure(upper, pressure)};
    }
    return rows;
  }

  void place_fluid() {
    auto& w = world_.w;
    auto& s = w.s;
    const auto rows = rows_at_rest();
    const double V = std::pow(w.dx, D);
    for (std::size_t i = 0; i < s.fluid; ++i) {
      std::array<double, D> x;
      for (std::size_t a = 0; a < D; ++a) x[a] = s.x[a][i];
      const auto row = static_cast<std::size_t>(x[1] / w.dx);
      const auto& state = rows[row][static_cast<std::size_t>(s.material[i])];
      s.m[i] = state.density * V;
      s.rho[i] = rho_start()[i] = state.density;
      s.T[i] = s.extras[2].values[i] = state.temperature;
      s.u[i] = dissipated()[i] = 0.0;
      if (dissolved_) element()[i] = is_metal(i) ? o_.element.concentration_metal : o_.element.concentration_silicate;
      if (enthalpy_) {
        const auto n = static_cast<std::size_t>(s.material[i]);
        s.T[i] = s.extras[2].values[i] = n == 0 && x[1] > p_.pond_top ? p_.cover_temperature : p_.temperature[n];
        s.c_V[i] = eos::evaluate((*p_.material)[n], s.rho[i], s.T[i]).c_V;
        content()[i] = content_start()[i] =
            contents(i, eos::pressure((*p_.material)[n], s.rho[i], s.T[i])).enthalpy(s.T[i]);
      }
      if (!p_.mode || o_.start == "coloured") continue;
      const auto to = carried_along(x);
      const auto u = mode_at(to);
      const double rate = o_.start == "eigenmode" ? p_.mode->growth_rate : 0.0;
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] = to[a];
        s.v[a][i] = rate * o_.amplitude * u[a];
      }
      if (carried_) {
        // As the mode compresses a particle: its pressure is that of the place where it went.
        const auto m = theory::at(*p_.mode, x[1] - p_.interface);
        const auto e = eos::evaluate((*p_.material)[static_cast<std::size_t>(s.material[i])], s.rho[i], s.T[i]);
        const double stiffness = warms_ ? s.rho[i] * e.sound_speed * e.sound_speed : e.K_T;
        const double wave = std::cos(p_.k_x * x[0]) * std::cos(p_.k_z * (D == 3 ? x[2 % D] : 0.0));
        s.rho[i] *= 1.0 + o_.amplitude * wave * (m.pressure - s.rho[i] * o_.gravity * m.displacement_y) / stiffness;
      }
    }
  }

  // The viscous sum of fourth order takes energy from every wave of the lattice, but may give some to particles in
  // disorder. Where the energy dissipated falls, that of second order, which cannot, takes its place.
  bool fourth_order() const { return o_.scheme.viscous_order == 4 && !second_order_; }
  void take_second_order() {
    second_order_ = true;
    limit_ = limit();
  }

  // A material by itself: isotherm or adiabat through the lid's pressure and temperature.
  barotropic curve_of(std::size_t n) const { return {&(*p_.material)[n], o_.p_top, o_.temperature, warms_}; }
  place on_curve(std::size_t n, double pressure) const { return at_pressure(curve_of(n), pressure); }

  // Explicit steps: those of the lattice, for sound at the pressures of top and floor.
  integrators::step_limit limit() {
    const double dx = world_.w.dx;
    viscous_ = fourth_order() ? fourth_order_weights<D>(world_.w.kernel, dx) : viscous_weights{};
    const auto stiff = rates_of_lattice<D>(world_.w.kernel, dx, viscous_, p_.stress_a, p_.stress_b);
    double nu = 0.0, kappa = 0.0;
    const double p_floor = p_.base->at(0.0).pressure;
    for (const std::size_t n : {0, 1})
      for (const double p : {o_.p_top, p_floor}) {
        const auto& material = (*p_.material)[n];
        const auto state = on_curve(n, p);
        fastest_sound_ =
            std::max(fastest_sound_, eos::evaluate(material, state.density, state.temperature).sound_speed);
        const bool law = n == 0 && o_.melting.viscosity_law != "constant";
        const double most = law ? o_.melting.viscosity_max : o_.material[n].viscosity;
        const double eta =
            n == 0 && o_.melting.inertia_viscosity > 0.0 ? std::min(most, o_.melting.inertia_viscosity) : most;
        // Beside something far stiffer a pair's mean, 4 η η'/(η + η'), is twice that of equals.
        nu = std::max(nu, (law ? 2.0 : 1.0) * eta / state.density);
        kappa = std::max(
            kappa, o_.conductivity / (state.density * eos::evaluate(material, state.density, state.temperature).c_V));
      }
    // Twice, as for viscosities: a partition coefficient makes a contrast.
    if (dissolved_)
      kappa = std::max(kappa, 2.0 * std::max(o_.element.diffusivity_silicate, o_.element.diffusivity_metal));
    const double conduction = rates_of_lattice<D>(world_.w.kernel, dx, {}).viscous * kappa;
    const double diffusive = std::max(stiff.viscous * nu, conduction);
    radius_ = 1.2 * diffusive / (dx * dx);
    // The stiffest capillary wave: of two spacings, ω² = σk³/(ρ + ρ').
    double capillary = 0.0;
    if (tense_) {
      const double both = on_curve(0, o_.p_top).density + on_curve(1, o_.p_top).density;
      capillary = std::sqrt(o_.surface_tension * std::pow(std::numbers::pi / dx, 3) / both);
    }
    // march's fractions are those of |eigenvalue| <= 2.2 c/dx and 4 d nu/dx^2.
    const double sound = *o_.march.time.cfl * 2.2 / stiff.sound * dx / fastest_sound_;
    const double viscous = *o_.march.time.diffusive * 4.0 * D * dx * dx / diffusive;
    const double wave = capillary / (*o_.march.time.cfl * 2.2);
    const double both = 1.0 / std::hypot(1.0 / sound, 1.0 / viscous, wave);
    return {both, wave * std::min(sound, viscous) > 1.0 ? "surface tension"
                  : sound < viscous                     ? "sound"
                  : conduction < diffusive              ? "viscosity"
                                                        : "conduction"};
  }

  // ---- right-hand side --------------------------------------------------------------------

  std::vector<particles::array*> scratch() {
    std::vector<particles::array*> all{&stress_,   &factor_,    &W_sum_, &compression_, &heat_,
                                       &rho_rate_, &conducted_, &melt_,  &inertia_,     &partition_,
                                       &mobility_, &metal_,     &gain_,  &area_,        &squared_volume_};
    for (auto& f : force_) all.push_back(&f);
    for (auto& f : tension_force_) all.push_back(&f);
    for (auto& f : colour_slope_) all.push_back(&f);
    return all;
  }

  // Where ghosts and images are, and how they move.
  void refresh_motion() {
    auto& w = world_.w;
    auto& s = w.s;
    const foundation::stage timed(w.times, "halo");
    std::vector<double*> fields;
    for (auto& v : s.v) fields.push_back(v.data());
    if (o_.conductivity > 0.0 && !enthalpy_) fields.push_back(s.T.data());
    domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(fields), &s.x);
    images::move(world_.images, s);
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) {
      const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
      for (std::size_t a = 0; a < D; ++a) s.v[a][i] = s.v[a][j];
      s.T[i] = s.T[j];
      images::for_each_mirror(world_.images, r, [&](const images::side<D>& wall) {
        if (wall.no_slip)
          for (std::size_t a = 0; a < D; ++a) s.v[a][i] = -s.v[a][i];
        else
          s.v[wall.axis][i] = -s.v[wall.axis][i];
      });
    });
  }

  // ΔV and ρ, and the pressure of the equation of state, of fluid and ghosts.
  void find_volumes() {
    auto& w = world_.w;
    auto& s = w.s;
    if (!carried_) {
      const foundation::stage timed(w.times, "volumes");
      w.sum(w.fluid(), kernel_sum<D>{self_, W_sum_.data()});
      foundation::for_all(s.fluid, [&](std::size_t i) {
        s.dV[i] = w.lattice_sum / W_sum_[i];
        s.rho[i] = s.m[i] / s.dV[i];
      });
    } else {
      foundation::for_all(s.fluid, [&](std::size_t i) { s.dV[i] = s.m[i] / s.rho[i]; });
    }
    {
      const foundation::stage timed(w.times, "equation of state");
      volume::equation_of_state(w, s.fluid);
    }
    const foundation::stage timed(w.times, "halo");
    // A ghost's ρ is to have the bits of its source's: ρ itself, or what ΔV gives there too.
    if (carried_) {
      w.exchange_fluid({s.dV.data(), s.p_eos.data(), s.rho.data()});
    } else {
      w.exchange_fluid({s.dV.data(), s.p_eos.data()});
      foundation::for_all(s.fluid_ghosts,
                          [&](std::size_t k) { s.rho[s.fluid + k] = s.m[s.fluid + k] / s.dV[s.fluid + k]; });
    }
    mirror(s.p_eos);
  }

  // Of fluid, ghosts and images: concentration, partition coefficient, ρ times diffusivity, material.
  void find_partition() {
    auto& w = world_.w;
    auto& s = w.s;
    const auto& e = o_.element;
    foundation::for_all(s.fluid, [&](std::size_t i) {
      metal_[i] = is_metal(i) ? 1.0 : 0.0;
      partition_[i] = is_metal(i) ? partition_coefficient(e, s.p_eos[i], s.T[i]) : 1.0;
      mobility_[i] = s.rho[i] * (is_metal(i) ? e.diffusivity_metal : e.diffusivity_silicate);
    });
    w.exchange_fluid({element().data(), metal_.data(), partition_.data(), mobility_.data()});
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) {
      const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
      for (auto* a : {&element(), &metal_, &partition_, &mobility_}) (*a)[i] = (*a)[j];
    });
  }

  // Forces of surface tension, and the area of contact per volume at each particle.
  void find_tension() {
    auto& w = world_.w;
    auto& s = w.s;
    const foundation::stage timed(w.times, "surface tension");
    std::array<double*, D> G, force;
    for (std::size_t a = 0; a < D; ++a) {
      G[a] = colour_slope_[a].data();
      force[a] = tension_force_[a].data();
    }
    w.sum(w.fluid(), colour_gradient<D>{s.dV.data(), metal_.data(), G});
    foundation::for_all(s.fluid, [&](std::size_t i) {
      double G2 = 0.0;
      for (std::size_t a = 0; a < D; ++a) G2 += G[a][i] * G[a][i];
      area_[i] = std::sqrt(G2);
    });
    domain::exchange<D>(w.d.ranks, w.d.fluid_halo, std::span<double* const>(G));
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) {
      const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
      for (std::size_t a = 0; a < D; ++a) G[a][i] = G[a][j];
      images::for_each_mirror(world_.images, r,
                              [&](const images::side<D>& wall) { G[wall.axis][i] = -G[wall.axis][i]; });
    });
    foundation::for_all(s.total(), [&](std::size_t i) { squared_volume_[i] = s.dV[i] * s.dV[i] / w.lattice_sum; });
    w.sum(w.fluid(),
          surface_stress<D>{squared_volume_.data(), pairs::pointers<D>(colour_slope_), o_.surface_tension, force});
  }

  // Temperature and melt out of the heat content, at the pressure of the equation of state; viscosity and inertia by
  // them.
  void find_phases() {
    auto& w = world_.w;
    auto& s = w.s;
    const foundation::stage timed(w.times, "phases");
    foundation::for_all(s.fluid, [&](std::size_t i) {
      const auto here = contents(i, s.p_eos[i]).at(content()[i]);
      s.T[i] = here.temperature;
      melt_[i] = is_metal(i) || !melts_ ? 0.0 : here.melt_fraction;
      inertia_[i] = 1.0;
      if (is_metal(i)) return;
      if (o_.melting.viscosity_law != "constant") s.eta[i] = viscosity_by_melt(o_.melting, s.T[i], melt_[i]);
      if (const double x = o_.melting.inertia_viscosity; x > 0.0) inertia_[i] = std::max(1.0, s.eta[i] / x);
    });
    w.exchange_fluid({s.T.data(), s.eta.data()});
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) {
      const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
      s.T[i] = s.T[j];
      s.eta[i] = s.eta[j];
    });
  }

  // The source's ΔV and ρ, and p + ρ g (y_source - y_image).
  void mirror(particles::array& p) {
    auto& s = world_.w.s;
    const double g = o_.walls.pressure == "hydrostatic" ? o_.gravity : 0.0;
    foundation::for_all(world_.images.source.size(), [&](std::size_t r) {
      const std::size_t i = s.first_wall() + r, j = world_.images.source[r];
      s.dV[i] = s.dV[j];
      s.rho[i] = s.rho[j];
      p[i] = p[j] + s.rho[j] * g * (s.x[1][j] - s.x[1][i]);
    });
  }

  // The pressure in the forces.
  void find_pressures() {
    auto& w = world_.w;
    auto& s = w.s;
    const std::size_t n = s.total();
    if (smoothed_) {
      const foundation::stage timed(w.times, "smoothing");
      foundation::for_all(n, [&](std::size_t i) { s.Y[i] = s.p_eos[i] * s.dV[i]; });
      w.sum(w.fluid(), smoothing<D>{s.Y.data(), s.dV.data(), self_, s.p.data(), W_sum_.data()});
      if (o_.scheme.normalise) foundation::for_all(s.fluid, [&](std::size_t i) { s.p[i] /= W_sum_[i]; });
      if (from_weight_) {
        volume::require_positive(w, s.p, "the smoothed pressure");
        foundation::for_all(s.fluid, [&](std::size_t i) { s.dV[i] = s.Y[i] / s.p[i]; });
      }
      w.exchange_fluid({s.p.data(), s.dV.data()});
      mirror_volumes(s.p);
    } else {
      foundation::for_all(n, [&](std::size_t i) { s.p[i] = s.p_eos[i]; });
    }
    foundation::for_all(n, [&](std::size_t i) {
      stress_[i] = (s.p[i] - reference_pressure(s.x[1][i])) * element_of_work(i);
      factor_[i] = first_pattern_ ? 1.0 : s.dV[i];
    });
    stress_[s.null()] = factor_[s.null()] = 0.0;
  }
  // mirror() once more, of what smoothing changed: ρ stays.
  void mirror_volumes(particles::array& p) { mirror(p); }

  void sum_over_neighbours() {
    auto& w = world_.w;
    auto& s = w.s;
    {
      const foundation::stage timed(w.times, "forces");
      forces<D> f{pairs::pointers<D>(s.v),
                  stress_.data(),
                  factor_.data(),
                  s.dV.data(),
                  s.eta.data(),
                  p_.stress_a,
                  p_.stress_b,
                  viscous_.a0,
                  viscous_.a1,
                  {},
                  compression_.data(),
                  heat_.data()};
      for (std::size_t a = 0; a < D; ++a) f.force[a] = force_[a].data();
      w.sum(w.fluid(), f);
    }
    if (carried_) {
      const foundation::stage timed(w.times, "continuity");
      w.sum(w.fluid(), density_rate<D>{pairs::pointers<D>(s.v), s.dV.data(), s.p_eos.data(), s.rho.data(), s.c.data(),
                                       o_.gravity, o_.scheme.delta * h_, rho_rate_.data()});
    }
    if (o_.conductivity > 0.0) {
      std::fill_n(conducted_.begin(), s.fluid, 0.0);
      w.sum(w.fluid(), diffusion::conduction<D>{s.T.data(), s.k.data(), s.dV.data(), conducted_.data()});
    }
    if (dissolved_) {
      const foundation::stage timed(w.times, "element");
      w.sum(w.fluid(), element_exchange<D>{element().data(), partition_.data(), mobility_.data(), metal_.data(),
                                           s.dV.data(), gain_.data()});
    }
  }

  void combine(std::span<double* const> rate) {
    auto& w = world_.w;
    auto& s = w.s;
    const foundation::stage timed(w.times, "rates");
    const std::size_t at_rho = 2 * D + 2, at_T = at_rho + (carried_ ? 1 : 0), at_c = at_T + (warms_ ? 1 : 0),
                      at_h = at_c + (dissolved_ ? 1 : 0);
    bool finite = true;
#pragma omp parallel for schedule(static) reduction(&& : finite) if (s.fluid > foundation::rows_worth_threads)
    for (std::size_t i = 0; i < s.fluid; ++i) {
      const double per_m = 1.0 / s.m[i];
      for (std::size_t a = 0; a < D; ++a) {
        rate[a][i] = s.v[a][i];
        double force = tense_ ? force_[a][i] + tension_force_[a][i] : force_[a][i];
        if (a == 1) force -= reference_slope_ * s.dV[i];
        rate[D + a][i] = (per_m * force + w.g[a]) / inertia_of(i);
        finite = finite && std::isfinite(rate[D + a][i]);
      }
      rate[2 * D][i] = per_m * s.p[i] * element_of_work(i) * compression_[i];
      rate[2 * D + 1][i] = per_m * heat_[i];
      double dlnrho = compression_[i] * (first_pattern_ ? s.dV[i] : 1.0) / w.lattice_sum;
      if (carried_) {
        rate[at_rho][i] = rho_rate_[i];
        dlnrho = rho_rate_[i] / s.rho[i];
        finite = finite && std::isfinite(rho_rate_[i]);
      }
      if (warms_) {
        const double gamma = s.alpha[i] * s.K_T[i] / (s.rho[i] * s.c_V[i]);
        rate[at_T][i] =
            gamma * s.T[i] * dlnrho + per_m * (heat_[i] + (o_.conductivity > 0.0 ? conducted_[i] : 0.0)) / s.c_V[i];
        finite = finite && std::isfinite(rate[at_T][i]);
      }
      if (dissolved_) {
        rate[at_c][i] = per_m * gain_[i];
        finite = finite && std::isfinite(rate[at_c][i]);
      }
      if (enthalpy_) {
        rate[at_h][i] = per_m * (heat_[i] + (o_.conductivity > 0.0 ? conducted_[i] : 0.0));
        finite = finite && std::isfinite(rate[at_h][i]);
      }
    }
    if (finite) return;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      bool good = true;
      for (const double* r : rate) good = good && std::isfinite(r[i]);
      if (!good)
        w.first_fault.report(s.id[i], "a rate is not finite: " + volume::where_is(s, i) + ", rho = " +
                                          volume::number(s.rho[i]) + " kg/m3, p = " + volume::number(s.p[i]) +
                                          " Pa; the flow has blown up, or the step is too large");
    }
  }

  // What the pressure has in the forces, A of terms.hpp over p: m^2D, or m^D with pattern 2.
  double element_of_work(std::size_t i) const {
    const auto& w = world_.w;
    const double scale = carried_ ? 1.0 : 1.0 / w.lattice_sum;
    return scale * w.s.dV[i] * (first_pattern_ ? w.s.dV[i] : 1.0);
  }
  double reference_pressure(double y) const { return reference_floor_ + reference_slope_ * y; }  // Pa
  // J (2-D: J/m), of p_r over the box: what Σ p_r ΔV stands for.
  double reference_integral() const {
    double mean = 0.5 * reference_floor_;
    for (std::size_t a = 0; a < D; ++a) mean *= o_.domain.length[a];
    return mean;
  }

  // ---- energy -----------------------------------------------------------------------------

  // J/kg, ∫ p dρ/ρ² from the density at the start, at the particle's temperature: four Gauss points in ln ρ.
  double elastic_energy(std::size_t i) const {
    const auto& s = world_.w.s;
    const auto& material = world_.w.materials[static_cast<std::size_t>(s.material[i])];
    constexpr std::array<double, 4> x{-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
    constexpr std::array<double, 4> weight{0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                           0.3478548451374538};
    const double half = 0.5 * std::log(s.rho[i] / rho_start()[i]);
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double rho = rho_start()[i] * std::exp(half * (1.0 + x[k]));
      sum += weight[k] * eos::pressure(material, rho, s.T[i]) / rho;
    }
    return half * sum;
  }

  // J (2-D: J/m): Δρ g L³/8 of a square box; of a drop, what it loses on the way from lid to floor, and its surface's.
  double energy_scale() const {
    const auto& L = o_.domain.length;
    const double weight = std::abs(p_.density_difference) * o_.gravity, a = o_.radius;
    if (kind_ == problem_kind::drop)
      return number_of_drops() * (weight * L[1] * std::numbers::pi * a * a * (D == 3 ? 4.0 / 3.0 * a : 1.0) +
                                  o_.surface_tension * round_surface(a));
    return weight * L[0] * L[1] * L[1] * (D == 3 ? L[2] : 1.0) / 8.0;
  }

  // ---- drop -------------------------------------------------------------------------------

  // m² (2-D: m), of the round drop.
  static double round_surface(double radius) { return std::numbers::pi * radius * (D == 3 ? 4.0 * radius : 2.0); }
  bool many() const { return kind_ == problem_kind::drop && p_.places.size() > 1; }
  double number_of_drops() const { return static_cast<double>(p_.places.size()); }
  // How many bodies the metal is in: sets of its particles that steps of up to 1.9 spacings hold together. Sheared
  // particles lie in rows up to so far apart, and one undisturbed row of the other liquid, 2 spacings, still parts two
  // drops. Less than a tenth of a drop is a fragment, and not counted. On every rank all metal at once.
  void find_bodies() {
    const auto& s = world_.w.s;
    std::vector<double> mine;
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (is_metal(i))
        for (std::size_t a = 0; a < D; ++a) mine.push_back(s.x[a][i]);
    const auto local = static_cast<double>(mine.size());
    mine.resize(static_cast<std::size_t>(ranks().maximum(local)), std::numeric_limits<double>::quiet_NaN());
    const auto all = ranks().every(std::span<const double>(mine));
    std::vector<std::array<double, 3>> points;
    for (std::size_t k = 0; k + D <= all.size(); k += D) {
      std::array<double, 3> x{};
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(k), D, x.begin());
      if (!std::isnan(x[0])) points.push_back(x);
    }
    const auto sizes = connected_sizes(box_of(o_.domain), points, 1.9 * world_.w.dx);
    const auto metal = static_cast<double>(points.size());
    record_.bodies.push_back(static_cast<double>(std::count_if(sizes.begin(), sizes.end(), [&](std::int64_t n) {
      return static_cast<double>(n) * 10.0 * number_of_drops() >= metal;
    })));
    record_.largest_body.push_back(static_cast<double>(sizes.front()) / metal);
  }
  // m, of a round drop of one drop's volume as particles have it.
  double radius_by_volume() const {
    return D == 3 ? std::cbrt(0.75 * drop_volume_ / std::numbers::pi) : std::sqrt(drop_volume_ / std::numbers::pi);
  }
  double centre_of_metal() const {
    const auto& s = world_.w.s;
    foundation::exact_sum mass, moment;
    for (std::size_t i = 0; i < s.fluid; ++i)
      if (is_metal(i)) {
        mass.add(s.m[i]);
        moment.add(s.m[i] * s.x[1][i]);
      }
    return ranks().exact(moment) / ranks().exact(mass);
  }
  // s, between crossings of zero of the stretch, from the first to the last; nothing with fewer than three.
  std::optional<double> oscillation_period() const {
    std::vector<double> crossings;
    const auto& f = record_.stretch;
    for (std::size_t k = 1; k < f.size(); ++k)
      if ((f[k - 1] > 0.0) != (f[k] > 0.0))
        crossings.push_back(record_.time[k - 1] +
                            (record_.time[k] - record_.time[k - 1]) * f[k - 1] / (f[k - 1] - f[k]));
    if (crossings.size() < 3) return std::nullopt;
    return 2.0 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  }

  // ---- element ----------------------------------------------------------------------------

  // Of what the metal would take up, P being what it is, from its start to equilibrium with all silicate: the part
  // taken.
  double equilibration(double c, double P) const {
    const auto& [metal, metal_volume, mass, volume] = metal_start_;
    const double there = *element_start_ / (metal + (mass - metal) / P);
    return (c - o_.element.concentration_metal) / (there - o_.element.concentration_metal);
  }
  // s, of the part 1 - 1/e.
  std::optional<double> when_equilibrated(const std::vector<double>& part) const {
    const double wanted = 1.0 - std::exp(-1.0);
    for (std::size_t k = 1; k < part.size(); ++k)
      if (part[k] >= wanted && part[k - 1] < wanted)
        return record_.time[k - 1] +
               (record_.time[k] - record_.time[k - 1]) * (wanted - part[k - 1]) / (part[k] - part[k - 1]);
    return std::nullopt;
  }
  // At the times of the record, the same of a round drop at rest in the middle of as much silicate, with the partition
  // coefficient that the drop had: diffusion along the radius alone.
  std::vector<double> equilibration_at_rest() const {
    const auto& [metal, metal_volume, mass, volume] = metal_start_;
    const double unit = D == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi;
    const auto radius_of = [&](double V) { return D == 2 ? std::sqrt(V / unit) : std::cbrt(V / unit); };
    const auto P_at = [&](double t) {
      const auto k = static_cast<std::size_t>(std::lower_bound(record_.time.begin(), record_.time.end(), t) -
                                              record_.time.begin());
      if (k == 0 || k == record_.time.size()) return k == 0 ? record_.partition.front() : record_.partition.back();
      const double share = (t - record_.time[k - 1]) / (record_.time[k] - record_.time[k - 1]);
      return (1.0 - share) * record_.partition[k - 1] + share * record_.partition[k];
    };
    const auto& e = o_.element;
    const double one = 1.0 / number_of_drops();  // with its share of the silicate
    auto part = theory::mean_inside({D, radius_of(one * metal_volume), radius_of(one * volume), metal / metal_volume,
                                     (mass - metal) / (volume - metal_volume), e.diffusivity_metal,
                                     e.diffusivity_silicate, e.concentration_metal, e.concentration_silicate, P_at},
                                    record_.time);
    for (std::size_t k = 0; k < part.size(); ++k) part[k] = equilibration(part[k], record_.partition[k]);
    return part;
  }

  // s, of the first line where the metal's centroid has fallen that far, by straight lines between.
  std::optional<double> time_of_fall(double fall) const { return when_below(record_.centroid.front() - fall); }
  std::optional<double> when_below(double y) const {
    for (std::size_t k = 1; k < record_.time.size(); ++k)
      if (record_.centroid[k] <= y && record_.centroid[k - 1] > y)
        return record_.time[k - 1] + (record_.time[k] - record_.time[k - 1]) * share(k, y);
    return std::nullopt;
  }
  // m/s, mean over a fiftieth of the height about y: sound that the start left swings on top of the velocity.
  std::optional<double> fall_at(double y) const {
    const double span = 0.02 * o_.domain.length[1];
    const auto above = when_below(y + 0.5 * span), below = when_below(y - 0.5 * span);
    return above && below ? std::optional(span / (*below - *above)) : std::nullopt;
  }
  // m/s, downward, of the metal's centroid over the time of the input's choice.
  std::optional<double> fall_between() const {
    const double from = o_.measure_from.value_or(record_.time.front()),
                 until = o_.measure_until.value_or(record_.time.back());
    if (!(until > from && from >= record_.time.front() && until <= record_.time.back())) return std::nullopt;
    return (centroid_at(from) - centroid_at(until)) / (until - from);
  }
  double centroid_at(double t) const {
    const auto k = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(std::lower_bound(record_.time.begin(), record_.time.end(), t) - record_.time.begin(),
                                   1, static_cast<std::ptrdiff_t>(record_.time.size()) - 1));
    const double part = (t - record_.time[k - 1]) / (record_.time[k] - record_.time[k - 1]);
    return (1.0 - part) * record_.centroid[k - 1] + part * record_.centroid[k];
  }
  double share(std::size_t k, double y) const {
    return (record_.centroid[k - 1] - y) / (record_.centroid[k - 1] - record_.centroid[k]);
  }

  problem_kind kind_;
  const options& o_;
  const parameters& p_;
  images::scene<D> world_;
  bool carried_ = false, smoothed_ = false, first_pattern_ = false, from_weight_ = false, warms_ = false;
  bool enthalpy_ = false, melts_ = false;
  bool dissolved_ = false, tense_ = false;
  std::size_t heat_at_ = 0, element_at_ = 0;  // of the extras
  double self_ = 0.0, h_ = 0.0, fastest_sound_ = 0.0, radius_ = 0.0;
  integrators::step_limit limit_;
  viscous_weights viscous_;

  std::array<particles::array, D> force_;
  particles::array stress_, factor_, W_sum_, compression_, heat_, rho_rate_, conducted_;
  particles::array melt_, inertia_;                       // melt fraction; ξ²
  particles::array partition_, mobility_, metal_, gain_;  // of an element: P, ρ D; 1 in metal; kg/s

  particles::array area_, squared_volume_;                        // 1/m, |G|; m^2D, ΔV²/s
  std::array<particles::array, D> colour_slope_, tension_force_;  // 1/m, G of surface_tension.hpp; N

  std::int64_t crossings_ = 0;
  record record_;
  std::optional<double> energy_start_;
  double mach_max_ = 0.0;
  std::optional<double> fraction_start_;                               // of drops: volume of the metal over all
  double surface_ = 0.0, laplace_pressure_ = 0.0, drop_volume_ = 0.0;  // J (2-D: J/m); Pa; m^D
  double mass_start_ = 0.0, mass_drift_ = 0.0;
  double dissipated_now_ = 0.0, dissipated_most_ = 0.0;  // J, at lines of the history
  bool second_order_ = false;
  double residual_ = 0.0, residual_max_ = 0.0, v_rms_ = 0.0, v_rms_max_ = 0.0, v_rms_max_time_ = 0.0;
  double reference_floor_ = 0.0, reference_slope_ = 0.0;  // Pa, Pa/m
  double density_min_ = 1e300, density_max_ = 0.0, pressure_min_ = 1e300;
  std::optional<double> element_start_;  // kg (2-D: kg/m)
  std::array<double, 4> metal_start_{};  // mass and volume of the metal, of all
  double element_error_ = 0.0;
  double heat_residual_ = 0.0, melt_fraction_ = 0.0, metal_depth_ = 0.0, metal_below_ = 0.0;
};

}  // namespace tetsuame::overturn
