#include <fcntl.h>
#include <fmt/core.h>

#include <algorithm>
#include <foundation/error.hpp>
#include <numeric>
#include <output/file.hpp>
#include <output/hdf5_handles.hpp>
#include <output/hdf5_layout.hpp>

namespace tetsuame::output {

namespace {

using hdf5::access_without_locks;
using hdf5::file_context;
using hdf5::handle;

hid_t number_type(element type) {
  return type == element::real      ? H5T_IEEE_F64LE
         : type == element::single  ? H5T_IEEE_F32LE
         : type == element::integer ? H5T_STD_I64LE
                                    : H5T_STD_I32LE;
}

// A text of so many bytes, without an end of its own.
handle text_type(const file_context& file, std::size_t bytes) {
  handle type(file.check(H5Tcopy(H5T_C_S1)), H5Tclose);
  file.check(H5Tset_size(type, std::max<std::size_t>(1, bytes)));
  file.check(H5Tset_strpad(type, H5T_STR_NULLPAD));
  file.check(H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

struct attribute_writer {
  const file_context& file;
  hid_t object;
  const std::string& name;

  void write(hid_t type, hid_t space_id, const void* data) const {
    const handle space(file.check(space_id), H5Sclose);
    const handle a(file.check(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
    file.check(H5Awrite(a, type, data));
  }
  template <class T>
  void array(hid_t type, const std::vector<T>& values) const {
    const hsize_t n = values.size();
    write(type, H5Screate_simple(1, &n, nullptr), values.data());
  }
  void operator()(double value) const { write(H5T_NATIVE_DOUBLE, H5Screate(H5S_SCALAR), &value); }
  void operator()(std::int64_t value) const { write(H5T_NATIVE_INT64, H5Screate(H5S_SCALAR), &value); }
  void operator()(const std::vector<double>& values) const { array(H5T_NATIVE_DOUBLE, values); }
  void operator()(const std::vector<std::int32_t>& values) const { array(H5T_NATIVE_INT32, values); }
  void operator()(const std::vector<std::uint32_t>& values) const { array(H5T_NATIVE_UINT32, values); }
  void operator()(const std::vector<std::uint64_t>& values) const { array(H5T_NATIVE_UINT64, values); }
  void operator()(const std::string& text) const {
    write(text_type(file, text.size()), H5Screate(H5S_SCALAR), text.c_str());
  }
};

void write_attributes(const file_context& file, hid_t object, const attributes& list) {
  for (const auto& [name, value] : list) std::visit(attribute_writer{file, object, name}, value);
}

constexpr hsize_t rows_at_a_time = 65536;  // compressed together

bool has_rows(const dataset& d) { return d.type != element::text && !d.shape.empty() && d.shape[0] > 0; }

void lay_out(const file_context& file, hid_t how, const dataset& d, bool compressed) {
  if (compressed && has_rows(d)) {
    std::vector<hsize_t> chunk(d.shape.begin(), d.shape.end());
    chunk[0] = std::min(chunk[0], rows_at_a_time);
    file.check(H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data()));
    file.check(H5Pset_shuffle(how));
    file.check(H5Pset_deflate(how, 4));
    return;
  }
  file.check(H5Pset_layout(how, H5D_CONTIGUOUS));
  file.check(H5Pset_alloc_time(how, H5D_ALLOC_TIME_EARLY));
  file.check(H5Pset_fill_time(how, H5D_FILL_TIME_NEVER));
}

handle create_dataset(const file_context& file, hid_t root, const dataset& d, bool compressed) {
  const handle links(file.check(H5Pcreate(H5P_LINK_CREATE)), H5Pclose);
  file.check(H5Pset_create_intermediate_group(links, 1));
  const handle how(file.check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  file.check(H5Pset_obj_track_times(how, false));  // the same state gives the same bytes
  lay_out(file, how, d, compressed);

  const bool text = d.type == element::text;
  const auto type = text ? text_type(file, d.shape.at(0)) : handle(file.check(H5Tcopy(number_type(d.type))), H5Tclose);
  const std::vector<hsize_t> shape(d.shape.begin(), d.shape.end());
  const bool scalar = text || shape.empty();
  const handle space(file.check(scalar ? H5Screate(H5S_SCALAR)
                                       : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr)),
                     H5Sclose);
  handle set(file.check(H5Dcreate2(root, d.path.c_str(), type, space, links, how, H5P_DEFAULT)), H5Dclose);
  write_attributes(file, set, d.attributes);
  return set;
}

void create_groups(const file_context& file, hid_t root, const layout& contents) {
  for (const auto& [path, list] : contents.groups) {
    const handle group(file.check(H5Gcreate2(root, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)), H5Gclose);
    write_attributes(file, group, list);
  }
}

void create_contents(const file_context& file, hid_t root, layout& contents) {
  create_groups(file, root, contents);
  for (auto& d : contents.datasets) {
    const auto set = create_dataset(file, root, d, false);
    d.bytes = bytes_of(d);
    if (d.bytes == 0) continue;
    const haddr_t at = H5Dget_offset(set);  // counts from the start of the file, user block included
    if (at == HADDR_UNDEF) file.check(-1);
    d.offset = at;
  }
}

// The values of `from`, into `to`, some rows at a time.
void copy_values(const file_context& file, hid_t from, hid_t to, const dataset& d) {
  const handle type(file.check(H5Dget_type(from)), H5Tclose);
  if (!has_rows(d)) {
    std::vector<char> values(bytes_of(d));
    if (values.empty()) return;
    file.check(H5Dread(from, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    file.check(H5Dwrite(to, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
    return;
  }
  const handle space(file.check(H5Dget_space(from)), H5Sclose);
  const auto row_bytes = bytes_of(d) / d.shape[0];
  std::vector<char> values(row_bytes * std::min<hsize_t>(d.shape[0], rows_at_a_time));
  std::vector<hsize_t> first(d.shape.size(), 0), count(d.shape.begin(), d.shape.end());
  for (; first[0] < d.shape[0]; first[0] += count[0]) {
    count[0] = std::min<hsize_t>(rows_at_a_time, d.shape[0] - first[0]);
    file.check(H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr));
    const handle memory(file.check(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr)), H5Sclose);
    file.check(H5Dread(from, type, memory, space, H5P_DEFAULT, values.data()));
    file.check(H5Dwrite(to, type, memory, space, H5P_DEFAULT, values.data()));
  }
}

// HDF5 leaves a file that it cannot flush open until the end of the program, so a full
// disk must show before HDF5 writes: this is more than the skeleton can take.
std::uint64_t upper_estimate(const layout& contents) {
  std::uint64_t bytes = contents.user_block + 65536;
  for (const auto& d : contents.datasets) bytes += bytes_of(d) + 4096 + 1024 * d.attributes.size();
  for (const auto& [path, list] : contents.groups) {
    bytes += 4096 + 1024 * list.size();
    for (const auto& [name, value] : list)
      if (const auto* text = std::get_if<std::string>(&value)) bytes += text->size();
  }
  return bytes;
}

}  // namespace

std::uint64_t bytes_of(const dataset& d) {
  const auto values =
      std::accumulate(d.shape.begin(), d.shape.end(), std::uint64_t{1}, std::multiplies<std::uint64_t>());
  if (d.type == element::text) return std::max<std::uint64_t>(1, values);
  return values * (d.type == element::index || d.type == element::single ? 4 : 8);
}

std::uint64_t create_layout(const std::string& path, layout& contents) {
  reserve(create_temporary(path), path, upper_estimate(contents));

  const file_context file{path, "write"};
  const handle creation(file.check(H5Pcreate(H5P_FILE_CREATE)), H5Pclose);
  file.check(H5Pset_userblock(creation, contents.user_block));
  handle root(file.check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access_without_locks(file))), H5Fclose);
  create_contents(file, root, contents);
  file.check(root.close());

  const descriptor written(path, O_RDWR);
  const auto bytes = size_of(written, path);
  reserve(written, path, bytes);
  return bytes;
}

void compress(const std::string& path, const layout& contents) {
  const auto temporary = temporary_name(path);
  // Deflate never adds more than a thousandth, and the index of chunks is small: a full disk shows here.
  reserve(create_temporary(temporary), temporary, upper_estimate(contents));
  try {
    const file_context source{path, "read"};
    const handle old(source.check(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access_without_locks(source))), H5Fclose);
    const file_context file{temporary, "write"};
    handle root(file.check(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access_without_locks(file))),
                H5Fclose);
    create_groups(file, root, contents);
    for (const auto& d : contents.datasets) {
      const handle from(source.check(H5Dopen2(old, d.path.c_str(), H5P_DEFAULT)), H5Dclose);
      copy_values(file, from, create_dataset(file, root, d, true), d);
    }
    file.check(root.close());
    sync(descriptor(temporary, O_RDWR).get(), temporary);
    replace_by_temporary(path);
  } catch (...) {
    remove_quietly(temporary);
    throw;
  }
}

}  // namespace tetsuame::output
