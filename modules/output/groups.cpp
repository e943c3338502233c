#include <algorithm>
#include <array>
#include <output/groups.hpp>
#include <stdexcept>

namespace tetsuame::output {

namespace {

struct quantity {
  std::string_view name, unit, description;
  bool vector = false;
};

// Units of three dimensions; fewer have metres of depth in them (unit_in).
constexpr std::array quantities{
    quantity{"Coordinates", "m", "position", true},
    quantity{"Velocities", "m/s", "velocity", true},
    quantity{"Masses", "kg", "mass; in fewer than three dimensions for each metre of depth"},
    quantity{"Density", "kg/m^3", "mass density"},
    quantity{"Pressure", "Pa", "pressure in the forces; in convection beyond that of the conductive state"},
    quantity{"Temperature", "K", "temperature; 0 in an ideal gas, which is given by its internal energy"},
    quantity{"SmoothingLength", "m",
             "h of the kernel, whose support has the radius KernelSupport h (in Header; GADGET: h is that radius)"},
    quantity{
        "Material", "1",
        "number of the material, whose name `names` has; of two liquids 1 is the denser one of the start, or the drop"},
    quantity{"Volume", "m^3", "volume element"},
    quantity{"Weight", "J", "weight Y = p dV of density-independent SPH"},
    quantity{"PressureEOS", "Pa", "pressure straight from the equation of state"},
    quantity{"SoundSpeed", "m/s", "adiabatic sound speed"},
    quantity{"InternalEnergy", "J/kg", "specific internal energy"},
    quantity{"GravitationalPotential", "J/kg", "of the own gravity of all particles"},
    quantity{"InternalEnergyGain", "J/kg", "specific internal energy gained since the start"},
    quantity{"Viscosity", "Pa s", "dynamic viscosity"},
    quantity{"ArtificialViscosity", "1", "coefficient alpha of the artificial viscosity"},
    quantity{"Concentration", "1", "of the element, amount for each mass"},
    quantity{"MeltFraction", "1", "liquid part of what melts; 0 in the metal"},
    quantity{"FreeSurface", "1", "1 on the free surface of water, 0 within"},
    quantity{"Zone", "1", "number of the inflow in whose zone it is, -1, -2, ... of outflows; 0: it moves by itself"},
    quantity{"Radius", "m", "of a grain"},
    quantity{"Spin", "1/s", "angular velocity of a grain", true},
    quantity{"AngularVelocity", "1/s", "angular velocity of a grain in the plane"},
    quantity{"CoordinationNumber", "1", "contacts of a grain"},
    quantity{"Displacement", "m", "position less start position", true},
    quantity{"DensityReference", "kg/m^3", "mass density of the exact solution here, or of the start at rest"},
    quantity{"PressureReference", "Pa", "pressure of the exact solution here"},
    quantity{"VelocitiesReference", "m/s", "velocity of the exact solution here", true},
};

// "kg" in three dimensions is "kg/m" in two and "kg/m^2" in one; "m^3" is "m^2" and "m".
std::string unit_in(int dimension, std::string_view unit) {
  std::string text(unit);
  if (dimension == 3) return text;
  if (unit == "m^3") return dimension == 2 ? "m^2" : "m";
  if (unit == "kg" || unit == "J") text += dimension == 2 ? "/m" : "/m^2";
  return text;
}

}  // namespace

std::optional<quantity_info> find_quantity(std::string_view name, int dimension) {
  const auto* q = std::ranges::find(quantities, name, &quantity::name);
  if (q == quantities.end()) return {};
  return quantity_info{unit_in(dimension, q->unit), q->vector};
}

void add_quantity(particle_group& g, std::string_view name, std::vector<const double*> components) {
  const auto* q = std::ranges::find(quantities, name, &quantity::name);
  if (q == quantities.end()) throw std::logic_error("no quantity " + std::string(name) + " in the table");
  g.columns.push_back({std::string(name), unit_in(g.dimension, q->unit), std::string(q->description),
                       std::move(components), q->vector, name == "Material"});
}

}  // namespace tetsuame::output
