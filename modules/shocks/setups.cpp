#include <cmath>
#include <exact/flows.hpp>
#include <shocks/setups.hpp>

namespace tetsuame::shocks {

namespace {

// An even lattice of about this spacing.
block lattice(const options& o, const point& low, const point& high, double spacing) {
  block b{low, high, {1, 1, 1}};
  for (std::size_t a = 0; a < static_cast<std::size_t>(o.dimension); ++a)
    b.n[a] = std::max<std::int64_t>(1, std::llround((high[a] - low[a]) / spacing));
  return b;
}

// The spacing with which gas of density rho has particles of the mass they have on the start lattice at rho_lattice.
double spacing_of(const options& o, double rho, double rho_lattice) {
  if (o.shock.masses == "equal_spacing") return o.dx();
  return o.dx() * std::pow(rho_lattice / rho, 1.0 / static_cast<double>(o.dimension));
}

// Two half boxes; as many particles in all as the lattice has.
setup riemann_tube(const options& o) {
  const auto& s = o.shock;
  const point end = o.box.length;
  const double middle = 0.5 * end[0], mean = 0.5 * (s.rho_l + s.rho_r);
  setup t;
  t.blocks = {lattice(o, {0.0, 0.0, 0.0}, {middle, end[1], end[2]}, spacing_of(o, s.rho_l, mean)),
              lattice(o, {middle, 0.0, 0.0}, end, spacing_of(o, s.rho_r, mean))};
  const exact::shock_tube tube(riemann::ideal_gas(s.rho_l, s.u_l, s.p_l, s.gamma),
                               riemann::ideal_gas(s.rho_r, s.u_r, s.p_r, s.gamma));
  t.exact = [=](const point& x, double time) {
    const auto w = tube.at(x[0] - middle, time);
    return state{w.rho, w.p, {w.u, 0.0, 0.0}, x[0] < middle ? 0 : 1};
  };
  t.start = [exact = t.exact](const point& x) { return exact(x, 0.0); };
  t.measured = [=, width = 0.5 * s.window * end[0]](const point& x, double) {
    return std::abs(x[0] - middle) <= width;
  };
  const auto& b = tube.between();
  t.numbers = {{"p_star", b.p}, {"u_star", b.u}, {"rho_star_l", b.rho_l}, {"rho_star_r", b.rho_r}};
  return t;
}

}  // namespace

setup make_setup(const options& o) { return riemann_tube(o); }

}  // namespace tetsuame::shocks
