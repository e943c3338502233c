// What is at the start of a test, and the exact solution where there is one.
#pragma once

#include <functional>
#include <gas/options.hpp>
#include <riemann/exact.hpp>
#include <vector>

namespace tetsuame::gas {

using point = std::array<double, 3>;

struct state {
  double rho, p;  // kg/m3, Pa
  point v{};      // m/s
  std::int32_t material = 0;
  std::optional<double> temperature = {};  // K, with an equation of state; none: that of its side
  std::optional<double> energy = {};       // J/kg, internal; none: by temperature or pressure
  std::optional<double> dissolved = {};    // of the element, amount per mass; none: that of &element
};

// An even lattice of n particles along each axis between two corners, cell-centred.
struct block {
  point low{}, high{};
  std::array<std::int64_t, 3> n{1, 1, 1};
  std::function<bool(const point&)> holds = {};  // none: all of it
};

// The owned particles of a rank, as the measures see them.
struct view {
  const domain::communicator& ranks;
  std::size_t n;
  std::array<const double*, 3> x, v;  // none beyond the dimension
  const double *m, *rho, *p, *volume;
  const std::int32_t* material;
  const std::int64_t* id;
  const double* melt = nullptr;                                 // melt fraction; none: nothing melts
  const double *concentration = nullptr, *partition = nullptr;  // of an element, where there is one

  point place(std::size_t i) const { return of(x, i); }
  point velocity(std::size_t i) const { return of(v, i); }

 private:
  static point of(const std::array<const double*, 3>& a, std::size_t i) {
    point r{};
    for (std::size_t k = 0; k < 3; ++k)
      if (a[k] != nullptr) r[k] = a[k][i];
    return r;
  }
};

// A measure over time: a column of history.csv. The values at all its lines are kept for the end.
struct trace {
  std::string name, unit;
  std::function<double(const view&)> value;  // collective
};
using samples = std::vector<std::vector<double>>;                            // [line]: time, then the traces
using numbers = std::vector<std::pair<std::string, std::optional<double>>>;  // none: could not be measured

// A particle that stands on no lattice.
struct placed {
  point x;
  double mass;  // kg
  state now;
};

// v = ω e_z × (x - centre) + ε (x - centre)
struct turning {
  double spin = 0.0, expansion = 0.0;  // rad/s, 1/s
  point centre{};                      // m
  double velocity(std::size_t a, const point& x) const {
    const double across = a == 0 ? centre[1] - x[1] : a == 1 ? x[0] - centre[0] : 0.0;
    return spin * across + expansion * (x[a] - centre[a]);
  }
  double centrifugal(std::size_t a, const point& x) const { return a < 2 ? spin * spin * (x[a] - centre[a]) : 0.0; }
};

struct setup {
  std::vector<block> blocks;
  std::vector<placed> particles = {};  // after those of the blocks
  std::int32_t material_l = 0;         // of the gas on the left or inside, with its gamma and p_infinity
  std::function<state(const point&)> start;
  turning turns = {};                             // of a start once it has settled, at rest in the frame that turns
  std::function<point(const point&)> moved = {};  // where its particle is put; none: there
  std::function<state(const point&, double t)> exact = {};    // none: no errors
  std::function<bool(const point&, double t)> measured = {};  // where errors are; none: everywhere
  numbers known = {};                                         // of the exact solution, for summary.json
  struct of_drift {
    double momentum, angular_momentum;  // kg m/s, kg m²/s
  };
  std::optional<of_drift> scales = {};  // over which drifts are told; none: they are not
  std::vector<trace> traces = {};
  std::function<numbers(const view&, const samples&)> measures = {};  // for summary.json; collective
  std::function<void()> expect_used =
      {};  // fails where a region of &region has had no place of the start; none: there are none
};

setup make_setup(const options& o);

// The slope of y by x, by least squares.
struct fitted_line {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  void add(double at, double value) { n += 1.0, x += at, y += value, xx += at * at, xy += at * value; }
  double slope() const { return (n * xy - x * y) / (n * xx - x * x); }
};

}  // namespace tetsuame::gas
