#include <Eigen/Sparse>
#include <cmath>
#include <foundation/error.hpp>
#include <initializer_list>
#include <theory/stokes_box.hpp>
#include <vector>

// The marker-and-cell scheme in its stream function (docs/theory/drop.md): psi at the corners of the cells, u = dpsi/dy
// and v = -dpsi/dx on the faces. The flow minimises
//   1/2 int [4 eta psi_xy^2 + eta (psi_yy - psi_xx)^2] - int f v,
// with psi_xy at the cells' centres and psi_yy - psi_xx at their corners. Behind a no-slip wall psi is mirrored.
namespace tetsuame::theory {

namespace {

struct axis {
  int cells;
  double spacing;  // m
  sides walls;
  bool periodic() const { return walls == sides::periodic; }
  int corners() const { return periodic() ? cells : cells + 1; }
  bool on_wall(int i) const { return !periodic() && (i == 0 || i == cells); }
  int wrapped(int i) const { return periodic() ? (i + cells) % cells : i; }
};

// The corners of the cells, and the place of each among the unknowns; -1: psi = 0.
struct corners {
  axis X, Y;
  std::vector<int> number;
  int unknowns = 0;

  corners(const axis& across, const axis& up) : X(across), Y(up) {
    for (int j = 0; j < Y.corners(); ++j) {
      for (int i = 0; i < X.corners(); ++i) {
        const bool pinned = X.periodic() && Y.periodic() && i == 0 && j == 0;  // psi is known but for a constant
        number.push_back(X.on_wall(i) || Y.on_wall(j) || pinned ? -1 : unknowns++);
      }
    }
  }
  int at(int i, int j) const { return number[static_cast<std::size_t>(Y.wrapped(j) * X.corners() + X.wrapped(i))]; }
};

// Part of a cell about (x, y) that the drop covers, by midpoints.
double covered(const drop_in_box& box, double x, double y, double dx, double dy) {
  constexpr int m = 16;
  const double r = std::hypot(x - box.x, y - box.y), reach = 0.5 * std::hypot(dx, dy);
  if (r >= box.radius + reach) return 0.0;
  if (r <= box.radius - reach) return 1.0;
  int inside = 0;
  for (int a = 0; a < m; ++a) {
    for (int b = 0; b < m; ++b) {
      const double px = x + dx * ((a + 0.5) / m - 0.5) - box.x, py = y + dy * ((b + 0.5) / m - 0.5) - box.y;
      inside += px * px + py * py < box.radius * box.radius;
    }
  }
  return static_cast<double>(inside) / (m * m);
}

// The matrix of the dissipation.
Eigen::SparseMatrix<double> dissipation(const drop_in_box& box, const corners& psi) {
  const axis &X = psi.X, &Y = psi.Y;
  const double dx = X.spacing, dy = Y.spacing, area = dx * dy, c = 1.0 / area;
  const double cx = -1.0 / (dx * dx), cy = 1.0 / (dy * dy);
  const auto viscosity = [&](int i2, int j2) {  // at (i2/2, j2/2) spacings
    const double part = covered(box, 0.5 * i2 * dx, 0.5 * j2 * dy, dx, dy);
    return std::pow(box.viscosity, 1.0 - part) * std::pow(box.drop_viscosity, part);
  };
  struct term {
    int unknown;
    double factor;
  };
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](double weight, std::initializer_list<term> terms) {
    for (const term& a : terms)
      for (const term& b : terms)
        if (a.unknown >= 0 && b.unknown >= 0) entries.emplace_back(a.unknown, b.unknown, weight * a.factor * b.factor);
  };
  const auto at = [&](int i, int j) { return psi.at(i, j); };
  for (int j = 0; j < Y.cells; ++j)
    for (int i = 0; i < X.cells; ++i)
      add(4.0 * viscosity(2 * i + 1, 2 * j + 1) * area,
          {{at(i, j), c}, {at(i + 1, j), -c}, {at(i, j + 1), -c}, {at(i + 1, j + 1), c}});
  for (int j = 0; j < Y.corners(); ++j) {
    for (int i = 0; i < X.corners(); ++i) {
      const bool wall_x = X.on_wall(i), wall_y = Y.on_wall(j);
      if (wall_x && wall_y) continue;
      const double eta = viscosity(2 * i, 2 * j);
      if (!wall_x && !wall_y) {
        add(eta * area, {{at(i, j), -2.0 * (cx + cy)},
                         {at(i - 1, j), cx},
                         {at(i + 1, j), cx},
                         {at(i, j - 1), cy},
                         {at(i, j + 1), cy}});
      } else if ((wall_x ? X : Y).walls == sides::no_slip) {
        const int inner = wall_x ? at(i == 0 ? 1 : i - 1, j) : at(i, j == 0 ? 1 : j - 1);
        add(0.5 * eta * area, {{inner, 2.0 * (wall_x ? cx : cy)}});
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(psi.unknowns, psi.unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

double fall_velocity(const drop_in_box& box, int cells) {
  const int rows = std::max(8, static_cast<int>(std::lround(cells * box.height / box.width)));
  const corners psi({cells, box.width / cells, box.left_right}, {rows, box.height / rows, box.floor_lid});
  const double dx = psi.X.spacing, dy = psi.Y.spacing, area = dx * dy;
  // Weight of the faces that v stands on; v = -(psi(i + 1, j) - psi(i, j))/dx.
  Eigen::VectorXd load = Eigen::VectorXd::Zero(psi.unknowns);
  double drop_area = 0.0;
  for (int j = 0; j < psi.Y.corners(); ++j) {
    for (int i = 0; i < cells; ++i) {
      const double c = covered(box, (i + 0.5) * dx, j * dy, dx, dy) * area;
      drop_area += c;
      if (const int a = psi.at(i, j); a >= 0) load[a] += c / dx;
      if (const int b = psi.at(i + 1, j); b >= 0) load[b] -= c / dx;
    }
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(dissipation(box, psi));
  if (factors.info() != Eigen::Success)
    foundation::fail_calculation("drop in a box: the matrix could not be factorised");
  // load . psi is the drop's volume flux upward; the force on it is -drho g.
  const Eigen::VectorXd flow = factors.solve(load);
  return box.density_difference * box.gravity * load.dot(flow) / drop_area;
}

double fall_velocity_extrapolated(const drop_in_box& box, int cells) {
  const double finer = fall_velocity(box, 2 * cells), change = finer - fall_velocity(box, cells);
  return finer + change / (box.viscosity == box.drop_viscosity ? 3.0 : 1.0);
}

}  // namespace tetsuame::theory
