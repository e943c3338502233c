#include <cmath>
#include <dem/contacts.hpp>
#include <foundation/threads.hpp>
#include <stdexcept>

namespace tetsuame::dem {

template <int D>
void contacts<D>::remember(const particles::particles<D>& s, const double* radius, const particles::partners& history) {
  light_.resize(s.fluid);
  foundation::for_all(s.fluid, [&](std::size_t i) {
    const double light = 1.0 / s.m[i];
    light_[i] = {light, 2.5 * light / (radius[i] * radius[i])};
  });
  kept_.slot.assign(pairs(), none);
  kept_.memory.clear();
  for (std::size_t p = 0; p < pairs(); ++p) {
    const auto known = history.find(first_[p], partner_id(s, p));
    if (known.empty()) continue;
    kept_.slot[p] = static_cast<std::uint32_t>(kept_.memory.size() / memory::size);
    kept_.memory.insert(kept_.memory.end(), known.begin(), known.end());
  }
}

template <int D>
void contacts<D>::keep(const particles::particles<D>& s, particles::partners& history) const {
  history.reset({s.id.data(), s.fluid});
  history.begin();
  for (std::size_t p = 0; p < pairs(); ++p) {
    if (kept_.slot[p] == none) continue;
    const auto m = memory::read(kept_.memory.data() + kept_.slot[p] * memory::size);
    m.write(history.insert(first_[p], partner_id(s, p)).data());
    if (p < grain_pairs_ && second_[p] < s.fluid)
      m.reversed().write(history.insert(second_[p], s.id[first_[p]]).data());
  }
  history.commit();
}

template <int D>
contact_measures contacts<D>::evaluate(const grain_fields<D>& f, double t, double dt, bool tells) {
  pack(f, 0.5 * dt);
  find_touching(t);
  const std::size_t n = touching_pairs_.size();
  now_.memory.resize(n * memory::size);
  result_.resize(n * result_size());
  told_.assign(tells ? n : 0, {});
  contact_measures all;
#pragma omp parallel if (n > foundation::rows_worth_threads)
  {
    contact_measures mine;
#pragma omp for schedule(static)
    for (std::size_t c = 0; c < n; ++c)
      touching_pairs_[c] < grain_pairs_ ? meet_grain(c, dt, mine) : meet_wall(c, t, dt, mine);
#pragma omp critical(dem_contacts)
    all.include(mine);
  }
  table_.rules.rolling == rolling_model::none ? gather<false>(f) : gather<true>(f);
  return all;
}

template <int D>
bool contacts<D>::touches(std::size_t p, double t) {
  const auto& i = places_[first_[p]];
  if (p < grain_pairs_) {
    double sum = i.R + places_[second_[p]].R;
    if (table_.adheres() && kept_.slot[p] != none) {
      const double R = i.R * places_[second_[p]].R / sum;
      sum += drawn_apart(table_.of(motions_[first_[p]].material, motions_[second_[p]].material), R);
    }
    return square<D>(apart(p)) < sum * sum;
  }
  auto& wall = wall_places_[p - grain_pairs_];
  double reach = i.R;
  if (table_.adheres() && kept_.slot[p] != none)
    reach += drawn_apart(table_.of(motions_[first_[p]].material, walls_.materials[second_[p]]), i.R);
  wall = walls_.at(second_[p], i.x, t, reach);
  return wall.found && wall.distance < reach;
}

// Contacts stand in the order of the pairs, whoever finds them.
template <int D>
void contacts<D>::find_touching(double t) {
  const std::size_t n = pairs();
  now_.slot.resize(n);
  wall_places_.resize(n - grain_pairs_);
  touching_pairs_.resize(n);
  constexpr std::size_t part = 4096;
  const std::size_t parts = (n + part - 1) / part;
  std::vector<std::size_t> found(parts);
#pragma omp parallel for schedule(static) if (n > foundation::values_worth_threads)
  for (std::size_t k = 0; k < parts; ++k) {
    std::uint32_t* to = touching_pairs_.data() + k * part;
    for (std::size_t p = k * part; p < std::min(n, (k + 1) * part); ++p) {
      const bool here = touches(p, t);
      *to = static_cast<std::uint32_t>(p);
      to += here ? 1 : 0;
      now_.slot[p] = none;
    }
    found[k] = static_cast<std::size_t>(to - touching_pairs_.data()) - k * part;
  }
  std::size_t all = 0;
  for (std::size_t k = 0; k < parts; ++k) {
    std::copy_n(touching_pairs_.begin() + static_cast<std::ptrdiff_t>(k * part), found[k],
                touching_pairs_.begin() + static_cast<std::ptrdiff_t>(all));
    all += found[k];
  }
  touching_pairs_.resize(all);
  for (std::size_t c = 0; c < all; ++c) now_.slot[touching_pairs_[c]] = static_cast<std::uint32_t>(c);
}

template <int D>
std::size_t contacts<D>::deepest_grain() const {
  double most = 0.0;
  std::size_t grain = 0;
  for (const std::uint32_t p : touching_pairs_) {
    const double R = places_[first_[p]].R;
    const bool grains = p < grain_pairs_;
    const double smaller = grains ? std::min(R, places_[second_[p]].R) : R;
    const double overlap =
        grains ? R + places_[second_[p]].R - solids::norm<D>(apart(p)) : R - wall_places_[p - grain_pairs_].distance;
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
  for (std::size_t c = 0; c < told_.size(); ++c) {
    const std::size_t p = touching_pairs_[c];
    const double part = p < grain_pairs_ && second_[p] >= s.fluid ? 0.5 : 1.0;
    number.add(part);
    elastic.add(part * told_[c].elastic);
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
  for_each_of(i, [&](std::size_t c) { sum += places_[i].R * told_[c].normal; });
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
  const std::size_t n = s.total();
  owned_ = s.fluid;
  places_.resize(n);
  motions_.resize(n);
  shifts_.resize(n - owned_);
  foundation::for_all(n, [&](std::size_t i) {
    auto& g = places_[i];
    auto& h = motions_[i];
    g.R = f.radius[i];
    h.m = s.m[i];
    h.material = static_cast<std::size_t>(s.material[i]);
    for (std::size_t a = 0; a < D; ++a) {
      g.x[a] = s.x[a][i];
      h.v[a] = s.v[a][i];
      h.v_mid[a] = s.v[a][i] - back * f.kept_acceleration[a][i];
    }
    for (std::size_t a = 0; a < turns<D>; ++a) {
      h.W[a] = g.R * f.spin[a][i];
      h.W_mid[a] = g.R * (f.spin[a][i] - back * f.kept_spin_rate[a][i]);
    }
    if (i < owned_) return;
    for (std::size_t a = 0; a < D; ++a) {
      if (f.own_place[a] != nullptr) g.x[a] = f.own_place[a][i];
      shifts_[i - owned_][a] = f.period[a] * std::round((s.x[a][i] - g.x[a]) / f.period[a]);
    }
  });
}

template <int D>
void contacts<D>::put(std::size_t c, const encounter<D>& e, const contact_force<D>& f, double lever_part,
                      double smaller, const memory& m, contact_measures& largest) {
  m.write(now_.memory.data() + c * memory::size);
  double* to = result_.data() + c * result_size();
  for (std::size_t a = 0; a < D; ++a) *to++ = f.force[a];
  const auto T = torque_of<D>(e.n, f.tangential);
  for (std::size_t a = 0; a < turns<D>; ++a) *to++ = lever_part * T[a];
  if (table_.rules.rolling != rolling_model::none)
    for (std::size_t a = 0; a < turns<D>; ++a) *to++ = f.rolling[a];
  if (!told_.empty()) told_[c] = {f.elastic, f.normal};
  largest.force = std::max(largest.force, f.normal);
  if (e.overlap > largest.relative_overlap * smaller) largest.relative_overlap = e.overlap / smaller;
  if (!std::exchange(largest.any, true) || e.overlap > largest.overlap) {
    largest.overlap = e.overlap;
    largest.approach = e.approach;
    for (std::size_t a = 0; a < D; ++a) largest.normal[a] = e.n[a];
  }
}

template <int D>
void contacts<D>::meet_grain(std::size_t c, double dt, contact_measures& largest) {
  const std::size_t p = touching_pairs_[c], a = first_[p], b = second_[p];
  const auto way = apart(p);
  const double d = solids::norm<D>(way), R_i = places_[a].R, R_j = places_[b].R, sum = R_i + R_j, levers = d / sum;
  const auto &i = motions_[a], &j = motions_[b];
  encounter<D> e;
  e.n = (1.0 / d) * way;
  e.overlap = sum - d;
  e.R = R_i * R_j / sum;
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
    e.roll = (1.0 / R_i) * i.W - (1.0 / R_j) * j.W;
    e.rolling = dt * ((1.0 / R_i) * i.W_mid - (1.0 / R_j) * j.W_mid);
    const double I_i = 1.4 * i.m * R_i * R_i, I_j = 1.4 * j.m * R_j * R_j;
    e.inertia = I_i * I_j / (I_i + I_j);
  }
  auto m = kept_.slot[p] == none ? memory{} : memory::read(kept_.memory.data() + kept_.slot[p] * memory::size);
  const auto f = force_of<D>(table_.rules, table_.of(i.material, j.material), e, m);
  put(c, e, f, levers, std::min(R_i, R_j), m, largest);
}

template <int D>
void contacts<D>::meet_wall(std::size_t c, double t, double dt, contact_measures& largest) {
  const std::size_t p = touching_pairs_[c], n = second_[p];
  const auto& i = motions_[first_[p]];
  const auto& [x, R] = places_[first_[p]];
  const auto& wall = wall_places_[p - grain_pairs_];
  encounter<D> e;
  e.n = wall.normal;
  e.overlap = R - wall.distance;
  e.R = R;
  e.m = i.m;
  const double levers = wall.distance / R;
  const auto between = [&](const auto& straight, const auto& spin, auto& across) {
    const double along = foundation::dot(straight, e.n);
    across = straight - along * e.n - solids::cross<D>(levers * spin, e.n);
    return along;
  };
  e.approach = -between(i.v - wall.velocity, i.W, e.slip);
  const auto mid = walls_.moves(n) ? walls_.at(n, x, t - 0.5 * dt, R).velocity : wall.velocity;
  between(i.v_mid - mid, i.W_mid, e.way);
  e.way = dt * e.way;
  e.roll = (1.0 / R) * i.W;
  e.rolling = (dt / R) * i.W_mid;
  e.inertia = 1.4 * i.m * R * R;
  auto m = kept_.slot[p] == none ? memory{} : memory::read(kept_.memory.data() + kept_.slot[p] * memory::size);
  const auto f = force_of<D>(table_.rules, table_.of(i.material, walls_.materials[n]), e, m);
  put(c, e, f, levers, R, m, largest);
}

template <int D>
template <bool rolls>
void contacts<D>::gather(const grain_fields<D>& f) const {
  const std::size_t n = f.s.fluid, size = result_size();
#pragma omp parallel for schedule(static) if (n > foundation::rows_worth_threads)
  for (std::size_t i = 0; i < n; ++i) {
    auto force = foundation::zero<double, D>();
    auto turning = foundation::zero<double, turns<D>>(), rolling = turning;
    const auto add = [&](std::size_t c, double sign) {
      const double* r = result_.data() + c * size;
      for (std::size_t a = 0; a < D; ++a) force[a] += sign * r[a];
      for (std::size_t a = 0; a < turns<D>; ++a) turning[a] += r[D + a];
      if constexpr (rolls)
        for (std::size_t a = 0; a < turns<D>; ++a) rolling[a] += sign * r[D + turns<D> + a];
    };
    for (std::size_t k = near_.start[i]; k < near_.start[i + 1]; ++k)
      if (const auto c = now_.slot[row_[k] >> 1]; c != none) add(c, (row_[k] & 1U) != 0 ? -1.0 : 1.0);
    for (std::size_t p = wall_start_[i]; p < wall_start_[i + 1]; ++p)
      if (const auto c = now_.slot[p]; c != none) add(c, 1.0);
    const double R = places_[i].R;
    const auto [light, easy] = light_[i];
    for (std::size_t a = 0; a < D; ++a) f.acceleration[a][i] = light * force[a] + f.gravity[a];
    for (std::size_t a = 0; a < turns<D>; ++a) f.spin_rate[a][i] = easy * (rolling[a] - R * turning[a]);
  }
}

template class contacts<2>;
template class contacts<3>;

}  // namespace tetsuame::dem
