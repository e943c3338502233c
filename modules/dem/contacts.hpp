// The contacts of grains with each other and with walls: pairs that may touch before the next lists, what each keeps
// from step to step, and their forces.
//
// A pair of two grains of this rank is computed once; one with a ghost on both ranks, with the same bits, as every term
// of it changes nothing but its sign when the grains change places. Each grain then adds the forces of its contacts in
// the order of its row of the neighbour list, which does not depend on ranks and threads; walls come last.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <dem/contact.hpp>
#include <dem/walls.hpp>
#include <foundation/exact_sum.hpp>
#include <limits>
#include <particles/particles.hpp>
#include <particles/partners.hpp>
#include <span>
#include <utility>
#include <vector>

namespace tetsuame::dem {

// What an evaluation reads of the grains, ghosts among them, and the rates that it leaves of those that are owned.
template <int D>
struct grain_fields {
  const particles::particles<D>& s;
  std::array<const double*, D> own_place;          // m: of ghosts that of the grain; null without periodic borders
  const double* radius;                            // m
  std::array<const double*, D> kept_acceleration;  // m/s2, of the step that ends here
  std::array<const double*, turns<D>> spin, kept_spin_rate;  // 1/s; 1/s2
  std::array<double*, D> acceleration;                       // m/s2
  std::array<double*, turns<D>> spin_rate;                   // 1/s2
  solids::point<D> period;                                   // m, of the axes with own_place
  solids::point<D> gravity;                                  // m/s2
};

// The largest of the contacts of an evaluation, on this rank.
struct contact_measures {
  bool any = false;
  double overlap = 0.0, force = 0.0;  // m, N; below 0 where all contacts are drawn apart
  double relative_overlap = 0.0;      // over the smaller radius
  double approach = 0.0;              // m/s, of the contact of the largest overlap
  std::array<double, 3> normal{};     // of that, from the partner to the grain

  void include(const contact_measures& other) {
    if (!other.any) return;
    if (!any || other.overlap > overlap) {
      overlap = other.overlap;
      approach = other.approach;
      normal = other.normal;
    }
    any = true;
    force = std::max(force, other.force);
    relative_overlap = std::max(relative_overlap, other.relative_overlap);
  }
};

// Compiled once, without fused multiplications: their rounding would tell the two grains of a pair apart.
template <int D>
class contacts {
 public:
  using memory = contact_memory<D>;

  contacts(const contact_table& table, const wall_set<D>& walls) : table_(table), walls_(walls) {}

  std::size_t pairs() const { return first_.size(); }

  // With new lists, while the positions are those that they are made from, at time t. near: of each owned grain the
  // grains that may touch it, in an order that ranks do not change; each of two owned grains has the other.
  struct rows {
    std::vector<std::size_t> start{0};  // of each grain, into `all`; one more at the end
    std::vector<std::uint32_t> all;
  };
  void find_pairs(const particles::particles<D>& s, const double* radius, rows near, double skin, double t) {
    near_ = std::move(near);
    pair_rows(s);
    find_walls(s, radius, skin, t);
  }
  // Then: what these kept. history: of the owned grains.
  void remember(const particles::particles<D>& s, const double* radius, const particles::partners& history);
  // Before new lists: what contacts keep, into rows of the owned grains.
  void keep(const particles::particles<D>& s, particles::partners& history) const;

  // Rates by the contacts at time t, dt after what contacts keep (s). tells: coordination(), pressures and energies are
  // asked for afterwards.
  contact_measures evaluate(const grain_fields<D>& f, double t, double dt, bool tells);
  // What contacts keep is that of the last evaluation from now on.
  void commit() { std::swap(kept_, now_); }
  // The owned grain of the deepest contact, in radii of the smaller one.
  std::size_t deepest_grain() const;

  // ---- after an evaluation that tells ----

  // Of this rank: those with ghosts count half. J: in their springs.
  void add_energy(const particles::particles<D>& s, foundation::exact_sum& number,
                  foundation::exact_sum& elastic) const;
  std::size_t coordination(std::size_t i) const;
  // N m, the trace of Σ l F over D, with the force F along the contact's normal and the way l from the centre to it:
  // over the grain's volume a pressure [J. H. Irving, J. G. Kirkwood, J. Chem. Phys. 18, 817 (1950)].
  double virial(std::size_t i) const;

