#include <algorithm>
#include <cmath>
#include <free_surface/memory.hpp>
#include <numbers>
#include <ranges>
#include <walls/wall_set.hpp>

namespace tetsuame::free_surface {

namespace {

// Of a particle there: one for each side, edge and corner that is near.
template <int D>
double images_of(const options& o, const solids::point<D>& x, double reach) {
  double with_itself = 1.0;
  for (std::size_t a = 0; a < D; ++a) {
    if (o.domain.periodic[a]) continue;
    const bool open_above = a == 1 && o.open_top();
    with_itself +=
        with_itself * ((x[a] < reach ? 1.0 : 0.0) + (!open_above && o.domain.length[a] - x[a] < reach ? 1.0 : 0.0));
  }
  return with_itself - 1.0;
}

// The places of M. Roberts' sequence, which fill a box evenly: multiples of powers of 1/φ, φ^(D+1) = φ + 1.
template <int D>
solids::point<D> place_in(const std::array<double, 3>& length, std::size_t n) {
  constexpr double ratio = D == 2 ? 1.32471795724474602596 : 1.22074408460575947536;
  return solids::point<D>::of([&](std::size_t a) {
    const double multiple = static_cast<double>(n + 1) * std::pow(ratio, -static_cast<double>(a + 1));
    return (multiple - std::floor(multiple)) * length[a];
  });
}

template <int D>
particle_numbers count(const options& o, const parameters& p) {
  constexpr std::size_t places = 200000;
  const auto& bodies = p.template bodies_in<D>();
  const auto solid = solids::joined(bodies);
  const double dx = o.domain.dx(), support = run::support_over_dx(o.common.kernel) * dx;
  const double reach = support + o.common.kernel.skin * dx;
  double each = 1.0 / places;  // particles that a place stands for
  for (std::size_t a = 0; a < D; ++a) each *= o.domain.length[a] / dx;
  const double part = o.flow.start == "drop" ? std::numbers::pi / (D == 2 ? 4.0 : 6.0) : 1.0;  // of the block
  particle_numbers all;
  for (std::size_t n = 0; n < places; ++n) {
    const auto x = place_in<D>(o.domain.length, n);
    point of_water{};
    for (std::size_t a = 0; a < D; ++a) of_water[a] = x[a];
    const double level = bodies.empty() ? support : solid.level(x);
    const bool wet = std::ranges::any_of(p.blocks, [&](const block& b) { return b.holds(of_water); });
    double here = 0.0;
    if (level >= 0.0 && wet) all.fluid += here = part * each;
    if (level < 0.0 && level > -support) all.in_bodies += here = each;
    all.images += here * images_of<D>(o, x, reach);
  }
  return all;
}

template <int D>
run::memory_need need_in(const options& o, const parameters& p) {
  constexpr double a_double = sizeof(double), a_number = 4.0;
  const bool bodies = !p.bodies_in<D>().empty();
  const auto sticks = [](const auto& side) { return side.slip == "no_slip"; };
  const bool two_velocities =
      (bodies && p.by != scheme::riemann) || o.walls.slip == "no_slip" || std::ranges::any_of(o.walls.sides, sticks);
  const bool free = std::ranges::any_of(p.motions_in<D>(), [](const auto& m) { return m.free.has_value(); });
  const bool loads = !p.force.empty() || free;
  const bool single = o.common.kernel.single_pairs();
  // Of every particle: its fields, ID and material; sums of an evaluation (water.hpp); its record in the loop over
  // pairs, rounded up to four numbers.
  const double more = (two_velocities ? D : 0.0) + (bodies ? D + 1.0 : 0.0) + (loads ? D + 1.0 : 0.0) +
                      (free ? 1.0 * solids::rigid<D>::components : 0.0) +
                      (o.flow.surface_tension > 0.0 ? 3.0 * D + 2.0 : 0.0);
  const double record = 4.0 * std::ceil((2.0 * D + 3.0 + (two_velocities ? D : 0.0)) / 4.0);
  const double each = a_double * (3.0 * D + 14.0) + 3.0 * a_number + a_double * (3.0 * D + 4.0 + more) +
                      (single ? 0.5 : 1.0) * a_double * record;
  // Of the fluid: the integrator's vectors of x, v, ρ; a list; what writing a snapshot takes.
  constexpr double vectors = 5.0, snapshot = 100.0, of_a_list = 0.5;
  const double skin = o.common.kernel.skin, support = run::support_over_dx(o.common.kernel);
  const double of_fluid =
      vectors * a_double * (2.0 * D + 1.0) + snapshot + of_a_list * run::particles_within(support + skin, D);
  // Of bodies: places, and the fluid about their markers, which fills half of the reach.
  const double of_bodies =
      sizeof(walls::body_place<D>) + a_double + 0.5 * a_number * run::particles_within(support + 0.5 * skin, D);
  const auto n = count<D>(o, p);
  const double bytes = each * (n.fluid + n.in_bodies + n.images) + of_fluid * n.fluid + of_bodies * n.in_bodies +
                       2.0 * a_number * n.images;
  return {n.fluid, n.fluid > 0.0 ? bytes / n.fluid : 0.0};
}

}  // namespace

particle_numbers numbers_at_start(const options& o, const parameters& p) {
  return o.domain.dimension == 3 ? count<3>(o, p) : count<2>(o, p);
}

run::memory_need need_of(const options& o, const parameters& p) {
  return o.domain.dimension == 3 ? need_in<3>(o, p) : need_in<2>(o, p);
}

}  // namespace tetsuame::free_surface
