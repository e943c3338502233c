#include <cmath>
#include <dem/contacts.hpp>
#include <foundation/threads.hpp>
#include <stdexcept>

namespace tetsuame::dem {

template <int D>
void contacts<D>::remember(const particles::particles<D>& s, const particles::partners& history) {
  memory_.assign(pairs() * memory::size, 0.0);
  foundation::for_all(pairs(), [&](std::size_t p) {
    const auto known = history.find(first_[p], partner_id(s, p));
    std::copy(known.begin(), known.end(), memory_.begin() + static_cast<std::ptrdiff_t>(p * memory::size));
  });
  next_ = memory_;
  result_.assign(pairs() * result_size(), 0.0);
  touching_.assign(pairs(), 0);
}

template <int D>
void contacts<D>::keep(const particles::particles<D>& s, particles::partners& history) const {
  history.reset({s.id.data(), s.fluid});
  history.begin();
  for (std::size_t p = 0; p < pairs(); ++p) {
    const auto m = memory::read(memory_.data() + p * memory::size);
    if (!(m.a > 0.0)) continue;
    m.write(history.insert(first_[p], partner_id(s, p)).data());
    if (p < grain_pairs_ && second_[p] < s.fluid)
      m.reversed().write(history.insert(second_[p], s.id[first_[p]]).data());
  }
  history.commit();
}

template <int D>
contact_measures contacts<D>::evaluate(const grain_fields<D>& f, double t, double dt, bool tells) {
  pack(f, 0.5 * dt);
  told_.assign(tells ? pairs() : 0, {});
  contact_measures all;
  const std::size_t n = pairs();
#pragma omp parallel if (n > foundation::rows_worth_threads)
  {
    contact_measures mine;
#pragma omp for schedule(static)
    for (std::size_t p = 0; p < n; ++p) p < grain_pairs_ ? meet_grain(p, dt, mine) : meet_wall(p, t, dt, mine);
#pragma omp critical(dem_contacts)
    all.include(mine);
  }
  table_.rules.rolling == rolling_model::none ? gather<false>(f) : gather<true>(f);
  return all;
}

template <int D>
std::size_t contacts<D>::deepest_grain() const {
  double most = 0.0;
  std::size_t grain = 0;
  for (std::size_t p = 0; p < pairs(); ++p) {
    if (touching_[p] == 0) continue;
    const auto& i = packed_[first_[p]];
    double overlap = 0.0, smaller = i.R;
    if (p < grain_pairs_) {
      const auto& j = packed_[second_[p]];
      smaller = std::min(i.R, j.R);
      overlap = i.R + j.R - solids::norm<D>(i.x - j.x - j.shift);
    }
    if (overlap > most * smaller) {
      most = overlap / smaller;
      grain = first_[p];
    }
  }
  return grain;
}

template <int D>
void contacts<D>::add_energy(const particles::particles<D>& s, foundation::exact_sum& number,
                             foundation::exact_sum& elastic) const {
  for (std::size_t p = 0; p < told_.size(); ++p) {
    if (touching_[p] == 0) continue;
    const double part = p < grain_pairs_ && second_[p] >= s.fluid ? 0.5 : 1.0;
    number.add(part);
    elastic.add(part * told_[p].elastic);
  }
}

template <int D>
std::size_t contacts<D>::coordination(std::size_t i) const {
  std::size_t n = 0;
  for_each_of(i, [&](std::size_t) { ++n; });
  return n;
}

template <int D>
double contacts<D>::virial(std::size_t i) const {
  double sum = 0.0;
  for_each_of(i, [&](std::size_t p) { sum += packed_[i].R * told_[p].normal; });
  return sum / D;
}

template <int D>
typename contacts<D>::deepest_overlap contacts<D>::deepest(const particles::particles<D>& s, const double* radius,
                                                           double t) const {
  deepest_overlap all;
  for (std::size_t p = 0; p < pairs(); ++p) {
    const std::size_t i = first_[p], j = second_[p];
    const auto x = solids::point<D>::of([&](std::size_t a) { return s.x[a][i]; });
    double radii = 0.0;
    if (p < grain_pairs_) {
      const auto apart = solids::point<D>::of([&](std::size_t a) { return x[a] - s.x[a][j]; });
      radii = (radius[i] + radius[j] - solids::norm<D>(apart)) / std::min(radius[i], radius[j]);
    } else {
      radii = (radius[i] - walls_.at(j, x, t, radius[i]).distance) / radius[i];
    }
    if (radii > all.radii)
      all = {radii, i, p >= grain_pairs_, p < grain_pairs_ ? s.id[j] : static_cast<std::int64_t>(j)};
  }
  return all;
}

template <int D>
void contacts<D>::pair_rows(const particles::particles<D>& s) {
  first_.clear();
  second_.clear();
  row_.resize(near_.all.size());
  std::vector<std::size_t> begins(s.fluid + 1, 0);  // of the pairs of which a grain is the first
  for (std::size_t i = 0; i < s.fluid; ++i) {
    begins[i] = first_.size();
    for (std::size_t k = near_.start[i]; k < near_.start[i + 1]; ++k) {
      const std::uint32_t j = near_.all[k];
      if (j < i) {
        std::size_t p = begins[j];
        while (p < begins[j + 1] && second_[p] != i) ++p;
        if (p == begins[j + 1]) throw std::logic_error("a pair of grains stands in one row only");
        row_[k] = static_cast<std::uint32_t>(2 * p + 1);
        continue;
      }
      row_[k] = static_cast<std::uint32_t>(2 * first_.size());
      first_.push_back(static_cast<std::uint32_t>(i));
      second_.push_back(j);
    }
    begins[i + 1] = first_.size();
  }
  grain_pairs_ = first_.size();
}

template <int D>
void contacts<D>::find_walls(const particles::particles<D>& s, const double* radius, double skin, double t) {
  wall_start_.assign(1, first_.size());
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const auto x = solids::point<D>::of([&](std::size_t a) { return s.x[a][i]; });
    for (std::size_t n = 0; n < walls_.size(); ++n) {
      // A body that moves may come as near as a grain does.
      const double reach = radius[i] + (walls_.moves(n) ? 1.0 : 0.5) * skin;
      const auto wall = walls_.at(n, x, t, reach);
      if (!wall.found || !(wall.distance < reach)) continue;
      first_.push_back(static_cast<std::uint32_t>(i));
      second_.push_back(static_cast<std::uint32_t>(n));
    }
    wall_start_.push_back(first_.size());
  }
}

