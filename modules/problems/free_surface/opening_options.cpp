#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <free_surface/input.hpp>
#include <limits>

namespace tetsuame::free_surface {

bool opening::holds(const std::array<double, 3>& x) const {
  for (std::size_t a = 0; a < 3; ++a)
    if (high[a] > low[a] && !(x[a] >= low[a] && x[a] < high[a])) return false;
  return true;
}

namespace {

const std::vector<std::string> variables{"x", "y", "z", "t", "length_x", "length_y", "length_z", "spacing"};
constexpr std::size_t most_openings = 16;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

void declare_group(namelist::schema& schema, const char* group, const char* of, opening_options& o) {
  schema.add(group, "side", o.side,
             {.choices = {walls::side_names.begin(), walls::side_names.end()},
              .maximum_size = most_openings,
              .meaning = std::string("of the box, through which water ") + of});
  const auto list = [](std::string meaning) {
    return namelist::key_info{.unit = "m",
                              .maximum_size = most_openings,
                              .sparse = true,
                              .may_be_left_open = true,
                              .meaning = std::move(meaning)};
  };
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string only = a == 2 ? " (3-D only)" : "";
    schema.add(group, along("low_", a), o.low[a], list("where along it the section begins; not given: 0" + only));
    schema.add(group, along("high_", a), o.high[a], list("where it ends; not given: the box's edge" + only));
  }
}

// What &inflow or &outflow says of its section n.
struct reader {
  const namelist::schema& schema;
  const options& o;
  const opening_options& given;
  const char* group;
  bool enters;
  std::size_t n;

  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    schema.fail_at(group, key, n, message);
  }
  double of(const std::vector<double>& list) const { return n < list.size() ? list[n] : none; }

  opening read() const {
    opening e;
    e.enters = enters;
    const auto side =
        static_cast<std::size_t>(std::ranges::find(walls::side_names, given.side[n]) - walls::side_names.begin());
    e.axis = side / 2;
    if (e.axis >= o.domain.axes()) fail("side", "in two dimensions there is no " + given.side[n]);
    if (o.domain.periodic[e.axis]) fail("side", "the box is periodic across it: there is no side");
    e.box = o.domain.length;
    e.spacing = o.domain.dx();
    e.position = side % 2 == 0 ? 0.0 : o.domain.length[e.axis];
    e.inward = side % 2 == 0 ? 1.0 : -1.0;
    find_zone(e);
    if (enters) find_velocity(e);
    find_level(e);
    return e;
  }

 private:
  // As long as the kernel reaches beyond what moves until lists are made anew, in whole layers, of which the last may
  // have gone on by one half.
  void find_zone(opening& e) const {
    const double reach = run::support_over_dx(o.common.kernel) + o.common.kernel.skin;
    e.length = e.spacing * std::ceil(reach + 0.5 - 1e-9);
    for (std::size_t a = 0; a < o.domain.axes(); ++a) {
      if (a == e.axis) continue;
      const double low = of(given.low[a]), high = of(given.high[a]);
      e.low[a] = std::isnan(low) ? 0.0 : low;
      e.high[a] = std::isnan(high) ? o.domain.length[a] : high;
      expect_on_lattice(along("low_", a), a, e.low[a]);
      expect_on_lattice(along("high_", a), a, e.high[a]);
      if (!(e.high[a] > e.low[a]))
        fail(along("high_", a),
             fmt::format("expected more than where it begins, {} m, found {} m", e.low[a], e.high[a]));
    }
    // Nothing ends water that rises above an open top.
    const bool rises = !enters && e.axis != 1 && o.open_top() && std::isnan(of(given.high[1]));
    if (rises) e.high[1] = std::numeric_limits<double>::infinity();
    for (std::size_t a = 0; a < 3; ++a)
      for (const auto& [key, list] : {std::pair{"low_", &given.low[a]}, std::pair{"high_", &given.high[a]}})
        if ((a == e.axis || a >= o.domain.axes()) && !std::isnan(of(*list)))
          fail(along(key, a), "a section has edges along the side alone");
    if (e.length > o.domain.length[e.axis] * (1.0 + 1e-9))
      fail("side", fmt::format("its zone is {:.6g} m long, and the box {} m", e.length, o.domain.length[e.axis]));
    e.low[e.axis] = e.inward > 0.0 ? 0.0 : e.position - e.length;
    e.high[e.axis] = e.inward > 0.0 ? e.length : e.position;
  }
  void expect_on_lattice(const std::string& key, std::size_t a, double at) const {
    const double length = o.domain.length[a], spacings = at / o.domain.dx();
    if (at < 0.0 || at > length * (1.0 + 1e-9))
      fail(key, fmt::format("outside the box: {} m, where it reaches from 0 to {} m", at, length));
    if (std::abs(spacings - std::round(spacings)) > 1e-6)
      fail(key, fmt::format("expected a whole number of particle spacings, {} m each, found {:.6g}", o.domain.dx(),
                            spacings));
  }

