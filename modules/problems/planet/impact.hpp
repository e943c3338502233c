// Initial condition of a planetary impact from two snapshots of settled bodies, and classification of its remnants.
#pragma once

#include <gas/setups.hpp>
#include <string>
#include <vector>

namespace tetsuame::planet {

struct impact_options {
  std::string target, impactor;         // snapshots
  double speed = 1.0;                   // at contact, of the mutual escape velocity
  double impact_parameter = 0.0;        // sine of the angle between velocity and line of centres at contact
  double time_before_contact = 3600.0;  // s
  std::optional<double> target_radius, impactor_radius;  // m
  bool is_asked_for() const { return !target.empty() || !impactor.empty(); }
};

// A settled body. Places and velocities of its particles are relative to its centre of mass.
struct body {
  std::vector<gas::placed> particles;
  double mass, radius;  // kg, m
};
// Reads a snapshot on every rank; `place` begins the messages of its errors. The radius is the mean distance of the
// outermost hundredth of the particles plus half their spacing. Throws bad input for a snapshot of another program, or
// one that run/start_file.hpp refuses.
body read_body(const std::string& path, const std::string& place, std::int32_t materials);

// The Kepler orbit of two point masses, followed back from contact. There the centres are R = R_1 + R_2 apart and the
// impactor has, relative to the target, the place R (cos θ, sin θ, 0) and the velocity (-v, 0, 0), with sin θ the
// impact parameter. The error of place and velocity is about 1e-10. Throws bad input where the centres are less than R
// apart at the start.
struct encounter {
  gas::point place, velocity;             // m, m/s, of the impactor relative to the target, at the start
  double escape_velocity, contact_speed;  // m/s
};
encounter before_contact(const impact_options& o, const body& target, const body& impactor);

// The particles of both bodies, the target's first, with their common centre of mass at rest at `centre` (m).
std::vector<gas::placed> meet(const body& target, const body& impactor, const encounter& e, const gas::point& centre);

// Classifies particles by their orbits about the planet [R. M. Canup et al., Icarus 150, 288 (2001)]. A particle within
// R belongs to the planet. Beyond R it escapes if v²/2 >= GM/r; otherwise it belongs to the disk if the circular orbit
// of its angular momentum h lies outside of the planet, h²/(GM) > R, and to the planet if not. M is the mass of the
// planet's particles, and R the radius of M at the target's mean density; both are iterated until M changes by less
// than 1e-6. Collective; the result does not depend on the number of ranks.
struct remnants {
  struct part {
    double mass = 0.0, metal = 0.0, of_impactor = 0.0;  // kg
    double angular_momentum = 0.0;                      // kg m²/s, about the planet's centre, its size
  };
  part planet, disk, escaping;
  double planet_radius = 0.0;  // m
};
remnants find_remnants(const gas::view& all, const body& target, std::int32_t metal);

}  // namespace tetsuame::planet
