#include <fcntl.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <foundation/agree.hpp>
#include <limits>
#include <numeric>
#include <output/directory.hpp>
#include <output/shared_file.hpp>
#include <output/snapshot.hpp>
#include <output/stored_file.hpp>

namespace tetsuame::output {

namespace {

constexpr std::size_t gadget_types = 6;

attributes header_attributes(const snapshot_header& header, const std::vector<particle_group>& groups,
                             const std::vector<id_order>& orders, const snapshot_form& form) {
  std::vector<std::uint64_t> here(gadget_types, 0);
  std::vector<std::uint32_t> low(gadget_types, 0), high(gadget_types, 0);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto type = static_cast<std::size_t>(groups[g].type);
    here.at(type) = orders[g].total_rows;
    low.at(type) = static_cast<std::uint32_t>(here[type]);
    high.at(type) = static_cast<std::uint32_t>(here[type] >> 32);
  }
  const auto& box = header.box_lengths;
  const auto flag = [](int value) { return static_cast<std::int64_t>(value); };
  return {{"NumPart_ThisFile", here},
          {"NumPart_Total", low},
          {"NumPart_Total_HighWord", high},
          {"MassTable", std::vector<double>(gadget_types, 0.0)},
          {"Time", header.time},
          {"Redshift", 0.0},
          {"BoxSize", *std::max_element(box.begin(), box.end())},
          {"NumFilesPerSnapshot", flag(1)},
          {"Omega0", 0.0},
          {"OmegaLambda", 0.0},
          {"HubbleParam", 1.0},
          {"Flag_Sfr", flag(0)},
          {"Flag_Cooling", flag(0)},
          {"Flag_StellarAge", flag(0)},
          {"Flag_Metals", flag(0)},
          {"Flag_Feedback", flag(0)},
          {"Flag_Entropy_ICs", flag(0)},
          {"Flag_DoublePrecision", flag(form.single ? 0 : 1)},
          {"Dimension", flag(header.dimension)},
          {"Step", header.step},
          {"BoxLengths", std::vector<double>(box.begin(), box.end())},
          {"Periodic", std::vector<std::int32_t>(header.periodic.begin(), header.periodic.end())},
          {"UnitLength_in_cm", 100.0},
          {"UnitMass_in_g", 1000.0},
          {"UnitVelocity_in_cm_per_s", 100.0},
          {"KernelSupport", header.kernel_support}};
}

std::uint64_t width_of(const column& c) { return c.vector ? 3 : c.components.size(); }

element type_of(const column& c, const snapshot_form& form) {
  if (c.integer) return element::index;
  return form.single && c.name != "Coordinates" ? element::single : element::real;
}

// Of the columns, those that are not asked for.
void leave_out(std::vector<particle_group>& groups, const snapshot_form& form) {
  if (form.fields.empty()) return;
  for (auto& group : groups)
    std::erase_if(group.columns, [&](const column& c) {
      return c.name != "Coordinates" && std::ranges::find(form.fields, c.name) == form.fields.end();
    });
}

void add_group(const particle_group& group, std::uint64_t rows, const snapshot_form& form, double kernel_support,
               layout& contents) {
  const auto folder = fmt::format("/PartType{}", group.type);
  contents.groups.push_back({folder, {}});
  contents.datasets.push_back(
      {folder + "/ParticleIDs",
       element::integer,
       {rows},
       {{"units", std::string("1")}, {"description", std::string("identity of the particle, the same in all files")}}});
  for (const auto& c : group.columns) {
    std::vector<std::uint64_t> shape{rows};
    if (width_of(c) > 1) shape.push_back(width_of(c));
    contents.datasets.push_back(
        {folder + "/" + c.name, type_of(c, form), shape, {{"units", c.units}, {"description", c.description}}});
    if (!c.names.empty()) contents.datasets.back().attributes.emplace_back("names", c.names);
    if (c.name == "SmoothingLength") contents.datasets.back().attributes.emplace_back("KernelSupport", kernel_support);
  }
  const bool fits = rows <= std::numeric_limits<std::int32_t>::max();
  contents.datasets.push_back({fmt::format("/Connectivity{}", group.type),
                               fits ? element::index : element::integer,
                               {rows, 1},
                               {{"description", std::string("row numbers, for ParaView")}}});
}

// A place along a periodic axis within [0, length): a particle may be beyond until lists are made, and readers that
// count in periods take no such place.
double within_period(double x, double length) {
  if (x < 0.0) x += length;
  return x >= length ? x - length : x;
}

// One row after another, as wide as in the file. Collective.
std::vector<double> rows_of(const column& c, const snapshot_header& header, const id_order& order) {
  const auto width = static_cast<std::size_t>(width_of(c));
  std::vector<double> rows(width * order.rows(), 0.0);
  for (std::size_t d = 0; d < std::min(width, c.components.size()); ++d) {
    auto x = arrange(order, c.components[d]);
    if (c.name == "Coordinates" && header.periodic[d])
      for (double& place : x) place = within_period(place, header.box_lengths[d]);
    for (std::size_t k = 0; k < x.size(); ++k) rows[width * k + d] = x[k];
  }
  return rows;
}

template <class Stored, class T>
void write_as(shared_file& file, const dataset& d, const id_order& order, const std::vector<T>& rows) {
  if (rows.empty()) return;
  if constexpr (!std::is_same_v<Stored, T>) {
    write_as<Stored>(file, d, order, std::vector<Stored>(rows.begin(), rows.end()));
  } else {
    const std::size_t row_bytes = rows.size() / order.rows() * sizeof(T);
    file.write(d, order.first_row * row_bytes, rows.data(), rows.size() * sizeof(T));
  }
}

template <class T>
void write_rows(shared_file& file, const dataset& d, const id_order& order, const std::vector<T>& rows) {
  if (d.type == element::index)
    write_as<std::int32_t>(file, d, order, rows);
  else if (d.type == element::single)
    write_as<float>(file, d, order, rows);
  else
    write_as<T>(file, d, order, rows);
}

// Collective. next: the group's first dataset; moved past its last.
void write_group(shared_file& file, const snapshot_header& header, const particle_group& group, const id_order& order,
                 std::vector<dataset>::const_iterator& next) {
  write_rows(file, *next++, order, order.ids);
  for (const auto& c : group.columns) write_rows(file, *next++, order, rows_of(c, header, order));
  std::vector<std::int64_t> numbers(order.rows());
  std::iota(numbers.begin(), numbers.end(), static_cast<std::int64_t>(order.first_row));
  write_rows(file, *next++, order, numbers);
}

}  // namespace

