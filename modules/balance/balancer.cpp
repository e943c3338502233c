#include <fmt/format.h>

#include <algorithm>
#include <balance/balancer.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <limits>
#include <numeric>

namespace tetsuame::balance {

namespace {

// A piece of a piecewise constant density: an amount between a and b.
struct piece {
  double a, b, amount;
};

// Part of an old group of cells, all slabs of it, that lies in a new cell.
struct source {
  std::size_t group;
  double fraction;
};

// Narrower slabs count as this wide, in parts of the box: a density stays finite where cuts coincide.
constexpr double narrowest = 1e-9;

piece spread_over(double a, double b, double amount, double length) {
  const double missing = narrowest * length - (b - a);
  if (missing > 0.0) a -= 0.5 * missing, b += 0.5 * missing;
  return {a, b, amount};
}

// The part of [a, b] that lies in slab n of a group: at the box's borders, what stands out counts as inside.
double part_in(const piece& p, const double* cut, int n, int count) {
  const double lower = n == 0 ? -std::numeric_limits<double>::infinity() : cut[n];
  const double upper = n + 1 == count ? std::numeric_limits<double>::infinity() : cut[n + 1];
  return std::max(0.0, std::min(p.b, upper) - std::max(p.a, lower)) / (p.b - p.a);
}

// At least w apart from each other and from the ends, moved as little as a pass from each side does; equal
// widths where there is no room.
void keep_apart(double* cut, int count, double w) {
  const double first = cut[0], last = cut[count];
  if (w * count >= last - first) {
    for (int n = 1; n < count; ++n) cut[n] = first + (last - first) * n / count;
    return;
  }
  for (int n = 1; n < count; ++n) cut[n] = std::max(cut[n], cut[n - 1] + w);
  for (int n = count - 1; n > 0; --n) cut[n] = std::min(cut[n], cut[n + 1] - w);
}

// Sorts what consists of a few sorted runs.
void merge_runs(std::vector<std::pair<double, double>>& values) {
  std::vector<std::ptrdiff_t> ends{0};
  while (values.begin() + ends.back() != values.end())
    ends.push_back(std::is_sorted_until(values.begin() + ends.back(), values.end()) - values.begin());
  for (std::size_t stride = 1; stride + 1 < ends.size(); stride *= 2)
    for (std::size_t k = 0; k + stride + 1 < ends.size(); k += 2 * stride)
      std::inplace_merge(values.begin() + ends[k], values.begin() + ends[k + stride],
                         values.begin() + ends[std::min(k + 2 * stride, ends.size() - 1)]);
}

// Inner cuts at which the integral of the density reaches the wanted amounts, given up to a common factor.
// The ends of `cut` are set.
void place(const std::vector<piece>& pieces, const std::vector<double>& wanted, double floor, double* cut) {
  const int count = static_cast<int>(wanted.size());
  const double first = cut[0], last = cut[count];
  double sum = 0.0;
  for (const auto& p : pieces) sum += p.amount;
  // The density changes at the pieces' ends: by how much, and where. Pieces come in stretches without gaps, in order.
  std::vector<std::pair<double, double>> changes;
  changes.reserve(pieces.size() + pieces.size() / 4 + 2);
  const double base = (sum > 0.0 ? floor * sum : 1.0) / (last - first);
  changes.emplace_back(first, base);
  for (std::size_t k = 0; k < pieces.size();) {
    double density = 0.0, at = 0.0;
    do {
      const auto& p = pieces[k];
      const double next = p.amount > 0.0 ? p.amount / (p.b - p.a) : 0.0;
      if (next != density) changes.emplace_back(std::clamp(p.a, first, last), next - density);
      density = next;
      at = p.b;
    } while (++k < pieces.size() && pieces[k].a == at);
    if (density != 0.0) changes.emplace_back(std::clamp(at, first, last), -density);
  }
  merge_runs(changes);
  changes.emplace_back(last, 0.0);
  const auto integrate = [&](auto&& at_segment) {
    double density = 0.0, below = 0.0;
    for (std::size_t k = 0; k + 1 < changes.size(); ++k) {
      density = std::max(density + changes[k].second, base);  // rounding must not make it negative
      const double a = changes[k].first, b = changes[k + 1].first;
      at_segment(a, density, below, below + density * (b - a));
      below += density * (b - a);
    }
    return below;
  };
  const double total = integrate([](double, double, double, double) {});
  const double all_wanted = std::accumulate(wanted.begin(), wanted.end(), 0.0);
  int n = 1;
  double target = total * wanted[0] / all_wanted;
  integrate([&](double a, double density, double below, double above) {
    for (; n < count && target <= above; ++n) {
      cut[n] = a + (target - below) / density;
      target += total * wanted[static_cast<std::size_t>(n)] / all_wanted;
    }
  });
  for (; n < count; ++n) cut[n] = last;  // what rounding left over
}

// Sums of the time (or of anything else) over the cells of each level: level[a] has one value for each slab of axis a.
template <int D>
std::array<std::vector<double>, D> level_sums(const cuts<D>& c, const std::vector<double>& per_rank) {
  std::array<std::vector<double>, D> level;
  level[D - 1] = per_rank;
  for (std::size_t a = D - 1; a-- > 0;) {
    const auto inner = static_cast<std::size_t>(c.counts[a + 1]);
    level[a].assign(level[a + 1].size() / inner, 0.0);
    for (std::size_t k = 0; k < level[a + 1].size(); ++k) level[a][k / inner] += level[a + 1][k];
  }
  return level;
}

// Where in a slab its contents are: its parts in equal bins of [lower, upper].
struct profile {
  double lower, upper;
  std::vector<double> part;
};

// Adds to the bins of [lower, upper], `share` of what lies between a and b, of which any that stands out counts as at
// the border.
void spread_into(std::vector<double>& bins, double lower, double upper, double a, double b, double share) {
  const double width = (upper - lower) / static_cast<double>(bins.size());
  const double from = (a - lower) / width, to = (b - lower) / width, last = static_cast<double>(bins.size() - 1);
  const auto first_bin = static_cast<std::size_t>(std::clamp(from, 0.0, last));
  const auto last_bin = static_cast<std::size_t>(std::clamp(to, 0.0, last));
  for (std::size_t n = first_bin; n <= last_bin; ++n) {
    const double below = n == first_bin ? from : static_cast<double>(n);
    const double above = n == last_bin ? to : static_cast<double>(n + 1);
    bins[n] += share * (to > from ? (above - below) / (to - from) : 1.0);
  }
}

// Where along the axis ranks [first, last) of a slab have their amounts: in as many bins as one rank tells.
template <int D>
void look_into(profile& slab, std::size_t axis, std::size_t first, std::size_t last, const std::vector<double>& amount,
               const extents<D>& where) {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (std::size_t r = first; r < last; ++r) {
    lower = std::min(lower, where[r].lower[axis]);
    upper = std::max(upper, where[r].upper[axis]);
  }
  if (lower > upper) return;
  slab = {std::clamp(lower, slab.lower, slab.upper), std::clamp(upper, slab.lower, slab.upper), {1.0}};
  if (!(slab.upper > slab.lower)) return;
  std::vector<double> bins(extent<D>::bins, 0.0);
  for (std::size_t r = first; r < last; ++r) {
    const auto& along = where[r].cost[axis];
    const double whole = std::accumulate(along.begin(), along.end(), 0.0);
    if (where[r].lower[axis] > where[r].upper[axis] || !(whole > 0.0) || !(amount[r] > 0.0)) continue;
    const double width = (where[r].upper[axis] - where[r].lower[axis]) / static_cast<double>(along.size());
    for (std::size_t n = 0; n < along.size(); ++n) {
      const double a = where[r].lower[axis] + width * static_cast<double>(n);
      spread_into(bins, slab.lower, slab.upper, a, a + width, amount[r] * along[n] / whole);
    }
  }
  const double whole = std::accumulate(bins.begin(), bins.end(), 0.0);
  if (!(whole > 0.0)) return;
  for (double& part : bins) part /= whole;
  slab.part = std::move(bins);
}

template <int D>
std::array<std::vector<profile>, D> level_profiles(const cuts<D>& c, const std::vector<double>& amount,
                                                   const extents<D>& where) {
  std::array<std::vector<profile>, D> level;
  for (std::size_t a = 0; a < D; ++a) {
    const auto count = static_cast<std::size_t>(c.counts[a]);
    for (std::size_t g = 0; g < c.groups(a); ++g)
      for (std::size_t n = 0; n < count; ++n) level[a].push_back({c.group(a, g)[n], c.group(a, g)[n + 1], {1.0}});
    const std::size_t inner = where.size() / level[a].size();  // ranks in a slab, 0 where they tell nothing
    for (std::size_t k = 0; inner > 0 && k < level[a].size(); ++k)
      look_into<D>(level[a][k], a, k * inner, (k + 1) * inner, amount, where);
  }
  return level;
}

// What a balancer knows of the present: cuts, and where in each slab of each level its contents are.
template <int D>
struct present {
  const cuts<D>& now;
  std::array<std::vector<profile>, D> contents;
  present(const cuts<D>& c, const std::vector<double>& amount, const extents<D>& where)
      : now(c), contents(level_profiles(c, amount, where)) {}

