// Tests of two materials with equations of state: heavy liquid over light liquid under gravity, and the impact of two
// bodies with a core.
#include <cmath>
#include <exact/instability.hpp>
#include <foundation/exact_sum.hpp>
#include <gas/setup_parts.hpp>
#include <memory>
#include <riemann/general.hpp>

namespace tetsuame::gas {

namespace {

// Pa: K_S = ρ c².
double adiabatic_modulus(const eos::caloric& material, double rho, double T) {
  return rho * std::pow(material.at(rho, material.internal_energy(rho, T)).c, 2);
}

// dp/dy = -ρ(p, T) g on either side of the contact in the middle, where p is p_l. Each material has its own temperature
// throughout. Between the nodes linear.
class column {
 public:
  explicit column(const options& o) : middle_(0.5 * o.domain.length[1]), step_(middle_ / intervals) {
    const auto& s = o.shock;
    build(s.l, -s.gravity * -step_, s.l.p, below_);
    build(s.r, -s.gravity * step_, s.l.p, above_);
  }

  struct level {
    double rho, p, modulus;  // kg/m^3, Pa, Pa: K_S
  };
  level at(double y) const {
    const auto& nodes = y < middle_ ? below_ : above_;
    const double place = std::min(std::abs(y - middle_) / step_, intervals - 1e-9);
    const auto k = static_cast<std::size_t>(place);
    const double b = place - static_cast<double>(k), a = 1.0 - b;
    const level &m = nodes[k], &n = nodes[k + 1];
    return {a * m.rho + b * n.rho, a * m.p + b * n.p, a * m.modulus + b * n.modulus};
  }

 private:
  static constexpr int intervals = 500;

  // per_density: -g dy
  static void build(const side_options& of, double per_density, double p, std::vector<level>& nodes) {
    const eos::any material = eos_of(of);
    const eos::caloric waves(material);
    const double T = *of.temperature;
    for (int k = 0; k <= intervals; ++k) {
      const double rho = eos::density(material, p, T);
      nodes.push_back({rho, p, adiabatic_modulus(waves, rho, T)});
      p += per_density * eos::density(material, p + 0.5 * per_density * rho, T);
    }
  }

  double middle_, step_;  // m
  std::vector<level> below_, above_;
};

// Of the mass of a material: its mean height.
trace mean_height(std::int32_t material) {
  return {"mean_height", "m", [=](const view& w) {
            foundation::exact_sum mass, moment;
            for (std::size_t i = 0; i < w.n; ++i)
              if (w.material[i] == material) {
                mass.add(w.m[i]);
                moment.add(w.m[i] * w.x[1][i]);
              }
            return w.ranks.exact(moment) / w.ranks.exact(mass);
          }};
}

// The largest (sign 1) or, with its sign changed, the least pressure (-1).
double extreme_pressure(const view& w, double sign) {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < w.n; ++i) most = std::max(most, sign * w.p[i]);
  return sign * w.ranks.maximum(most);
}

}  // namespace

// Two liquids between walls, the right one (material 1) above the left one (0), in hydrostatic balance, against the
// linear theory of these layers: a sharp contact between compressible fluids, whose growth rate the start has. The
// lattice itself is displaced: a contact that moved by less than a spacing would not show otherwise.
setup overturn(const options& o) {
  const auto& s = o.shock;
  const double H = o.domain.length[1], k = wave_number(o);
  const auto balanced = std::make_shared<const column>(o);
  const auto profile = [=](double y) {
    const auto here = balanced->at(y);
    return exact::layer_state{here.rho, 0.0, here.modulus};  // K_S in the place of γ p, γ = 1
  };
  const exact::layered_flow layers{profile, 1.0, s.gravity, 0.0, H, exact::edge::wall, exact::edge::wall, {0.5 * H}};
  const double growth = k * exact::fastest_mode(layers, k).imag();
  setup t;
  const point middle{o.domain.length[0], 0.5 * H, o.domain.length[2]}, foot{0.0, 0.5 * H, 0.0};
  if (s.masses == "equal_mass")
    t.blocks = {lattice(o, {}, middle, o.domain.dx()),
                lattice(o, foot, o.domain.length, spacing_of(o, s.r.rho, s.l.rho))};
  else
    t.blocks = {whole_box(o)};
  const std::array<eos::any, 2> liquids{eos_of(s.l), eos_of(s.r)};
  const std::array<double, 2> T{*s.l.temperature, *s.r.temperature};
  const interface_wave wave{k, H, s.perturbation, growth};
  t.moved = [=, L = o.domain.length[0], per_growth = growth > 0.0 ? 1.0 / growth : 0.0](const point& x) {
    const auto [u, v, eta] = wave.at(x);
    point put = x;
    put[0] += per_growth * u;
    put[0] -= L * std::floor(put[0] / L);
    put[1] += eta;
    return put;
  };
  t.start = [=, moved = t.moved](const point& x) {
    const auto [u, v, eta] = wave.at(x);
    const bool above = x[1] > 0.5 * H;
    const double p = balanced->at(moved(x)[1]).p;
    return state{eos::density(liquids[above], p, T[above]), p, {u, v, 0.0}, above};
  };
  compare_growth(growth, k, {0.5 * H}, t);
  t.known.emplace_back("growth_rate_sharp",
                       exact::rayleigh_taylor_growth(k, s.gravity, s.r.rho, s.l.rho, 0.5 * H, 0.5 * H));
  t.traces.push_back(mean_height(1));
  return t;
}