std::string snapshot_name(int number) { return fmt::format("snapshot_{:04}.h5", number); }

std::uint64_t bytes_of(std::vector<particle_group> groups, const snapshot_form& form) {
  leave_out(groups, form);
  layout contents;
  for (const auto& group : groups) add_group(group, group.n, form, 0.0, contents);
  std::uint64_t bytes = 0;
  for (const auto& d : contents.datasets) bytes += bytes_of(d);
  return bytes;
}

void write_snapshot(MPI_Comm comm, const std::string& path, const snapshot_header& header,
                    std::vector<particle_group> groups, const provenance& origin, const snapshot_form& form) {
  leave_out(groups, form);
  std::vector<id_order> orders;
  for (const auto& group : groups) orders.push_back(order_by_id(comm, group.n, group.ids));

  const auto input = foundation::broadcast(comm, origin.resolved_input);
  layout contents;
  contents.groups = {{"/Header", header_attributes(header, groups, orders, form)},
                     {"/Provenance", {{"Program", origin.program}, {"Version", origin.version}}}};
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (orders[g].total_rows > 0) add_group(groups[g], orders[g].total_rows, form, header.kernel_support, contents);
  contents.datasets.push_back({"/Provenance/ResolvedInput", element::text, {input.size()}, {}});

  shared_file file(comm, path, contents);
  auto next = contents.datasets.cbegin();
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (orders[g].total_rows > 0) write_group(file, header, groups[g], orders[g], next);
  if (foundation::rank_of(comm) == 0) file.write(*next, 0, input.c_str(), next->bytes);
  file.finish();
  if (form.compressed) foundation::on_rank_0(comm, [&] { compress(path, contents); });
}

// ---- the series ---------------------------------------------------------------------------