  // f(piece) for the contents of slab m of a group, of this amount in all.
  template <class F>
  void visit(std::size_t axis, std::size_t g, int m, double amount, const F& f) const {
    const auto& [lower, upper, part] =
        contents[axis][g * static_cast<std::size_t>(now.counts[axis]) + static_cast<std::size_t>(m)];
    const auto whole = spread_over(lower, upper, amount, now.group(axis, g)[now.counts[axis]] - now.group(axis, g)[0]);
    const double width = (whole.b - whole.a) / static_cast<double>(part.size());
    double a = whole.a;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const double b = k + 1 == part.size() ? whole.b : whole.a + width * static_cast<double>(k + 1);
      f(piece{a, b, amount * part[k]});
      a = b;
    }
  }

  // The sources of the next level's cuts in slab n between new cuts: the old slabs that reach into it.
  std::vector<source> within(const std::vector<source>& from, std::size_t axis, const double* cut, int n) const {
    const int count = now.counts[axis];
    const double near = narrowest * (cut[count] - cut[0]);
    std::vector<source> found;
    for (const auto& s : from) {
      const double* old = now.group(axis, s.group);
      // From the last old slab that begins at or below the new one, or touches it within rounding.
      auto m = static_cast<int>(std::upper_bound(old, old + count, cut[n] - near) - old);
      for (m = std::max(0, m - 1); m < count && (n + 1 == count || old[m] <= cut[n + 1] + near); ++m) {
        double part = 0.0;
        visit(axis, s.group, m, 1.0, [&](const piece& p) { part += p.amount * part_in(p, cut, n, count); });
        if (part > 0.0)
          found.push_back({s.group * static_cast<std::size_t>(count) + static_cast<std::size_t>(m), s.fraction * part});
      }
    }
    return found;
  }
};

// The amounts wanted in `count` slabs that now take t: equal, and, under-relaxed, still a part of what these ranks
// have.
std::vector<double> wanted_of(const double* t, std::size_t count, double relaxation) {
  const double sum = std::accumulate(t, t + count, 0.0);
  std::vector<double> w(count, 1.0 / static_cast<double>(count));
  for (std::size_t n = 0; n < count && sum > 0.0; ++n) w[n] = relaxation * w[n] + (1.0 - relaxation) * t[n] / sum;
  return w;
}

template <int D>
struct remapping {
  const present<D>& at;
  std::array<std::vector<double>, D> time;  // of the slabs of each level
  const balancer_options& o;
  cuts<D> then;

