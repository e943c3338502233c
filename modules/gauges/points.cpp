#include <algorithm>
#include <cmath>
#include <gauges/points.hpp>
#include <operators/symmetric.hpp>
#include <stdexcept>

namespace tetsuame::gauges {

namespace {

using foundation::exact_sum;

// Null: snapshots of the problem have none.
const double* values_of(const output::particle_group& g, const std::string& name) {
  const auto found = std::ranges::find(g.columns, name, &output::column::name);
  return found == g.columns.end() ? nullptr : found->components[0];
}
const output::column& column_of(const output::particle_group& g, const std::string& name) {
  const auto found = std::ranges::find(g.columns, name, &output::column::name);
  if (found == g.columns.end()) throw std::logic_error("snapshots have no " + name);
  return *found;
}

// f(d) for each displacement of the place from the point, or of one of its images across periodic sides, within reach;
// d: m, of the place itself.
template <int D, class F>
void for_each_near(const domain::box<D>& region, std::array<double, D> d, double reach, const F& f, std::size_t a = 0) {
  if (a == D) return f(d);
  const double length = region.length[a];
  const double nearest = region.periodic[a] ? std::remainder(d[a], length) : d[a];
  for (const double by : {0.0, -length, length}) {
    if (by != 0.0 && !region.periodic[a]) break;
    d[a] = nearest + by;
    if (std::abs(d[a]) < reach) for_each_near<D>(region, d, reach, f, a + 1);
  }
}

// About one point, with the weights w: Σ w, Σ w d, Σ w d d; of each component of a field Σ w f, Σ w f d.
template <int D>
struct moments {
  static constexpr std::size_t S = operators::symmetric_terms(D), of_places = 1 + D + S, of_values = 1 + D;

  static std::size_t size(std::size_t values) { return of_places + of_values * values; }

  static void add(std::span<exact_sum> to, double w, const std::array<double, D>& d, std::span<const double> f) {
    to[0].add(w);
    for (std::size_t a = 0; a < D; ++a) {
      to[1 + a].add(w * d[a]);
      for (std::size_t b = a; b < D; ++b) to[1 + D + operators::symmetric_place(a, b, D)].add(w * d[a] * d[b]);
    }
    for (std::size_t k = 0; k < f.size(); ++k) {
      const auto of = to.subspan(of_places + of_values * k, of_values);
      of[0].add(w * f[k]);
      for (std::size_t a = 0; a < D; ++a) of[1 + a].add(w * f[k] * d[a]);
    }
  }

  // C⁻¹ x̄, or 0 where the slope is not determined: C is singular, or the point farther from the places' mean than two
  // of their standard deviations along each axis. In the corner of a box it is nearer.
  static std::array<double, D> towards_mean(std::span<const double> m) {
    std::array<std::array<double, D>, D> C;
    std::array<double, D> mean;
    for (std::size_t a = 0; a < D; ++a) mean[a] = m[1 + a] / m[0];
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = 0; b < D; ++b)
        C[a][b] = m[1 + D + operators::symmetric_place(a, b, D)] / m[0] - mean[a] * mean[b];
    if (!operators::factorise(C, 1e-3)) return {};
    const auto y = operators::solve(C, mean);
    double deviations2 = 0.0;
    for (std::size_t a = 0; a < D; ++a) deviations2 += y[a] * mean[a];
    return deviations2 < 4.0 * D ? y : std::array<double, D>{};
  }

  static void append_values(std::span<const double> m, std::size_t values, std::vector<double>& to) {
    const double w = m[0];
    if (!(w > 0.0)) return to.insert(to.end(), values, 0.0), void();
    const auto y = towards_mean(m);
    for (std::size_t k = 0; k < values; ++k) {
      const auto of = m.subspan(of_places + of_values * k, of_values);
      double value = of[0] / w;
      for (std::size_t a = 0; a < D; ++a) value -= y[a] * (of[1 + a] / w - of[0] / w * (m[1 + a] / w));
      to.push_back(value);
    }
  }
};

// Of the whole fluid on this rank, for one point.
template <int D, class Kernel>
void add_all(const output::particle_group& fluid, const std::vector<const double*>& fields,
             const domain::box<D>& region, const Kernel& kernel, const std::array<double, 3>& point,
             std::span<exact_sum> to) {
  const auto& x = column_of(fluid, "Coordinates").components;
  const double *h = values_of(fluid, "SmoothingLength"), *mass = values_of(fluid, "Masses"),
               *rho = values_of(fluid, "Density");
  const bool equal = mass == nullptr || rho == nullptr;
  std::vector<double> f(fields.size());
  for (std::size_t i = 0; i < fluid.n; ++i) {
    const double support = h != nullptr ? Kernel::support_over_h * h[i] : kernel.support();
    std::array<double, D> d;
    for (std::size_t a = 0; a < D; ++a) d[a] = x[a][i] - point[a];
    for_each_near<D>(region, d, support, [&](const std::array<double, D>& near) {
      double r2 = 0.0;
      for (const double component : near) r2 += component * component;
      if (!(r2 < support * support)) return;
      const double wider = support / kernel.support();
      const double W = kernel.value(std::sqrt(r2) / wider) / std::pow(wider, D);
      for (std::size_t k = 0; k < f.size(); ++k) f[k] = fields[k][i];
      moments<D>::add(to, equal ? W : mass[i] / rho[i] * W, near, f);
    });
  }
}

}  // namespace

template <int D>
std::vector<double> read(const options& o, const output::particle_group& fluid, const domain::box<D>& region,
                         const kernels::any<D>& kernel, const domain::communicator& ranks) {
  std::vector<const double*> fields;
  for (const auto& name : o.fields) {
    const auto& components = column_of(fluid, name).components;
    fields.insert(fields.end(), components.begin(), components.end());
  }
  const std::size_t each = moments<D>::size(fields.size());
  std::vector<exact_sum> sums(each * o.number());
  for (std::size_t n = 0; n < o.number(); ++n)
    std::visit(
        [&](const auto& k) { add_all<D>(fluid, fields, region, k, o.at(n), std::span(sums).subspan(each * n, each)); },
        kernel);
  const auto all = ranks.exact(sums);
  std::vector<double> values;
  for (std::size_t n = 0; n < o.number(); ++n)
    moments<D>::append_values(std::span(all).subspan(each * n, each), fields.size(), values);
  return values;
}

#define TETSUAME_READ(D)                                                                                     \
  template std::vector<double> read<D>(const options&, const output::particle_group&, const domain::box<D>&, \
                                       const kernels::any<D>&, const domain::communicator&)
TETSUAME_READ(1);
TETSUAME_READ(2);
TETSUAME_READ(3);
#undef TETSUAME_READ

}  // namespace tetsuame::gauges