template <int D>
void contacts<D>::pack(const grain_fields<D>& f, double back) {
  const auto& s = f.s;
  packed_.resize(s.total());
  foundation::for_all(s.total(), [&](std::size_t i) {
    auto& g = packed_[i];
    g.R = f.radius[i];
    g.m = s.m[i];
    g.material = static_cast<std::size_t>(s.material[i]);
    for (std::size_t a = 0; a < D; ++a) {
      g.x[a] = f.own_place[a] != nullptr ? f.own_place[a][i] : s.x[a][i];
      g.shift[a] = f.own_place[a] != nullptr ? f.period[a] * std::round((s.x[a][i] - g.x[a]) / f.period[a]) : 0.0;
      g.v[a] = s.v[a][i];
      g.v_mid[a] = s.v[a][i] - back * f.kept_acceleration[a][i];
    }
    for (std::size_t a = 0; a < turns<D>; ++a) {
      g.W[a] = g.R * f.spin[a][i];
      g.W_mid[a] = g.R * (f.spin[a][i] - back * f.kept_spin_rate[a][i]);
    }
  });
}

template <int D>
void contacts<D>::part(std::size_t p) {
  touching_[p] = 0;
  double* const next = next_.data() + p * memory::size;
  if (next[D] != 0.0) std::fill_n(next, memory::size, 0.0);
}

template <int D>
void contacts<D>::put(std::size_t p, const encounter<D>& e, const contact_force<D>& f, double lever_part,
                      double smaller, const memory& m, contact_measures& largest) {
  m.write(next_.data() + p * memory::size);
  double* to = result_.data() + p * result_size();
  for (std::size_t a = 0; a < D; ++a) *to++ = f.force[a];
  const auto T = torque_of<D>(e.n, f.tangential);
  for (std::size_t a = 0; a < turns<D>; ++a) *to++ = lever_part * T[a];
  if (table_.rules.rolling != rolling_model::none)
    for (std::size_t a = 0; a < turns<D>; ++a) *to++ = f.rolling[a];
  touching_[p] = 1;
  if (!told_.empty()) told_[p] = {f.elastic, f.normal};
  largest.force = std::max(largest.force, f.normal);
  largest.relative_overlap = std::max(largest.relative_overlap, e.overlap / smaller);
  if (e.overlap > largest.overlap) {
    largest.overlap = e.overlap;
    largest.approach = e.approach;
    for (std::size_t a = 0; a < D; ++a) largest.normal[a] = e.n[a];
  }
}

