#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <solids/bounds.hpp>

namespace tetsuame::solids {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// What lies on one side of a plane: normal·x ≤ offset.
template <int D>
struct half_space {
  point<D> normal;
  double offset;  // m
};

// ---- what holds a piece ---------------------------------------------------------------------------------

// No farther along a direction from a place than these (m).
template <int D>
void add_slab(std::vector<half_space<D>>& all, const point<D>& place, const point<D>& along, double low, double high) {
  const double at = foundation::dot(along, place);
  all.push_back({along, at + high});
  all.push_back({-1.0 * along, -(at + low)});
}

// Half spaces that hold what lies behind a face.
template <int D>
void add_behind(std::vector<half_space<D>>& all, const surface<D>& s) {
  using form = typename surface<D>::form;
  if (s.what == form::plane) {
    const double sign = s.turned ? -1.0 : 1.0;
    all.push_back({sign * s.axis, sign * foundation::dot(s.axis, s.place)});
    return;
  }
  if (s.turned) return;
  if constexpr (D == 3)
    if (s.what == form::mesh) {
      for (std::size_t k = 0; k < D; ++k) {
        const auto along = point<D>::of([&](std::size_t c) { return s.orientation[c][k]; });
        add_slab<D>(all, s.place, along, s.triangles->low()[k], s.triangles->high()[k]);
      }
      return;
    }
  // About an axis the sides of a prism, which face the coordinate axes as far as they can.
  for (std::size_t k = 0; k < D; ++k) {
    const auto side = s.what == form::sphere ? unit<D>(k) : unit<D>(k) - s.axis[k] * s.axis;
    if (const double length = norm<D>(side); length > 1e-6)
      add_slab<D>(all, s.place, (1.0 / length) * side, -s.radius, s.radius);
  }
  if (s.what == form::cone) all.push_back({-1.0 * s.axis, -foundation::dot(s.axis, s.place)});
}

// Where these planes meet.
template <int D>
std::optional<point<D>> corner_of(const std::array<const half_space<D>*, D>& planes) {
  Eigen::Matrix<double, D, D> normals;
  Eigen::Matrix<double, D, 1> offsets;
  for (int r = 0; r < D; ++r) {
    const auto& plane = *planes[static_cast<std::size_t>(r)];
    normals.row(r) = Eigen::Map<const Eigen::Matrix<double, 1, D>>(plane.normal.c.data());
    offsets[r] = plane.offset;
  }
  if (std::abs(normals.determinant()) < 1e-9) return {};
  const Eigen::Matrix<double, D, 1> x = normals.inverse() * offsets;
  return point<D>::of([&](std::size_t k) { return x[static_cast<Eigen::Index>(k)]; });
}

// f(planes) for each D of them.
template <int D, class F>
void for_each_meeting(const std::vector<half_space<D>>& all, F&& f) {
  std::array<const half_space<D>*, D> planes;
  const auto choose = [&](auto&& self, std::size_t chosen, std::size_t first) -> void {
    if (chosen == D) return f(planes);
    for (std::size_t k = first; k < all.size(); ++k) {
      planes[chosen] = &all[k];
      self(self, chosen + 1, k + 1);
    }
  };
  choose(choose, 0, 0);
}

// Of what lies behind all of these faces: its corners, where none of them is far away.
template <int D>
bounds<D> bounds_behind(const faces<D>& of) {
  std::vector<half_space<D>> all;
  for (const auto& face : of) add_behind<D>(all, face);
  double size = 0.0;
  for (const auto& h : all) size = std::max(size, std::abs(h.offset));
  const double far = 1e6 * (size > 0.0 ? size : 1.0);
  const std::vector<half_space<D>> given = all;
  for (std::size_t k = 0; k < D; ++k) add_slab<D>(all, foundation::zero<double, D>(), unit<D>(k), -far, far);
  auto b = bounds<D>::none();
  for_each_meeting<D>(all, [&](const auto& planes) {
    const auto x = corner_of<D>(planes);
    if (!x) return;
    const double rounding = norm<D>(*x) > 0.5 * far ? 1e-12 * far : 1e-9 * size;
    for (const auto& h : given)
      if (foundation::dot(h.normal, *x) > h.offset + rounding) return;
    b.widen(*x);
  });
  for (std::size_t k = 0; k < D; ++k) {
    if (b.low[k] < -0.5 * far) b.low[k] = -infinity;
    if (b.high[k] > 0.5 * far) b.high[k] = infinity;
  }
  return b;
}

// ---- periodic sides --------------------------------------------------------------------------------------

// Between the sides of the axis, and no nearer to them than the reach.
template <int D>
bool stays_between(const bounds<D>& b, const period<D>& box, std::size_t axis) {
  return b.empty() || (b.low[axis] > box.reach && b.high[axis] < box.length[axis] - box.reach);
}

// Planes and cylinders along an axis.
template <int D>
bool runs_along(const surface<D>& face, const period<D>& box, std::size_t axis) {
  using form = typename surface<D>::form;
  const double along = face.axis[axis], length = box.length[axis];
  if (face.what == form::cylinder) return std::sqrt(std::max(0.0, 1.0 - along * along)) * length < box.slight;
  return face.what == form::plane && std::abs(along) * length < box.slight;
}

template <int D>
bool ends_bar(const surface<D>& face, std::size_t axis) {
  return face.what == surface<D>::form::plane && 1.0 - std::abs(face.axis[axis]) < 1e-9;
}
// A bar along the axis, at least as long as the box.
template <int D>
bool is_long_bar(const body<D>& of, const period<D>& box, std::size_t axis) {
  const auto where = bounds_of(of);
  return of.pieces().size() == 1 && !of.pieces().front().outside && where.ends(axis) &&
         where.length(axis) > box.length[axis] * (1.0 - 1e-9) &&
         std::ranges::all_of(of.pieces().front().bounds, [&](const auto& face) {
           return ends_bar<D>(face, axis) || runs_along<D>(face, box, axis);
         });
}

// A face is the same about both sides of an axis: it runs along it, or a plane has both wholly before or behind it.
template <int D>
bool is_same_at_sides(const surface<D>& face, const period<D>& box, std::size_t axis) {
  if (face.what != surface<D>::form::plane || runs_along<D>(face, box, axis)) return runs_along<D>(face, box, axis);
  double least = infinity, most = -infinity;
  for (std::size_t corner = 0; corner < std::size_t{1} << D; ++corner) {
    const auto x = point<D>::of([&](std::size_t a) {
      const bool upper = (corner >> a & 1U) != 0;
      const double beyond = a == axis ? 0.0 : box.reach;
      return upper ? box.length[a] + beyond : -beyond;
    });
    const double distance = face.at(x).distance;
    least = std::min(least, distance);
    most = std::max(most, distance);
  }
  return least > box.reach || most < -box.reach;
}

constexpr std::array<char, 3> axis_name{'x', 'y', 'z'};

}  // namespace

