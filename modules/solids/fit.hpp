// Where wall particles stand that fit a surface: the places of a lattice inside of a body, moved so that what they hold
// of the body's volume ends where its surface does, and not half a spacing before or behind their outermost row.
//
// A place c of the lattice stands for its cell, of which f_c is solid: where that and the place disagree, places hold
// too much or too little of the body, by a layer s_c = w_c (f_c - [c is solid]), w_c = Δx Σ_a |n_a| being the cell's
// width along the normal n_c. A displacement S of all places about x moves their outer end by n·S. It is found by least
// squares about the point of the surface nearest to x (derived here),
//
//   Σ_c a_c [n_c n_c^T + λ (1 - n n^T)] S = Σ_c a_c s_c n_c,   a_c = W(|x_c - x_s|)/w_c  where the surface cuts c
//
// Rows along a plane come to (k + 1/2) Δx below it. A surface that is inclined to the lattice stays as it is: there the
// water's lattice goes on into the body, so that still water rests on it, and the surface lies at all offsets. Rows
// that followed an incline of 2 to 17° would make the pressure beside it wrong by 0.1 to 0.5 of that at the floor. Of
// two planes that meet each has its part; along a surface, where nothing but noise says how to move, λ = 0.1 holds. A
// place in the corner of a box, about whose foot W finds r <= 2.62 times
// as much of its own face as of the other, is short of the latter by q/(1 + q) of |s| <= Δx/2, q = λ (1 + r): 0.133 Δx.
#pragma once

#include <solids/body.hpp>
#include <unordered_map>

namespace tetsuame::solids {

template <int D>
class fit {
 public:
  // of: what is solid; spacing: m, of its lattice, (n + 1/2) Δx.
  fit(const body<D>& of, double spacing) : of_(of), spacing_(spacing) {}

  // m, where the wall particle of a place of the lattice stands that is to be no deeper than this: the place itself
  // outside of the body, and far from its surface.
  point<D> place(const point<D>& on_lattice, double deepest);

 private:
  struct cut {
    bool any;               // the surface goes through the cell, along the lattice
    point<D> at, normal;    // m
    double width, too_few;  // m: w_c, s_c
  };
  using cell = std::array<std::int64_t, D>;
  struct hash {
    std::size_t operator()(const cell& c) const;
  };
  const cut& look(const cell& c);

  const body<D>& of_;
  double spacing_;
  std::unordered_map<cell, cut, hash> known_;
};

}  // namespace tetsuame::solids
