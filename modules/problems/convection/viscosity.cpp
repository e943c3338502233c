#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <convection/options.hpp>
#include <melting/melting.hpp>
#include <tables/table.hpp>
#include <utility>

namespace tetsuame::convection {

namespace {

// Between values `first` and the next of a list: part s of the way. One value only: nothing depends on it.
struct place {
  std::size_t first, next;
  double s;
};

place find(const std::vector<double>& x, double at) {
  if (x.size() == 1) return {0, 0, 0.0};
  const double beyond = 0.1 * (x.back() - x.front());
  const double held = std::clamp(at, x.front() - beyond, x.back() + beyond);
  const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, held);
  const auto next = static_cast<std::size_t>(after - x.begin());
  return {next - 1, next, (held - x[next - 1]) / (x[next] - x[next - 1])};
}

// Of temperature, depth and viscosity: by their names, or else three in this order.
std::array<std::size_t, 3> columns_of(const tables::table& text) {
  const auto T = text.column_of({"temperature", "t"}), depth = text.column_of({"depth"}),
             viscosity = text.column_of({"viscosity"});
  std::array<std::size_t, 3> all{0, 1, 2};
  if (T && depth && viscosity)
    all = {*T, *depth, *viscosity};
  else if (T || depth || viscosity || text.columns() != 3)
    text.fail(fmt::format(
        "three columns are wanted, temperature (K), depth (m), viscosity (Pa s), in this order or with these names; "
        "there are {}{}",
        text.columns(), text.headings().empty() ? "" : fmt::format(": {}", fmt::join(text.headings(), ", "))));
  text.expect_unit(all[0], "K", 1.0);
  text.expect_unit(all[1], "m", 1.0);
  text.expect_unit(all[2], "Pa s", 1.0);
  return all;
}

}  // namespace

viscosity_table::viscosity_table(std::vector<double> T, std::vector<double> depth,
                                 const std::function<double(double, double)>& viscosity)
    : T_(std::move(T)), depth_(std::move(depth)) {
  log_.reserve(T_.size() * depth_.size());
  for (const double t : T_)
    for (const double z : depth_) log_.push_back(std::log(viscosity(t, z)));
}

viscosity_table viscosity_table::read(const std::string& path) {
  const auto text = tables::table::read(path);
  const auto columns = columns_of(text);
  const auto T = text.numbers(columns[0]), depth = text.numbers(columns[1]), viscosity = text.numbers(columns[2]);
  viscosity_table table;
  auto& depths = table.depth_;
  const auto append = [&](std::vector<double>& list, double value, std::size_t row, const char* what, char unit) {
    if (!list.empty() && !(value > list.back()))
      text.fail_at(row, fmt::format("{} must ascend: {} {} comes after {} {}", what, value, unit, list.back(), unit));
    list.push_back(value);
  };
  for (std::size_t n = 0; n < text.rows() && T[n] == T.front(); ++n) append(depths, depth[n], n, "depths", 'm');
  for (std::size_t n = 0; n < text.rows(); ++n) {
    const std::size_t k = n % depths.size();
    if (k == 0) append(table.T_, T[n], n, "temperatures", 'K');
    if (T[n] != table.T_.back() || depth[n] != depths[k])
      text.fail_at(n,
                   fmt::format("the table is not rectangular: {} K, {} m is wanted here, for every temperature has the "
                               "depths of the first",
                               table.T_.back(), depths[k]));
    if (!(viscosity[n] > 0.0))
      text.fail_at(n, columns[2], fmt::format("the viscosity must be above 0, not {}", viscosity[n]));
    table.log_.push_back(std::log(viscosity[n]));
  }
  if (text.rows() % depths.size() != 0)
    text.fail_at(text.rows() - 1, fmt::format("the table is not rectangular: at {} K there are {} of {} depths",
                                              table.T_.back(), text.rows() % depths.size(), depths.size()));
  return table;
}

double viscosity_table::log(double T, double depth) const {
  const auto t = find(T_, T), z = find(depth_, depth);
  const std::size_t n = depth_.size();
  const double low = std::lerp(log_[t.first * n + z.first], log_[t.next * n + z.first], t.s);
  const double high = std::lerp(log_[t.first * n + z.next], log_[t.next * n + z.next], t.s);
  return std::lerp(low, high, z.s);
}

bool viscosity_table::covers(double T, double depth) const {
  const auto within = [](const std::vector<double>& x, double at) {
    return x.size() == 1 || (at >= x.front() && at <= x.back());
  };
  return within(T_, T) && within(depth_, depth);
}

