#include <fmt/format.h>

#include <numbers>
#include <solids/shape.hpp>

namespace tetsuame::solids {

namespace {

template <int D>
surface<D> flat(const point<D>& place, const point<D>& normal) {
  surface<D> s;
  s.place = place;
  s.axis = normal;
  return s;
}

template <int D>
surface<D> round(typename surface<D>::form what, double radius) {
  surface<D> s;
  s.what = what;
  s.radius = radius;
  return s;
}

template <int D>
point<D> up(double height) {
  return height * unit<D>(D - 1);
}

// A · B
template <int D>
rotation<D> product(const rotation<D>& A, const rotation<D>& B) {
  rotation<D> C;
  for (std::size_t k = 0; k < D; ++k) C[k] = turn_back<D>(B, A[k]);
  return C;
}

template <int D>
rotation<D> about_axis(std::size_t first, std::size_t second, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  auto R = no_rotation<D>();
  R[first][first] = R[second][second] = std::cos(angle);
  R[second][first] = std::sin(angle);
  R[first][second] = -R[second][first];
  return R;
}

}  // namespace

template <int D>
std::string place_text(const point<D>& x) {
  std::string text = "(";
  for (std::size_t k = 0; k < D; ++k) text += fmt::format("{}{:.6g}", k > 0 ? ", " : "", x[k]);
  return text + ")";
}

template <int D>
faces<D> plane() {
  return {flat<D>(up<D>(0.0), unit<D>(D - 1))};
}

template <int D>
faces<D> box(const point<D>& length) {
  faces<D> all;
  for (std::size_t k = 0; k < D; ++k)
    for (const double side : {-1.0, 1.0})
      all.push_back(flat<D>((0.5 * side * length[k]) * unit<D>(k), side * unit<D>(k)));
  return all;
}

template <int D>
faces<D> sphere(double radius) {
  return {round<D>(surface<D>::form::sphere, radius)};
}

template <int D>
faces<D> cylinder(double radius, double height) {
  if constexpr (D == 2) {
    return box<2>({{2.0 * radius, height}});
  } else {
    return {round<D>(surface<D>::form::cylinder, radius), flat<D>(up<D>(0.5 * height), unit<D>(D - 1)),
            flat<D>(up<D>(-0.5 * height), -1.0 * unit<D>(D - 1))};
  }
}

template <int D>
faces<D> cone(double radius, double height) {
  const double slant = std::hypot(radius, height);
  faces<D> all{flat<D>(up<D>(0.0), -1.0 * unit<D>(D - 1))};
  if constexpr (D == 2) {
    for (const double side : {-1.0, 1.0})
      all.push_back(flat<D>(up<D>(height), point<D>{{side * height / slant, radius / slant}}));
  } else {
    auto s = round<D>(surface<D>::form::cone, radius);
    s.place = up<D>(height);
    s.axis = -1.0 * unit<D>(D - 1);
    s.cosine = height / slant;
    s.sine = radius / slant;
    all.push_back(s);
  }
  return all;
}

template <int D>
faces<D> bowl(double radius, double thickness) {
  faces<D> all{flat<D>(up<D>(0.0), unit<D>(D - 1)), round<D>(surface<D>::form::sphere, radius + thickness),
               round<D>(surface<D>::form::sphere, radius)};
  all.back().turned = true;
  return all;
}

faces<3> triangulated(std::shared_ptr<const mesh> triangles) {
  surface<3> s;
  s.what = surface<3>::form::mesh;
  s.triangles = std::move(triangles);
  return {s};
}

template <int D>
faces<D> placed(faces<D> all, const rotation<D>& R, const point<D>& shift) {
  for (auto& s : all) {
    s.place = turn<D>(R, s.place) + shift;
    s.axis = turn<D>(R, s.axis);
    if (s.triangles) s.orientation = product<D>(R, s.orientation);
  }
  return all;
}

template <int D>
rotation<D> turned_by(const std::array<double, 3>& degrees) {
  if constexpr (D == 2) {
    return about_axis<2>(0, 1, degrees[2]);
  } else {
    const auto x = about_axis<3>(1, 2, degrees[0]), y = about_axis<3>(2, 0, degrees[1]),
               z = about_axis<3>(0, 1, degrees[2]);
    return product<3>(z, product<3>(y, x));
  }
}

template std::string place_text<2>(const point<2>&);
template faces<2> plane<2>();
template faces<2> box<2>(const point<2>&);
template faces<2> sphere<2>(double);
template faces<2> cylinder<2>(double, double);
template faces<2> cone<2>(double, double);
template faces<2> bowl<2>(double, double);
template faces<2> placed<2>(faces<2>, const rotation<2>&, const point<2>&);
template rotation<2> turned_by<2>(const std::array<double, 3>&);
template std::string place_text<3>(const point<3>&);
template faces<3> plane<3>();
template faces<3> box<3>(const point<3>&);
template faces<3> sphere<3>(double);
template faces<3> cylinder<3>(double, double);
template faces<3> cone<3>(double, double);
template faces<3> bowl<3>(double, double);
template faces<3> placed<3>(faces<3>, const rotation<3>&, const point<3>&);
template rotation<3> turned_by<3>(const std::array<double, 3>&);

}  // namespace tetsuame::solids