template <int D>
void contacts<D>::meet_grain(std::size_t p, double dt, contact_measures& largest) {
  const packed_grain &i = packed_[first_[p]], &j = packed_[second_[p]];
  const auto apart = i.x - j.x - j.shift;
  const double d2 = square<D>(apart), sum = i.R + j.R;
  if (!(d2 < sum * sum)) return part(p);
  const double d = std::sqrt(d2), levers = d / sum;
  encounter<D> e;
  e.n = (1.0 / d) * apart;
  e.overlap = sum - d;
  e.R = i.R * j.R / sum;
  e.m = i.m * j.m / (i.m + j.m);
  const auto both = [&](const auto& straight, const auto& spins, auto& across) {
    const double along = foundation::dot(straight, e.n);
    across = straight - along * e.n - solids::cross<D>(levers * spins, e.n);
    return along;
  };
  e.approach = -both(i.v - j.v, i.W + j.W, e.slip);
  both(i.v_mid - j.v_mid, i.W_mid + j.W_mid, e.way);
  e.way = dt * e.way;
  if (table_.rules.rolling != rolling_model::none) {
    e.roll = i.spin() - j.spin();
    e.rolling = dt * (i.spin_mid() - j.spin_mid());
    const double I_i = 1.4 * i.m * i.R * i.R, I_j = 1.4 * j.m * j.R * j.R;
    e.inertia = I_i * I_j / (I_i + I_j);
  }
  auto m = memory::read(memory_.data() + p * memory::size);
  const auto f = force_of<D>(table_.rules, table_.of(i.material, j.material), e, m);
  put(p, e, f, levers, std::min(i.R, j.R), m, largest);
}

template <int D>
void contacts<D>::meet_wall(std::size_t p, double t, double dt, contact_measures& largest) {
  const packed_grain& i = packed_[first_[p]];
  const std::size_t n = second_[p];
  const auto wall = walls_.at(n, i.x, t, i.R);
  if (!wall.found || !(wall.distance < i.R)) return part(p);
  encounter<D> e;
  e.n = wall.normal;
  e.overlap = i.R - wall.distance;
  e.R = i.R;
  e.m = i.m;
  const double levers = wall.distance / i.R;
  const auto between = [&](const auto& straight, const auto& spin, auto& across) {
    const double along = foundation::dot(straight, e.n);
    across = straight - along * e.n - solids::cross<D>(levers * spin, e.n);
    return along;
  };
  e.approach = -between(i.v - wall.velocity, i.W, e.slip);
  const auto mid = walls_.moves(n) ? walls_.at(n, i.x, t - 0.5 * dt, i.R).velocity : wall.velocity;
  between(i.v_mid - mid, i.W_mid, e.way);
  e.way = dt * e.way;
  e.roll = i.spin();
  e.rolling = dt * i.spin_mid();
  e.inertia = 1.4 * i.m * i.R * i.R;
  auto m = memory::read(memory_.data() + p * memory::size);
  const auto f = force_of<D>(table_.rules, table_.of(i.material, walls_.materials[n]), e, m);
  put(p, e, f, levers, i.R, m, largest);
}

template <int D>
template <bool rolls>
void contacts<D>::gather(const grain_fields<D>& f) const {
  const std::size_t n = f.s.fluid, size = result_size();
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
  for (std::size_t i = 0; i < n; ++i) {
    auto force = foundation::zero<double, D>();
    auto turning = foundation::zero<double, turns<D>>(), rolling = turning;
    const auto add = [&](std::size_t p, double sign) {
      const double* r = result_.data() + p * size;
      for (std::size_t a = 0; a < D; ++a) force[a] += sign * r[a];
      for (std::size_t a = 0; a < turns<D>; ++a) turning[a] += r[D + a];
      if constexpr (rolls)
        for (std::size_t a = 0; a < turns<D>; ++a) rolling[a] += sign * r[D + turns<D> + a];
    };
    for (std::size_t k = near_.start[i]; k < near_.start[i + 1]; ++k)
      if (const std::size_t p = row_[k] >> 1; touching_[p] != 0) add(p, (row_[k] & 1U) != 0 ? -1.0 : 1.0);
    for (std::size_t p = wall_start_[i]; p < wall_start_[i + 1]; ++p)
      if (touching_[p] != 0) add(p, 1.0);
    const auto& g = packed_[i];
    const double light = 1.0 / g.m, easy = 2.5 / (g.m * g.R * g.R);
    for (std::size_t a = 0; a < D; ++a) f.acceleration[a][i] = light * force[a] + f.gravity[a];
    for (std::size_t a = 0; a < turns<D>; ++a) f.spin_rate[a][i] = easy * (rolling[a] - g.R * turning[a]);
  }
}

template class contacts<2>;
template class contacts<3>;

}  // namespace tetsuame::dem
