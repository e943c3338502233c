// What grains meet beside each other: plane sides of the box, and bodies of any shape that stand or move.
#pragma once

#include <algorithm>
#include <array>
#include <domain/decomposition.hpp>
#include <optional>
#include <solids/motion.hpp>
#include <utility>
#include <vector>

namespace tetsuame::dem {

// A plane side of the box: grains are where (x - position) * inward > 0 along the axis.
struct plane_side {
  std::size_t axis = 0;
  double position = 0.0;  // m
  double inward = 1.0;
};

// A body that opens: it stands until grains are at rest, and then moves steadily.
template <int D>
struct gate {
  std::size_t body = 0;
  solids::point<D> velocity = foundation::zero<double, D>();  // m/s, once it is open
  double at_rest = 0.0;                                       // m/s, of the fastest grain
  double seconds = 0.0;                                       // s, for which it moves
};

template <int D>
struct wall_set {
  std::vector<plane_side> sides;
  std::vector<solids::body<D>> bodies;         // at rest
  std::vector<solids::prescribed<D>> motions;  // of each body
  std::vector<std::size_t> materials;          // of the sides, then of the bodies
  std::optional<dem::gate<D>> gate;
  std::optional<double> opened;  // s, when the gate began to move

  std::size_t size() const { return sides.size() + bodies.size(); }

  struct meeting {
    double distance;            // m, of the surface from x, negative inside
    solids::point<D> normal;    // out of the wall
    solids::point<D> velocity;  // m/s, of the surface there
    bool found;                 // within reach
  };
  // Wall n at time t, from x.
  meeting at(std::size_t n, const solids::point<D>& x, double t, double reach) const {
    if (n < sides.size()) {
      const auto& s = sides[n];
      auto normal = foundation::zero<double, D>();
      normal[s.axis] = s.inward;
      return {(x[s.axis] - s.position) * s.inward, normal, foundation::zero<double, D>(), true};
    }
    const std::size_t b = n - sides.size();
    const auto now = pose_of(b, t);
    const auto foot = bodies[b].at(now.to_body(x), reach);
    const auto normal = solids::turn<D>(now.turned, foot.normal);
    return {foot.distance, normal, rate_of(b, t).at(x - foot.distance * normal), foot.found};
  }
  bool moves(std::size_t n) const {
    if (n < sides.size()) return false;
    return motions[n - sides.size()].moves() || (gate && gate->body == n - sides.size());
  }
  // m, the farthest that a point of wall n within this distance of the body's pivot has moved between these times.
  double way(std::size_t n, double from, double to, double extent) const {
    if (!moves(n)) return 0.0;
    const auto before = pose_of(n - sides.size(), from), now = pose_of(n - sides.size(), to);
    double turned2 = 0.0;
    for (std::size_t k = 0; k < D; ++k) {
      const auto row = now.turned[k] - before.turned[k];
      turned2 += foundation::dot(row, row);
    }
    return solids::norm<D>(now.shift - before.shift) + extent * std::sqrt(turned2);
  }
  // m/s, the largest speed of a body's surface within this distance of its pivot.
  double speed(std::size_t n, double t, double extent) const {
    if (!moves(n)) return 0.0;
    const auto rate = rate_of(n - sides.size(), t);
    return solids::norm<D>(rate.velocity) + extent * std::sqrt(foundation::dot(rate.angular, rate.angular));
  }
  solids::pose<D> pose_of(std::size_t b, double t) const {
    auto now = motions[b].at(t);
    if (gate && gate->body == b && opened) now.shift += std::clamp(t - *opened, 0.0, gate->seconds) * gate->velocity;
    return now;
  }
  solids::rate<D> rate_of(std::size_t b, double t) const {
    auto now = motions[b].rate_at(t);
    if (gate && gate->body == b && opened && t >= *opened && t < *opened + gate->seconds)
      now.velocity += gate->velocity;
    return now;
  }
};

}  // namespace tetsuame::dem