  std::vector<double> wanted(std::size_t axis, std::size_t g) const {
    const auto count = static_cast<std::size_t>(at.now.counts[axis]);
    return wanted_of(time[axis].data() + g * count, count, o.relaxation);
  }

  void cut_group(std::size_t axis, std::size_t g, const std::vector<source>& from) {
    const int count = at.now.counts[axis];
    double* cut = then.group(axis, g);
    std::vector<piece> pieces;
    for (const auto& s : from) {
      const double* t = time[axis].data() + s.group * static_cast<std::size_t>(count);
      for (int m = 0; m < count; ++m)
        at.visit(axis, s.group, m, s.fraction * t[m], [&](const piece& p) { pieces.push_back(p); });
    }
    place(pieces, wanted(axis, g), o.floor, cut);
    keep_apart(cut, count, o.minimum_width);
    if (axis + 1 == D) return;
    for (int n = 0; n < count; ++n)
      cut_group(axis + 1, g * static_cast<std::size_t>(count) + static_cast<std::size_t>(n),
                at.within(from, axis, cut, n));
  }
};

template <int D>
cuts<D> remap(const cuts<D>& now, const std::vector<double>& time, const balancer_options& o, const extents<D>& where) {
  const present<D> at(now, time, where);
  remapping<D> r{at, level_sums(now, time), o, now};
  r.cut_group(0, 0, {{0, 1.0}});
  return r.then;
}

// omega of damped Jacobi iteration at which the shortest wave of error, whose factor is 1 - 2 omega, and the longest
// that the next coarser level leaves over, 1 - omega, shrink alike: by 1/3 an update.
constexpr double omega_of_levels = 2.0 / 3.0;

// One level: neighbouring groups of `stride` slabs exchange time over the border between them. t: s, of each slab. With
// f = T_i - T_(i-1) of the groups' means, a border that lets s pass changes f by -s (1/n_i + 1/n_(i-1)), n slabs in
// each: Jacobi's step. The slabs of a group keep their parts of its time.
void exchange(std::vector<double>& t, std::size_t stride, double omega) {
  const std::size_t count = t.size(), groups = (count + stride - 1) / stride;
  const auto first = [&](std::size_t i) {
    return t.begin() + static_cast<std::ptrdiff_t>(std::min(i * stride, count));
  };
  std::vector<double> was(groups), slabs(groups), is;
  for (std::size_t i = 0; i < groups; ++i) {
    was[i] = std::accumulate(first(i), first(i + 1), 0.0);
    slabs[i] = static_cast<double>(first(i + 1) - first(i));
  }
  is = was;
  for (std::size_t i = 1; i < groups; ++i) {
    const double f = was[i] / slabs[i] - was[i - 1] / slabs[i - 1];
    const double passes = omega * f / (1.0 / slabs[i] + 1.0 / slabs[i - 1]);
    is[i - 1] += passes;
    is[i] -= passes;
  }
  for (std::size_t i = 0; i < groups; ++i)
    for (auto slab = first(i); slab != first(i + 1); ++slab)
      *slab = was[i] > 0.0 ? *slab * std::max(0.0, is[i]) / was[i] : std::max(0.0, is[i]) / slabs[i];
}

template <int D>
cuts<D> level_relaxation(const cuts<D>& now, const std::vector<double>& time, const balancer_options& o,
                         const extents<D>& where) {
  cuts<D> then = now;
  const present<D> at(now, time, where);
  const auto level = level_sums(now, time);
  for (std::size_t a = 0; a < D; ++a) {
    const auto count = static_cast<std::size_t>(now.counts[a]);
    for (std::size_t g = 0; g < now.groups(a); ++g) {
      std::vector<double> wanted(count);
      std::vector<piece> pieces;
      for (std::size_t m = 0; m < count; ++m) {
        const auto& slab = at.contents[a][g * count + m];
        wanted[m] = level[a][g * count + m];
        pieces.push_back(spread_over(slab.lower, slab.upper, wanted[m], now.group(a, g)[count] - now.group(a, g)[0]));
      }
      if (std::all_of(wanted.begin(), wanted.end(), [](double t) { return t == 0.0; })) continue;
      std::size_t coarsest = 0;
      while (coarsest < static_cast<std::size_t>(o.levels) && (std::size_t{2} << coarsest) < count) ++coarsest;
      for (std::size_t l = coarsest + 1; l-- > 0;)
        exchange(wanted, std::size_t{1} << l, o.relaxation * omega_of_levels);
      place(pieces, wanted, o.floor, then.group(a, g));
      keep_apart(then.group(a, g), now.counts[a], o.minimum_width);
    }
  }
  return then;
}

// visit(old rank, new rank, part of the old cell) for each pair of cells that meet.
template <int D, class F>
void visit_overlaps(const cuts<D>& now, const cuts<D>& then, const std::vector<double>& amount, const extents<D>& where,
                    const F& visit) {
  const present<D> at(now, amount, where);
  const auto within = [&](auto&& self, std::size_t axis, std::size_t g, const std::vector<source>& from) -> void {
    for (int n = 0; n < then.counts[axis]; ++n) {
      const auto found = at.within(from, axis, then.group(axis, g), n);
      const std::size_t cell = g * static_cast<std::size_t>(then.counts[axis]) + static_cast<std::size_t>(n);
      if (axis + 1 < D)
        self(self, axis + 1, cell, found);
      else
        for (const auto& s : found) visit(s.group, cell, s.fraction);
    }
  };
  within(within, 0, 0, {{0, 1.0}});
}

template <int D>
void check_size(const cuts<D>& c, std::size_t n, const char* what) {
  if (n != static_cast<std::size_t>(c.ranks()))
    foundation::fail_input(fmt::format("the balancer got {} {} for {} ranks", n, what, c.ranks()));
}

// The part of the box that a cut lies in, and how much more than what is below this part it should have beneath it.
struct closer_look {
  window at;
  std::size_t cut;  // of its group
  double wanted;
};

// Cuts along an axis by the density in equal parts of the box, even within each part.
template <int D>
std::vector<closer_look> place_coarsely(cuts<D>& then, std::size_t axis, const std::vector<std::vector<double>>& wanted,
                                        double floor, const density_along<D>& density) {
  constexpr std::size_t least = 256, of_a_slab = 32;
  const auto count = static_cast<std::size_t>(then.counts[axis]), groups = wanted.size();
  const std::size_t parts = std::max(least, of_a_slab * count);
  std::vector<window> whole;
  for (std::size_t g = 0; g < groups; ++g) whole.push_back({g, then.group(axis, g)[0], then.group(axis, g)[count]});
  const auto cost = density(axis, then, whole, parts);
  std::vector<closer_look> looks;
  for (std::size_t g = 0; g < groups; ++g) {
    const double first = whole[g].lower, width = (whole[g].upper - first) / static_cast<double>(parts);
    const auto edge = [&](std::size_t k) { return first + width * static_cast<double>(k); };
    std::vector<piece> pieces;
    std::vector<double> below{0.0};
    for (std::size_t k = 0; k < parts; ++k) {
      pieces.push_back({edge(k), edge(k + 1), cost[g * parts + k]});
      below.push_back(below.back() + cost[g * parts + k]);
    }
    double* cut = then.group(axis, g);
    place(pieces, wanted[g], floor, cut);
    const double all_wanted = std::accumulate(wanted[g].begin(), wanted[g].end(), 0.0);
    double so_far = 0.0;
    for (std::size_t n = 1; n < count; ++n) {
      so_far += wanted[g][n - 1];
      const std::size_t k = whole[g].part(cut[n], parts);
      looks.push_back({{g, edge(k), edge(k + 1)}, n, below.back() * so_far / all_wanted - below[k]});
    }
  }
  return looks;
}

// Of the borders of a window's parts, ends included, that which has most nearly so much below it; where nothing lies
// between some of them, the middle of these.
double nearest_border(const closer_look& look, const double* cost, std::size_t parts) {
  double below = 0.0, chosen = 0.0;
  std::size_t first = 0, last = 0;
  for (std::size_t k = 1; k <= parts; ++k) {
    below += cost[k - 1];
    if (std::abs(below - look.wanted) < std::abs(chosen - look.wanted)) {
      chosen = below;
      first = k;
    }
    if (below == chosen) last = k;
  }
  const double middle = 0.5 * static_cast<double>(first + last) / static_cast<double>(parts);
  return look.at.lower + middle * (look.at.upper - look.at.lower);
}

template <int D>
void place_finely(cuts<D>& then, std::size_t axis, const std::vector<closer_look>& looks,
                  const density_along<D>& density) {
  constexpr std::size_t parts = 64;
  std::vector<window> windows;
  for (const auto& look : looks) windows.push_back(look.at);
  const auto cost = density(axis, then, windows, parts);
  for (std::size_t n = 0; n < looks.size(); ++n) {
    const double* here = cost.data() + n * parts;
    if (std::any_of(here, here + parts, [](double c) { return c > 0.0; }))
      then.group(axis, looks[n].at.group)[looks[n].cut] = nearest_border(looks[n], here, parts);
  }
}

}  // namespace

