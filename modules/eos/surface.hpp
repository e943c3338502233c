// A quantity known at the nodes of a rectangular grid of two ascending coordinates x and y, between them by bicubic
// Hermite pieces: value and first derivatives are continuous. The slopes at the nodes are those of the quartics through
// five neighbours. Where the data of a cell rise along a coordinate, so does the piece: the slopes at its corners are
// reduced until the differences of its Bezier coefficients along that coordinate are not negative, which suffices
// [after R. E. Carlson, F. N. Fritsch, SIAM J. Numer. Anal. 22, 386 (1985)].
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tetsuame::eos {

// Where a coordinate lies on an axis: between the nodes k and k + 1, a distance `width` apart, at the part t of it.
struct axis_place {
  std::size_t k;
  double t, width;
};

class axis {
 public:
  explicit axis(std::vector<double> nodes) : nodes_(std::move(nodes)) {}  // ascending, two at least

  double low() const { return nodes_.front(); }
  double high() const { return nodes_.back(); }
  std::size_t size() const { return nodes_.size(); }
  double operator[](std::size_t k) const { return nodes_[k]; }
  bool holds(double x) const { return x >= low() && x <= high(); }
  axis_place find(double x) const;  // of x that it holds
  // Derivatives at the nodes of values `stride` apart.
  void slopes(const double* values, double* result, std::size_t stride) const;

 private:
  std::vector<double> nodes_;
};

struct surface_point {
  double value, by_x, by_y;
};

class surface {
 public:
  // values[j * x.size() + i] at the nodes i of x and j of y. The axes outlive the surface.
  surface(const axis& x, const axis& y, const std::vector<double>& values, bool rises_in_x, bool rises_in_y);

  surface_point at(const axis_place& x, const axis_place& y) const;
  // At a place on x and the node j of y.
  double at_node(const axis_place& x, std::size_t j) const;
  // Nodes whose slopes were reduced.
  std::size_t reduced() const { return reduced_; }

 private:
  struct node {
    double f, x, y, xy;  // value and derivatives
  };
  const node& of(std::size_t i, std::size_t j) const { return nodes_[j * x_->size() + i]; }
  bool keeps_monotone(std::size_t i, std::size_t j, bool along_x) const;
  void reduce(std::size_t i, std::size_t j, bool along_x, bool all);

  const axis *x_, *y_;
  std::vector<node> nodes_;
  std::size_t reduced_ = 0;
};

}  // namespace tetsuame::eos
