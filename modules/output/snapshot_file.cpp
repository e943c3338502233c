#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <output/snapshot_file.hpp>

namespace tetsuame::output {

namespace {

// What files say of a unit: where, by which name, and how much of SI it is in (cgs).
struct stated_unit {
  std::vector<const char*> names;
  double si;
};
const stated_unit of_length{{"Unit length in cgs (U_L)", "UnitLength_in_cm", "UnitLength_In_CGS"}, 1e-2};
const stated_unit of_mass{{"Unit mass in cgs (U_M)", "UnitMass_in_g", "UnitMass_In_CGS"}, 1e-3};
const stated_unit of_time{{"Unit time in cgs (U_t)", "UnitTime_in_s"}, 1.0};
const stated_unit of_velocity{{"UnitVelocity_in_cm_per_s", "UnitVelocity_In_CGS"}, 1e-2};
const stated_unit of_temperature{{"Unit temperature in cgs (U_T)"}, 1.0};

// What SWIFT's snapshots call a field; its files of a start have GADGET's names.
constexpr std::array<std::pair<std::string_view, const char*>, 5> swift_names{
    {{"Density", "Densities"},
     {"InternalEnergy", "InternalEnergies"},
     {"Pressure", "Pressures"},
     {"Temperature", "Temperatures"},
     {"SmoothingLength", "SmoothingLengths"}}};

constexpr std::array factors_to_cgs{"to_cgs", "Conversion factor to CGS (not including cosmological corrections)",
                                    "CGSConversionFactor"};

}  // namespace

snapshot_file::snapshot_file(const std::string& path, std::string place)
    : place_(std::move(place)), file_(path), datasets_(file_.datasets(fluid)) {
  check_layout();
  check_header();
  check_shapes();
}

void snapshot_file::fail(const std::string& what) const { foundation::fail_input(place_ + file_.path() + what); }

std::optional<std::vector<double>> snapshot_file::numbers(const std::string& object, const std::string& name) const {
  const auto found = file_.attribute(object, name);
  if (!found) return {};
  if (found->numbers.empty()) fail(fmt::format(": {}/{} holds no numbers", object, name));
  for (const double value : found->numbers)
    if (!std::isfinite(value)) fail(fmt::format(": {}/{} is {}", object, name, value));
  return found->numbers;
}

std::optional<double> snapshot_file::number(const std::string& object, const std::string& name) const {
  const auto found = numbers(object, name);
  if (!found) return {};
  if (found->size() != 1) fail(fmt::format(": {}/{} is not one number", object, name));
  return found->front();
}

void snapshot_file::check_layout() const {
  if (file_.has_group(fluid)) return;
  const bool of_phantom = !file_.datasets("particles").empty();
  fail(fmt::format(" has no group {}: expected a snapshot in GADGET's layout{}", fluid,
                   of_phantom ? ", and this looks like a dump of Phantom: tetsuame.write_snapshot of Python writes one "
                                "of its particles"
                              : ""));
}

void snapshot_file::check_header() const {
  if (const auto n = number("Header", "NumFilesPerSnapshot"); n && *n > 1.0)
    fail(fmt::format(" is one of {} files of a snapshot: expected one file", *n));
  const double hubble = number("Header", "HubbleParam").value_or(1.0);
  if (hubble != 0.0 && hubble != 1.0)
    fail(fmt::format(": HubbleParam is {}, and lengths in units of 1/h are not read: expected 0 or 1", hubble));
  const bool expands = number("Cosmology", "Cosmological run").value_or(0.0) != 0.0;
  if (const double z = number("Header", "Redshift").value_or(0.0); z != 0.0 || expands)
    fail(fmt::format(" is of an expanding universe (redshift {}), whose comoving units are not read", z));
  // Those of this program's walls are no fluid.
  for (int type = is_of_this_program() ? 2 : 1; type < 6; ++type)
    for (const auto& d : file_.datasets(fmt::format("PartType{}", type)))
      if (!d.shape.empty() && d.shape[0] > 0)
        fail(fmt::format(": PartType{} holds {} particles, and only gas, PartType0, is read", type, d.shape[0]));
}

void snapshot_file::expect_sound(const char* name) const {
  const auto d = find(name);
  if (!d) return;
  if (d->holds == stored_dataset::content::elsewhere)
    fail(fmt::format(": {}/{} lies in another file, or nowhere: links out of a file are not followed", fluid, d->name));
  if (!d->is_of_numbers()) fail(fmt::format(": {}/{} is not of numbers", fluid, d->name));
  if (d->shape.empty()) fail(fmt::format(": {}/{} is one value: expected one for each particle", fluid, d->name));
  if (particles_ != 0 && d->shape[0] != particles_)
    fail(fmt::format(": {}/{} has {} rows, and {} {}", fluid, d->name, d->shape[0], first_, particles_));
}

void snapshot_file::check_shapes() {
  for (const char* name :
       {"Coordinates", "ParticleIDs", "Velocities", "Density", "Masses", "Temperature", "Material"}) {
    const auto d = find(name);
    expect_sound(name);
    if (!d || !first_.empty()) continue;
    first_ = d->name;
    particles_ = d->shape[0];
  }
  if (first_.empty()) fail(fmt::format(": {} has no field Coordinates", fluid));
  const auto told = numbers("Header", "NumPart_ThisFile");
  if (told && told->front() != static_cast<double>(particles_))
    fail(fmt::format(": Header/NumPart_ThisFile says {} particles, and {}/{} has {}", told->front(), fluid, first_,
                     particles_));
}

bool snapshot_file::is_of_this_program() const { return file_.attribute("Provenance", "Program").has_value(); }

std::optional<int> snapshot_file::dimension() const {
  const auto found = number("Header", "Dimension");
  if (!found) return {};
  if (*found != 1.0 && *found != 2.0 && *found != 3.0) fail(fmt::format(": Header/Dimension is {}", *found));
  return static_cast<int>(*found);
}

std::optional<stored_dataset> snapshot_file::find(std::string_view name, const std::string& group) const {
  const auto of = group == fluid ? datasets_ : file_.datasets(group);
  auto found = std::ranges::find(of, name, &stored_dataset::name);
  const auto other = std::ranges::find(swift_names, name, [](const auto& pair) { return pair.first; });
  if (found == of.end() && group == fluid && other != swift_names.end())
    found = std::ranges::find(of, other->second, &stored_dataset::name);
  return found == of.end() ? std::nullopt : std::optional(*found);
}

snapshot_file::box snapshot_file::of_box() const {
  box b{numbers("Header", "BoxLengths"), numbers("Header", "BoxSize")};
  if (!b.size) return b;
  const auto system = system_factor(length);
  const double factor = system ? *system : factor_of(std::string(fluid) + "/Coordinates", length);
  for (double& edge : *b.size) edge *= factor;
  return b;
}

std::optional<double> snapshot_file::system_factor(const std::array<int, 4>& powers) const {
  const auto find_unit = [&](const stated_unit& u) -> std::optional<double> {
    for (const char* object : {"Units", "Parameters", "Header"})
      for (const char* name : u.names)
        if (const auto found = number(object, name)) {
          if (!(*found > 0.0)) fail(fmt::format(": {}/{} is {}", object, name, *found));
          return *found * u.si;
        }
    return {};
  };
  auto L = find_unit(of_length), M = find_unit(of_mass), T = find_unit(of_time), K = find_unit(of_temperature);
  if (const auto v = find_unit(of_velocity); v && L && !T) T = *L / *v;
  if (!K) K = 1.0;
  double factor = 1.0;
  const std::array units{L, M, T, K};
  for (std::size_t k = 0; k < units.size(); ++k) {
    if (powers[k] == 0) continue;
    if (!units[k]) return {};
    factor *= std::pow(*units[k], powers[k]);
  }
  return factor;
}

double snapshot_file::factor_of(const std::string& dataset, const std::array<int, 4>& powers) const {
  if (const auto text = file_.attribute(dataset, "units"); text && !text->text.value_or("").empty()) {
    const auto found = unit_of(*text->text);
    if (!found)
      fail(fmt::format(": the units of {}, '{}', are not known: expected {}", dataset, *text->text, name_of(powers)));
    if (found->powers != powers)
      fail(fmt::format(": {} is in {}: expected {}, or another unit of that", dataset, *text->text, name_of(powers)));
    return found->factor;
  }
  for (const char* name : factors_to_cgs)
    if (const auto factor = number(dataset, name); factor && *factor > 0.0) {
      // Of a mass in fewer than three dimensions the depth is one of the file's units of length.
      const int missing = powers[1] == 1 && powers[0] > -3 ? -powers[0] : 0;
      double depth = 1.0;
      if (missing > 0) depth = std::pow(factor_of(std::string(fluid) + "/Coordinates", length), missing);
      return *factor * std::pow(1e-2, powers[0] + missing) * std::pow(1e-3, powers[1]) / depth;
    }
  if (const auto factor = system_factor(powers)) return *factor;
  fail(
      fmt::format(": {} says no unit: expected its attribute `units` ('{}', or another), or UnitLength_in_cm, "
                  "UnitMass_in_g and UnitVelocity_in_cm_per_s in Header",
                  dataset, name_of(powers)));
}

std::vector<double> snapshot_file::read(const std::string& group, const std::string& name,
                                        const std::array<int, 4>& powers) const {
  const auto stored = find(name, group);
  const auto dataset = group + "/" + (stored ? stored->name : name);
  const double factor = factor_of(dataset, powers);
  auto values = file_.reals(dataset);
  if (factor != 1.0)
    for (double& value : values) value *= factor;
  return values;
}

std::optional<double> snapshot_file::mass_of_all(int dimension) const {
  const auto table = numbers("Header", "MassTable");
  if (!table || !(table->front() > 0.0)) return {};
  const auto factor = system_factor(mass(dimension));
  if (!factor) fail(": Header/MassTable has no unit: expected UnitLength_in_cm and UnitMass_in_g in Header");
  return table->front() * *factor;
}

stored_file::integers snapshot_file::identities() const {
  return file_.whole_numbers(std::string(fluid) + "/ParticleIDs");
}

std::vector<double> snapshot_file::plain(const std::string& name) const {
  return file_.reals(std::string(fluid) + "/" + name);
}

std::vector<std::string> snapshot_file::names_of(const std::string& name) const {
  const auto read = file_.attribute(std::string(fluid) + "/" + name, "names");
  std::string rest = read ? read->text.value_or("") : "";
  std::vector<std::string> all;
  constexpr std::string_view between = ", ";
  while (!rest.empty()) {
    const auto end = std::min(rest.find(between), rest.size());
    all.push_back(rest.substr(0, end));
    rest.erase(0, end + between.size());
  }
  return all;
}

}  // namespace tetsuame::output
