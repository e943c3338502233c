// The pressure in the forces, by name:
//   smoothed      p_i = Σ_j Y_j W_ij, j = i included      [Saitoh & Makino 2013; S0]
//   non_smoothed  p_i = p^(ρ_i, T_i)                       [S0, program F]
// Normalised smoothing divides by Σ_j ΔV_j W_ij where volumes are known beforehand, which restores constants anywhere;
// where ΔV is what is sought (Hosono's iteration), by the lattice's s (docs/theory/lattice_sum.md).
#pragma once

#include <volume/shape.hpp>

namespace tetsuame::volume {

// p_i = Σ_j Y_j W_ij times a scale, or its mean, over Σ_j ΔV_j W_ij.
template <int D, bool mean>
struct weight_sum {
  const double* Y;   // J
  const double* dV;  // m^D, of the mean
  double self;       // 1/m^D, W(0)
  double scale;
  double* p;               // Pa, set
  double* norm = nullptr;  // Σ_j ΔV_j W_ij, set; null where nobody asks

  template <class R>
  struct me {
    R sum, norm;
  };
  auto reads() const {
    if constexpr (mean)
      return std::tuple{pairs::read(pairs::of_weight, Y, D), pairs::read(pairs::of_volume, dV, D)};
    else
      return std::tuple{pairs::read(pairs::of_weight, Y, D)};
  }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0), R(0.0)};
  }
  void add(auto& a, const auto& ij) const {
    a.sum += ij(pairs::of_weight) * ij.W;
    if constexpr (mean) a.norm += ij(pairs::of_volume) * ij.W;
  }
  void end(const auto& i, const auto& a) const {
    const double own = self * i.lengths.to(D);
    const auto sum = a.sum + i(Y, D) * own;
    if constexpr (mean) {
      const auto all = a.norm + i(dV, D) * own;
      i.set(p, sum / all);
      if (norm != nullptr) i.set(norm, all);
    } else {
      i.set(p, sum * scale);
    }
  }
};

// What wall particles add to either.
template <int D, bool mean>
struct weight_sum_of_walls {
  const double* Y;     // J
  const double* norm;  // of the mean
  double* p;           // Pa, added to

  template <class R>
  struct me {
    R sum;
  };
  auto reads() const { return std::tuple{pairs::read(pairs::of_weight, Y, D)}; }
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const { a.sum += ij(pairs::of_weight) * ij.W; }
  void end(const auto& i, const auto& a) const {
    if constexpr (mean)
      i.add(p, a.sum / i(norm));
    else
      i.add(p, a.sum);
  }
};

// 1/Σ_j W_ij times a scale: the volume a particle has by its neighbours' number.
template <int D>
struct number_volume {
  double self;  // 1/m^D
  double scale;
  double* dV;  // m^D, set

  template <class R>
  struct me {
    R sum;
  };
  template <class R>
  me<R> begin(const pairs::cluster<R>&) const {
    return {R(0.0)};
  }
  void add(auto& a, const auto& ij) const { a.sum += ij.W; }
  void end(const auto& i, const auto& a) const { i.set(dV, scale / (a.sum + self * i.lengths.to(D)), D); }
};

template <int D>
double self_value(const pairs::workspace<D>& w) {
  return std::visit([](const auto& k) { return k.self(); }, w.kernel);
}

// scale/Σ_j W_ij of these rows.
template <int D>
void volumes_by_number(const pairs::workspace<D>& w, const pairs::row_range& rows, double scale, double* V) {
  w.sum(rows, number_volume<D>{self_value(w), scale, V});
}

// Σ_j Y_j W_ij of these rows, divided by Σ_j V_j W_ij where `normalise`.
template <int D, class Rows>
void smooth(pairs::workspace<D>& w, const particles::array& Y, const particles::array& V, bool normalise,
            const Rows& rows, particles::array& p) {
  if (normalise)
    w.sum(rows, weight_sum<D, true>{Y.data(), V.data(), self_value(w), 1.0, p.data()});
  else
    w.sum(rows, weight_sum<D, false>{Y.data(), nullptr, self_value(w), 1.0, p.data()});
}
template <int D, class Rows>
void smooth(pairs::workspace<D>& w, const particles::array& V, bool normalise, const Rows& rows) {
  smooth(w, w.s.Y, V, normalise, rows, w.s.p);
}

// Σ_j Y_j W_ij of these rows, divided by the lattice's sum where `normalise`.
template <int D>
void smooth_by_lattice(pairs::workspace<D>& w, bool normalise, const pairs::row_range& rows) {
  const double scale = normalise ? 1.0 / w.lattice_sum : 1.0;
  w.sum(rows, weight_sum<D, false>{w.s.Y.data(), nullptr, self_value(w), scale, w.s.p.data()});
}

// The sums of the owned fluid in two parts, where walls have markers and Y is known before their pressures are. First,
// with f = ν∇²v + g, which the walls' Y need and which goes over the same neighbours, those near markers over the
// fluid; then what wall particles add to them.
template <int D, bool mean>
void smooth_with_acceleration(pairs::workspace<D>& w, const wall_context<D>& around, auto treatment) {
  auto& s = w.s;
  auto& set = around.walls;
  if constexpr (mean) set.declare_kernel_sum(s);
  const std::size_t first = s.first_wall();
  foundation::for_all(s.total() - first, [&](std::size_t k) { s.Y[first + k] = 0.0; });
  treatment.kinematics(w, set,
                       weight_sum<D, mean>{s.Y.data(), around.V.data(), self_value(w), 1.0, s.p.data(),
                                           mean ? set.kernel_sum->data() : nullptr});
}
template <int D, bool mean>
void smooth_over_walls(pairs::workspace<D>& w, walls::wall_set<D>& set) {
  if (set.rows_near_walls.rows.empty()) return;
  auto& s = w.s;
  std::swap(set.wall_neighbours.records, w.list.records);  // one scratch for all passes
  w.sum_by(set.wall_neighbours, set.rows_near_walls,
           weight_sum_of_walls<D, mean>{s.Y.data(), mean ? set.kernel_sum->data() : nullptr, s.p.data()});
  std::swap(set.wall_neighbours.records, w.list.records);
}

struct smoothed {
  static constexpr const char* name = "smoothed";
};

struct non_smoothed {
  static constexpr const char* name = "non_smoothed";
};

}  // namespace tetsuame::volume
