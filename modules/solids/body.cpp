#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <optional>
#include <solids/body.hpp>
#include <span>

namespace tetsuame::solids {

namespace {

template <int D>
using vector = Eigen::Matrix<double, D, 1>;
template <int D>
vector<D> of_point(const point<D>& a) {
  return vector<D>(a.c.data());
}

// The normals of several surfaces at a place, one in a row, and the distances from them.
template <int D>
struct tangent {
  Eigen::Matrix<double, Eigen::Dynamic, D, 0, D, D> normals;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, D, 1> distances;

  tangent(const faces<D>& all, std::span<const std::size_t> of, const point<D>& p)
      : normals(static_cast<Eigen::Index>(of.size()), D), distances(static_cast<Eigen::Index>(of.size())) {
    for (std::size_t k = 0; k < of.size(); ++k) {
      const auto a = all[of[k]].at(p);
      distances[static_cast<Eigen::Index>(k)] = a.distance;
      normals.row(static_cast<Eigen::Index>(k)) = of_point<D>(a.normal).transpose();
    }
  }
};

// The point nearest to x on all of these surfaces, from a start. On the planes that touch them at the last guess p it
// is p' = x − Σ λ_k n_k with n_k·(p' − p) = −φ_k: a step −Nᵀ(N Nᵀ)⁻¹ φ onto the surfaces, and one along them towards x,
// whose length is that of a secant [J. Barzilai and J. M. Borwein, IMA J. Numer. Anal. 8, 141 (1988)] as the surfaces
// are curved.
template <int D>
std::optional<point<D>> meet(const faces<D>& all, std::span<const std::size_t> of, const point<D>& x, point<D> p,
                             double small) {
  double part = 1.0;
  vector<D> last_along, last_step;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const tangent<D> here(all, of, p);
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, D, D> gram = here.normals * here.normals.transpose();
    if (!(gram.determinant() > 1e-10)) return {};  // they touch, or are parallel
    const auto inverse = gram.ldlt();
    const vector<D> wanted = of_point<D>(x - p);
    const vector<D> along = wanted - here.normals.transpose() * inverse.solve(here.normals * wanted);
    if (iteration > 0) {
      const double change = last_step.dot(last_along - along);
      part = change > 0.0 ? std::clamp(last_step.squaredNorm() / change, 0.1, 1e4) : std::min(2.0 * part, 1e4);
    }
    const vector<D> onto = -(here.normals.transpose() * inverse.solve(here.distances));
    const vector<D> step = onto + part * along;
    for (int k = 0; k < D; ++k) p[static_cast<std::size_t>(k)] += step[k];
    if (step.norm() < small && here.distances.cwiseAbs().maxCoeff() < small) return p;
    last_along = along;
    last_step = step;
  }
  return {};
}

}  // namespace

template <int D>
bool solid(const piece<D>& of, const point<D>& x) {
  double inside = -std::numeric_limits<double>::infinity();
  for (const auto& face : of.bounds) inside = std::max(inside, face.side(x));
  return (of.outside ? -inside : inside) < 0.0;
}

template <int D>
body<D>::body(std::string name, std::vector<piece<D>> pieces) : name_(std::move(name)), pieces_(std::move(pieces)) {
  for (const auto& p : pieces_)
    for (const auto& face : p.bounds) {
      all_.push_back(face);
      size_ = std::max({size_, norm<D>(face.place), face.radius, face.triangles ? face.triangles->size() : 0.0});
    }
  small_ = 1e-10 * (size_ > 0.0 ? size_ : 1.0);
}

// of_face(k): signed distance from face k.
template <int D>
template <class Distance>
double body<D>::combine(Distance&& of_face) const {
  constexpr double nothing = std::numeric_limits<double>::infinity();
  double all = nothing, whole = nothing;
  std::size_t k = 0;
  for (const auto& p : pieces_) {
    double inside = -nothing;
    for (std::size_t f = 0; f < p.bounds.size(); ++f) inside = std::max(inside, of_face(k++));
    if (p.outside) inside = -inside;
    if (p.how == operation::begin) {
      all = std::min(all, whole);
      whole = inside;
    }
    if (p.how == operation::unite) whole = std::min(whole, inside);
    if (p.how == operation::subtract) whole = std::max(whole, -inside);
    if (p.how == operation::intersect) whole = std::max(whole, inside);
  }
  return std::min(all, whole);
}

template <int D>
body<D> joined(const std::vector<body<D>>& bodies) {
  std::vector<piece<D>> pieces;
  for (const auto& b : bodies)
    for (std::size_t p = 0; p < b.pieces().size(); ++p) {
      pieces.push_back(b.pieces()[p]);
      if (p == 0) pieces.back().how = operation::begin;
    }
  return {"all", std::move(pieces)};
}

