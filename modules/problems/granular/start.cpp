#include <cmath>
#include <granular/options.hpp>
#include <run/start.hpp>

namespace tetsuame::granular {

namespace {

using namelist::element_of;

std::int32_t material_of(const options& o, const std::string& name) {
  const auto& all = o.table.materials;
  for (std::size_t n = 0; n < all.size(); ++n)
    if (all[n].name == name) return static_cast<std::int32_t>(n);
  return 0;
}

// Of one packing: a cubic lattice of cells that the largest grain fits in.
struct lattice {
  std::array<double, 3> low{};
  std::array<std::int64_t, 3> number{1, 1, 1};
  double least = 0.0, most = 0.0, cell = 0.0;  // m: radii; edge of a cell

  std::int64_t grains() const { return number[0] * number[1] * number[2]; }
};
lattice lattice_of(const options& o, std::size_t n) {
  const auto& p = o.packings_given;
  lattice l;
  l.least = p.radius[n];
  l.most = element_of(p.radius_max, n).value_or(l.least);
  l.cell = 2.0 * l.most * element_of(p.spacing, n).value_or(1.0);
  for (std::size_t a = 0; a < o.domain.axes(); ++a) {
    const double low = element_of(p.low[a], n).value_or(0.0),
                 high = element_of(p.high[a], n).value_or(o.domain.length[a]);
    l.number[a] =
        std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((high - low) / l.cell * (1.0 + 1e-9))));
    // In the middle of what the box leaves.
    l.low[a] = low + 0.5 * (high - low - static_cast<double>(l.number[a]) * l.cell);
  }
  return l;
}

}  // namespace

std::int64_t number_of_grains(const options& o) {
  auto all = static_cast<std::int64_t>(o.grains_given.number());
  for (std::size_t n = 0; n < o.packings_given.number(); ++n) all += lattice_of(o, n).grains();
  return all;
}

void for_each_grain(const options& o, const std::function<void(const grain&)>& f) {
  std::int64_t id = 0;
  const auto& g = o.grains_given;
  for (std::size_t n = 0; n < g.number(); ++n) {
    grain one;
    one.id = id++;
    one.material = material_of(o, element_of(g.material, n));
    one.radius = g.radius[n];
    for (std::size_t a = 0; a < 3; ++a) {
      one.x[a] = element_of(g.place[a], n).value_or(0.0);
      one.v[a] = element_of(g.velocity[a], n).value_or(0.0);
      one.spin[a] = element_of(g.spin[a], n).value_or(0.0);
    }
    f(one);
  }
  const auto& p = o.packings_given;
  for (std::size_t n = 0; n < o.packings_given.number(); ++n) {
    const auto l = lattice_of(o, n);
    const double jitter = element_of(p.jitter, n).value_or(0.0),
                 random = element_of(p.random_velocity, n).value_or(0.0);
    std::array<std::int64_t, 3> row{};
    for (row[2] = 0; row[2] < l.number[2]; ++row[2])
      for (row[1] = 0; row[1] < l.number[1]; ++row[1])
        for (row[0] = 0; row[0] < l.number[0]; ++row[0]) {
          grain one;
          one.id = id++;
          one.material = material_of(o, element_of(p.material, n));
          run::random_of_particle draw(one.id, o.seed);
          one.radius = l.least + (l.most - l.least) * 0.5 * (1.0 + draw.between_minus_1_and_1());
          for (std::size_t a = 0; a < o.domain.axes(); ++a) {
            // A grain stays in its own cell.
            const double room = jitter * (0.5 * l.cell - one.radius);
            one.x[a] = l.low[a] + (static_cast<double>(row[a]) + 0.5) * l.cell + room * draw.between_minus_1_and_1();
            one.v[a] = element_of(p.velocity[a], n).value_or(0.0) + random * draw.between_minus_1_and_1();
          }
          f(one);
        }
  }
}

}  // namespace tetsuame::granular
