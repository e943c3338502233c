#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convection/options.hpp>
#include <numbers>
#include <two_fluids/column.hpp>

namespace tetsuame::convection {

namespace {

// The cubic through the four nodes around a place: their weights.
struct place_between {
  std::size_t first;
  std::array<double, 4> weight;
};

place_between find(double y, double L, int nodes) {
  const double at = std::clamp(y / L, 0.0, 1.0) * nodes;
  const int first = std::clamp(static_cast<int>(at) - 1, 0, nodes - 3);
  const double s = at - first;
  return {static_cast<std::size_t>(first),
          {-(s - 1.0) * (s - 2.0) * (s - 3.0) / 6.0, s * (s - 2.0) * (s - 3.0) / 2.0, -s * (s - 1.0) * (s - 3.0) / 2.0,
           s * (s - 1.0) * (s - 2.0) / 6.0}};
}

eos::material_options material_of(const options& o, const relaxation::fluid_layer& f) {
  eos::material_options m;
  m.name = o.convection.eos;
  m.table = o.convection.eos_table;
  if (m.name != "linear") return m;
  m.reference_pressure = o.convection.p_top;
  m.reference_density = f.rho;
  m.reference_temperature = o.temperature_cold();
  m.bulk_modulus = f.K;
  m.thermal_expansivity = f.alpha;
  m.heat_capacity = o.physics.material.heat_capacity;
  return m;
}

constexpr int places = 100;  // over the height

// Smallest and largest heat capacity, J/(kg K): it follows the pressure where what rises cools.
std::pair<double, double> heat_capacities(const options& o, const parameters& p) {
  const double c_p = o.physics.material.heat_capacity, T_top = o.temperature_cold(), T_bottom = o.temperature_hot();
  double least = c_p, most = c_p;
  for (int k = 0; k <= places && o.convection.adiabatic_heating; ++k)
    for (const double T : {T_top, 0.5 * (T_top + T_bottom), T_bottom}) {
      const double here = c_p + p.weighed->heat_capacity_change(p.fluid.L * k / places, T);
      least = std::min(least, here), most = std::max(most, here);
    }
  return {least, most};
}

}  // namespace

gravity_density::gravity_density(const eos::any& material, const layer& l) : l_(l) {
  const double beyond = 0.1 * std::abs(l.T_bottom - l.T_top);
  low_ = std::max(std::min(l.T_bottom, l.T_top) - beyond, 0.0);
  high_ = std::max(l.T_bottom, l.T_top) + beyond;
  const two_fluids::barotropic adiabat{&material, l.p_top, l.T_top, true};
  const two_fluids::column at_rest(adiabat, adiabat, 0.5 * l.L, l.L, l.g);
  constexpr int terms = degree + 1;
  nodes_.resize(nodes + 1);
  for (int k = 0; k <= nodes; ++k) {
    auto& n = nodes_[static_cast<std::size_t>(k)];
    const auto here = at_rest.at(l.L * k / nodes);
    const auto e = eos::evaluate(material, here.density, here.temperature);
    n = {here.pressure, here.density, here.temperature, e.alpha, e.K_T, {}, {}};
    // Values at the zeros of the next polynomial.
    std::array<double, terms> weighed{};
    for (int j = 0; j < terms; ++j) {
      const double s = std::cos(std::numbers::pi * (j + 0.5) / terms),
                   T = 0.5 * (low_ + high_) + 0.5 * (high_ - low_) * s;
      weighed[static_cast<std::size_t>(j)] = -l.g * eos::density(material, here.pressure, T) / l.rho;
    }
    for (int m = 0; m < terms; ++m) {
      double sum = 0.0;
      for (int j = 0; j < terms; ++j)
        sum += weighed[static_cast<std::size_t>(j)] * std::cos(std::numbers::pi * m * (j + 0.5) / terms);
      n.series[static_cast<std::size_t>(m)] = (m == 0 ? 1.0 : 2.0) / terms * sum;
    }
  }
  for (std::size_t k = nodes; k-- > 0;)
    for (std::size_t m = 0; m <= degree; ++m)
      nodes_[k].above[m] = nodes_[k + 1].above[m] + 0.5 * l.L / nodes * (nodes_[k].series[m] + nodes_[k + 1].series[m]);
}

gravity_density::polynomial gravity_density::coefficients(polynomial node::*member, double y) const {
  const auto at = find(y, l_.L, nodes);
  polynomial c{};
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t m = 0; m <= degree; ++m) c[m] += at.weight[k] * (nodes_[at.first + k].*member)[m];
  return c;
}