template <int D>
double body<D>::level(const point<D>& x) const {
  return combine([&](std::size_t k) { return all_[k].at(x).distance; });
}

template <int D>
bool body<D>::solid(const point<D>& x) const {
  return combine([&](std::size_t k) { return all_[k].side(x); }) < 0.0;
}

// The best candidate so far, and whether another is one.
template <int D>
struct body<D>::search {
  const body& of;
  const point<D>& x;
  double best;  // m
  point<D> nearest = foundation::zero<double, D>();
  bool found = false;

  // Both signs of the level about p, along all sums and differences of the normals of the faces that meet there.
  bool on_surface(std::span<const std::size_t> meeting, const point<D>& p) const {
    const double step = 100.0 * of.small_;
    bool solid = false, fluid = false;
    for (std::size_t signs = 0; signs < std::size_t{1} << meeting.size(); ++signs) {
      auto y = p;
      for (std::size_t k = 0; k < meeting.size(); ++k)
        y += ((signs >> k & 1U) != 0 ? -step : step) * of.all_[meeting[k]].at(p).normal;
      (of.solid(y) ? solid : fluid) = true;
    }
    return solid && fluid;
  }

  void offer(std::span<const std::size_t> meeting, const point<D>& p) {
    const double distance = norm<D>(x - p);
    if (!(distance < best) || !on_surface(meeting, p)) return;
    best = distance;
    nearest = p;
    found = true;
  }

  void offer_meeting(std::span<const std::size_t> meeting) {
    // From x, and from its nearest points on each of the faces: a line may meet a sphere twice.
    for (std::size_t start = 0; start <= meeting.size(); ++start) {
      auto p = x;
      if (start > 0) {
        const auto a = of.all_[meeting[start - 1]].at(x);
        p -= a.distance * a.normal;
      }
      if (const auto met = meet<D>(of.all_, meeting, x, p, of.small_)) offer(meeting, *met);
    }
  }
};

template <int D>
point<D> body<D>::into_fluid(const point<D>& p) const {
  const double step = 100.0 * small_;
  std::vector<point<D>> normals;
  for (const auto& face : all_)
    if (const auto a = face.at(p); std::abs(a.distance) < step && normals.size() < 8) normals.push_back(a.normal);
  auto sum = foundation::zero<double, D>();
  for (std::size_t signs = 0; signs < std::size_t{1} << normals.size(); ++signs) {
    auto along = foundation::zero<double, D>();
    for (std::size_t k = 0; k < normals.size(); ++k) along += (signs >> k & 1U) != 0 ? -1.0 * normals[k] : normals[k];
    const double length = norm<D>(along);
    if (length > 1e-6 && !solid(p + (10.0 * step / length) * along)) sum += (1.0 / length) * along;
  }
  const double length = norm<D>(sum);
  return length > 1e-6 ? (1.0 / length) * sum : foundation::zero<double, D>();
}

template <int D>
foot<D> body<D>::at(const point<D>& x, double reach) const {
  std::vector<at_surface<D>> near(all_.size());
  for (std::size_t k = 0; k < all_.size(); ++k) near[k] = all_[k].at(x, reach);
  const double bound = combine([&](std::size_t k) { return near[k].distance; });
  if (std::abs(bound) >= reach) return {bound, {}, x, false};
  std::vector<std::size_t> order(all_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(near[a].distance) < std::abs(near[b].distance);
  });

  search s{*this, x, reach};
  for (std::size_t i = 0; i < order.size() && std::abs(near[order[i]].distance) < s.best; ++i) {
    const auto& a = near[order[i]];
    s.offer(std::span(&order[i], 1), x - a.distance * a.normal);
    for (std::size_t j = 0; j < i; ++j) {
      s.offer_meeting(std::array{order[j], order[i]});
      if constexpr (D == 3)
        for (std::size_t k = 0; k < j; ++k) s.offer_meeting(std::array{order[k], order[j], order[i]});
    }
  }

  const double sign = bound < 0.0 ? -1.0 : 1.0;
  if (!s.found)
    return {sign * (reach < std::numeric_limits<double>::infinity() ? reach : std::abs(bound)), {}, x, false};
  const double distance = sign * s.best;
  const auto normal = s.best > 100.0 * small_ ? (1.0 / distance) * (x - s.nearest) : into_fluid(s.nearest);
  return {distance, normal, s.nearest, true};
}

template class body<2>;
template class body<3>;
template body<2> joined(const std::vector<body<2>>&);
template body<3> joined(const std::vector<body<3>>&);
template bool solid<2>(const piece<2>&, const point<2>&);
template bool solid<3>(const piece<3>&, const point<3>&);

}  // namespace tetsuame::solids