namespace {

constexpr std::string_view first_lines =
    "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
    "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr std::array<std::string_view, 2> series_names{"series.xdmf", "walls.xdmf"};
constexpr std::string_view last_lines = "    </Grid>\n  </Domain>\n</Xdmf>\n";

std::string data_item(const std::string& place, const stored_dataset& d) {
  return fmt::format(R"(<DataItem Format="HDF" NumberType="{}" Precision="{}" Dimensions="{}">{}</DataItem>)",
                     d.holds == stored_dataset::content::integers ? "Int" : "Float", d.bytes_per_value,
                     fmt::join(d.shape, " "), place);
}

std::string attribute_text(const std::string& folder, const stored_dataset& d) {
  const std::uint64_t width = d.shape.size() < 2 ? 1 : d.shape[1];
  return fmt::format("        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n", d.name,
                     width == 1   ? "Scalar"
                     : width == 3 ? "Vector"
                                  : "Matrix",
                     data_item(folder + d.name, d));
}

// The particles of a type at the time of a snapshot; empty without any.
std::string text_of(const stored_file& snapshot, int type) {
  const auto file = std::filesystem::path(snapshot.path()).filename().string();
  const auto group = fmt::format("/PartType{}", type), numbers_name = fmt::format("Connectivity{}", type);
  const auto folder = file + ":" + group + "/";
  std::string geometry, values;
  std::uint64_t n = 0;
  for (const auto& d : snapshot.datasets(group)) {
    if (d.shape.empty() || !d.is_of_numbers()) continue;
    n = d.shape[0];
    if (d.name == "Coordinates")
      geometry = fmt::format("        <Geometry GeometryType=\"XYZ\">{}</Geometry>\n", data_item(folder + d.name, d));
    values += attribute_text(folder, d);  // places too: readers of meshes that stay take the geometry once
  }
  if (n == 0) return "";
  const auto top = snapshot.datasets("/");
  const auto found = std::ranges::find(top, numbers_name, &stored_dataset::name);
  if (found == top.end())
    foundation::fail_file(fmt::format("cannot read {}: /{} is missing", snapshot.path(), numbers_name));
  auto numbers = *found;
  numbers.shape = {n, 1};
  return fmt::format(
      "      <Grid Name=\"{}\" GridType=\"Uniform\">\n"
      "        <Time Value=\"{}\"/>\n"
      "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\">{}</Topology>\n"
      "{}{}      </Grid>\n",
      type == 0 ? "fluid" : "wall", snapshot.number("/Header", "Time"), n,
      data_item(fmt::format("{}:/{}", file, numbers_name), numbers), geometry, values);
}

std::string path_in(const std::string& directory, std::string_view name) {
  return (std::filesystem::path(directory) / name).string();
}

// Replaces the files by those of these snapshots.
void write_whole(const std::string& directory, const std::vector<std::string>& snapshots, series& all) {
  std::array<std::string, 2> texts;
  for (const auto& name : snapshots) {
    try {
      const stored_file snapshot(path_in(directory, name));
      const std::array more{text_of(snapshot, 0), text_of(snapshot, 1)};
      for (const std::size_t type : {0, 1}) texts[type] += more[type];
    } catch (const std::exception& e) {
      all.messages.push_back(fmt::format("{}; series.xdmf goes on without it", e.what()));
    }
  }
  for (const std::size_t type : {0, 1}) {
    const auto path = path_in(directory, series_names[type]);
    if (type == 1 && texts[type].empty()) {
      remove_quietly(path);
      continue;
    }
    const auto text = std::string(first_lines) + texts[type];
    all.end[type] = text.size();
    replace_text(path, text + std::string(last_lines));
  }
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
    if (all.end[0] == 0) return write_whole(directory, {snapshot_file}, all);
    const stored_file snapshot(path_in(directory, snapshot_file));
    for (const std::size_t type : {0, 1}) {
      const auto text = text_of(snapshot, static_cast<int>(type));
      if (text.empty()) continue;
      const auto path = path_in(directory, series_names[type]);
      std::error_code problem;
      const auto bytes = std::filesystem::file_size(path, problem);
      if (problem || bytes != all.end[type] + last_lines.size())  // somebody removed or changed it
        return write_whole(directory, snapshots_below(directory, std::numeric_limits<std::int64_t>::max()), all);
      const auto added = text + std::string(last_lines);
      write_at(descriptor(path, O_WRONLY), path, added.data(), added.size(), all.end[type]);
      all.end[type] += text.size();
    }
  });
}

series continue_series(MPI_Comm comm, const std::string& directory, int next) {
  series all;
  foundation::on_rank_0(comm, [&] {
    for (const auto& [number, name] : numbered_files(directory, "snapshot_", ".h5"))
      if (number >= next) remove_quietly(path_in(directory, name));
    write_whole(directory, snapshots_below(directory, next), all);
  });
  return all;
}

}  // namespace tetsuame::output
