#include <fcntl.h>
#include <fmt/core.h>
#include <hdf5.h>

#include <algorithm>
#include <foundation/error.hpp>
#include <numeric>
#include <output/file.hpp>
#include <output/hdf5_layout.hpp>

namespace tetsuame::output {

namespace {

// HDF5 keeps its reasons to itself while this lives.
struct quiet {
  H5E_auto2_t function = nullptr;
  void* data = nullptr;
  quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function, &data);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  quiet(const quiet&) = delete;
  quiet& operator=(const quiet&) = delete;
  ~quiet() { H5Eset_auto2(H5E_DEFAULT, function, data); }
};

// The innermost entry of HDF5's stack is the one that says what happened.
std::string hdf5_reason() {
  std::string reason = "unknown reason";
  const auto keep_first = [](unsigned n, const H5E_error2_t* e, void* out) -> herr_t {
    if (n == 0 && e->desc != nullptr) *static_cast<std::string*>(out) = e->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &reason);
  return reason;
}

struct file_context {
  const std::string& path;
  const char* verb;
  quiet silence{};

  template <class T>
  T check(T result) const {
    if (result < 0) foundation::fail_file(fmt::format("cannot {} {}: HDF5: {}", verb, path, hdf5_reason()));
    return result;
  }
};

class handle {
 public:
  using closer = herr_t (*)(hid_t);
  handle(hid_t id, closer how) : id_(id), close_(how) {}
  handle(handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  ~handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  // Closing may write, so it may fail.
  herr_t close() {
    const hid_t id = std::exchange(id_, -1);
    return close_(id);
  }

 private:
  hid_t id_;
  closer close_;
};

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

// Locks fail on some network file systems, and nothing here needs them.
handle access_without_locks(const file_context& file) {
  handle access(file.check(H5Pcreate(H5P_FILE_ACCESS)), H5Pclose);
  file.check(H5Pset_file_locking(access, false, true));
  return access;
}

struct opened_file {
  file_context file;
  handle root;
  explicit opened_file(const std::string& path)
      : file{path, "read"},
        root(file.check(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access_without_locks(file))), H5Fclose) {}
};

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
    const opened_file old(path);
    const file_context file{temporary, "write"};
    handle root(file.check(H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access_without_locks(file))),
                H5Fclose);
    create_groups(file, root, contents);
    for (const auto& d : contents.datasets) {
      const handle from(old.file.check(H5Dopen2(old.root, d.path.c_str(), H5P_DEFAULT)), H5Dclose);
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

double read_real_attribute(const std::string& path, const std::string& object, const std::string& name) {
  const auto values = read_real_attributes(path, object, name);
  if (values.size() != 1)
    foundation::fail_file(fmt::format("cannot read {}: {}/{} is not one number", path, object, name));
  return values[0];
}

std::vector<double> read_real_attributes(const std::string& path, const std::string& object, const std::string& name) {
  const opened_file opened(path);
  const auto& [file, root] = opened;
  const handle a(file.check(H5Aopen_by_name(root, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT)), H5Aclose);
  const handle space(file.check(H5Aget_space(a)), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(file.check(H5Sget_simple_extent_npoints(space))));
  file.check(H5Aread(a, H5T_NATIVE_DOUBLE, values.data()));
  return values;
}

std::vector<stored_dataset> list_datasets(const std::string& path, const std::string& group) {
  const opened_file opened(path);
  const auto& [file, root] = opened;
  std::vector<stored_dataset> list;
  if (group != "/" && file.check(H5Lexists(root, group.c_str(), H5P_DEFAULT)) == 0) return list;
  const handle folder(file.check(H5Gopen2(root, group.c_str(), H5P_DEFAULT)), H5Gclose);
  H5G_info_t info;
  file.check(H5Gget_info(folder, &info));
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    char name[256];
    file.check(H5Lget_name_by_idx(folder, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT));
    const handle object(file.check(H5Oopen(folder, name, H5P_DEFAULT)), H5Oclose);
    if (H5Iget_type(object) != H5I_DATASET) continue;
    const hid_t set = object;
    const handle type(file.check(H5Dget_type(set)), H5Tclose);
    const handle space(file.check(H5Dget_space(set)), H5Sclose);
    std::vector<hsize_t> shape(static_cast<std::size_t>(file.check(H5Sget_simple_extent_ndims(space))));
    file.check(H5Sget_simple_extent_dims(space, shape.data(), nullptr));
    list.push_back({name, H5Tget_class(type) == H5T_INTEGER, H5Tget_size(type), {shape.begin(), shape.end()}});
  }
  return list;
}

std::vector<double> read_reals(const std::string& path, const std::string& name) {
  const opened_file opened(path);
  const auto& [file, root] = opened;
  const handle set(file.check(H5Dopen2(root, name.c_str(), H5P_DEFAULT)), H5Dclose);
  const handle space(file.check(H5Dget_space(set)), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(file.check(H5Sget_simple_extent_npoints(space))));
  file.check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
  return values;
}

}  // namespace tetsuame::output