namespace {

// Pressure of a column at rest, Pa.
double pressure_at(const options& o, const parameters& p, double depth) {
  if (p.weighed) return p.weighed->pressure(p.fluid.L - depth);
  return o.convection.p_top + p.fluid.rho * p.fluid.g * depth;
}

std::vector<double> evenly(double first, double last, std::size_t steps) {
  std::vector<double> all;
  for (std::size_t k = 0; k <= steps; ++k)
    all.push_back(std::lerp(first, last, static_cast<double>(k) / static_cast<double>(steps)));
  return all;
}

// Melt fraction f between solidus and liquidus, and the viscosity by it (melting/melting.hpp).
viscosity_table by_melt(const options& o, const parameters& p) {
  const auto& c = o.convection;
  const auto kind =
      c.composition == "chondritic" ? melting::composition::chondritic : melting::composition::peridotitic;
  const double T_top = o.temperature_cold(), T_bottom = o.temperature_hot();
  const double beyond = 0.1 * std::abs(T_bottom - T_top);
  const double coldest = std::max(std::min(T_top, T_bottom) - beyond, 1.0),
               hottest = std::max(T_top, T_bottom) + beyond;
  return {evenly(coldest, hottest, 512), evenly(0.0, p.fluid.L, 256), [&](double T, double depth) {
            const double P = pressure_at(o, p, depth);
            const double f = melting::melt_fraction(T, melting::solidus(P), melting::liquidus(kind, P));
            const double eta =
                c.melt_viscosity == "blended" ? melting::blended_viscosity(T, f) : melting::suspension_viscosity(T, f);
            return std::clamp(eta, c.viscosity_min, c.viscosity_max);
          }};
}

viscosity_table from_file(const namelist::schema& schema, const options& o, double L) {
  const auto& c = o.convection;
  if (c.viscosity_file.empty())
    schema.fail("convection", "viscosity_file", "viscosity_law = 'table' needs the name of its file");
  auto table = schema.placed("convection", "viscosity_file", [&] { return viscosity_table::read(c.viscosity_file); });
  for (const double T : {o.temperature_cold(), o.temperature_hot()})
    for (const double depth : {0.0, L})
      if (!table.covers(T, depth))
        schema.fail("convection", "viscosity_file",
                    fmt::format("'{}' has {} to {} K and {} to {} m; the layer has {} K and a depth of {} m",
                                c.viscosity_file, table.temperatures().front(), table.temperatures().back(),
                                table.depths().front(), table.depths().back(), T, depth));
  return table;
}

// By the exponential law, or by one of its named cases [Blankenbach et al., Geophys. J. Int. 98, 23 (1989)].
void follow_exponents(const namelist::schema& schema, convection_options& c, viscosity_law& law) {
  const auto named = [&](const char* name, double of_temperature, double of_depth) {
    if (c.viscosity_law != name) return;
    const auto set = [&](const char* key, double& value, double wanted) {
      if (schema.given("convection", key) && std::abs(value - wanted) > 1e-12 * (1.0 + wanted))
        schema.fail("convection", key,
                    fmt::format("viscosity_law = '{}' has {} here: choose 'exponential'", name, wanted));
      value = wanted;
    };
    set("temperature_exponent", c.temperature_exponent, of_temperature);
    set("depth_exponent", c.depth_exponent, of_depth);
  };
  named("blankenbach_2a", std::log(1000.0), 0.0);
  named("blankenbach_2b", std::log(16384.0), std::log(64.0));
  law.b = c.temperature_exponent;
  law.c = c.depth_exponent;
  law.log_middle = 0.5 * (law.c - law.b);
}

// The viscosity of the top, which is that of the fluid unless numbers are given, and of the middle of the conductive
// state.
void follow_table(const options& o, parameters& p) {
  constexpr int places = 100;  // over the height
  const auto& c = o.convection;
  auto& f = p.fluid;
  auto& law = p.law;
  const double T_top = o.temperature_cold(), T_bottom = o.temperature_hot();
  law.log_reference = law.table->log(T_top, 0.0);
  const bool scaled = c.rayleigh || c.prandtl;
  if (!scaled) f.nu = std::exp(law.log_reference) / f.rho;
  double least = law.log_reference, most = least;
  for (int k = 0; k < places; ++k) {
    const double s = (k + 0.5) / places, here = law.table->log(std::lerp(T_top, T_bottom, s), s * f.L);
    law.log_middle += (here - law.log_reference) / places;
    least = std::min(least, here), most = std::max(most, here);
  }
  const double top = f.rho * f.nu;
  p.lines.push_back(fmt::format(
      "viscosity by {}: {:.4g} to {:.4g} Pa s in the conductive state{}; Rayleigh number and xi are those of the top's "
      "viscosity, {:.4g} Pa s",
      c.viscosity_law == "table" ? "'" + c.viscosity_file + "'" : "melt fraction",
      top * std::exp(least - law.log_reference), top * std::exp(most - law.log_reference),
      scaled ? fmt::format(" (scaled by {:.4g} to the Rayleigh number asked for)", top / std::exp(law.log_reference))
             : "",
      top));
}

}  // namespace

void resolve_viscosity(const namelist::schema& schema, options& o, parameters& p) {
  auto& c = o.convection;
  auto& law = p.law;
  const bool table = c.viscosity_law == "table", melt = c.viscosity_law == "melt";
  law = {};
  law.varies = c.viscosity_law != "constant";
  law.T_top = o.temperature_cold();
  law.dT = p.fluid.dT;
  law.L = p.fluid.L;
  if (!table && !melt) return follow_exponents(schema, c, law);
  if (melt && !(std::min(o.temperature_cold(), o.temperature_hot()) > 0.0))
    schema.fail("convection", "viscosity_law", "'melt' needs absolute temperatures: those of top and bottom above 0 K");
  if (c.viscosity_max < c.viscosity_min) schema.fail("convection", "viscosity_max", "is below viscosity_min");
  law.table = std::make_shared<viscosity_table>(
      table ? from_file(schema, o, p.fluid.L)
            : schema.placed("convection", "viscosity_law", [&] { return by_melt(o, p); }));
  follow_table(o, p);
}

}  // namespace tetsuame::convection