  // The owned grain that lies deepest in another one, or in a wall, at time t: how deep, in radii of the smaller one.
  struct deepest_overlap {
    double radii = 0.0;
    std::size_t grain = 0;
    bool wall = false;
    std::int64_t partner = 0;  // its ID, or the wall's number
  };
  deepest_overlap deepest(const particles::particles<D>& s, const double* radius, double t) const;

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  // Of a grain, by which most pairs are seen not to touch: x is that of the grain itself, of ghosts too.
  struct place {
    solids::point<D> x;
    double R;
  };
  // And the rest: W = R ω, by which surfaces move; `mid` is half a step ago, as the positions moved.
  struct motion {
    solids::point<D> v, v_mid;
    solids::about<D> W, W_mid;
    double m;
    std::size_t material;
  };
  // Of the contacts of an evaluation, which stand in the order of the pairs.
  struct touching {
    std::vector<std::uint32_t> slot;  // of each pair: its place among the contacts, or none
    std::vector<double> memory;       // of each contact
  };
  struct told {
    double elastic = 0.0, normal = 0.0;  // J, N
  };

  // Of each contact: force and torque's factor, and a rolling torque, if there are such.
  std::size_t result_size() const {
    return D + turns<D> + (table_.rules.rolling == rolling_model::none ? 0 : turns<D>);
  }
  // x_i - x_j, the grains' own, and what the image of j stands off: the same bits, but for the sign, for both of a
  // pair.
  solids::point<D> apart(std::size_t p) const {
    const std::size_t j = second_[p];
    const auto straight = places_[first_[p]].x - places_[j].x;
    return j < owned_ ? straight : straight - shifts_[j - owned_];
  }
  std::int64_t partner_id(const particles::particles<D>& s, std::size_t p) const {
    return p < grain_pairs_ ? s.id[second_[p]] : -1 - static_cast<std::int64_t>(second_[p]);
  }
  // f(contact) of those of grain i, after an evaluation.
  template <class F>
  void for_each_of(std::size_t i, const F& f) const {
    for (std::size_t k = near_.start[i]; k < near_.start[i + 1]; ++k)
      if (const auto c = now_.slot[row_[k] >> 1]; c != none) f(c);
    for (std::size_t p = wall_start_[i]; p < wall_start_[i + 1]; ++p)
      if (const auto c = now_.slot[p]; c != none) f(c);
  }

  // Each pair once, its first grain owned by this rank; and rows of pairs, whose last bit is set where the grain is the
  // second of it.
  void pair_rows(const particles::particles<D>& s);
  void find_walls(const particles::particles<D>& s, const double* radius, double skin, double t);
  void pack(const grain_fields<D>& f, double back);
  void find_touching(double t);
  bool touches(std::size_t p, double t);
  void put(std::size_t c, const encounter<D>& e, const contact_force<D>& f, double lever_part, double smaller,
           const memory& m, contact_measures& largest);
  void meet_grain(std::size_t c, double dt, contact_measures& largest);
  void meet_wall(std::size_t c, double t, double dt, contact_measures& largest);
  template <bool rolls>
  void gather(const grain_fields<D>& f) const;

  const contact_table& table_;
  const wall_set<D>& walls_;
  rows near_;
  std::vector<std::uint32_t> row_;             // pairs, in the place of neighbours
  std::vector<std::size_t> wall_start_;        // of each owned grain, its pairs with walls; one more at the end
  std::vector<std::uint32_t> first_, second_;  // of each pair; behind those of grains a wall's number
  std::size_t grain_pairs_ = 0;
  std::size_t owned_ = 0;
  std::vector<place> places_;
  std::vector<motion> motions_;
  std::vector<std::array<double, 2>> light_;                // 1/kg, 1/(kg m2): 1/m and 5/(2 m R²) of the owned
  std::vector<solids::point<D>> shifts_;                    // m, of ghosts
  std::vector<typename wall_set<D>::meeting> wall_places_;  // of each pair with a wall
  std::vector<std::uint32_t> touching_pairs_;               // of the last evaluation
  touching kept_, now_;                                     // of the last commit; of the last evaluation
  std::vector<double> result_;
  std::vector<told> told_;  // of each contact, or none
};

extern template class contacts<2>;
extern template class contacts<3>;

}  // namespace tetsuame::dem
