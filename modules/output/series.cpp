#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <foundation/agree.hpp>
#include <limits>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <output/hdf5_layout.hpp>
#include <output/series.hpp>

namespace tetsuame::output {

namespace {

constexpr std::string_view first_lines =
    "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
    "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr std::string_view last_lines = "    </Grid>\n  </Domain>\n</Xdmf>\n";

std::string data_item(const std::string& place, const stored_dataset& d) {
  return fmt::format(R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}">{}</DataItem>)",
                     d.integer ? "Int" : "Float", d.bytes_per_value, fmt::join(d.shape, " "), place);
}

std::string attribute_text(const std::string& folder, const stored_dataset& d) {
  const std::uint64_t width = d.shape.size() < 2 ? 1 : d.shape[1];
  return fmt::format("          <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", d.name,
                     width == 1   ? "Scalar"
                     : width == 3 ? "Vector"
                                  : "Matrix",
                     data_item(folder + d.name, d));
}

std::string grid_text(const std::string& file, int type, const std::vector<stored_dataset>& datasets,
                      stored_dataset numbers) {
  const auto folder = fmt::format("{}:/PartType{}/", file, type);
  std::string geometry, values;
  std::uint64_t n = 0;
  for (const auto& d : datasets) {
    if (d.shape.empty()) continue;
    n = d.shape[0];
    if (d.name == "Coordinates")
      geometry = fmt::format("          <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", data_item(folder + d.name, d));
    else
      values += attribute_text(folder, d);
  }
  numbers.integer = true;
  numbers.shape = {n, 1};
  return fmt::format(
      "        <Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "          <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\">{}</Topology>\n"
      "{}{}        </Grid>\n",
      type == 0 ? "fluid" : "wall", n, data_item(fmt::format("{}:/{}", file, numbers.name), numbers), geometry, values);
}

std::string text_of(const std::string& directory, const std::string& file) {
  const auto path = (std::filesystem::path(directory) / file).string();
  const descriptor plain_file(path, O_RDONLY);  // HDF5 would wait for a pipe
  auto text = fmt::format(
      "      <Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
      "        <Time Value=\"{}\"/>\n",
      file, read_real_attribute(path, "/Header", "Time"));
  const auto top = list_datasets(path, "/");
  for (const int type : {0, 1}) {
    const auto datasets = list_datasets(path, fmt::format("/PartType{}", type));
    if (datasets.empty()) continue;
    const auto name = fmt::format("Connectivity{}", type);
    const auto numbers = std::find_if(top.begin(), top.end(), [&](const stored_dataset& d) { return d.name == name; });
    if (numbers == top.end()) foundation::fail_file(fmt::format("cannot read {}: /{} is missing", path, name));
    text += grid_text(file, type, datasets, *numbers);
  }
  return text + "      </Grid>\n";
}

std::string path_in(const std::string& directory) {
  return (std::filesystem::path(directory) / "series.xdmf").string();
}

// Replaces the file by one of these snapshots.
void write_whole(const std::string& directory, const std::vector<std::string>& snapshots, series& all) {
  std::string text(first_lines);
  for (const auto& name : snapshots) {
    try {
      text += text_of(directory, name);
    } catch (const std::exception& e) {
      all.messages.push_back(fmt::format("{}; series.xdmf goes on without it", e.what()));
    }
  }
  all.end = text.size();
  replace_text(path_in(directory), text.append(last_lines));
}

std::vector<std::string> snapshots_below(const std::string& directory, std::int64_t next) {
  std::vector<std::string> names;
  for (const auto& [number, name] : numbered_files(directory, "snapshot_", ".h5"))
    if (number < next) names.push_back(name);
  return names;
}

}  // namespace

void add_to_series(MPI_Comm comm, const std::string& directory, const std::string& snapshot_file, series& all) {
  foundation::on_rank_0(comm, [&] {
    const auto path = path_in(directory);
    if (all.end == 0) return write_whole(directory, {snapshot_file}, all);
    std::error_code problem;
    const auto bytes = std::filesystem::file_size(path, problem);
    if (problem || bytes != all.end + last_lines.size())  // somebody removed or changed it
      return write_whole(directory, snapshots_below(directory, std::numeric_limits<std::int64_t>::max()), all);
    const auto text = text_of(directory, snapshot_file);
    const auto added = text + std::string(last_lines);
    write_at(descriptor(path, O_WRONLY), path, added.data(), added.size(), all.end);
    all.end += text.size();
  });
}

series continue_series(MPI_Comm comm, const std::string& directory, int next) {
  series all;
  foundation::on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "snapshot_", ".h5"))
      if (number >= next) remove_quietly((std::filesystem::path(directory) / name).string());
    write_whole(directory, snapshots_below(directory, next), all);
  });
  return all;
}

}  // namespace tetsuame::output