double gravity_density::heat_capacity_change(double y, double T) const {
  const auto c = coefficients(&node::above, y);
  const double per_T = 2.0 / (high_ - low_);
  const double s = std::clamp((T - 0.5 * (low_ + high_)) * per_T, -1.0, 1.0);
  // d²T_m/ds² = m dU_(m-1)/ds, and dU_(n+1) = 2 U_n + 2 s dU_n - dU_(n-1).
  double u_before = 1.0, u = 2.0 * s, du_before = 0.0, du = 2.0, sum = 0.0;
  for (std::size_t m = 2; m <= degree; ++m) {
    sum += c[m] * static_cast<double>(m) * du;
    const double du_next = 2.0 * u + 2.0 * s * du - du_before, u_next = 2.0 * s * u - u_before;
    du_before = du, du = du_next, u_before = u, u = u_next;
  }
  return -T * sum * per_T * per_T;
}

double gravity_density::value(double node::*member, double y) const {
  const auto at = find(y, l_.L, nodes);
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) sum += at.weight[k] * (nodes_[at.first + k].*member);
  return sum;
}

std::pair<double, double> gravity_density::series(double y, double T) const {
  const auto c = coefficients(&node::series, y);
  // Polynomials of the first and second kind by their recurrences. Beyond the range the series goes on straight.
  const double per_T = 2.0 / (high_ - low_), wanted = (T - 0.5 * (low_ + high_)) * per_T;
  const double s = std::clamp(wanted, -1.0, 1.0);
  double t_before = 1.0, t = s, u_before = 1.0, u = 2.0 * s, sum = c[0] + c[1] * s, slope = c[1];
  for (std::size_t m = 2; m <= degree; ++m) {
    const double t_next = 2.0 * s * t - t_before;
    sum += c[m] * t_next;
    slope += c[m] * static_cast<double>(m) * u;
    const double u_next = 2.0 * s * u - u_before;
    t_before = t, t = t_next, u_before = u, u = u_next;
  }
  return {sum + slope * (wanted - s), slope * per_T};
}

double gravity_density::buoyancy(double y, double T, double p, double q) const {
  const double conductive = l_.T_bottom - (l_.T_bottom - l_.T_top) * y / l_.L;
  const double b = series(y, T).first - series(y, conductive).first;
  return q == 0.0 ? b : b - l_.g * q * p / value(&node::K, y) * value(&node::rho, y) / l_.rho;
}

double gravity_density::slope(double y, double T) const { return series(y, T).second; }

void resolve_gravity(const namelist::schema& schema, const options& o, parameters& p) {
  const auto& c = o.convection;
  const auto& f = p.fluid;
  const double c_p = o.physics.material.heat_capacity, T_top = o.temperature_cold(), T_bottom = o.temperature_hot();
  p.dissipation_number = f.alpha * f.g * f.L / c_p;
  if (c.gravity_density != "equation_of_state") return;
  if (!(T_top > 0.0))
    schema.fail("convection", "gravity_density",
                "an equation of state needs absolute temperatures: that of the top must be above 0 K");
  const auto material = schema.placed("convection", "eos", [&] { return eos::make(material_of(o, f)); });
  p.weighed = schema.placed("convection", "eos", [&] {
    return std::make_shared<gravity_density>(material,
                                             gravity_density::layer{f.L, f.g, f.rho, c.p_top, T_top, T_bottom});
  });
  const auto& w = *p.weighed;
  double mean = 0.0;
  for (int k = 0; k < places; ++k) {
    const double y = f.L * (k + 0.5) / places;
    mean += w.slope(y, w.temperature(y)) / places;
  }
  p.dissipation_number = mean * f.L / c_p;
  const auto [least, most] = heat_capacities(o, p);
  if (!(least > 0.0))
    schema.fail("convection", "eos",
                fmt::format("with this equation of state the heat capacity would fall to {:.4g} J/(kg K): give a "
                            "larger heat_capacity, or leave adiabatic_heating",
                            least));
  p.lines.push_back(fmt::format(
      "gravity feels the density of {}: at rest {:.4g} to {:.4g} kg/m3, {:.4g} to {:.4g} Pa, adiabat {:.4g} to {:.4g} "
      "K, expansivity {:.3g} to {:.3g} 1/K from top to bottom; heat capacity {:.4g} to {:.4g} J/(kg K); dissipation "
      "number {:.4g}",
      eos::about(material).name, w.density(f.L), w.density(0.0), w.pressure(f.L), w.pressure(0.0), w.temperature(f.L),
      w.temperature(0.0), w.expansivity(f.L), w.expansivity(0.0), least, most, p.dissipation_number));
}

}  // namespace tetsuame::convection
