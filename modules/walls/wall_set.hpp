// The walls of a box: its sides, and of one rank the particles that stand behind them, with their sources or markers.
#pragma once

#include <algorithm>
#include <atomic>
#include <cells/neighbour_list.hpp>
#include <foundation/error.hpp>
#include <optional>
#include <pairs/workspace.hpp>
#include <particles/named_fields.hpp>
#include <string>
#include <walls/boundary_force.hpp>
#include <walls/options.hpp>

namespace tetsuame::walls {

// Some of the markers, and the fluid that they see. Row k is of the wall particle first_wall() + of[k].
struct marker_rows {
  std::vector<std::uint32_t> of;
  cells::point_list near;             // fluid within reach of each marker: places in `listed`
  std::vector<std::uint32_t> listed;  // local indices of all in `near`, ghosts and null particle included
  // Shape functions of all in `near`, of an evaluation, in the precision of pairs; and by what those of a marker in
  // single precision are multiplied, so that their sum is one.
  cells::neighbour_list::scratch phi;
  std::vector<double> scale;
  pairs::row_subset near_wall;  // owned fluid that some marker may see
};

// A wall particle of a body, where it is now, and its marker.
template <int D>
struct body_place {
  std::array<double, D> x, marker, normal;  // m, m, into the fluid
  double height = 0.0;                      // m, of the marker above the surface
  double reflection_ratio = 1.0;            // what is odd about the wall: minus so much of the marker's value
  std::int64_t number = 0;                  // on the lattice
  std::int32_t body = 0;                    // of the problem
};

// Bodies of any shape beside the sides (bodies.hpp).
template <int D>
struct body_walls {
  std::vector<body_place<D>> places;  // of this rank: row r belongs to the wall particle first_wall() + r
  std::int64_t numbers = 0;           // of the lattice, and of what moves; none: no bodies on any rank
  bool no_slip = false;
  bool move = false;  // some of them; as far as half the skin while lists live

  cells::point_list near;    // fluid, and its images, within reach of each marker
  std::vector<double> room;  // the part of each marker's neighbourhood that bodies leave to the fluid

  bool any() const { return numbers > 0; }
};

template <int D>
struct wall_set {
  options how;
  std::vector<side<D>> sides;
  boundary_force force;  // of the virtual markers' walls

  body_walls<D> bodies;
  std::size_t body_particles = 0;   // of this rank and its ghosts; images stand behind these
  std::size_t images_of_fluid = 0;  // the first of the images; the others are of bodies

  // Row r belongs to the wall particle first_wall() + r, of images to first_wall() + body_particles + r.
  std::vector<std::uint32_t> mirrored;     // bit n: through sides[n]
  std::vector<std::uint32_t> source;       // of a mirror image: local index
  std::array<particles::array, D> marker;  // m, mirror image of a wall particle that stands still
  double reach = 0.0;                      // m, radius of a marker's interpolation

  // While lists live no fluid reads the deepest wall particles: their values follow in complete evaluations alone,
  // those whose walls are written, and from the positions of then.
  marker_rows read;
  std::optional<marker_rows> unread;
  bool complete = true;

  // Of the owned fluid: who stands near wall particles, and which of these each has for neighbours; who is in no
  // `read.near_wall`, in the rows that wait for no ghosts and in those at the border.
  pairs::row_subset rows_near_walls;
  cells::neighbour_list wall_neighbours;
  pairs::remainder interior_apart, border_apart;
  // What the walls' kinematics take for volume and density of the fluid; null: ΔV and ρ.
  particles::array *volume = nullptr, *density = nullptr;
  particles::array& volumes(particles::particles<D>& s) const { return volume != nullptr ? *volume : s.dV; }
  const particles::array& volumes(const particles::particles<D>& s) const { return volume != nullptr ? *volume : s.dV; }
  particles::array& densities(particles::particles<D>& s) const { return density != nullptr ? *density : s.rho; }

