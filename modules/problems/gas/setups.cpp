#include <cmath>
#include <exact/flows.hpp>
#include <exact/instability.hpp>
#include <exact/sedov.hpp>
#include <foundation/exact_sum.hpp>
#include <gas/setup_parts.hpp>
#include <memory>
#include <numbers>
#include <riemann/general.hpp>

namespace tetsuame::gas {

block lattice(const options& o, const point& low, const point& high, double spacing) {
  block b{low, high, {1, 1, 1}};
  for (std::size_t a = 0; a < o.domain.axes(); ++a)
    b.n[a] = std::max<std::int64_t>(1, std::llround((high[a] - low[a]) / spacing));
  return b;
}

block whole_box(const options& o) { return lattice(o, {}, o.domain.length, o.domain.dx()); }

double distance(const point& a, const point& b) {
  double r2 = 0.0;
  for (std::size_t k = 0; k < 3; ++k) r2 += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(r2);
}

double spacing_of(const options& o, double rho, double rho_lattice) {
  if (o.shock.masses == "equal_spacing") return o.domain.dx();
  return o.domain.dx() * std::pow(rho_lattice / rho, 1.0 / static_cast<double>(o.domain.dimension));
}

namespace {

// Two half boxes; as many particles in all as the lattice has.
setup two_halves(const options& o, std::function<state(const point&, double t)> exact, numbers known) {
  const auto& s = o.shock;
  const point end = o.domain.length;
  const double middle = s.middle * end[0], mean = s.middle * s.l.rho + (1.0 - s.middle) * s.r.rho;
  setup t;
  t.blocks = {lattice(o, {0.0, 0.0, 0.0}, {middle, end[1], end[2]}, spacing_of(o, s.l.rho, mean)),
              lattice(o, {middle, 0.0, 0.0}, end, spacing_of(o, s.r.rho, mean))};
  t.start = [exact](const point& x) { return exact(x, 0.0); };
  t.measured = [=, half = 0.5 * end[0], width = 0.5 * s.window * end[0]](const point& x, double) {
    return std::abs(x[0] - half) <= width;
  };
  t.exact = std::move(exact);
  t.known = std::move(known);
  return t;
}

setup tube_of_gases(const options& o) {
  const auto& s = o.shock;
  const exact::shock_tube tube({s.l.rho, s.l.u, s.l.p, *s.l.gamma, s.l.p_infinity},
                               {s.r.rho, s.r.u, s.r.p, *s.r.gamma, s.r.p_infinity});
  const auto at = [=, middle = s.middle * o.domain.length[0]](const point& x, double time) {
    const auto w = tube.at(x[0] - middle, time);
    return state{w.rho, w.p, {w.u, 0.0, 0.0}, x[0] < middle ? 0 : 1};
  };
  const auto& b = tube.between();
  return two_halves(o, at, {{"p_star", b.p}, {"u_star", b.u}, {"rho_star_l", b.rho_l}, {"rho_star_r", b.rho_r}});
}

// With equations of state.
setup tube_of_materials(const options& o) {
  struct materials {
    eos::caloric l, r;
    riemann::general_tube tube;
    explicit materials(const shock_options& q)
        : l(eos_of(q.l)),
          r(eos_of(q.r)),
          tube({&l, q.l.rho, q.l.u, *q.l.temperature}, {&r, q.r.rho, q.r.u, *q.r.temperature}) {}
  };
  const auto both = std::make_shared<const materials>(o.shock);
  const auto at = [both, s = o.shock, middle = o.shock.middle * o.domain.length[0]](const point& x, double time) {
    if (!(time > 0.0)) return x[0] < middle ? state{s.l.rho, s.l.p, {s.l.u}, 0} : state{s.r.rho, s.r.p, {s.r.u}, 1};
    const double xi = (x[0] - middle) / time;
    const auto w = both->tube.at(xi);
    return state{w.rho, w.p, {w.v}, both->tube.on_left(xi) ? 0 : 1};
  };
  const auto &l = both->tube.star_l(), &r = both->tube.star_r();
  return two_halves(o, at,
                    {{"p_star", l.p},
                     {"u_star", l.v},
                     {"rho_star_l", l.rho},
                     {"rho_star_r", r.rho},
                     {"temperature_star_l", both->l.temperature(l.rho, l.u)},
                     {"temperature_star_r", both->r.temperature(r.rho, r.u)}});
}

point middle_of(const options& o) {
  point c{};
  for (std::size_t k = 0; k < 3; ++k) c[k] = 0.5 * o.domain.length[k];
  return c;
}

// A square (cube) of half the box's edge, denser than what is around it, in pressure balance: [S4] has densities 4 and
// 1, pressure 2.5, gamma 5/3.
setup square(const options& o) {
  const auto& s = o.shock;
  const auto D = o.domain.axes();
  const point end = o.domain.length, c = middle_of(o);
  const auto inside = [=](const point& x) {
    for (std::size_t a = 0; a < D; ++a)
      if (std::abs(x[a] - c[a]) > 0.25 * end[a]) return false;
    return true;
  };
  setup t;
  t.material_l = 1;
  point low{}, high{};
  for (std::size_t a = 0; a < D; ++a) {
    low[a] = 0.25 * end[a];
    high[a] = 0.75 * end[a];
  }
  t.blocks = {whole_box(o), lattice(o, low, high, spacing_of(o, s.l.rho, s.r.rho))};
  t.blocks[0].holds = [=](const point& x) { return !inside(x); };
  t.start = [=](const point& x) {
    return inside(x) ? state{s.l.rho, s.l.p, {s.l.u, 0.0, 0.0}, 1} : state{s.r.rho, s.r.p, {s.r.u, 0.0, 0.0}, 0};
  };
  t.traces = {{"square_area", D == 2 ? "m^2" : "m^3",
               [](const view& w) {
                 foundation::exact_sum area;
                 for (std::size_t i = 0; i < w.n; ++i)
                   if (w.material[i] == 1) area.add(w.volume[i]);
                 return w.ranks.exact(area);
               }},
              // From the centre of mass, mean over the quadrants.
              {"corner_distance", "m", [=](const view& w) {
                 point centre{};
                 foundation::exact_sum mass;
                 std::array<foundation::exact_sum, 3> moment;
                 for (std::size_t i = 0; i < w.n; ++i) {
                   if (w.material[i] != 1) continue;
                   mass.add(w.m[i]);
                   for (std::size_t a = 0; a < D; ++a) moment[a].add(w.m[i] * w.x[a][i]);
                 }
                 for (std::size_t a = 0; a < D; ++a) centre[a] = w.ranks.exact(moment[a]) / w.ranks.exact(mass);
                 std::vector<double> farthest(std::size_t{1} << D, 0.0);
                 for (std::size_t i = 0; i < w.n; ++i) {
                   if (w.material[i] != 1) continue;
                   std::size_t quadrant = 0;
                   for (std::size_t a = 0; a < D; ++a) quadrant |= (w.x[a][i] > centre[a] ? 1U : 0U) << a;
                   farthest[quadrant] = std::max(farthest[quadrant], distance(w.place(i), centre));
                 }
                 w.ranks.maximum(std::span<double>(farthest));
                 double mean = 0.0;
                 for (const double r : farthest) mean += r / static_cast<double>(farthest.size());
                 return mean;
               }}};
  // A corner of radius r is nearer to the centre by (sqrt(D) - 1) r.
  t.measures = [=](const view&, const samples& all) {
    const double edge = 0.5 * end[0], lost = all.front()[2] - all.back()[2];
    return numbers{{"square_area_change", all.back()[1] / all.front()[1] - 1.0},
                   {"square_corner_radius", lost / (std::sqrt(static_cast<double>(D)) - 1.0) / edge}};
  };
  return t;
}

// Where the density, averaged over shells one spacing wide, is half the way from that ahead to the peak, outside of it.
double shock_radius(const view& w, const point& centre, double dx, double largest,
                    const std::function<double(double)>& ahead) {
  const auto shells = static_cast<std::size_t>(largest / dx) + 1;
  std::vector<foundation::exact_sum> mass(shells), volume(shells);
  for (std::size_t i = 0; i < w.n; ++i) {
    const double r = distance(w.place(i), centre);
    if (!(r < largest)) continue;
    const auto k = static_cast<std::size_t>(r / dx);
    mass[k].add(w.m[i]);
    volume[k].add(w.m[i] / w.rho[i]);
  }
  std::vector<double> rho(shells, 0.0);
  std::size_t peak = 0;
  for (std::size_t k = 0; k < shells; ++k) {
    const double V = w.ranks.exact(volume[k]);
    const double r = (static_cast<double>(k) + 0.5) * dx;
    if (V > 0.0) rho[k] = w.ranks.exact(mass[k]) / V / ahead(r);
    if (rho[k] > rho[peak]) peak = k;
  }
  const double half = 0.5 * (1.0 + rho[peak]);
  for (std::size_t k = peak; k + 1 < shells; ++k)
    if (rho[k] >= half && rho[k + 1] < half)
      return (static_cast<double>(k) + 0.5 + (rho[k] - half) / (rho[k] - rho[k + 1])) * dx;
  return 0.0;
}

// Of the lattice about the centre.
double sum_of_shares(const options& o, const std::function<double(const point&)>& share) {
  const auto& s = o.shock;
  double shares = 0.0;
  const auto reach = static_cast<std::int64_t>(s.blast_radius) + 2;
  const auto& n = o.domain.particles;
  std::array<std::int64_t, 3> low{}, high{};
  for (std::size_t a = 0; a < o.domain.axes(); ++a) {
    const std::int64_t middle = s.corner ? 0 : n[a] / 2;
    low[a] = std::max<std::int64_t>(0, middle - reach);
    high[a] = std::min(n[a] - 1, middle + reach);
  }
  for (auto i = low[0]; i <= high[0]; ++i)
    for (auto j = low[1]; j <= high[1]; ++j)
      for (auto k = low[2]; k <= high[2]; ++k) {
        point x{};
        const std::array<std::int64_t, 3> at{i, j, k};
        for (std::size_t a = 0; a < o.domain.axes(); ++a) x[a] = (static_cast<double>(at[a]) + 0.5) * o.domain.dx();
        shares += share(x);
      }
  return shares;
}

// Ω ∫ g φ λ^D dλ of the blast's profile, by the midpoint rule.
double momentum_of_blast(const exact::sedov& blast, int dimension) {
  double shape = 0.0;
  constexpr int intervals = 4000;
  for (int k = 0; k < intervals; ++k) {
    const double lambda = (k + 0.5) / intervals;
    const auto w = blast.profile(lambda);
    shape += w.g * w.phi * std::pow(lambda, dimension) / intervals;
  }
  return shape * (dimension == 1 ? 2.0 : 2.0 * std::numbers::pi * (dimension - 1.0));
}

setup sedov(const options& o) {
  const auto& s = o.shock;
  const point c = s.corner ? point{} : middle_of(o);
  const double in_box = s.corner ? std::pow(0.5, static_cast<double>(o.domain.dimension)) : 1.0;
  setup t;
  t.blocks = {whole_box(o)};
  const double radius = s.blast_radius * o.domain.dx();
  const auto share = [=](const point& x) {
    const double q = distance(x, c) / radius;
    return q < 1.0 ? (1.0 - q * q) * (1.0 - q * q) : 0.0;
  };
  const double per_volume = std::pow(o.domain.dx(), static_cast<double>(o.domain.dimension));
  const double shares = sum_of_shares(o, share) / in_box;
  t.start = [=](const point& x) {
    return state{s.l.rho, s.l.p + (s.gamma - 1.0) * s.energy * share(x) / (shares * per_volume), {}, 0};
  };
  const exact::sedov blast(static_cast<int>(o.domain.dimension), s.gamma);
  t.exact = [=](const point& x, double time) {
    const double r = distance(x, c);
    if (!(time > 0.0)) return state{s.l.rho, s.l.p, {}, 0};
    const auto w = blast.at(r, time, s.energy, s.l.rho);
    state e{w.rho, w.p, {}, 0};
    for (std::size_t a = 0; a < 3; ++a) e.v[a] = r > 0.0 ? w.u * (x[a] - c[a]) / r : 0.0;
    return e;
  };
  const double end = o.common.time.end();
  if (end > 0.0) t.known = {{"shock_radius_exact", blast.shock_radius(s.energy, s.l.rho, end)}};
  // Two measures of the radius: by the density, and by the momentum along r, which smoothing at the shock does not
  // change:
  //   ∫ρ u dV = Ω ρ0 u_s r_s^D ∫ g φ λ^D dλ,   u_s = 2 r_s/((D+2) t)
  const double shape = momentum_of_blast(blast, static_cast<int>(o.domain.dimension));
  t.measures = [=, D = static_cast<double>(o.domain.dimension), dx = o.domain.dx(),
                half = (s.corner ? 1.0 : 0.5) * o.domain.length[0]](const view& w, const samples& all) {
    foundation::exact_sum momentum;
    for (std::size_t i = 0; i < w.n; ++i) {
      const point x = w.place(i), v = w.velocity(i);
      const double r = distance(x, c);
      for (std::size_t a = 0; a < 3 && r > 0.0; ++a) momentum.add(w.m[i] * v[a] * (x[a] - c[a]) / r);
    }
    const double power = 0.5 * (D + 2.0) * all.back()[0] * w.ranks.exact(momentum) / (in_box * shape * s.l.rho);
    return numbers{{"shock_radius", std::pow(std::max(power, 0.0), 1.0 / (D + 1.0))},
                   {"shock_radius_density", shock_radius(w, c, dx, half, [&](double) { return s.l.rho; })}};
  };
  return t;
}

// Cold gas that falls on the middle of the box, all of it with the same speed u_l.
setup noh(const options& o) {
  const auto& s = o.shock;
  const point c = middle_of(o);
  const exact::noh flow{static_cast<int>(o.domain.dimension), s.gamma, s.l.rho, s.l.u};
  setup t;
  t.blocks = {whole_box(o)};
  t.exact = [=](const point& x, double time) {
    const double r = std::max(distance(x, c), 1e-12 * c[0]);
    const auto w = flow.at(r, time);
    state e{w.rho, std::max(w.p, s.l.p), {}, 0};
    for (std::size_t a = 0; a < 3; ++a) e.v[a] = w.u * (x[a] - c[a]) / r;
    return e;
  };
  t.start = [exact = t.exact](const point& x) { return exact(x, 0.0); };
  t.measured = [=](const point& x, double) { return distance(x, c) <= s.window * c[0]; };
  const double end = o.common.time.end();
  t.known = {{"shock_radius_exact", flow.shock_radius(end)}};
  t.measures = [=, dx = o.domain.dx(), most = s.window * c[0]](const view& w, const samples&) {
    return numbers{{"shock_radius", shock_radius(w, c, dx, most, [&](double r) {
                      return flow.rho0 * std::pow(1.0 + flow.u0 * end / r, flow.dimension - 1);
                    })}};
  };
  return t;
}

setup gresho(const options& o) {
  const auto& s = o.shock;
  const point c = middle_of(o);
  const exact::gresho vortex{0.2 * o.domain.length[0], s.l.u, s.l.rho, s.l.p};
  setup t;
  t.blocks = {whole_box(o)};
  t.start = [=](const point& x) {
    const double dx = x[0] - c[0], dy = x[1] - c[1], r = std::sqrt(dx * dx + dy * dy);
    const double v = r > 0.0 ? vortex.velocity(r) / r : 0.0;
    return state{s.l.rho, vortex.pressure(r), {-v * dy, v * dx, 0.0}, 0};
  };
  t.exact = [start = t.start](const point& x, double) { return start(x); };
  return t;
}

// Two blasts that meet [P. Woodward, P. Colella, J. Comput. Phys. 54, 115 (1984)]: pressure p_l in the left tenth of
// the box, p_r in the right tenth, 0.01 between.
setup blasts(const options& o) {
  const auto& s = o.shock;
  setup t;
  t.blocks = {whole_box(o)};
  t.start = [=, L = o.domain.length[0]](const point& x) {
    return state{s.l.rho, x[0] < 0.1 * L ? s.l.p : x[0] < 0.9 * L ? 0.01 : s.r.p, {}, 0};
  };
  t.measures = [](const view& w, const samples&) {
    double densest = 0.0;
    for (std::size_t i = 0; i < w.n; ++i) densest = std::max(densest, w.rho[i]);
    return numbers{{"density_max", w.ranks.maximum(densest)}};
  };
  return t;
}

// Of vy, the wave k along x near the layers at these heights.
trace wave_amplitude(double k, std::vector<double> heights) {
  return {"wave_amplitude", "m/s", [=, heights = std::move(heights)](const view& w) {
            foundation::exact_sum sine, cosine, weight;
            for (std::size_t i = 0; i < w.n; ++i) {
              double near = std::numeric_limits<double>::infinity();
              for (const double y : heights) near = std::min(near, std::abs(w.x[1][i] - y));
              const double here = w.volume[i] * std::exp(-k * near);
              sine.add(here * w.v[1][i] * std::sin(k * w.x[0][i]));
              cosine.add(here * w.v[1][i] * std::cos(k * w.x[0][i]));
              weight.add(here);
            }
            return 2.0 * std::hypot(w.ranks.exact(sine), w.ranks.exact(cosine)) / w.ranks.exact(weight);
          }};
}

// Least squares of ln amplitude between one and two growth times, when what else was in the start has died away.
std::optional<double> measured_growth(const samples& all, double expected) {
  fitted_line line;
  for (const auto& sample : all) {
    if (sample[0] < 1.0 / expected || sample[0] > 2.0 / expected) continue;
    if (!(sample[1] > 0.0)) return std::nullopt;
    line.add(sample[0], std::log(sample[1]));
  }
  return line.n > 2.0 ? std::optional(line.slope()) : std::nullopt;
}

}  // namespace

void compare_growth(double growth, double k, std::vector<double> heights, setup& t) {
  t.known = {{"growth_rate_theory", growth}};
  t.traces = {wave_amplitude(k, std::move(heights))};
  t.measures = [=](const view&, const samples& all) { return numbers{{"growth_rate", measured_growth(all, growth)}}; };
}

double wave_number(const options& o) {
  return 2.0 * std::numbers::pi * static_cast<double>(o.shock.waves) / o.domain.length[0];
}

interface_wave::motion interface_wave::at(const point& x) const {
  const double d = x[1] - 0.5 * H, left = k * (0.5 * H - std::abs(d)), size = speed / std::sinh(0.5 * k * H);
  const double v = size * std::cos(k * x[0]) * std::sinh(left);
  const double u = std::copysign(size, d) * std::sin(k * x[0]) * std::cosh(left);
  return {u, v, growth > 0.0 ? v / growth : 0.0};
}

namespace {

// A band of gas that flows the other way, with smooth layers [C. P. McNally, W. Lyra, J.-C. Passy, Astrophys. J. Suppl.
// 201, 18 (2012)], and the linear theory of just these layers (exact/instability.hpp). The sine along x is the same at
// both layers, so at the planes of symmetry between them the wave's pressure is zero.
setup kelvin_helmholtz(const options& o) {
  const auto& s = o.shock;
  const double H = o.domain.length[1], k = wave_number(o);
  const auto profile = [=](double y, double inner, double outer) {
    const double mean = 0.5 * (inner + outer), jump = 0.5 * (inner - outer), d = 0.25 * H - std::abs(y - 0.5 * H);
    return mean + (d > 0.0 ? jump * (1.0 - std::exp(-d / s.layer)) : -jump * (1.0 - std::exp(d / s.layer)));
  };
  setup t;
  t.blocks = {whole_box(o)};
  t.start = [=](const point& x) {
    return state{profile(x[1], s.l.rho, s.r.rho),
                 s.l.p,
                 {profile(x[1], s.l.u, s.r.u), s.perturbation * std::sin(k * x[0]), 0.0},
                 x[1] > 0.25 * H && x[1] < 0.75 * H};
  };
  const exact::layered_flow layers{
      [=](double y) {
        return exact::layer_state{profile(y, s.l.rho, s.r.rho), profile(y, s.l.u, s.r.u), s.l.p};
      },
      s.gamma,
      0.0,
      0.0,
      0.5 * H,
      exact::edge::free,
      exact::edge::free,
      {}};
  compare_growth(k * exact::fastest_mode(layers, k).imag(), k, {0.25 * H, 0.75 * H}, t);
  return t;
}

// Heavy gas over light gas between walls [T. Abel, MNRAS 413, 271 (2011), whose layer this is], rho_r over rho_l, in
// hydrostatic balance with p_l in the middle, against the linear theory of just this layer, whose growth rate the start
// has.
setup rayleigh_taylor(const options& o) {
  const auto& s = o.shock;
  const double H = o.domain.length[1], k = wave_number(o);
  const auto profile = [=](double y) {
    const double d = 2.0 * (y - 0.5 * H) / s.layer, jump = s.r.rho - s.l.rho;
    // ln(1 + e^d) without overflow
    const double log = std::max(d, 0.0) + std::log1p(std::exp(-std::abs(d)));
    const double column = s.l.rho * (y - 0.5 * H) + 0.5 * s.layer * jump * (log - std::numbers::ln2);
    return exact::layer_state{s.l.rho + jump / (1.0 + std::exp(-d)), 0.0, s.l.p - s.gravity * column};
  };
  const exact::layered_flow layers{profile, s.gamma, s.gravity, 0.0, H, exact::edge::wall, exact::edge::wall, {}};
  const double growth = k * exact::fastest_mode(layers, k).imag();
  setup t;
  t.blocks = {whole_box(o)};
  t.start = [=, wave = interface_wave{k, H, s.perturbation, growth}](const point& x) {
    const auto [u, v, eta] = wave.at(x);
    return state{profile(x[1] - eta).rho, profile(x[1]).p, {u, v, 0.0}, x[1] - 0.5 * H - eta > 0.0};
  };
  compare_growth(growth, k, {0.5 * H}, t);
  t.known.emplace_back("growth_rate_sharp",
                       exact::rayleigh_taylor_growth(k, s.gravity, s.r.rho, s.l.rho, 0.5 * H, 0.5 * H));
  return t;
}

}  // namespace

namespace {

setup test_of(const options& o) {
  const auto& test = o.shock.test;
  if (test == "square") return square(o);
  if (test == "sedov") return sedov(o);
  if (test == "noh") return noh(o);
  if (test == "gresho") return gresho(o);
  if (test == "blasts") return blasts(o);
  if (test == "kelvin_helmholtz") return o.any_eos() ? shear(o) : kelvin_helmholtz(o);
  if (test == "rayleigh_taylor") return o.any_eos() ? overturn(o) : rayleigh_taylor(o);
  if (test == "impact") return impact(o);
  if (test == "collapse") return collapse(o);
  if (test == "viscous_shock") return viscous_shock(o);
  return o.any_eos() ? tube_of_materials(o) : tube_of_gases(o);
}

}  // namespace

setup make_setup(const options& o) {
  auto test = test_of(o);
  if (o.shock.molecular.any() && o.shock.test != "viscous_shock") {  // what is known is of gas without friction
    test.exact = {};
    test.measured = {};
    test.known = {};
  }
  if (o.regions.any() || !o.common.start.file.empty()) forget_solution(test);
  return o.regions.any() ? with_regions(o, std::move(test)) : test;
}

}  // namespace tetsuame::gas
