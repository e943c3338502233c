#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <run/start_checks.hpp>
#include <run/start_file.hpp>

namespace tetsuame::run {

namespace {

using output::snapshot_file;

// Times the room that there is: 1 in fluid in order and some percent more in disorder, 2 where it lies twice.
constexpr double overlapping = 1.6;

std::string text_of(std::vector<double> lengths) { return fmt::format("{:.9g} m", fmt::join(lengths, " x ")); }

// Whether these are the edges of the box, to what single precision keeps of them.
bool is_box(const std::vector<double>& lengths, const start_box& box) {
  if (lengths.size() < static_cast<std::size_t>(box.dimension)) return false;
  for (std::size_t a = 0; a < static_cast<std::size_t>(box.dimension); ++a)
    if (!(std::abs(lengths[a] - box.length[a]) <= 1e-6 * box.length[a])) return false;
  return true;
}

// Kernel and walls are of the spacing of &domain: with another one sums err, and what stands behind walls does not fit.
void check_spacing(const start_file& file, const start_box& box, const std::vector<double>& volumes) {
  constexpr double most = 1.5;  // of the volumes, on the mean
  double mean = 0.0;
  for (const double V : volumes) mean += V / static_cast<double>(volumes.size());
  const double spacing = std::pow(mean, 1.0 / box.dimension), ratio = mean / std::pow(box.dx, box.dimension);
  if (ratio >= 1.0 / most && ratio <= most) return;
  file.fail(fmt::format(
      " holds {} particles with a spacing of {:.6g} m on the mean, beside {:.6g} m of &domain, of which kernel "
      "and walls are: expected particles_x = {} or so",
      file.particles(), spacing, box.dx, std::llround(box.length[0] / spacing)));
}

}  // namespace

start_file::start_file(const start_options& o, const start_box& box, const std::vector<std::string>& fields)
    : file_(o.file, o.place), box_(box) {
  check_fields(fields);
  check_dimension();
  if (file_.particles() == 0) fail(" holds no particles");
  for (const auto& name : fields)
    if (file_.find(name)) columns_of(name);
  check_box();
  order_by_id();
}

void start_file::check_fields(const std::vector<std::string>& fields) const {
  std::vector<std::string> lacking;
  for (const auto& name : fields)
    if (!file_.find(name) && !(name == "Masses" && file_.mass_of_all(box_.dimension))) lacking.push_back(name);
  if (!file_.find("ParticleIDs")) lacking.emplace_back("ParticleIDs");
  if (lacking.empty()) return;
  const bool by_energy = std::ranges::find(lacking, "Temperature") != lacking.end() && file_.find("InternalEnergy");
  if (std::ranges::find(lacking, "Material") != lacking.end() && file_.find("MaterialIDs"))
    fail(": its MaterialIDs are those of SWIFT's equations of state: expected a field Material, 0 or 1");
  fail(fmt::format(
      " has no field {}{}", fmt::join(lacking, ", "),
      by_energy ? ": InternalEnergy does not stand for it, as energies begin at another zero elsewhere" : ""));
}

// As its attribute says, or its rows.
void start_file::check_dimension() const {
  const auto of_file = file_.dimension();
  if (of_file && *of_file != box_.dimension)
    fail(fmt::format(" has {} dimensions, and the box {}", *of_file, box_.dimension));
}

// How many components a row has; it must have those that the box needs.
std::size_t start_file::columns_of(const std::string& name) const {
  const auto shape = file_.find(name)->shape;
  const bool vector = name == "Coordinates" || name == "Velocities";
  const std::size_t columns = shape.size() < 2 ? 1 : shape[1], D = static_cast<std::size_t>(box_.dimension);
  if (shape.size() > 2 || (vector ? columns != D && columns != 3 : columns != 1))
    fail(fmt::format(": {} is of {}, and not of {} particles in {} dimensions", name, fmt::join(shape, " x "),
                     file_.particles(), box_.dimension));
  return columns;
}

void start_file::check_box() const {
  const auto of_file = file_.of_box();
  const std::vector<double> wanted(box_.length.begin(), box_.length.begin() + box_.dimension);
  const auto refuse = [&](const char* name, const std::vector<double>& found, const char* more) {
    fail(fmt::format(" is of another box: its {} {} {}, and &domain's {}{}", name, found.size() == 1 ? "is" : "are",
                     text_of(found), text_of(wanted), more));
  };
  if (!of_file.lengths && !of_file.size)
    fail(": Header has neither BoxSize nor BoxLengths, so that its box is not known");
  if (of_file.lengths && !is_box(*of_file.lengths, box_))
    refuse("BoxLengths", *of_file.lengths, " (BoxLengths are in m, BoxSize in the file's unit of length)");
  if (!of_file.size) return;
  auto size = *of_file.size;
  const double longest = *std::ranges::max_element(wanted);
  const bool fits = size.size() == 1 ? std::abs(size[0] - longest) <= 1e-6 * longest : is_box(size, box_);
  if (!fits) refuse("BoxSize", size, "");
}

void start_file::order_by_id() {
  const auto d = file_.find("ParticleIDs");
  if (d->holds != output::stored_dataset::content::integers || d->shape.size() > 2 ||
      (d->shape.size() == 2 && d->shape[1] != 1))
    fail(": ParticleIDs are not one whole number for each particle");
  auto [values, are_signed] = file_.identities();
  for (std::size_t k = 0; are_signed && k < values.size(); ++k)
    if (static_cast<std::int64_t>(values[k]) < 0)
      fail(fmt::format(": the particle in row {} has the ID {}, below 0", k, static_cast<std::int64_t>(values[k])));
  row_.resize(values.size());
  std::iota(row_.begin(), row_.end(), std::size_t{0});
  std::ranges::sort(row_, {}, [&](std::size_t k) { return std::pair(values[k], k); });
  ids_.reserve(values.size());
  for (const std::size_t k : row_) ids_.push_back(values[k]);
  for (std::size_t n = 1; n < ids_.size(); ++n)
    if (ids_[n] == ids_[n - 1])
      fail(fmt::format(": the particles in rows {} and {} have the same ID, {}", row_[n - 1], row_[n], ids_[n]));
}

std::string start_file::message_at(std::size_t number, const std::string& what) const {
  return fmt::format(": particle {}: {}", ids_[number], what);
}
void start_file::fail_at(std::size_t number, const std::string& what) const { fail(message_at(number, what)); }

std::vector<double> start_file::numbers(const char* name, const std::array<int, 4>& powers) const {
  file_.expect_sound(name);
  columns_of(name);
  const auto values = file_.read(snapshot_file::fluid, name, powers);
  std::vector<double> all(row_.size());
  for (std::size_t n = 0; n < all.size(); ++n) {
    all[n] = values[row_[n]];
    if (!std::isfinite(all[n])) fail_at(n, fmt::format("its {} is {}", name, all[n]));
  }
  return all;
}

// beyond_is_zero: along an axis that the box does not have; else it is to be the same for all.
std::vector<double> start_file::vectors(const char* name, const std::array<int, 4>& powers, bool beyond_is_zero) const {
  const auto values = file_.read(snapshot_file::fluid, name, powers);
  const std::size_t D = static_cast<std::size_t>(box_.dimension), columns = columns_of(name);
  std::vector<double> all(D * row_.size());
  for (std::size_t n = 0; n < row_.size(); ++n) {
    const double* of = &values[columns * row_[n]];
    for (std::size_t a = 0; a < columns; ++a) {
      if (!std::isfinite(of[a])) fail_at(n, fmt::format("its {} along {} are {}", name, "xyz"[a], of[a]));
      if (a < D) all[D * n + a] = of[a];
      if (a >= D && of[a] != (beyond_is_zero ? 0.0 : values[a]))
        fail_at(n, fmt::format("its {} along {} are {:.9g}, and the box has {} dimensions", name, "xyz"[a], of[a], D));
    }
  }
  return all;
}

std::vector<double> start_file::places() const {
  auto x = vectors("Coordinates", snapshot_file::length, false);
  const std::size_t D = static_cast<std::size_t>(box_.dimension);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t a = k % D;
    const double L = box_.length[a], beyond = box_.periodic[a] ? box_.dx : 0.0;
    if ((x[k] < -beyond && !box_.open[a][0]) || (x[k] > L + beyond && !box_.open[a][1]))
      fail_at(k / D, fmt::format("it lies at {} = {:.9g} m, outside the box, 0 to {:.9g} m", "xyz"[a], x[k], L));
    if (!box_.periodic[a]) continue;
    // As far as a particle comes between two lists; snapshots of older versions have it there.
    if (x[k] < 0.0) x[k] += L;
    if (x[k] >= L) x[k] -= L;
  }
  check_apart(x);
  return x;
}