void declare(namelist::schema& schema, balancer_options& o) {
  schema.group("balancer", "how the cuts between ranks follow the measured times");
  const auto add = [&](const std::string& name, auto& bound, namelist::key_info info) {
    info.may_change = info.expert = true;
    info.expert_name = "balancer_" + name;
    schema.add("balancer", name, bound, std::move(info));
  };
  add("method", o.method,
      {.choices = {"remap", "level_relaxation"},
       .meaning = "all cuts at once by the density of cost, or a damped quasi-Newton step from coarse to fine"});
  add("relaxation", o.relaxation,
      namelist::up_to(1.0,
                      "part of its full step that a method takes: all of the imbalance by remap; omega = 2/3 by "
                      "level_relaxation"));
  add("minimum_width", o.minimum_width, {.unit = "m", .minimum = 0.0, .meaning = "of every slab"});
  add("floor", o.floor,
      namelist::between(1e-12, 1.0, "least density of cost, in parts of the mean: places cuts where nothing is"));
  add("levels", o.levels, namelist::between(0, 30, "level_relaxation: the coarsest groups have 2**levels slabs"));
  add("readings", o.readings,
      namelist::between(1, 100,
                        "of the clock that have to agree before a rank counts as slower or faster than its work; "
                        "1: the times as they are"));
}