// A band of the left material (1), half of the box, that flows past the right one (0) with sharp contacts, as in
// [T. D. Sandnes et al., J. Comput. Phys. 532, 113907 (2025), section 4.4], and the linear theory of just these layers,
// both compressible: exact/instability.hpp with K_S in the place of γ p.
setup shear(const options& o) {
  const auto& s = o.shock;
  const point end = o.domain.length;
  const double H = end[1], k = wave_number(o);
  const auto inside = [H](double y) { return std::abs(y - 0.5 * H) < 0.25 * H; };
  const double outer = o.domain.dx(), inner = spacing_of(o, s.l.rho, s.r.rho);
  setup t;
  t.material_l = 1;
  t.blocks = {lattice(o, {}, {end[0], 0.25 * H, end[2]}, outer),
              lattice(o, {0.0, 0.25 * H, 0.0}, {end[0], 0.75 * H, end[2]}, inner),
              lattice(o, {0.0, 0.75 * H, 0.0}, end, outer)};
  t.start = [=](const point& x) {
    const side_options& own = inside(x[1]) ? s.l : s.r;
    return state{own.rho, own.p, {own.u, s.perturbation * std::sin(k * x[0]), 0.0}, inside(x[1]) ? 1 : 0};
  };
  const auto modulus = [](const side_options& of) {
    return adiabatic_modulus(eos::caloric(eos_of(of)), of.rho, *of.temperature);
  };
  const exact::layer_state in{s.l.rho, s.l.u, modulus(s.l)}, out{s.r.rho, s.r.u, modulus(s.r)};
  const exact::layered_flow layers{[=](double y) { return inside(y) ? in : out; },
                                   1.0,
                                   0.0,
                                   0.0,
                                   0.5 * H,
                                   exact::edge::free,
                                   exact::edge::free,
                                   {0.25 * H}};
  compare_growth(k * exact::fastest_mode(layers, k).imag(), k, {0.25 * H, 0.75 * H}, t);
  t.known.emplace_back("growth_rate_sharp",
                       k * std::abs(s.l.u - s.r.u) * std::sqrt(s.l.rho * s.r.rho) / (s.l.rho + s.r.rho));
  return t;
}

// Two discs or balls with a core of the left material (1) and a mantle of the right one (0), about to touch in the
// middle of an otherwise empty box. The one on the left has velocity u_l, that on the right u_r. p_star is the pressure
// of two mantles that meet so in one dimension.
setup impact(const options& o) {
  const auto& s = o.shock;
  point centre{};
  for (std::size_t a = 0; a < o.domain.axes(); ++a) centre[a] = 0.5 * o.domain.length[a];
  const auto from_own_centre = [=, radius = s.radius](const point& x) {
    point own = centre;
    own[0] += x[0] < centre[0] ? -radius : radius;
    return distance(x, own);
  };
  setup t;
  t.material_l = 1;
  t.blocks = {whole_box(o)};
  t.blocks[0].holds = [=, radius = s.radius](const point& x) { return from_own_centre(x) < radius; };
  t.start = [=, s = o.shock](const point& x) {
    const bool core = from_own_centre(x) < s.core * s.radius;
    const side_options& own = core ? s.l : s.r;
    return state{own.rho, own.p, {x[0] < centre[0] ? s.l.u : s.r.u, 0.0, 0.0}, core};
  };
  const eos::caloric mantle(eos_of(s.r));
  const riemann::general_tube meeting({&mantle, s.r.rho, s.l.u, *s.r.temperature},
                                      {&mantle, s.r.rho, s.r.u, *s.r.temperature});
  t.known = {{"p_star", meeting.star_l().p}};
  t.traces = {{"pressure_max", "Pa", [](const view& w) { return extreme_pressure(w, 1.0); }},
              {"pressure_min", "Pa", [](const view& w) { return extreme_pressure(w, -1.0); }}};
  return t;
}

}  // namespace tetsuame::gas