  // Owned fluid near walls of no slip (slip_continuity.hpp), where somebody asks for it.
  bool asks_near_no_slip = false;
  pairs::row_subset near_no_slip;
  bool any_no_slip() const {
    return std::ranges::any_of(sides, [](const side<D>& wall) { return wall.no_slip; });
  }

  particles::array* kernel_sum = nullptr;  // Σ_j ΔV_j W_ij of the fluid near the walls, where smoothing divides by it

  // Fields of the particles, m/s2, of fluid near the walls: ν∇²v + g. None along axes that have no walls.
  std::array<particles::array*, D> f{};

  // Rows of wall particles. What the momentum balance adds between marker and wall particle: ρ f·Δx (Pa) and m f·Δx
  // (J). Due: the next sweep over the markers makes them.
  particles::array pressure_step, weight_step;
  bool steps_due = false;
  particles::array mass;  // kg, of the fluid at each marker
  void clear_rows(std::size_t number) {
    for (auto* rows : {&pressure_step, &weight_step, &mass}) rows->assign(number, 0.0);
    steps_due = false;
  }

  // Where walls have markers, with the first lists; and where smoothing divides by the sum, with the first evaluation.
  void declare_fields(particles::particles<D>& s) {
    for (const auto& wall : sides)
      if (auto& field = f[wall.axis]; field == nullptr)
        field = &particles::declare(s, "WallAcceleration_" + std::to_string(wall.axis), "m/s^2",
                                    particles::role::derived, "of fluid near walls, without pressure");
  }
  void declare_kernel_sum(particles::particles<D>& s) {
    if (kernel_sum == nullptr) kernel_sum = &particles::declare(s, "KernelSum", "1", particles::role::derived);
  }

