#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <output/agree.hpp>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <output/series.hpp>

namespace tetsuame::output {

namespace {

series_entry describe(const std::string& directory, const std::string& file) {
  const auto path = (std::filesystem::path(directory) / file).string();
  series_entry entry{file, read_real_attribute(path, "/Header", "Time"), {}};
  const auto top = list_datasets(path, "/");
  for (const int type : {0, 1}) {
    auto datasets = list_datasets(path, fmt::format("/PartType{}", type));
    if (datasets.empty()) continue;
    const auto name = fmt::format("Connectivity{}", type);
    const auto numbers = std::find_if(top.begin(), top.end(), [&](const stored_dataset& d) { return d.name == name; });
    if (numbers == top.end()) foundation::fail_file(fmt::format("cannot read {}: /{} is missing", path, name));
    entry.groups.push_back({type, std::move(datasets), numbers->bytes_per_value});
  }
  return entry;
}

std::string data_item(const std::string& place, const stored_dataset& d) {
  std::string dimensions;
  for (const auto n : d.shape) dimensions += (dimensions.empty() ? "" : " ") + std::to_string(n);
  return fmt::format(R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}">{}</DataItem>)",
                     d.integer ? "Int" : "Float", d.bytes_per_value, dimensions, place);
}

std::string attribute_text(const std::string& folder, const stored_dataset& d) {
  const std::uint64_t width = d.shape.size() < 2 ? 1 : d.shape[1];
  return fmt::format("          <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", d.name,
                     width == 1   ? "Scalar"
                     : width == 3 ? "Vector"
                                  : "Matrix",
                     data_item(folder + d.name, d));
}

std::string grid_text(const std::string& file, const series_group& group) {
  const auto folder = fmt::format("{}:/PartType{}/", file, group.type);
  std::string geometry, values;
  std::uint64_t n = 0;
  for (const auto& d : group.datasets) {
    if (d.shape.empty()) continue;
    n = d.shape[0];
    if (d.name == "Coordinates")
      geometry = fmt::format("          <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", data_item(folder + d.name, d));
    else
      values += attribute_text(folder, d);
  }
  const stored_dataset numbers{"", true, group.connectivity_bytes, {n, 1}};
  return fmt::format(
      "        <Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "          <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\">{}</Topology>\n"
      "{}{}        </Grid>\n",
      group.type == 0 ? "fluid" : "wall", n, data_item(fmt::format("{}:/Connectivity{}", file, group.type), numbers),
      geometry, values);
}

void write_series(const std::string& directory, const series& all) {
  replace_text((std::filesystem::path(directory) / "series.xdmf").string(), xdmf_text(all));
}

}  // namespace

std::string xdmf_text(const series& all) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
      "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const auto& entry : all.entries) {
    text += fmt::format(
        "      <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
        "        <Time Value=\"{}\"/>\n",
        entry.file, entry.time);
    for (const auto& group : entry.groups) text += grid_text(entry.file, group);
    text += "      </Grid>\n";
  }
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

void add_to_series(MPI_Comm comm, const std::string& directory, const std::string& snapshot_file, series& all) {
  on_rank_0(comm, [&] {
    all.entries.push_back(describe(directory, snapshot_file));
    write_series(directory, all);
  });
}

series continue_series(MPI_Comm comm, const std::string& directory, int next) {
  series all;
  on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "snapshot_", ".h5")) {
      if (number >= next) {
        remove_quietly((std::filesystem::path(directory) / name).string());
        continue;
      }
      try {
        all.entries.push_back(describe(directory, name));
      } catch (const std::exception& e) {
        all.messages.push_back(fmt::format("{}; series.xdmf goes on without it", e.what()));
      }
    }
    write_series(directory, all);
  });
  return all;
}

}  // namespace tetsuame::output
