#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <foundation/files.hpp>
#include <numbers>
#include <solids/options.hpp>

namespace tetsuame::solids {

namespace {

constexpr std::array<const char*, 3> axes{"x", "y", "z"};

namelist::key_info list(std::size_t most, std::string unit, std::string meaning, double minimum = -1e300) {
  return {.unit = std::move(unit),
          .minimum = minimum,
          .maximum = 1e300,
          .maximum_size = most,
          .sparse = true,
          .meaning = std::move(meaning)};
}
namelist::key_info names(std::size_t most, std::vector<std::string> choices, std::string meaning) {
  return {.choices = std::move(choices), .maximum_size = most, .sparse = true, .meaning = std::move(meaning)};
}
namelist::key_info files(std::size_t most, std::string meaning) {
  auto info = names(most, {}, std::move(meaning));
  info.file = namelist::file_of::run;
  return info;
}

void declare_axes(namelist::schema& schema, const char* group, const std::string& name,
                  std::array<std::vector<double>, 3>& to, const namelist::key_info& info) {
  for (std::size_t k = 0; k < 3; ++k) schema.add(group, name + "_" + axes[k], to[k], info);
}

// Element n; of a shorter list what an element that is not given has.
double of(const std::vector<double>& values, std::size_t n) { return n < values.size() ? values[n] : 0.0; }
std::string of(const std::vector<std::string>& texts, std::size_t n, const char* otherwise) {
  return n < texts.size() && !texts[n].empty() ? texts[n] : otherwise;
}

template <int D>
point<D> vector_of(const std::array<std::vector<double>, 3>& components, std::size_t n) {
  return point<D>::of([&](std::size_t k) { return of(components[k], n); });
}

// Of triangles where they stand, m: what products of their coordinates can hold, and not lost beside them.
void expect_known_places(const std::string& name, double extent, double reach) {
  constexpr double most = 1e30, least = 1e-30, lost = 1e-9;
  if (!(reach <= most))
    foundation::fail_input(
        fmt::format("{}: with its scale and place the surface reaches {:.3g} m far; expected: at most {:.0e} m", name,
                    reach, most));
  if (!(extent >= std::max(least, lost * reach)))
    foundation::fail_input(fmt::format(
        "{}: with its scale the surface is {:.3g} m large, and stands {:.3g} m away: rounding would lose it", name,
        extent, reach));
}

// The pieces' lists, and what goes wrong with piece n of them.
struct reader {
  const namelist::schema& schema;
  const options& o;
  const words& called;

  std::string body(std::size_t n) const { return of(o.body, n, "solid"); }

  [[noreturn]] void fail(const std::string& key, std::size_t n, const std::string& message) const {
    schema.fail(called.group, key,
                fmt::format("piece {} ('{}' of {} '{}'): {}", n + 1, o.shape[n], called.whole, body(n), message));
  }

  // A length that the shape has, or has not.
  double length(const std::string& key, const std::vector<double>& values, std::size_t n, bool has) const {
    const double value = of(values, n);
    if (has && !(value > 0.0)) fail(key, n, "expected a length above 0");
    if (!has && value != 0.0) fail(key, n, "this shape has none");
    return value;
  }

  template <int D>
  void expect_dimensions(std::size_t n) const {
    if constexpr (D == 2)
      for (const auto& [key, values] : {std::pair{"centre_z", &o.centre[2]},
                                        {"length_z", &o.length[2]},
                                        {"angle_x", &o.angle[0]},
                                        {"angle_y", &o.angle[1]}})
        if (of(*values, n) != 0.0) fail(key, n, "there is none in two dimensions");
  }

