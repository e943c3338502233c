#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <run/start_file.hpp>

namespace tetsuame::run::detail {

std::vector<std::size_t> rows_of_file(const start_options& o, int dimension, std::int64_t particles,
                                      const std::vector<std::string>& fields) {
  const auto fail = [&](const std::string& what) { foundation::fail_input(o.place + o.file + what); };
  const auto datasets = output::list_datasets(o.file, "PartType0");
  const auto find = [&](const std::string& name) {
    return std::ranges::find_if(datasets, [&](const auto& d) { return d.name == name; });
  };
  std::vector<std::string> lacking;
  for (const auto& name : fields)
    if (find(name) == datasets.end()) lacking.push_back(name);
  if (find("ParticleIDs") == datasets.end()) lacking.emplace_back("ParticleIDs");
  if (!lacking.empty()) fail(fmt::format(" has no field {}", fmt::join(lacking, ", ")));
  const double of_file = output::read_real_attribute(o.file, "Header", "Dimension");
  if (of_file != dimension) fail(fmt::format(" has {} dimensions, and the box {}", of_file, dimension));

  const auto ids = output::read_reals(o.file, "PartType0/ParticleIDs");
  if (static_cast<std::int64_t>(ids.size()) != particles)
    fail(fmt::format(" holds {} particles, and the box {}", ids.size(), particles));
  for (const auto& name : fields)
    if (const auto& shape = find(name)->shape; shape.empty() || shape[0] != ids.size() ||
                                               (shape.size() > 1 && shape[1] < static_cast<std::uint64_t>(dimension)))
      fail(fmt::format(": field {} is not of {} particles in {} dimensions", name, particles, dimension));
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> row(ids.size(), none);
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const auto id = static_cast<std::size_t>(std::clamp(ids[k], 0.0, 1e15));
    if (id >= row.size() || row[id] != none)
      fail(fmt::format(": the particles' IDs are not those of a box of {}", particles));
    row[id] = k;
  }
  return row;
}

}  // namespace tetsuame::run::detail