template <int D>
cuts<D> propose(const cuts<D>& now, const std::vector<double>& time_per_rank, const balancer_options& o,
                const extents<D>& where) {
  check_size(now, time_per_rank.size(), "times");
  if (!where.empty()) check_size(now, where.size(), "extents");
  std::vector<double> time(time_per_rank);
  for (double& t : time)
    if (!(t > 0.0) || !std::isfinite(t)) t = 0.0;
  if (std::all_of(time.begin(), time.end(), [](double t) { return t == 0.0; })) return now;
  if (o.method == "remap") return remap(now, time, o, where);
  if (o.method == "level_relaxation") return level_relaxation(now, time, o, where);
  foundation::fail_input("unknown method of the balancer: " + o.method);
}

template <int D>
cuts<D> propose_by_density(const cuts<D>& now, const std::vector<double>& time_per_rank, const balancer_options& o,
                           const density_along<D>& density) {
  check_size(now, time_per_rank.size(), "times");
  cuts<D> then = now;
  const auto time = level_sums(now, time_per_rank);
  for (std::size_t a = 0; a < D; ++a) {
    const auto count = static_cast<std::size_t>(now.counts[a]), groups = now.groups(a);
    if (count == 1) continue;
    std::vector<std::vector<double>> wanted;
    for (std::size_t g = 0; g < groups; ++g)
      wanted.push_back(wanted_of(time[a].data() + g * count, count, o.relaxation));
    const auto closer = place_coarsely<D>(then, a, wanted, o.floor, density);
    place_finely<D>(then, a, closer, density);
    for (std::size_t g = 0; g < groups; ++g) keep_apart(then.group(a, g), now.counts[a], o.minimum_width);
  }
  return then;
}