  particles::array p_given, rho_given;  // Pa, kg/m3, of each owned wall particle, where they stay as at the start
};

namespace detail {

// A lattice place along one axis whose mirror image lies in this rank's cell; nothing is mirrored inside the box.
struct place_along {
  std::int64_t n;
  double x, marker;  // m
  std::uint32_t mirrored;
};

template <int D>
std::vector<place_along> places_along(const pairs::workspace<D>& w, const wall_set<D>& set, std::size_t axis,
                                      std::int64_t layers, std::int64_t cells) {
  const auto cell = w.d.cell();
  std::vector<place_along> all;
  for (std::int64_t n = -layers; n < cells + layers; ++n) {
    place_along p{n, (static_cast<double>(n) + 0.5) * w.dx, 0.0, 0};
    p.marker = p.x;
    for (std::size_t k = 0; k < set.sides.size(); ++k)
      if (set.sides[k].axis == axis && (p.x - set.sides[k].position) * set.sides[k].inward < 0.0) {
        p.mirrored |= 1U << k;
        p.marker = 2.0 * set.sides[k].position - p.x;
      }
    if (p.marker >= cell.lower[axis] && p.marker < cell.upper[axis]) all.push_back(p);
  }
  return all;
}

template <int D>
struct wall_place {
  std::array<double, D> x, marker;
  std::int64_t id;
  std::uint32_t mirrored;
};

template <int D>
void store(pairs::workspace<D>& w, wall_set<D>& set, const std::vector<wall_place<D>>& mine) {
  auto& s = w.s;
  particles::allocate(s, s.fluid, s.fluid_ghosts, mine.size(), 0);
  set.mirrored.resize(mine.size());
  for (auto& component : set.marker) component.resize(mine.size());
  for (std::size_t r = 0; r < mine.size(); ++r) {
    const std::size_t i = s.first_wall() + r;
    s.id[i] = mine[r].id;
    s.material[i] = 0;
    set.mirrored[r] = mine[r].mirrored;
    for (std::size_t a = 0; a < D; ++a) {
      s.x[a][i] = mine[r].x[a];
      if (s.keeps_start) s.x_start[a][i] = mine[r].x[a];
      set.marker[a][r] = mine[r].marker[a];
    }
    s.m[i] = s.rho[i] = s.p[i] = s.p_eos[i] = s.c_V[i] = s.c[i] = 1.0;
  }
}

}  // namespace detail

// Places the wall particles of the lattice spacing dx on the lattice outside the box, as
// deep as the kernel reaches. IDs follow the fluid's: the same on any number of ranks. A wall particle stands on the
// rank whose cell holds its marker, which needs the fluid about it: every mirror image of the marker's lattice place.
template <int D>
void place(pairs::workspace<D>& w, wall_set<D>& set, std::int64_t fluid_total, double depth) {
  const auto& box = w.d.region;
  const auto layers = static_cast<std::int64_t>(std::ceil(depth / w.dx));
  std::array<std::int64_t, D> cells, low;
  std::array<std::vector<detail::place_along>, D> along;
  std::size_t places = 1;
  for (std::size_t a = 0; a < D; ++a) {
    cells[a] = std::llround(box.length[a] / w.dx);
    low[a] = box.periodic[a] ? 0 : layers;
    if (low[a] > cells[a])
      foundation::fail_input(
          "the box is narrower along axis " + std::to_string(a + 1) +
          " than the walls are deep (kernel support): use more particles along it or a smaller h_over_dx");
    along[a] = detail::places_along(w, set, a, low[a], cells[a]);
    places *= along[a].size();
  }
  std::vector<detail::wall_place<D>> mine;
  for (std::size_t k = 0; k < places; ++k) {
    detail::wall_place<D> p{{}, {}, fluid_total, 0};
    std::int64_t stride = 1;
    std::size_t rest = k;
    for (std::size_t a = 0; a < D; ++a) {
      const auto& here = along[a][rest % along[a].size()];
      rest /= along[a].size();
      p.x[a] = here.x;
      p.marker[a] = here.marker;
      p.mirrored |= here.mirrored;
      p.id += stride * (here.n + low[a]);
      stride *= cells[a] + 2 * low[a];
    }
    if (p.mirrored != 0) mine.push_back(p);
  }
  detail::store(w, set, mine);
}

// Values of a wall particle from those at its marker, one mirror after the other: odd about
// the wall's value where it is fixed, even where it is free. In a corner both walls act.
template <int D>
double reflected_component(const side<D>& wall, bool sticks, std::size_t a, double v) {
  if (sticks && wall.no_slip) return 2.0 * wall.velocity[a] - v;  // v_w = 2 u_wall - v_m
  return a == wall.axis ? -v : v;                                 // v_w = v_m - 2 (v_m·n) n
}
template <int D>
void reflect_velocity(const side<D>& wall, bool sticks, std::array<double, D>& v) {
  for (std::size_t a = 0; a < D; ++a) v[a] = reflected_component(wall, sticks, a, v[a]);
}
template <int D>
void mirror_velocity(const wall_set<D>& set, std::size_t r, std::array<double, D>& v) {
  for (std::size_t k = 0; k < set.sides.size(); ++k)
    if ((set.mirrored[r] >> k & 1U) != 0) reflect_velocity<D>(set.sides[k], true, v);
}

template <int D>
double mirror_temperature(const wall_set<D>& set, std::size_t r, double T) {
  for (std::size_t k = 0; k < set.sides.size(); ++k)
    if ((set.mirrored[r] >> k & 1U) != 0 && set.sides[k].thermal == heat::fixed_temperature)
      T = 2.0 * set.sides[k].temperature - T;
  return T;
}

// The last guard: a particle that passed a wall is put back, and its velocity towards the
// wall reversed. Returns how many on this rank; a run that needed it reports the number.
template <int D>
std::int64_t reflect(const wall_set<D>& set, particles::particles<D>& s) {
  std::atomic<std::int64_t> crossings{0};
  for (const auto& wall : set.sides) {
    auto& x = s.x[wall.axis];
    auto& v = s.v[wall.axis];
    foundation::for_all(s.fluid, [&](std::size_t i) {
      if ((x[i] - wall.position) * wall.inward >= 0.0) return;
      x[i] = 2.0 * wall.position - x[i];
      if (v[i] * wall.inward < 0.0) v[i] = -v[i];
      ++crossings;
    });
  }
  return crossings;
}

}  // namespace tetsuame::walls