  void find_velocity(opening& e) const {
    if (n >= given.velocity.size() || given.velocity[n].empty()) fail("velocity", "must be given: how fast it enters");
    e.text = given.velocity[n];
    const auto constants = regions::named(schema, o.of_regions, variables);
    e.velocity = schema.placed(group, "velocity", [&] { return regions::expression(e.text, variables, constants); });
    // At the start it may be 0.
    for_each_row(e, [&](const point& x) {
      const double u = e.speed(x, 0.0);
      if (!(u >= 0.0) || !std::isfinite(u))
        fail("velocity", fmt::format("expected 0 or more, inwards, found {:.6g} m/s at ({:.6g}, {:.6g}, {:.6g}) m", u,
                                     x[0], x[1], x[2]));
    });
  }

  // Of what enters or leaves upright the pressure at the zone's upper end is none.
  void find_level(opening& e) const {
    const double level = of(given.level);
    if (!std::isnan(level)) {
      if (e.axis == 1) fail("level", "is of sections in upright sides");
      if (level < e.low[1] || level > o.domain.length[1] * (1.0 + 1e-9))
        fail("level", fmt::format("expected a height between that where the section begins, {} m, and the box's, {} m, "
                                  "found {} m",
                                  e.low[1], o.domain.length[1], level));
      e.level = level;
    } else if (enters) {
      e.level = e.axis == 1 && e.inward < 0.0 ? e.low[1] : e.high[1];
    }
  }

 public:
  // f(place) of each row of a zone's lattice.
  template <class F>
  static void for_each_row(const opening& e, const F& f) {
    std::array<std::int64_t, 3> number{1, 1, 1}, row{};
    for (std::size_t a = 0; a < 3; ++a)
      if (a != e.axis && e.high[a] > e.low[a]) number[a] = std::llround((e.high[a] - e.low[a]) / e.spacing);
    for (row[2] = 0; row[2] < number[2]; ++row[2])
      for (row[1] = 0; row[1] < number[1]; ++row[1])
        for (row[0] = 0; row[0] < number[0]; ++row[0]) {
          point x{};
          for (std::size_t a = 0; a < 3; ++a)
            if (e.high[a] > e.low[a]) x[a] = e.low[a] + (static_cast<double>(row[a]) + 0.5) * e.spacing;
          f(x);
        }
  }
};

bool overlap(const opening& a, const opening& b, std::size_t axes) {
  for (std::size_t k = 0; k < axes; ++k)
    if (!(std::min(a.high[k], b.high[k]) > std::max(a.low[k], b.low[k]) + 1e-6 * a.spacing)) return false;
  return true;
}

// Entering water needs room.
template <int D>
void expect_clear(const namelist::schema& schema, const parameters& p) {
  const auto& bodies = p.bodies_in<D>();
  if (bodies.empty()) return;
  for (std::size_t n = 0; n < p.openings.size() && p.openings[n].enters; ++n) {
    const auto& e = p.openings[n];
    const auto layers = std::llround(e.length / e.spacing);
    reader::for_each_row(e, [&](point x) {
      for (std::int64_t k = 0; k < layers; ++k) {
        x[e.axis] = e.low[e.axis] + (static_cast<double>(k) + 0.5) * e.spacing;
        const auto at = solids::point<D>::of([&](std::size_t a) { return x[a]; });
        for (const auto& body : bodies)
          if (body.solid(at))
            schema.fail_at("inflow", "side", n,
                           fmt::format("body '{}' of &solids stands in the section's zone, which is {:.6g} m long",
                                       body.name(), e.length));
      }
    });
  }
}

}  // namespace