void experience::moved(double predicted, const std::vector<double>& before, const std::vector<double>& after) {
  const auto was = spread_of(before), is = spread_of(after);
  if (predicted > 0.0)
    trust = std::max(0.05, 0.5 * (trust + std::clamp((was.maximum - is.maximum) / predicted, 0.0, 1.0)));
  double both = 0.0, was_square = 0.0, is_square = 0.0;
  for (std::size_t r = 0; r < std::min(before.size(), after.size()); ++r) {
    const double a = before[r] / std::max(was.mean, 1e-300) - 1.0, b = after[r] / std::max(is.mean, 1e-300) - 1.0;
    both += a * b;
    was_square += a * a;
    is_square += b * b;
  }
  if (!(was_square > 0.0) || !(is_square > 0.0)) return;
  const double correlation = both / std::sqrt(was_square * is_square);
  if (correlation < -0.2) relaxation = std::max(0.15, 0.6 * relaxation);
  if (correlation > 0.2) relaxation = std::min(1.0, 1.25 * relaxation);
}

void experience::stayed() { trust += 0.05 * (1.0 - trust); }

balancer_options relaxed(balancer_options o, const experience& so_far) {
  o.relaxation *= so_far.relaxation;
  return o;
}

std::vector<double> lasting_cost::of(const std::vector<double>& seconds, const std::vector<double>& counted) {
  const double all_seconds = std::accumulate(seconds.begin(), seconds.end(), 0.0);
  const double all_work = std::accumulate(counted.begin(), counted.end(), 0.0);
  if (readings_ < 2 || !(all_seconds > 0.0) || !(all_work > 0.0)) return seconds;
  slowness_.resize(seconds.size(), std::vector<double>(readings_, 1.0));
  std::vector<double> cost(seconds.size());
  for (std::size_t r = 0; r < seconds.size(); ++r) {
    const double time = seconds[r] / all_seconds, work = counted[r] / all_work;
    auto& seen = slowness_[r];
    std::rotate(seen.begin(), seen.begin() + 1, seen.end());
    seen.back() = work > 0.0 && time > 0.0 ? time / work : 1.0;
    const auto [least, most] = std::minmax_element(seen.begin(), seen.end());
    const double lasting = *least > 1.0 ? *least : *most < 1.0 ? *most : 1.0;
    cost[r] = all_seconds * work * lasting;
  }
  return cost;
}