template <int D>
bool bounds<D>::empty() const {
  for (std::size_t k = 0; k < D; ++k)
    if (low[k] > high[k]) return true;
  return false;
}

template <int D>
bounds<D> bounds<D>::none() {
  return {point<D>::of([](std::size_t) { return infinity; }), point<D>::of([](std::size_t) { return -infinity; })};
}

template <int D>
bounds<D> bounds<D>::all() {
  return {point<D>::of([](std::size_t) { return -infinity; }), point<D>::of([](std::size_t) { return infinity; })};
}

template <int D>
bounds<D> bounds<D>::within(const bounds& other) const {
  return {point<D>::of([&](std::size_t k) { return std::max(low[k], other.low[k]); }),
          point<D>::of([&](std::size_t k) { return std::min(high[k], other.high[k]); })};
}

template <int D>
void bounds<D>::widen(const point<D>& x) {
  for (std::size_t k = 0; k < D; ++k) {
    low[k] = std::min(low[k], x[k]);
    high[k] = std::max(high[k], x[k]);
  }
}

template <int D>
bounds<D> bounds_of(const body<D>& of) {
  auto all = bounds<D>::none(), whole = bounds<D>::none();
  const auto unite = [](bounds<D>& to, const bounds<D>& b) {
    if (b.empty()) return;
    to.widen(b.low);
    to.widen(b.high);
  };
  for (const auto& p : of.pieces()) {
    const auto behind = bounds_behind<D>(p.bounds);
    const auto solid = p.outside ? bounds<D>::all() : behind;
    if (p.how == operation::begin) {
      unite(all, whole);
      whole = solid;
    }
    if (p.how == operation::unite) unite(whole, solid);
    if (p.how == operation::intersect) whole = whole.within(solid);
    if (p.how == operation::subtract && p.outside) whole = whole.within(behind);
  }
  unite(all, whole);
  return all;
}

template <int D>
bool period<D>::any() const {
  return std::ranges::find(along, true) != along.end();
}

