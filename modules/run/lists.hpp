// What a run computes on: particles with their lists and kernel, and the walls of their box. Lists are made anew
// whenever a particle has moved far enough: who owns which particle, ghosts, what stands behind the walls.
#pragma once

#include <cmath>
#include <pairs/workspace.hpp>
#include <run/apart.hpp>
#include <walls/bodies.hpp>
#include <walls/slip_continuity.hpp>
#include <walls/treatments.hpp>

namespace tetsuame::run {

template <int D>
struct state {
  pairs::workspace<D> w;
  walls::any treatment = walls::mirror{};
  walls::wall_set<D> walls;
  double skin = 0.0;  // m, of the lists as they are
  // As the input has them; none until lists are first made with a wider skin.
  struct {
    double skin = 0.0, halo = 0.0;  // m
  } narrowest;
  std::int64_t fluid_total = 0;
  double state_time = 0.0, list_time = 0.0;  // s, of the state in the arrays; of that from which the lists were made
  double next_dt = 0.0;                      // s, of the step ahead; 0: not known
  double list_lifetime = 0.0;                // s, of lists for an expected motion (run/list_motion.hpp); 0: no such
  std::vector<particles::partners*> partners{};  // whose rows follow the owned fluid; not owned

  bool mirrors() const { return std::holds_alternative<walls::mirror>(treatment); }
  // The axes along which all that particles meet moves with them: nothing stands there.
  std::array<bool, D> drifts() const {
    const bool stands = std::visit([](auto t) { return decltype(t)::has_particles; }, treatment) && !mirrors();
    if ((stands && !walls.sides.empty()) || walls.bodies.any()) return {};
    auto along = w.d.region.periodic;
    for (std::size_t a = 0; a < D; ++a) along[a] = along[a] || w.d.region.is_free(a);
    return along;
  }
};

// m, how far the frame w.frame has moved since the lists were made.
template <int D>
std::array<double, D> frame_displacement(const state<D>& box) {
  std::array<double, D> way;
  for (std::size_t a = 0; a < D; ++a) way[a] = box.w.frame[a] * (box.state_time - box.list_time);
  return way;
}

// m, the displacements on this rank since the lists were made, in the frame w.frame.
template <int D>
apart moved_since_lists(const state<D>& box) {
  const auto& s = box.w.s;
  return apart_of<D>(s.fluid, box.drifts(), [&, way = frame_displacement(box)](std::size_t a, std::size_t i) {
    return s.x[a][i] - s.x_list[a][i] - way[a];
  });
}

// m/s, the velocities on this rank, in the frame w.frame.
template <int D>
apart velocities(const state<D>& box) {
  const auto& s = box.w.s;
  return apart_of<D>(s.fluid, box.drifts(), [&](std::size_t a, std::size_t i) { return s.v[a][i] - box.w.frame[a]; });
}

// m/s, the largest on this rank.
template <int D>
double largest_speed(const state<D>& box) {
  const auto& s = box.w.s;
  const auto all = apart_of<D>(s.fluid, {}, [&](std::size_t a, std::size_t i) { return s.v[a][i]; });
  return all.numbers[apart::longest];
}

// Whether particles have drifted so far from where lists found them that they are to be wrapped: the digits of
// positions far outside the box would be lost. farthest: m, in the frame w.frame.
template <int D>
bool drifted(const state<D>& box, double farthest) {
  const auto along = box.drifts();
  const auto way = frame_displacement(box);
  for (std::size_t a = 0; a < D; ++a)
    if (along[a] && box.w.d.region.periodic[a] && farthest + std::abs(way[a]) > 0.5 * box.w.d.region.length[a])
      return true;
  return false;
}

// m, the skin of lists that are to be so wide: no less than the input's; no more than what makes the way that steps get
// on with a pair's work longest, s/(S + s)^D with a skin s and a support S, of some three and a half spacings; and no
// wider than a periodic box leaves room for when supports have grown.
template <int D>
double skin_within_limits(const state<D>& box, double wanted) {
  const auto& d = box.w.d;
  const double least = box.narrowest.skin > 0.0 ? box.narrowest.skin : box.skin;
  double most = (D == 3 ? 2.0 : 3.0) * box.w.dx;
  for (std::size_t a = 0; a < D; ++a)
    if (d.region.periodic[a]) most = std::min(most, d.region.length[a] - 1.2 * (d.width - box.skin));
  return wanted > least ? std::max(least, std::min(wanted, most)) : least;  // of what is not a number, too
}

// Of the next lists.
template <int D>
void set_skin(state<D>& box, double skin) {
  auto& least = box.narrowest;
  if (skin == box.skin) return;
  if (least.skin == 0.0) least = {box.skin, box.w.d.width};
  box.skin = skin;
  box.w.d.width = least.halo + (skin - least.skin) * (1.0 + 1e-6);
}

struct list_lengths {
  double edge, reach;  // m: of the grid's cells; of halos, images and the widest row
};

// Sorts the owned fluid, which is in the order of cells and IDs, into layers (workspace::border): within, those whose
// neighbours may have ghosts or walls for neighbours, and those that may themselves. With bodies, which may be
// anywhere, all wait.
template <int D>
void order_in_layers(pairs::workspace<D>& w, double reach, bool bodies, cells::indices& order) {
  w.core = w.border = 0;
  if (w.d.ranks.size == 1 || bodies) return;  // nothing is ever on its way
  const auto cell = w.d.cell();
  const auto deeper_than = [&](double depth) {
    auto deep = cell;
    for (std::size_t a = 0; a < D; ++a) {
      if (!w.d.region.open[a][0]) deep.lower[a] = std::max(deep.lower[a], 0.0);
      if (!w.d.region.open[a][1]) deep.upper[a] = std::min(deep.upper[a], w.d.region.length[a]);
      deep.lower[a] += depth;
      deep.upper[a] -= depth;
    }
    return [&w, deep](std::size_t i) { return w.d.within(deep, cells::position<D>(w.s.x, i)); };
  };
  // A little more than lists reach, against rounding.
  const auto border = std::stable_partition(order.begin(), order.end(), deeper_than(reach * (1.0 + 1e-6)));
  const auto core = std::stable_partition(order.begin(), border, deeper_than(2.0 * reach * (1.0 + 1e-6)));
  w.border = static_cast<std::size_t>(border - order.begin());
  w.core = static_cast<std::size_t>(core - order.begin());
}

// Once lists are made: layers end where clusters do.
template <int D>
void end_layers_with_clusters(pairs::workspace<D>& w) {
  w.border -= w.border % pairs::lanes;
  w.core = std::min(w.core, w.border);
  if (w.core == 0) return;
  for (std::size_t r = w.border / pairs::lanes; r < w.list.rows(); ++r)
    w.list.for_each(r, [&](std::uint32_t j, auto...) { w.core = std::min<std::size_t>(w.core, j); });
}

// Ghosts of the fluid, and what stands behind the walls: particles that stay, images.
template <int D>
void surround(state<D>& box, double reach) {
  auto& w = box.w;
  auto& s = w.s;
  domain::make_halo<D>(w.d, s, 0, s.fluid, s.fluid, w.d.fluid_halo,
                       [&](std::size_t ghosts) { particles::allocate(s, s.fluid, ghosts, s.walls, 0); });
  if (box.walls.bodies.any()) walls::place_bodies(w, box.walls, box.fluid_total);
  if (!box.mirrors() || box.walls.bodies.any())
    domain::make_halo<D>(w.d, s, s.first_wall(), s.walls, s.first_wall() + s.walls, w.d.wall_halo,
                         [&](std::size_t ghosts) { particles::allocate(s, s.fluid, s.fluid_ghosts, s.walls, ghosts); });
  if (box.mirrors()) walls::make_images(box.walls, s, box.fluid_total, reach);
}

// Hands particles to their ranks, sorts them by cell and ID, makes halos, what stands behind the walls, and lists. The
// state's arrays move: the integrator must be told. as_they_were: lists are made from the list positions, with which a
// restart, or a change of cuts, has the same sums. Ghosts and images have their positions and masses; other fields are
// the caller's to refresh. lengths(): list_lengths, asked when particles are with their ranks; make_list(list_lengths,
// grid of all particles).
template <int D, class Lengths, class MakeList>
void rebuild_by(state<D>& box, bool as_they_were, const Lengths& lengths, const MakeList& make_list) {
  auto& w = box.w;
  auto& s = w.s;
  const foundation::stage timed(w.times, "lists");
  if (box.mirrors()) particles::allocate(s, s.fluid, 0, 0, 0);
  if (as_they_were)
    exchange_list_positions(s);
  else
    domain::wrap(w.d.region, s);
  domain::migrate(w.d, s, box.partners);
  const list_lengths l = lengths();
  {
    cells::indices order = cells::make_grid<D>(s.x, s.id, s.fluid, l.edge).members;
    order_in_layers(w, l.reach, box.walls.bodies.any(), order);
    particles::reorder(s, 0, std::span<const std::uint32_t>(order));
    for (auto* rows : box.partners) rows->reorder(order);
  }
  if (!as_they_were) {
    foundation::for_all(s.fluid, [&](std::size_t i) {
      for (std::size_t a = 0; a < D; ++a) s.x_list[a][i] = s.x[a][i];
    });
    box.list_time = box.state_time;
  }
  surround(box, l.reach);
  w.exchange_fluid({s.m.data()});
  const auto grid = cells::make_grid<D>(s.x, s.id, s.total(), l.edge);
  make_list(l, grid);
  end_layers_with_clusters(w);
  std::visit(
      [&](auto t) {
        if constexpr (decltype(t)::has_markers) walls::detail::prepare_markers(w, box.walls, grid, box.skin);
      },
      box.treatment);
  if (box.walls.asks_near_no_slip) walls::choose_near_no_slip(w, box.walls, box.skin);
  // Lists end when some fluid, or a body, has moved half the skin.
  if (box.walls.bodies.any()) walls::list_bodies(w, box.walls, grid, (box.walls.bodies.move ? 1.0 : 0.5) * box.skin);
  if (as_they_were) exchange_list_positions(s);
}

// Of one support for all.
template <int D>
void rebuild(state<D>& box, bool as_they_were) {
  auto& w = box.w;
  auto& s = w.s;
  const double reach = w.support() + box.skin;
  rebuild_by(
      box, as_they_were,
      [&] {
        return list_lengths{cells::cell_edge(w.dx), reach};
      },
      [&](const list_lengths&, const cells::grid<D>& grid) {
        cells::make_list<D>(w.list, grid, s.x, s.fluid, cells::one_reach{reach});
      });
}

}  // namespace tetsuame::run