  faces<3> from_file(std::size_t n, const rotation<3>& R, const point<3>& shift) const {
    if (o.file.size() <= n || o.file[n].empty()) fail("file", n, "expected the name of an STL file");
    const double scale = of(o.scale, n) == 0.0 ? 1.0 : of(o.scale, n);
    return schema.placed(called.group, "file", [&] {
      auto all = read_stl(foundation::read_plain_file(o.file[n]), o.file[n]);
      expect_closed(all, o.file[n]);
      double extent = 0.0, reach = 0.0;  // m
      for (auto& p : all.points) {
        const auto scaled = scale * point<3>{p};
        extent = std::max(extent, norm<3>(scaled - scale * point<3>{all.points.back()}));
        p = (shift + turn<3>(R, scaled)).c;
        reach = std::max({reach, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
      }
      expect_known_places(o.file[n], extent, reach);
      return triangulated(std::make_shared<const mesh>(all, o.file[n]));
    });
  }

  template <int D>
  faces<D> bounds(std::size_t n) const {
    const std::string& shape = o.shape[n];
    expect_dimensions<D>(n);
    const bool tall = shape == "cylinder" || shape == "cone";
    for (std::size_t k = 0; k < D; ++k) length(std::string("length_") + axes[k], o.length[k], n, shape == "box");
    const double radius = length("radius", o.radius, n, tall || shape == "sphere" || shape == "bowl");
    const double height = length("height", o.height, n, tall);
    const double thickness = length("thickness", o.thickness, n, shape == "bowl");
    if (shape != "file" && !of(o.file, n, "").empty()) fail("file", n, "this shape has none");
    if (shape != "file" && of(o.scale, n) != 0.0) fail("scale", n, "this shape has none");
    const auto R = turned_by<D>({of(o.angle[0], n), of(o.angle[1], n), of(o.angle[2], n)});
    const auto centre = vector_of<D>(o.centre, n);
    if (shape == "file") {
      if constexpr (D == 3) return from_file(n, R, centre);
      fail("shape", n, "surfaces of triangles take three dimensions");
    }
    faces<D> all;
    if (shape == "plane") all = plane<D>();
    if (shape == "box") all = box<D>(vector_of<D>(o.length, n));
    if (shape == "sphere") all = sphere<D>(radius);
    if (shape == "cylinder") all = cylinder<D>(radius, height);
    if (shape == "cone") all = cone<D>(radius, height);
    if (shape == "bowl") all = bowl<D>(radius, thickness);
    return placed<D>(std::move(all), R, centre);
  }

  void expect_no_more_than_shapes() const {
    const auto expect = [&](const std::string& key, std::size_t size) {
      if (size > o.shape.size())
        schema.fail(called.group, key,
                    fmt::format("has {} elements, and shape {}: every piece takes a shape", size, o.shape.size()));
    };
    for (const auto& [key, texts] :
         {std::pair{called.whole, &o.body}, {"operation", &o.operation}, {called.side, &o.solid}, {"file", &o.file}})
      expect(key, texts->size());
    for (const auto& [key, values] :
         {std::pair{"radius", &o.radius}, {"height", &o.height}, {"thickness", &o.thickness}, {"scale", &o.scale}})
      expect(key, values->size());
    for (std::size_t k = 0; k < 3; ++k) {
      expect(std::string("centre_") + axes[k], o.centre[k].size());
      expect(std::string("length_") + axes[k], o.length[k].size());
      expect(std::string("angle_") + axes[k], o.angle[k].size());
    }
  }
};

// The motions' lists, and what goes wrong with motion n of them.
struct motion_reader {
  const namelist::schema& schema;
  const motion_options& o;

  [[noreturn]] void fail(const std::string& key, std::size_t n, const std::string& message) const {
    schema.fail("motions", key, fmt::format("motion {} (of body '{}'): {}", n + 1, o.body[n], message));
  }

  template <int D>
  about<D> axis(std::size_t n) const {
    if constexpr (D == 2) {
      return {{1.0}};
    } else {
      const auto a = vector_of<3>(o.axis, n);
      const double length = norm<3>(a);
      return length > 0.0 ? (1.0 / length) * a : unit<3>(2);
    }
  }

  bool is_free(std::size_t n) const { return of(o.kind, n, "harmonic") == "free"; }
  void expect_none(std::size_t n, const char* kind,
                   std::initializer_list<std::pair<const char*, const std::vector<double>*>> lists) const {
    for (const auto& [key, values] : lists)
      if (of(*values, n) != 0.0) fail(key, n, fmt::format("is not of a {} motion", kind));
  }

  free_options free(std::size_t n, int dimension) const {
    if (!of(o.file, n, "").empty()) fail("file", n, "a free motion has none");
    expect_none(n, "free",
                {{"period", &o.period},
                 {"phase", &o.phase},
                 {"amplitude_x", &o.amplitude[0]},
                 {"amplitude_y", &o.amplitude[1]},
                 {"amplitude_z", &o.amplitude[2]},
                 {"amplitude_angle", &o.amplitude_angle}});
    if (dimension == 2)
      expect_none(n, "two-dimensional", {{"gyration_x", &o.gyration[0]}, {"gyration_y", &o.gyration[1]}});
    free_options f{of(o.density, n), of(o.mass, n), {}, hinge(n, dimension), {}, {}};
    if ((f.density > 0.0) == (f.mass > 0.0)) fail("density", n, "a free body takes its density or its mass");
    for (std::size_t k = 0; k < 3; ++k) f.gyration[k] = of(o.gyration[k], n);
    if (dimension == 3) expect_inertia(n, f.gyration);
    const auto fail_here = [&](const std::string& key, const std::string& why) { fail(key, n, why); };
    if (dimension == 2)
      f.in_plane = restraint_of<2>(o.restraint, n, fail_here);
    else
      f.in_space = restraint_of<3>(o.restraint, n, fail_here);
    return f;
  }
  std::optional<point<3>> hinge(std::size_t n, int dimension) const {
    const auto at = vector_of<3>(o.pivot, n);
    for (std::size_t k = 0; k < 3; ++k) {
      if (at[k] == 0.0) continue;
      const auto key = std::string("pivot_") + axes[k];
      if (of(o.restraint.freedom, n, "all") != "turn") fail(key, n, "of free bodies those of freedom 'turn' have one");
      if (k == 2 && dimension == 2) fail(key, n, "there is none in two dimensions");
    }
    if (norm<3>(at) > 0.0) return at;
    return {};
  }
  // Radii of gyration about principal axes (m): all or none, and no square of one above the sum of the others',
  // whatever masses lie where.
  void expect_inertia(std::size_t n, const std::array<double, 3>& gyration) const {
    constexpr double slight = 1e-9;  // a plate's are equal to it
    const auto given = std::ranges::count_if(gyration, [](double k) { return k > 0.0; });
    if (given == 0) return;
    const auto key = [](std::size_t k) { return std::string("gyration_") + axes[k]; };
    for (std::size_t k = 0; k < 3; ++k)
      if (!(gyration[k] > 0.0))
        fail(key(k), n,
             "expected a length above 0: in three dimensions a body takes all three radii of gyration, or none");
    for (std::size_t k = 0; k < 3; ++k) {
      const double mine = gyration[k] * gyration[k];
      double others = -mine;
      for (const double radius : gyration) others += radius * radius;
      if (mine > (1.0 + slight) * others)
        fail(key(k), n,
             fmt::format(
                 "no body has a moment of inertia above the sum of its other two: expected at most {:.6g} m, the "
                 "root of the sum of the squares of the other two radii of gyration",
                 std::sqrt(others)));
    }
  }

  template <int D>
  prescribed<D> motion(std::size_t n) const {
    expect_none(n, "prescribed",
                {{"density", &o.density},
                 {"mass", &o.mass},
                 {"gyration_x", &o.gyration[0]},
                 {"gyration_y", &o.gyration[1]},
                 {"gyration_z", &o.gyration[2]}});
    expect_unrestrained(o.restraint, n, [&](const std::string& key, const std::string& why) { fail(key, n, why); });
    const auto pivot = vector_of<D>(o.pivot, n);
    if (of(o.kind, n, "harmonic") == "table") {
      if (o.file.size() <= n || o.file[n].empty()) fail("file", n, "expected the name of a table");
      return schema.placed("motions", "file", [&] {
        return prescribed<D>(pivot, axis<D>(n), read_motion(tables::table::read(o.file[n]), D));
      });
    }
    if (!of(o.file, n, "").empty()) fail("file", n, "a harmonic motion has none");
    if (!(of(o.period, n) > 0.0)) fail("period", n, "expected a time above 0");
    constexpr double degree = std::numbers::pi / 180.0;
    return {
        pivot,
        axis<D>(n),
        {of(o.period, n), of(o.phase, n) * degree, vector_of<D>(o.amplitude, n), of(o.amplitude_angle, n) * degree}};
  }
};

void declare_motions(namelist::schema& schema, motion_options& m) {
  const auto numbers = [](const char* unit, const char* meaning, double minimum = -1e300) {
    return list(most_motions, unit, meaning, minimum);
  };
  schema.group("motions", "how bodies of &solids move: an element of each list for each body that does");
  schema.add("motions", "body", m.body, names(most_motions, {}, "which body"));
  schema.add("motions", "kind", m.kind,
             names(most_motions, {"harmonic", "table", "free"},
                   "amplitudes times sin(2 pi t/period + phase), by a file, or under the forces of water and gravity"));
  schema.add("motions", "period", m.period, numbers("s", "of a harmonic motion", 0.0));
  schema.add("motions", "phase", m.phase, numbers("degrees", "of a harmonic motion"));
  declare_axes(schema, "motions", "amplitude", m.amplitude, numbers("m", "of a harmonic displacement"));
  schema.add("motions", "amplitude_angle", m.amplitude_angle,
             numbers("degrees", "of a harmonic rotation about the pivot"));
  declare_axes(
      schema, "motions", "pivot", m.pivot,
      numbers("m",
              "a point that rotations leave where it is; of a free body of freedom 'turn' its hinge, none: its "
              "centre of mass"));
  declare_axes(schema, "motions", "axis", m.axis, numbers("", "direction of the axis of rotation; none: z"));
  schema.add("motions", "file", m.file,
             files(most_motions, "a table of t (s), x, y, z (m), angle (degrees), by these names or in this order"));
  schema.add("motions", "density", m.density, numbers("kg/m^3", "of a free body", 0.0));
  schema.add("motions", "mass", m.mass,
             numbers("kg", "of a free body, for each metre of depth in 2-D; in place of density", 0.0));
  declare_axes(schema, "motions", "gyration", m.gyration,
               numbers("m",
                       "radii of gyration of a free body about axes through its centre of mass, which are its "
                       "principal axes: in 3-D "
                       "all three; none: as of one density, of a hundredth of the liquid's at least",
                       0.0));
  declare(schema, most_motions, numbers, m.restraint);
}

}  // namespace

void declare_pieces(namelist::schema& schema, const words& called, const std::vector<std::string>& shapes_of_pieces,
                    options& o) {
  const auto numbers = [](const char* unit, const char* meaning, double minimum = -1e300) {
    return list(most_pieces, unit, meaning, minimum);
  };
  const char* group = called.group;
  schema.add(group, called.whole, o.body,
             names(most_pieces, {},
                   group == std::string("solids") ? "name of the body that the piece belongs to; none: 'solid'"
                                                  : "of the region that the piece belongs to; none: one by itself"));
  schema.add(group, "shape", o.shape,
             names(most_pieces, shapes_of_pieces,
                   "of the piece, upright before it is turned; plane: all below its centre; cone: centre of its base;"
                   " bowl: lower half of a hollow sphere; in 2-D sections through the axis"));
  schema.add(group, "operation", o.operation,
             names(most_pieces, {"union", "difference", "intersection"},
                   "with the pieces of its body before it; difference: what it covers is taken away"));
  schema.add(group, called.side, o.solid,
             names(most_pieces, {"inside", "outside"}, "of its surface, where the piece is"));
  declare_axes(schema, group, "centre", o.centre,
               numbers("m", "where the piece stands; of a file: where its origin is"));
  declare_axes(schema, group, "angle", o.angle,
               numbers("degrees", "turned by, about its centre: x first, then y, then z"));
  declare_axes(schema, group, "length", o.length, numbers("m", "of a box", 0.0));
  schema.add(group, "radius", o.radius, numbers("m", "of a sphere, cylinder, cone; of a bowl's hollow", 0.0));
  schema.add(group, "height", o.height, numbers("m", "of a cylinder or cone", 0.0));
  schema.add(group, "thickness", o.thickness, numbers("m", "of a bowl's wall", 0.0));
  schema.add(
      group, "file", o.file,
      files(most_pieces,
            "an STL file, ASCII or binary: a closed surface, normals outwards (3-D only); corners nearer to each "
            "other than 1e-6 of its size are one"));
  schema.add(group, "scale", o.scale, numbers("", "metres of a file's unit of length; none: 1", 0.0));
}

void declare(namelist::schema& schema, options& o) {
  schema.group("solids", "bodies in the box, made of pieces: an element of each list for each piece");
  declare_pieces(schema, of_solids, {shapes.begin(), shapes.end()}, o);
}
void declare(namelist::schema& schema, options& o, motion_options& m) {
  declare(schema, o);
  declare_motions(schema, m);
}

template <int D>
std::vector<body<D>> make_bodies(const namelist::schema& schema, const options& o, const words& called) {
  const reader in{schema, o, called};
  in.expect_no_more_than_shapes();
  std::vector<std::string> names;
  std::vector<std::vector<piece<D>>> pieces;
  for (std::size_t n = 0; n < o.shape.size(); ++n) {
    const auto b = static_cast<std::size_t>(std::ranges::find(names, in.body(n)) - names.begin());
    if (b == names.size()) {
      names.push_back(in.body(n));
      pieces.emplace_back();
    }
    const std::string how = of(o.operation, n, "union");
    piece<D> p;
    p.how = how == "union" ? operation::unite : how == "difference" ? operation::subtract : operation::intersect;
    if (pieces[b].empty() && p.how != operation::unite) in.fail("operation", n, "the first piece of a body is united");
    p.bounds = in.bounds<D>(n);
    p.outside = of(o.solid, n, "inside") == "outside";
    pieces[b].push_back(std::move(p));
  }
  std::vector<body<D>> all;
  for (std::size_t b = 0; b < names.size(); ++b) all.emplace_back(names[b], std::move(pieces[b]));
  return all;
}

template <int D>
void expect_sound(const namelist::schema& schema, const std::vector<body<D>>& bodies, const lattice<D>& box,
                  double reach) {
  schema.placed("solids", "shape", [&] {
    expect_in_box(bodies, box);
    expect_thick(bodies, box, reach);
  });
}

namespace {

// Of motion n.
std::size_t body_of(const motion_reader& in, const std::vector<std::string>& bodies, std::size_t n) {
  const auto of_name = std::ranges::find(bodies, in.o.body[n]);
  if (of_name == bodies.end()) in.fail("body", n, "&solids has no body of this name");
  for (std::size_t k = 0; k < n; ++k)
    if (in.o.body[k] == in.o.body[n]) in.fail("body", n, "moves already");
  return static_cast<std::size_t>(of_name - bodies.begin());
}

}  // namespace

std::vector<std::optional<free_options>> make_free(const namelist::schema& schema, const motion_options& o,
                                                   int dimension, const std::vector<std::string>& names) {
  const motion_reader in{schema, o};
  std::vector<std::optional<free_options>> all(names.size());
  for (std::size_t n = 0; n < o.body.size(); ++n)
    if (in.is_free(n)) all[body_of(in, names, n)] = in.free(n, dimension);
  return all;
}

template <int D>
std::vector<prescribed<D>> make_motions(const namelist::schema& schema, const motion_options& o,
                                        const std::vector<body<D>>& bodies) {
  const motion_reader in{schema, o};
  std::vector<prescribed<D>> all(bodies.size());
  std::vector<std::string> names;
  for (const auto& b : bodies) names.push_back(b.name());
  for (std::size_t n = 0; n < o.body.size(); ++n) {
    auto& motion = all[body_of(in, names, n)];
    if (!in.is_free(n)) motion = in.motion<D>(n);
  }
  return all;
}

template std::vector<body<2>> make_bodies<2>(const namelist::schema&, const options&, const words&);
template std::vector<body<3>> make_bodies<3>(const namelist::schema&, const options&, const words&);
template void expect_sound<2>(const namelist::schema&, const std::vector<body<2>>&, const lattice<2>&, double);
template void expect_sound<3>(const namelist::schema&, const std::vector<body<3>>&, const lattice<3>&, double);
template std::vector<prescribed<2>> make_motions<2>(const namelist::schema&, const motion_options&,
                                                    const std::vector<body<2>>&);
template std::vector<prescribed<3>> make_motions<3>(const namelist::schema&, const motion_options&,
                                                    const std::vector<body<3>>&);

}  // namespace tetsuame::solids
