#include <cmath>
#include <exact/viscous_shock.hpp>
#include <gas/setup_parts.hpp>

namespace tetsuame::gas {

// Gas at rest on the right, which a shock runs into; its structure is exact at any time. Errors are measured about it.
setup viscous_shock(const options& o) {
  const auto& s = o.shock;
  const double from = s.middle * o.domain.length[0], half = 0.5 * s.window * o.domain.length[0];
  const exact::viscous_shock shock(s.r.rho, s.r.p, s.gamma, s.l.p, s.molecular.along());
  setup t;
  t.blocks = {whole_box(o)};
  t.exact = [=, moving = s.r.u](const point& x, double time) {
    const auto w = shock.at(x[0] - from - moving * time, time);
    return state{w.rho, w.p, {moving + w.u, 0.0, 0.0}, 0};
  };
  t.start = [exact = t.exact](const point& x) { return exact(x, 0.0); };
  t.measured = [=, speed = shock.speed() + s.r.u](const point& x, double time) {
    return std::abs(x[0] - from - speed * time) <= half;
  };
  t.known = {{"shock_speed", shock.speed()},
             {"shock_width", shock.width()},
             {"density_behind", shock.density_behind()},
             {"velocity_behind", shock.flow_behind()}};
  return t;
}

}  // namespace tetsuame::gas