template <int D>
bool goes_on(const body<D>& of, const period<D>& box, std::size_t axis) {
  return std::ranges::all_of(of.pieces(), [&](const auto& p) {
    return stays_between(bounds_behind<D>(p.bounds), box, axis) ||
           std::ranges::all_of(p.bounds, [&](const auto& face) { return is_same_at_sides<D>(face, box, axis); });
  });
}

template <int D>
bool runs_through(const body<D>& of, const period<D>& box, std::size_t axis) {
  if (!box.along[axis]) return false;
  return is_long_bar(of, box, axis) || (goes_on(of, box, axis) && !stays_between(bounds_of(of), box, axis));
}

template <int D>
void keep_one_period(bounds<D>& where, const body<D>& of, const period<D>& box, std::size_t axis) {
  if (!is_long_bar(of, box, axis)) where.low[axis] = 0.0;
  where.high[axis] = where.low[axis] + box.length[axis];
}

template <int D>
std::string fault_across(const body<D>& of, const period<D>& box, double most) {
  if (!box.any()) return "";
  const auto b = bounds_of(of);
  bool triangles = false;
  for (const auto& p : of.pieces())
    for (const auto& face : p.bounds) triangles = triangles || face.what == surface<D>::form::mesh;
  for (std::size_t a = 0; a < D; ++a) {
    if (!box.along[a] || goes_on(of, box, a) || is_long_bar(of, box, a)) continue;
    if (!b.ends(a))
      return fmt::format(
          "body '{}' has no end along {}, where the box is periodic, and does not run straight across its sides: give "
          "it an end, faces along {}, or let the box have walls there",
          of.name(), axis_name[a], axis_name[a]);
    if (const double longest = triangles ? std::min(most, 1.0) : most;
        b.length(a) > longest * box.length[a] * (1.0 - 1e-9))
      return fmt::format(
          "body '{}' is {:.4g} m long along {}, where the box repeats itself every {:.4g} m, and does not run straight "
          "across its sides: at most {:.4g} m",
          of.name(), b.length(a), axis_name[a], box.length[a], longest * box.length[a]);
  }
  return "";
}

template <int D>
body<D> repeated(const body<D>& of, const period<D>& box) {
  if (!box.any()) return of;
  const auto b = bounds_of(of);
  auto pieces = of.pieces();
  std::vector<point<D>> shifts{foundation::zero<double, D>()};
  for (std::size_t a = 0; a < D; ++a) {
    if (!box.along[a] || !b.ends(a) || goes_on(of, box, a)) continue;
    if (is_long_bar(of, box, a)) {  // images would fill its ends up
      std::erase_if(pieces.front().bounds, [&](const auto& face) { return ends_bar<D>(face, a); });
      continue;
    }
    const double L = box.length[a];
    const double first = std::ceil((-box.reach - b.high[a]) / L), last = std::floor((L + box.reach - b.low[a]) / L);
    const auto before = shifts;
    for (double k = 0.0; k <= last - first; k += 1.0) {
      const double n = first + k;
      if (n == 0.0) continue;
      for (auto by : before) {
        by[a] = n * L;
        shifts.push_back(by);
      }
    }
  }
  std::vector<body<D>> all;
  for (const auto& shift : shifts) {
    auto there = pieces;
    for (auto& p : there) p.bounds = placed<D>(std::move(p.bounds), no_rotation<D>(), shift);
    all.emplace_back(of.name(), std::move(there));
  }
  return {of.name(), all.size() == 1 ? pieces : joined(all).pieces()};
}

template struct bounds<2>;
template struct bounds<3>;
template struct period<2>;
template struct period<3>;
template bounds<2> bounds_of(const body<2>&);
template bounds<3> bounds_of(const body<3>&);
template bool goes_on(const body<2>&, const period<2>&, std::size_t);
template bool goes_on(const body<3>&, const period<3>&, std::size_t);
template bool runs_through(const body<2>&, const period<2>&, std::size_t);
template bool runs_through(const body<3>&, const period<3>&, std::size_t);
template void keep_one_period(bounds<2>&, const body<2>&, const period<2>&, std::size_t);
template void keep_one_period(bounds<3>&, const body<3>&, const period<3>&, std::size_t);
template std::string fault_across(const body<2>&, const period<2>&, double);
template std::string fault_across(const body<3>&, const period<3>&, double);
template body<2> repeated(const body<2>&, const period<2>&);
template body<3> repeated(const body<3>&, const period<3>&);

}  // namespace tetsuame::solids
