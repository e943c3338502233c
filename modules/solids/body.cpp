#include <Eigen/Dense>
#include <algorithm>
#include <numeric>
#include <optional>
#include <solids/body.hpp>
#include <span>

namespace tetsuame::solids {

namespace {

// The point nearest to x on all of these surfaces, from a start: on the planes that touch them at the last guess it is
// p' = x − Σ λ_k n_k with n_k·(p' − p) = −φ_k. `part`: of the step along the surfaces.
template <int D>
std::optional<point<D>> meet(const faces<D>& all, std::span<const std::size_t> of, const point<D>& x, point<D> p,
                             double small, double part) {
  const auto n = static_cast<Eigen::Index>(of.size());
  Eigen::Matrix<double, Eigen::Dynamic, D, 0, D, D> normals(n, D);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, D, 1> distances(n);
  for (int iteration = 0; iteration < 200; ++iteration) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto a = all[of[static_cast<std::size_t>(k)]].at(p);
      distances[k] = a.distance;
      for (int c = 0; c < D; ++c) normals(k, c) = a.normal[static_cast<std::size_t>(c)];
    }
    Eigen::Matrix<double, D, 1> wanted;
    for (int c = 0; c < D; ++c) wanted[c] = part * (x[static_cast<std::size_t>(c)] - p[static_cast<std::size_t>(c)]);
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, D, D> gram = normals * normals.transpose();
    if (!(gram.determinant() > 1e-10)) return {};  // they touch, or are parallel
    const Eigen::Matrix<double, D, 1> step =
        wanted - normals.transpose() * gram.ldlt().solve(distances + normals * wanted);
    for (int c = 0; c < D; ++c) p[static_cast<std::size_t>(c)] += step[c];
    if (step.norm() < part * small && distances.cwiseAbs().maxCoeff() < small) return p;
  }
  return {};
}

}  // namespace

template <int D>
double level(const piece<D>& of, const point<D>& x) {
  double inside = -std::numeric_limits<double>::infinity();
  for (const auto& face : of.bounds) inside = std::max(inside, face.at(x).distance);
  return of.outside ? -inside : inside;
}

template <int D>
body<D>::body(std::string name, std::vector<piece<D>> pieces) : name_(std::move(name)), pieces_(std::move(pieces)) {
  double size = 0.0;
  for (const auto& p : pieces_)
    for (const auto& face : p.bounds) {
      all_.push_back(face);
      size = std::max({size, norm<D>(face.place), face.radius, face.triangles ? face.triangles->size() : 0.0});
    }
  small_ = 1e-10 * (size > 0.0 ? size : 1.0);
}

// of_face(k): signed distance from face k.
template <int D>
template <class Distance>
double body<D>::combine(Distance&& of_face) const {
  double whole = std::numeric_limits<double>::infinity();  // nothing is solid
  std::size_t k = 0;
  for (const auto& p : pieces_) {
    double inside = -std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < p.bounds.size(); ++f) inside = std::max(inside, of_face(k++));
    if (p.outside) inside = -inside;
    if (p.how == operation::unite) whole = std::min(whole, inside);
    if (p.how == operation::subtract) whole = std::max(whole, -inside);
    if (p.how == operation::intersect) whole = std::max(whole, inside);
  }
  return whole;
}

template <int D>
double body<D>::level(const point<D>& x) const {
  return combine([&](std::size_t k) { return all_[k].at(x).distance; });
}

// The best candidate so far, and whether another is one.
template <int D>
struct body<D>::search {
  const body& of;
  const point<D>& x;
  double best;  // m
  point<D> nearest = foundation::zero<double, D>(), normal = foundation::zero<double, D>();
  bool found = false;

  // Both signs of the level about p, along all sums and differences of the normals of the faces that meet there.
  bool on_surface(std::span<const std::size_t> meeting, const point<D>& p, const point<D>& first) const {
    const double step = 100.0 * of.small_;
    bool solid = false, fluid = false;
    for (std::size_t signs = 0; signs < std::size_t{1} << meeting.size(); ++signs) {
      auto y = p;
      for (std::size_t k = 0; k < meeting.size(); ++k)
        y += ((signs >> k & 1U) != 0 ? -step : step) * (meeting.size() == 1 ? first : of.all_[meeting[k]].at(p).normal);
      (of.solid(y) ? solid : fluid) = true;
    }
    return solid && fluid;
  }

  void offer(std::span<const std::size_t> meeting, const point<D>& p, const point<D>& first) {
    const double distance = norm<D>(x - p);
    if (!(distance < best) || !on_surface(meeting, p, first)) return;
    best = distance;
    nearest = p;
    normal = first;
    found = true;
  }

  void offer_meeting(std::span<const std::size_t> meeting) {
    for (const double part : {1.0, 0.4}) {
      bool converged = false;
      // From x, and from its nearest points on each of the faces: a line may meet a sphere twice.
      for (std::size_t start = 0; start <= meeting.size(); ++start) {
        auto p = x;
        if (start > 0) {
          const auto a = of.all_[meeting[start - 1]].at(x);
          p -= a.distance * a.normal;
        }
        const auto met = meet<D>(of.all_, meeting, x, p, of.small_, part);
        if (!met) continue;
        converged = true;
        offer(meeting, *met, of.all_[meeting[0]].at(*met).normal);
      }
      if (converged) return;
    }
  }
};

template <int D>
foot<D> body<D>::at(const point<D>& x, double reach) const {
  std::vector<at_surface<D>> near(all_.size());
  for (std::size_t k = 0; k < all_.size(); ++k) near[k] = all_[k].at(x);
  std::vector<std::size_t> order(all_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::abs(near[a].distance) < std::abs(near[b].distance);
  });

  search s{*this, x, reach};
  for (std::size_t i = 0; i < order.size() && std::abs(near[order[i]].distance) < s.best; ++i) {
    const auto& a = near[order[i]];
    s.offer(std::span(&order[i], 1), x - a.distance * a.normal, a.normal);
    for (std::size_t j = 0; j < i; ++j) {
      s.offer_meeting(std::array{order[j], order[i]});
      if constexpr (D == 3)
        for (std::size_t k = 0; k < j; ++k) s.offer_meeting(std::array{order[k], order[j], order[i]});
    }
  }

  const double bound = combine([&](std::size_t k) { return near[k].distance; });
  const double sign = bound < 0.0 ? -1.0 : 1.0;
  if (!s.found) return {sign * std::max(std::abs(bound), std::min(reach, std::abs(bound))), {}, x, false};
  const double distance = sign * s.best;
  // On the surface itself the normal is that of a face there.
  auto normal = s.normal;
  if (s.best > 100.0 * small_) normal = (1.0 / distance) * (x - s.nearest);
  return {distance, normal, s.nearest, true};
}

template class body<2>;
template class body<3>;
template double level<2>(const piece<2>&, const point<2>&);
template double level<3>(const piece<3>&, const point<3>&);

}  // namespace tetsuame::solids
