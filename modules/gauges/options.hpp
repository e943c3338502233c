// Points that read fields of the fluid, in any problem of particles (docs/theory/gauges.md): group &gauges.
//
//   &gauges
//     point = 'above', 'below'  point_x = 1e5, 1e5  point_y = 3e5, 7e4  point_fields = 'Pressure', 'Velocities'
//   /
#pragma once

#include <domain/options.hpp>
#include <functional>
#include <output/history.hpp>

namespace tetsuame::gauges {

using places = std::array<std::vector<double>, 3>;  // m, x, y and z of each

struct options {
  std::vector<std::string> name;    // one a point; none: their numbers
  places place;                     // of the points
  std::vector<std::string> fields;  // of snapshots, read at each point

  std::size_t number() const { return place[0].size(); }
  bool any() const { return number() > 0; }
  std::string name_of(std::size_t n) const { return name.empty() ? std::to_string(n + 1) : name[n]; }
  std::array<double, 3> at(std::size_t n) const {  // m; 0 along axes that the box lacks
    std::array<double, 3> x{};
    for (std::size_t a = 0; a < 3 && !place[a].empty(); ++a) x[a] = place[a][n];
    return x;
  }
};

void declare(namelist::schema& schema, options& o);
// known: what snapshots of the problem have. Fails with exit 2, placed at a key.
void resolve(const namelist::schema& schema, options& o, const domain::options& box,
             const std::vector<std::string>& known);
// Refuses a point of which why(place) says why it cannot be there; empty: it can.
void refuse_points(const namelist::schema& schema, const options& o,
                   const std::function<std::string(const std::array<double, 3>& place)>& why);

// A key of this axis: what, with x, y or z.
std::string along(const std::string& what, std::size_t axis);
// Places with the keys along(what, axis): as many along each of these axes, as far as the box has them, and all in it.
// names: for messages; none: their numbers.
void check_places(const namelist::schema& schema, const domain::options& box, const std::string& what, const places& of,
                  std::initializer_list<std::size_t> axes, const std::vector<std::string>& names);

// Of what the points read, in the order of read() (points.hpp): pressure_above, velocities_above_x, …
std::vector<output::history_column> columns(const options& o, int dimension);

}  // namespace tetsuame::gauges