// Two particles at one place feel the same forces and stay together for good; rounding aside, so do those so near.
void start_file::check_apart(const std::vector<double>& x) const {
  const auto found = find_coincident({box_.dimension, box_.length, box_.periodic}, x, 1e-6 * box_.dx);
  if (found)
    fail(fmt::format(": particles {} and {} lie at the same place, {}, and would never part", ids_[found->first],
                     ids_[found->second], place_text(x, found->first)));
}

std::string start_file::place_text(const std::vector<double>& places, std::size_t number) const {
  const auto D = static_cast<std::ptrdiff_t>(box_.dimension);
  const auto begin = places.begin() + D * static_cast<std::ptrdiff_t>(number);
  return fmt::format("({:.9g}) m", fmt::join(begin, begin + D, ", "));
}

void start_file::check_packing(const std::vector<double>& places, const std::vector<double>& volumes) const {
  constexpr double spacings =
      3.0;  // a cell's edge at least: a disturbed lattice has no more than (4/3)^D too many there
  const std::size_t D = static_cast<std::size_t>(box_.dimension);
  std::array<std::size_t, 3> cells{1, 1, 1};
  double cell = 1.0;  // m^D
  for (std::size_t a = 0; a < D; ++a) {
    cells[a] = static_cast<std::size_t>(std::max(1.0, std::floor(box_.length[a] / (spacings * box_.dx))));
    cell *= box_.length[a] / static_cast<double>(cells[a]);
  }
  std::vector<double> filled(cells[0] * cells[1] * cells[2], 0.0);
  std::vector<std::size_t> first(filled.size(), volumes.size());  // particle of each cell
  for (std::size_t n = 0; n < volumes.size(); ++n) {
    std::size_t c = 0;
    for (std::size_t a = D; a-- > 0;) {
      const double at = places[D * n + a] / box_.length[a] * static_cast<double>(cells[a]);
      c = c * cells[a] + std::min(cells[a] - 1, static_cast<std::size_t>(std::max(0.0, at)));
    }
    filled[c] += volumes[n];
    first[c] = std::min(first[c], n);
  }
  const auto fullest = static_cast<std::size_t>(std::ranges::max_element(filled) - filled.begin());
  if (filled[fullest] > far_off * cell)
    fail(
        fmt::format(": the particles about particle {} have a volume of {:.6g} m^{} together, in a place of {:.6g}: "
                    "Coordinates are of another unit, or another box",
                    ids_[first[fullest]], filled[fullest], D, cell));
}

