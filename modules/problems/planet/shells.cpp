#include <fmt/format.h>

#include <cmath>
#include <foundation/error.hpp>
#include <planet/shells.hpp>
#include <random>

namespace tetsuame::planet {

namespace {

using vector = std::array<double, 3>;

// A rotation that any direction is as likely to result of [K. Shoemake, Graphics Gems III, 124 (1992)].
std::array<vector, 3> random_rotation(std::mt19937_64& bits) {
  const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  const double u = uniform(), a = 2.0 * pi * uniform(), b = 2.0 * pi * uniform();
  const double x = std::sqrt(1.0 - u) * std::sin(a), y = std::sqrt(1.0 - u) * std::cos(a);
  const double z = std::sqrt(u) * std::sin(b), w = std::sqrt(u) * std::cos(b);
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

// n directions; the k-th belongs to the k-th of n zones of equal area.
void add_shell(std::int64_t n, double radius, double mass, std::size_t layer, std::mt19937_64& bits,
               std::vector<particle>& all) {
  const auto turn = random_rotation(bits);
  const double golden = pi * (3.0 - std::sqrt(5.0));
  for (std::int64_t k = 0; k < n; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(n);
    const double s = std::sqrt(1.0 - z * z), angle = golden * static_cast<double>(k);
    const vector e{s * std::cos(angle), s * std::sin(angle), z};
    particle p{{}, mass, layer};
    for (std::size_t a = 0; a < 3; ++a) p.x[a] = radius * (turn[a][0] * e[0] + turn[a][1] * e[1] + turn[a][2] * e[2]);
    all.push_back(p);
  }
}

// n places of a ring, evenly spaced; the first one anywhere.
void add_ring(std::int64_t n, double radius, double mass, std::size_t layer, std::mt19937_64& bits,
              std::vector<particle>& all) {
  const double first = static_cast<double>(bits() >> 11) * 0x1p-53;
  for (std::int64_t k = 0; k < n; ++k) {
    const double angle = 2.0 * pi * (static_cast<double>(k) + first) / static_cast<double>(n);
    all.push_back({{radius * std::cos(angle), radius * std::sin(angle), 0.0}, mass, layer});
  }
}

// ∫dr/d from the inside of the layer to each of its levels, d = (mass/ρ)^(1/D): how many shells lie within.
std::vector<double> shells_within(const shape& form, const std::vector<level>& levels, double mass) {
  std::vector<double> count(levels.size(), 0.0);
  for (std::size_t k = levels.size() - 1; k-- > 0;) {
    const double rho = 0.5 * (levels[k].rho + levels[k + 1].rho);
    count[k] = count[k + 1] + (levels[k].r - levels[k + 1].r) * form.root(rho / mass);
  }
  return count;
}

// The mass inside of the place with so many shells within.
double mass_at(const shape& form, const std::vector<level>& levels, const std::vector<double>& count, double shells) {
  std::size_t k = levels.size() - 1;
  while (k > 0 && count[k - 1] < shells) --k;
  if (k == 0) return levels.front().m;
  const level &in = levels[k], &out = levels[k - 1];
  const double t = (shells - count[k]) / (count[k - 1] - count[k]);
  const double r = in.r + t * (out.r - in.r), inside = std::pow(in.r, form.dimension),
               part = (form.power(r) - inside) / (std::pow(out.r, form.dimension) - inside);
  return in.m + part * (out.m - in.m);
}

}  // namespace

std::vector<particle> on_shells(const profile& planet, const std::vector<std::string>& names, std::int64_t number) {
  std::vector<particle> all;
  std::mt19937_64 bits(1);
  const shape& form = planet.form();
  const auto add = form.is_sphere() ? add_shell : add_ring;
  for (std::size_t n = 0; n < planet.layers().size(); ++n) {
    const auto& levels = planet.layers()[n].levels;
    const double low = levels.back().m, all_mass = levels.front().m - low;
    const auto of_layer = std::llround(static_cast<double>(number) * all_mass / planet.mass());
    if (of_layer < 8)
      foundation::fail_input(
          fmt::format("layer '{}' would have {} of {} particles: expected at least 8", names[n], of_layer, number));
    const double mass = all_mass / static_cast<double>(of_layer);
    const auto count = shells_within(form, levels, mass);
    const auto shells = std::max<std::int64_t>(1, std::llround(count.front()));
    std::int64_t done = 0;
    for (std::int64_t k = 1; k <= shells; ++k) {
      const double to =
          mass_at(form, levels, count, count.front() * static_cast<double>(k) / static_cast<double>(shells));
      const std::int64_t until = k == shells ? of_layer : std::llround((to - low) / mass);
      if (until == done) continue;
      const double middle = low + 0.5 * static_cast<double>(done + until) * mass;
      // The innermost shell may be one particle in the centre.
      const double radius = n == 0 && done == 0 && until == 1 ? 0.0 : planet.at_mass(middle, n).r;
      add(until - done, radius, mass, n, bits, all);
      done = until;
    }
  }
  return all;
}

}  // namespace tetsuame::planet