decision worth_moving(double slowest_now, double slowest_then, double cost, std::int64_t steps, double trust) {
  decision d;
  d.gain = trust * (slowest_now - slowest_then) * static_cast<double>(steps);
  d.cost = cost;
  d.move = d.gain > d.cost;
  d.reason = fmt::format("{} {:.3g} s over {} steps, moving costs {:.3g} s: {}", d.gain < 0.0 ? "would lose" : "gain",
                         std::abs(d.gain), steps, d.cost, d.move ? "move" : "stay");
  return d;
}

template <int D>
decision worth_moving(const cuts<D>& now, const cuts<D>& then, const std::vector<double>& time_per_step,
                      const std::vector<double>& particles, const move_costs& moving, std::int64_t steps,
                      const experience& so_far, const extents<D>& where) {
  check_size(now, time_per_step.size(), "times");
  check_size(now, particles.size(), "numbers of particles");
  std::vector<double> after(particles.size(), 0.0), in_and_out(particles.size(), 0.0);
  visit_overlaps(now, then, time_per_step, where, [&](std::size_t from, std::size_t to, double part) {
    after[to] += part * time_per_step[from];
    if (from == to) return;
    in_and_out[from] += part * particles[from];
    in_and_out[to] += part * particles[from];
  });
  const double cost = moving.per_particle * *std::max_element(in_and_out.begin(), in_and_out.end()) + moving.rebuild;
  double slowest = *std::max_element(after.begin(), after.end());
  for (std::size_t r = 0; r < particles.size(); ++r)
    if (particles[r] > 0.0) slowest = std::max(slowest, time_per_step[r] / particles[r]);
  auto d =
      worth_moving(*std::max_element(time_per_step.begin(), time_per_step.end()), slowest, cost, steps, so_far.trust);
  d.after = std::move(after);
  return d;
}

spread spread_of(const std::vector<double>& time) {
  if (time.empty()) return {};
  const auto [least, most] = std::minmax_element(time.begin(), time.end());
  return {std::accumulate(time.begin(), time.end(), 0.0) / static_cast<double>(time.size()), *least, *most};
}

#define TETSUAME_BALANCE(D)                                                                                         \
  template cuts<D> propose(const cuts<D>&, const std::vector<double>&, const balancer_options&, const extents<D>&); \
  template cuts<D> propose_by_density(const cuts<D>&, const std::vector<double>&, const balancer_options&,          \
                                      const density_along<D>&);                                                     \
  template decision worth_moving(const cuts<D>&, const cuts<D>&, const std::vector<double>&,                        \
                                 const std::vector<double>&, const move_costs&, std::int64_t, const experience&,    \
                                 const extents<D>&)
TETSUAME_BALANCE(1);
TETSUAME_BALANCE(2);
TETSUAME_BALANCE(3);

}  // namespace tetsuame::balance