std::vector<double> start_file::velocities() const { return vectors("Velocities", snapshot_file::velocity, true); }

std::vector<double> start_file::densities() const {
  auto rho = numbers("Density", snapshot_file::density);
  for (std::size_t n = 0; n < rho.size(); ++n)
    if (!(rho[n] > 0.0)) fail_at(n, fmt::format("its Density is {:.6g} kg/m^3, and not above 0", rho[n]));
  return rho;
}

std::vector<double> start_file::masses() const {
  const auto powers = snapshot_file::mass(box_.dimension);
  if (!file_.find("Masses")) return std::vector<double>(row_.size(), *file_.mass_of_all(box_.dimension));
  auto m = numbers("Masses", powers);
  for (std::size_t n = 0; n < m.size(); ++n)
    if (!(m[n] > 0.0)) fail_at(n, fmt::format("its mass is {:.6g} {}, and not above 0", m[n], output::name_of(powers)));
  return m;
}

std::vector<double> start_file::temperatures(bool above_0) const {
  auto T = numbers("Temperature", snapshot_file::temperature);
  for (std::size_t n = 0; above_0 && n < T.size(); ++n)
    if (!(T[n] > 0.0)) fail_at(n, fmt::format("its Temperature is {:.6g} K, and not above 0", T[n]));
  return T;
}