double opening::speed(const std::array<double, 3>& x, double t) const {
  std::array<double, 3> at = x;
  at[axis] = position + inward * length;
  return velocity->at(std::array{at[0], at[1], at[2], t, box[0], box[1], box[2], spacing});
}

void declare_openings(namelist::schema& schema, options& o) {
  schema.group("inflow",
               "sections of the sides through which water enters; may stand several times. Within the box lies a zone "
               "as long as the kernel reaches, whose water moves with the velocity that is given");
  declare_group(schema, "inflow", "enters", o.inflow);
  schema.add("inflow", "velocity", o.inflow.velocity,
             {.unit = "m/s",
              .maximum_size = most_openings,
              .sparse = true,
              .formula = true,
              .meaning = "inwards, 0 or more: a number, or an expression of x, y, z (m), t (s), length_x, length_y, "
                         "length_z, spacing (m), pi and &constants"});
  const auto level = [](std::string meaning) {
    return namelist::key_info{.unit = "m",
                              .minimum = 0.0,
                              .maximum_size = most_openings,
                              .sparse = true,
                              .may_be_left_open = true,
                              .meaning = std::move(meaning)};
  };
  schema.add("inflow", "level", o.inflow.level,
             level("height of the surface by whose weight entering water is under pressure; not given: the section's "
                   "upper edge"));
  schema.group(
      "outflow",
      "sections through which it leaves; may stand several times. Within the box lies such a zone, whose water "
      "moves outwards as that before it, and is taken away at the side");
  declare_group(schema, "outflow", "leaves", o.outflow);
  schema.add(
      "outflow", "level", o.outflow.level,
      level("height of the surface by whose weight water there is under pressure, which holds the depth of water "
            "slower than its waves; not given: the pressure is that of the water before it"));
}

void find_openings(const namelist::schema& schema, const options& o, parameters& p) {
  for (const auto& [given, group, enters] :
       {std::tuple{&o.inflow, "inflow", true}, std::tuple{&o.outflow, "outflow", false}}) {
    std::size_t most = std::max(given->level.size(), given->velocity.size());
    for (std::size_t a = 0; a < 3; ++a) most = std::max({most, given->low[a].size(), given->high[a].size()});
    if (most > given->side.size()) schema.fail(group, "side", "must be given, for each section");
    for (std::size_t n = 0; n < given->side.size(); ++n)
      p.openings.push_back(reader{schema, o, *given, group, enters, n}.read());
  }
}

void check_openings(const namelist::schema& schema, const options& o, const parameters& p) {
  if (p.openings.empty()) return;
  const char* group = p.openings.front().enters ? "inflow" : "outflow";
  const std::size_t inflows = o.inflow.side.size();
  for (std::size_t n = 0; n < p.openings.size(); ++n)
    for (std::size_t k = 0; k < n; ++k)
      if (overlap(p.openings[k], p.openings[n], o.domain.axes())) {
        const bool enters = n < inflows;
        schema.fail_at(enters ? "inflow" : "outflow", "side", enters ? n : n - inflows,
                       "its zone and that of another section overlap: leave room between them");
      }
  if (!o.common.start.file.empty())
    schema.fail(group, "side", "a snapshot does not say which of its water enters or leaves: &initial file");
  if (o.common.start.settles())
    schema.fail(group, "side", "water that enters or leaves does not settle: &initial settle");
  if (o.flow.start != "rest") schema.fail(group, "side", "goes with start = 'rest', where &region may give velocities");
  if (o.flow.surface_tension > 0.0)
    schema.fail(group, "side", "is not for water with surface_tension: nothing holds its surface at the section");
  if (o.domain.dimension == 3)
    expect_clear<3>(schema, p);
  else
    expect_clear<2>(schema, p);
}

double fastest_inflow(const options& o, const parameters& p) {
  constexpr int times = 20;  // of the run, where it changes
  double most = 0.0;
  for (const auto& e : p.openings) {
    if (!e.enters) continue;
    for (int k = 0; k <= (e.changes_with_time() ? times : 0); ++k)
      reader::for_each_row(e, [&](const point& x) {
        const double u = e.speed(x, o.common.time.end() * k / times);
        if (std::isfinite(u)) most = std::max(most, u);
      });
  }
  return most;
}

}  // namespace tetsuame::free_surface
