#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <theory/drop.hpp>
#include <theory/free_slip_box.hpp>
#include <theory/stokes_box.hpp>
#include <two_fluids/cloud.hpp>
#include <two_fluids/groups.hpp>

namespace tetsuame::two_fluids {

void declare_drops(namelist::schema& schema, const char* group, options& o) {
  schema.add(group, "radius", o.radius, positive("m", "of the drop"));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add(group, axis_names[a], o.centre[a],
               not_negative("m", "its centre; not given: the middle, y at 0.75 of the height"));
  schema.add(group, "measure_at", o.measure_at,
             for_expert(between(0.0, 1.0, "height over the box's where the velocity is measured")));
  schema.add(group, "shape", o.shape,
             {.choices = {"round", "square"},
              .expert = true,
              .meaning = "at the start; square (a cube): of the round one's volume"});
  schema.add(group, "elongation", o.elongation,
             for_expert(positive("1", "at the start, extent along y over that across, at the same volume")));
  schema.add(group, "drops", o.drops,
             between(1, 1e5, "how many; several lie where they are drawn, all over the box, or at places_x …"));
  schema.add(group, "seed", o.seed, {.minimum = 0, .expert = true, .meaning = "of the places drawn"});
  schema.add(group, "least_gap", o.least_gap,
             for_expert(not_negative(
                 "m", "several drops: between the surfaces of two drawn, and to walls; not given: two spacings")));
  for (std::size_t a = 0; a < 3; ++a)
    schema.add(group, std::string("places_") + axis_names[a], o.places[a],
               for_expert(not_negative("m", "several drops: their centres, in the place of drawn ones")));
  for (auto [key, value, meaning] : {std::tuple{"measure_from", &o.measure_from, "not given: the start"},
                                     {"measure_until", &o.measure_until, "not given: the end"}})
    schema.add(group, key, *value,
               for_expert(not_negative(
                   "s", std::string("several drops: of the time over which their fall is measured; ") + meaning)));
}

// Along the contact the stress of surface tension is up to (1 - 1/d) sigma |G|, |G| = 0.4/dx (terms.hpp): a
// pressure below that leaves the particles there under tension, in which no lattice is stable.
void warn_of_tension(const options& o, parameters& p, double y) {
  const double pressure = p.base->at(std::min(y, o.domain.length[1])).pressure,
               least = 0.4 * (1.0 - 1.0 / static_cast<double>(o.domain.dimension)) * o.surface_tension / p.dx;
  if (o.surface_tension > 0.0 && pressure < 2.0 * least)
    p.lines.push_back(fmt::format(
        "warning: surface tension puts the contact under a tension of up to {:.3g} Pa, and the pressure there "
        "is {:.3g} Pa: particles will clump, and make energy; raise p_top",
        least, pressure));
}

// What a drop with surface tension is held against.
void find_tension(const options& o, parameters& p, double outside, double top_of_drops) {
  if (!(o.surface_tension > 0.0)) return;
  const int dimension = static_cast<int>(o.domain.dimension);
  p.oscillation_period =
      2.0 * std::numbers::pi /
      theory::oscillation_frequency(2, dimension, o.surface_tension, o.radius, outside + p.density_difference, outside);
  warn_of_tension(o, p, top_of_drops);
  p.bond_number = std::abs(p.density_difference) * o.gravity * o.radius * o.radius / o.surface_tension;
  p.lines.push_back(fmt::format(
      "Bond number {:.4g}; largest stable radius {:.4g} m (Rayleigh-Taylor waves on the front)", p.bond_number,
      p.density_difference == 0.0 ? std::numeric_limits<double>::infinity()
                                  : theory::largest_radius(o.surface_tension, p.density_difference, o.gravity)));
}

namespace {

// Finite differences over the box, a few cells to the radius, in a fraction of a second and some tens of megabytes: no
// more than 8000 cells, and where a radius then has less than two, none.
std::optional<int> cells_across(const domain::options& d, double radius) {
  constexpr double most = 8000.0;
  const double wanted = std::ceil(6.0 * d.length[0] / radius),
               affordable = std::floor(std::sqrt(most * d.length[0] / d.length[1])),
               cells = std::min(wanted, affordable);
  if (!(cells >= 8.0 && cells * radius >= 2.0 * d.length[0])) return std::nullopt;
  return static_cast<int>(cells);
}

constexpr double most_terms = 2e7;  // of a Fourier series: a second

// Of one drop with its centre there: creeping flow about it.
std::optional<double> find_fall_of_one(const options& o, const parameters& p, const std::array<double, 3>& at,
                                       std::string& about) {
  const auto& d = o.domain;
  const double eta = o.material[0].viscosity, eta_drop = o.material[1].viscosity;
  const auto w = slips_of(o);
  if (d.dimension == 2) {
    const auto sides = [](const std::string& slip) {
      return slip == "no_slip" ? theory::sides::no_slip : theory::sides::free_slip;
    };
    if (w.floor != w.lid || w.sides == "different") {
      about = "no theory for walls that differ from those on the other side";
      return std::nullopt;
    }
    const theory::drop_in_box box{d.length[0],   d.length[1],
                                  o.radius,      at[0],
                                  at[1],         eta,
                                  eta_drop,      p.density_difference,
                                  o.gravity,     d.periodic[0] ? theory::sides::periodic : sides(w.sides),
                                  sides(w.floor)};
    const auto cells = cells_across(d, o.radius);
    about = cells ? "creeping flow about the round drop in this box (finite differences)"
                  : "no theory: the drop is too small beside the box for finite differences over it";
    return cells ? std::optional(theory::fall_velocity_extrapolated(box, *cells)) : std::nullopt;
  }
  if (w.all_free()) {
    const theory::drop_among_free_slip one{3,   d.length, d.periodic,           o.radius, at,
                                           eta, eta_drop, p.density_difference, o.gravity};
    const bool affordable = theory::terms_of_fall(one) <= most_terms;
    about = affordable ? "creeping flow about the round drop in this box (Fourier series)"
                       : "no theory: the drop is too small beside the box for its Fourier series";
    return affordable ? std::optional(theory::fall_velocity(one)) : std::nullopt;
  }
  about = "in three dimensions there is a theory for free-slip walls only";
  return std::nullopt;
}

// Of several drops: where they lie.
void find_places(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  const bool deep = d.dimension == 3;
  for (const char* key : {"x", "y", "z"})
    if (schema.given("drop", key)) schema.fail("drop", key, "is of one drop");
  if (schema.given("drop", "measure_at") && o.measure_at != 0.5)  // which a resolved input has
    schema.fail("drop", "measure_at", "is of one drop");
  refuse(schema, "drop", {"shape", "elongation"}, "several drops are round at the start");
  o.measure_at = 0.5;
  for (std::size_t a = 0; a < d.axes(); ++a)
    if (2.0 * o.radius > d.length[a]) schema.fail("drop", "radius", "the drops must lie inside the box");
  if (!o.places[0].empty()) {
    refuse(schema, "drop", {"least_gap", "seed"}, "is of drops that are drawn, and places are given");
    for (std::size_t n = 0; n < o.places[0].size(); ++n) {
      const std::array<double, 3> at{o.places[0][n], o.places[1][n], deep ? o.places[2][n] : 0.0};
      for (std::size_t a = 0; a < d.axes(); ++a)
        if (!d.periodic[a] && (at[a] < o.radius || at[a] > d.length[a] - o.radius))
          schema.fail("drop", std::string("places_") + axis_names[a], "the drops must lie inside the box");
      for (const auto& other : p.places)
        if (distance(d, at, other) < 2.0 * o.radius) schema.fail("drop", "places_x", "two drops overlap");
      p.places.push_back(at);
    }
  } else {
    if (!o.least_gap) o.least_gap = 2.0 * p.dx;
    const auto drawn = drawn_places(d, o.radius, *o.least_gap, o.drops, o.seed);
    if (!drawn)
      schema.fail("drop", "drops",
                  fmt::format("{} drops of radius {:.6g} m do not fit into the box at random, {:.6g} m from each other "
                              "and from the walls",
                              o.drops, o.radius, *o.least_gap));
    p.places = *drawn;
  }
}

// What their fall is held against.
void find_cloud(const options& o, parameters& p) {
  const auto& d = o.domain;
  const bool deep = d.dimension == 3;
  const auto number = static_cast<double>(p.places.size());
  const double size = std::numbers::pi * o.radius * o.radius * (deep ? 4.0 / 3.0 * o.radius : 1.0),
               fraction = number * size / (d.length[0] * d.length[1] * (deep ? d.length[2] : 1.0));
  const double eta = o.material[0].viscosity, eta_drop = o.material[1].viscosity;
  const double y = 0.5 * d.length[1], weight = p.density_difference * o.gravity;
  std::string about;
  p.fall_alone = find_fall_of_one(o, p, {0.5 * d.length[0], y, 0.5 * d.length[2]}, about);
  const theory::drop one{o.radius, p.density_difference, o.gravity, eta, eta_drop};
  if (fraction <= 0.1)
    p.fall_array = deep ? theory::hadamard_rybczynski(one) * theory::cubic_array_factor(fraction, eta_drop / eta)
                        : weight * o.radius * o.radius / eta * theory::square_array_velocity(fraction, eta_drop / eta);
  const double reynolds =
      2.0 * o.radius * p.base->at(y).density *
      std::abs(p.fall_alone.value_or(deep ? theory::hadamard_rybczynski(one) : p.fall_array.value_or(0.0))) / eta;
  if (fraction <= 0.6) p.hindered = theory::hindered_settling_factor(fraction, reynolds);
  const auto w = slips_of(o);
  const theory::drop_among_free_slip all{
      static_cast<int>(d.dimension), d.length, d.periodic, o.radius, {}, eta, eta_drop,
      p.density_difference,          o.gravity};
  if (!(w.all_free() && eta == eta_drop)) {
    p.theory_about = "for several drops there is a theory for free-slip walls and equal viscosities only";
  } else if (theory::terms_of_mean_fall(all, p.places.size()) > 5.0 * most_terms) {
    p.theory_about = "no theory: the drops are too many, or too small beside the box, for their Fourier series";
  } else {
    p.theory_fall = theory::mean_fall_velocity(all, p.places);
    p.theory_about = "creeping flow about the round drops as they lie at the start (Fourier series)";
  }
  p.lines.push_back(fmt::format("{} drops, volume fraction {:.4g}", p.places.size(), fraction));
}

// One drop, whose place may be left open: it lies in the box, and is measured on its way.
void check_the_drop(const namelist::schema& schema, options& o, const parameters& p, double y) {
  const auto& d = o.domain;
  const bool deep = d.dimension == 3;
  const double height = d.length[1];
  const double dimensions = deep ? 3.0 : 2.0;
  const double thinnest =
      o.radius * std::min(std::pow(o.elongation, -1.0 / dimensions), std::pow(o.elongation, 1.0 - 1.0 / dimensions));
  if (thinnest < p.dx)
    schema.fail("drop", "elongation",
                fmt::format("leaves the drop {:.6g} m wide about its middle, less than the particle spacing, {:.6g} m",
                            thinnest, p.dx));
  refuse(schema, "drop", {"seed", "least_gap", "measure_from", "measure_until"}, "is of several drops");
  const std::array<double, 3> middle{0.5 * d.length[0], 0.75 * height, 0.5 * d.length[2]};
  for (std::size_t a = 0; a < 3; ++a)
    if (!o.centre[a]) o.centre[a] = middle[a];
  for (std::size_t a = 0; a < d.axes(); ++a)
    if (*o.centre[a] < o.radius || *o.centre[a] > d.length[a] - o.radius)
      schema.fail("drop", axis_names[a], "the drop must lie inside the box");
  if (!(y > o.radius && y < *o.centre[1] - 0.02 * height))
    schema.fail(
        "drop", "measure_at",
        "must be lower than the drop starts, by a fiftieth of the height at least, and the drop above the floor");
}

}  // namespace

// Difference of density and terminal velocity at the height where it is measured.
void find_fall(const namelist::schema& schema, options& o, parameters& p) {
  const auto& d = o.domain;
  const bool deep = d.dimension == 3;
  const double height = d.length[1];
  const auto& given = o.places;
  if (o.radius < p.dx)
    schema.fail(
        "drop", "radius",
        fmt::format("expected at least the particle spacing, {:.6g} m, found {:.6g}: a drop takes six of them to "
                    "be resolved",
                    p.dx, o.radius));
  for (std::size_t a = 0; a < 3; ++a)
    if (given[a].size() != (a < 2 || deep ? given[0].size() : 0))
      schema.fail("drop", std::string("places_") + axis_names[a],
                  "as many numbers as drops along each axis, and none along z in two dimensions");
  if (!given[0].empty()) {
    const auto number = static_cast<std::int64_t>(given[0].size());
    if (schema.given("drop", "drops") && o.drops != number) schema.fail("drop", "drops", "is not the number of places");
    if (number < 2) schema.fail("drop", "places_x", "one drop's place is x, y, z");
    o.drops = number;
  }
  const bool many = o.drops > 1;
  const double y = (many ? 0.5 : o.measure_at) * height;
  const barotropic inside{&(*p.material)[1], o.p_top, o.temperature, o.temperature_law == "adiabatic"};
  const place here = p.base->at(y);
  p.density_difference =
      schema.placed("drop", "eos_drop", [&] { return at_pressure(inside, here.pressure).density; }) - here.density;
  if (many) {
    find_places(schema, o, p);
    schema.placed("drop", "drops", [&] { find_cloud(o, p); });
    for (auto [key, value] : {std::pair{"measure_from", o.measure_from}, {"measure_until", o.measure_until}})
      if (value && *value > o.common.time.end()) schema.fail("drop", key, "is after the end of the run");
    if (o.measure_from && o.measure_until && !(*o.measure_until > *o.measure_from))
      schema.fail("drop", "measure_until", "must be after measure_from");
    double highest = 0.0;
    for (const auto& at : p.places) highest = std::max(highest, at[1]);
    find_tension(o, p, here.density, highest + o.radius);
    return;
  }
  check_the_drop(schema, o, p, y);
  p.places = {{*o.centre[0], *o.centre[1], *o.centre[2]}};
  find_tension(o, p, here.density, *o.centre[1] + o.radius);
  p.theory_fall = schema.placed("drop", "radius", [&] {
    return find_fall_of_one(o, p, {*o.centre[0], y, *o.centre[2]}, p.theory_about);
  });
}

}  // namespace tetsuame::two_fluids