std::vector<double> start_file::energies() const { return numbers("InternalEnergy", snapshot_file::energy); }

std::vector<double> start_file::concentrations() const {
  auto c = numbers("Concentration", {});
  for (std::size_t n = 0; n < c.size(); ++n)
    if (c[n] < 0.0) fail_at(n, fmt::format("its Concentration is {:.6g}, and below 0", c[n]));
  return c;
}

std::vector<double> start_file::pressures() const { return numbers("Pressure", snapshot_file::pressure); }

void start_file::expect_at_rest(const std::vector<double>& velocities) const {
  const std::size_t D = static_cast<std::size_t>(box_.dimension);
  for (std::size_t k = 0; k < velocities.size(); ++k)
    if (velocities[k] != 0.0)
      fail_at(k / D,
              fmt::format("its velocity along {} is {:.6g} m/s, and what is settled starts at rest (&initial settle)",
                          "xyz"[k % D], velocities[k]));
}

void start_file::check_neighbours(const std::vector<double>& places, const std::vector<double>& volumes,
                                  const std::vector<double>& reach, bool and_overlap) const {
  if (and_overlap) check_spacing(*this, box_, volumes);
  const auto found = find_neighbourhoods({box_.dimension, box_.length, box_.periodic}, places, volumes, reach);
  for (std::size_t n = 0; n < volumes.size(); ++n)
    if (!std::isfinite(found.nearest[n]))
      fail_at(n, fmt::format("it has no neighbour within {:.6g} m, as far as the kernel reaches, at {}", reach[n],
                             place_text(places, n)));
  const auto fullest = std::ranges::max_element(found.filled);
  if (and_overlap && *fullest > overlapping) {
    const auto n = static_cast<std::size_t>(fullest - found.filled.begin());
    fail_at(
        n, fmt::format("it and the particles about it take up {:.3g} times the room that there is, at {}: they overlap",
                       *fullest, place_text(places, n)));
  }
}

std::vector<std::int32_t> start_file::materials(std::int32_t number, const std::vector<std::string>& names,
                                                std::int32_t own) const {
  std::vector<std::int32_t> all(row_.size(), 0);
  if (number == 1 && !file_.find("Material")) return all;
  file_.expect_sound("Material");
  columns_of("Material");
  const auto values = file_.plain("Material");
  const auto called = names.empty() ? std::vector<std::string>{} : file_.names_of("Material");
  for (std::size_t n = 0; n < all.size(); ++n) {
    const double m = values[row_[n]];
    const bool is_number = m >= 0.0 && m == std::floor(m);
    if (is_number && m < static_cast<double>(called.size())) {
      const auto& name = called[static_cast<std::size_t>(m)];
      if (const auto known = std::ranges::find(names, name); known != names.end()) {
        all[n] = static_cast<std::int32_t>(known - names.begin());
        continue;
      }
      if (m >= own)
        fail_at(n, fmt::format("its Material {} is '{}', and the input has '{}'", m, name, fmt::join(names, "', '")));
    }
    if (!is_number || m >= number)
      fail_at(n, fmt::format("its Material is {}: expected {}", m,
                             number == 1     ? "0"
                             : number == 2   ? "0 or 1"
                             : names.empty() ? fmt::format("0 to {}", number - 1)
                                             : fmt::format("0 to {} ('{}')", number - 1, fmt::join(names, "', '"))));
    all[n] = static_cast<std::int32_t>(m);
  }
  return all;
}

}  // namespace tetsuame::run
