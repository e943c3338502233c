#include <fcntl.h>
#include <fmt/core.h>

#include <output/file.hpp>
#include <output/hdf5_handles.hpp>
#include <output/stored_file.hpp>

namespace tetsuame::output {

namespace {

using hdf5::handle;

// Called where a link leads into another file.
herr_t refuse_to_follow(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return -1; }

}  // namespace

struct stored_file::opened {
  hdf5::file_context file;
  handle root;
  handle within;  // properties of access that keep links within the file

  explicit opened(const std::string& path)
      : file{path, "read"},
        root(file.check(H5Fopen(path.c_str(), H5F_ACC_RDONLY, hdf5::access_without_locks(file))), H5Fclose),
        within(file.check(H5Pcreate(H5P_LINK_ACCESS)), H5Pclose) {
    file.check(H5Pset_elink_cb(within, refuse_to_follow, nullptr));
  }

  // Invalid where the path leads nowhere, or out of the file.
  handle object(hid_t from, const char* name) const { return {H5Oopen(from, name, within), H5Oclose}; }

  [[noreturn]] void fail(const std::string& what) const {
    foundation::fail_file(fmt::format("cannot read {}: {}", file.path, what));
  }

  // The dataset, whose values lie in the file and can be decoded.
  handle dataset(const std::string& name) const {
    handle set = object(root, name.c_str());
    if (set < 0 || H5Iget_type(set) != H5I_DATASET) fail(name + " is no dataset of this file");
    const handle how(file.check(H5Dget_create_plist(set)), H5Pclose);
    if (H5Pget_layout(how) == H5D_VIRTUAL || H5Pget_external_count(how) > 0)
      fail(name + " lies in other files, which are not followed");
    for (int k = 0; k < H5Pget_nfilters(how); ++k) {
      unsigned flags = 0, configuration = 0;
      std::size_t values = 0;
      char filter[64] = "";
      const auto id = H5Pget_filter2(how, static_cast<unsigned>(k), &flags, &values, nullptr, sizeof filter, filter,
                                     &configuration);
      if (H5Zfilter_avail(id) <= 0)
        fail(fmt::format("{} is compressed by filter {} ('{}'), which this machine's HDF5 does not have", name,
                         static_cast<int>(id), filter));
    }
    return set;
  }

  template <class T>
  std::vector<T> values(const handle& set, hid_t as) const {
    const handle space(file.check(H5Dget_space(set)), H5Sclose);
    std::vector<T> all(static_cast<std::size_t>(file.check(H5Sget_simple_extent_npoints(space))));
    if (!all.empty()) file.check(H5Dread(set, as, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()));
    return all;
  }

  // Of an object in a group: the dataset that it is, if it is one.
  std::optional<stored_dataset> described(hid_t folder, const char* name) const {
    const handle set = object(folder, name);
    if (set < 0) return stored_dataset{name, stored_dataset::content::elsewhere, 0, {}};
    if (H5Iget_type(set) != H5I_DATASET) return {};
    const handle type(file.check(H5Dget_type(set)), H5Tclose);
    const auto of = H5Tget_class(type);
    stored_dataset d{name, stored_dataset::content::other, H5Tget_size(type), {}};
    if (of == H5T_INTEGER) d.holds = stored_dataset::content::integers;
    if (of == H5T_FLOAT) d.holds = stored_dataset::content::reals;
    const handle how(file.check(H5Dget_create_plist(set)), H5Pclose);
    if (H5Pget_layout(how) == H5D_VIRTUAL) d.holds = stored_dataset::content::elsewhere;
    if (d.holds == stored_dataset::content::elsewhere) return d;
    const handle space(file.check(H5Dget_space(set)), H5Sclose);
    if (H5Sget_simple_extent_type(space) == H5S_NULL) {
      d.shape = {0};
      return d;
    }
    std::vector<hsize_t> shape(static_cast<std::size_t>(file.check(H5Sget_simple_extent_ndims(space))));
    file.check(H5Sget_simple_extent_dims(space, shape.data(), nullptr));
    d.shape.assign(shape.begin(), shape.end());
    return d;
  }

  std::string text(const handle& a, const handle& type, const handle& space) const {
    if (H5Tis_variable_str(type) > 0) {
      char* read = nullptr;
      file.check(H5Aread(a, type, static_cast<void*>(&read)));
      std::string copy = read == nullptr ? "" : read;
      file.check(H5Dvlen_reclaim(type, space, H5P_DEFAULT, static_cast<void*>(&read)));
      return copy;
    }
    std::string copy(H5Tget_size(type), '\0');
    file.check(H5Aread(a, type, copy.data()));
    return copy.substr(0, copy.find('\0'));
  }
};

stored_file::stored_file(const std::string& path) : path_(path) {
  const descriptor plain_file(path, O_RDONLY);  // HDF5 would wait for a pipe
  file_ = std::make_unique<opened>(path_);
}

stored_file::~stored_file() = default;

bool stored_file::has_group(const std::string& name) const {
  const handle object = file_->object(file_->root, name.c_str());
  return object >= 0 && H5Iget_type(object) == H5I_GROUP;
}

std::vector<stored_dataset> stored_file::datasets(const std::string& group) const {
  std::vector<stored_dataset> list;
  const auto& file = file_->file;
  if (!has_group(group)) return list;
  const handle folder = file_->object(file_->root, group.c_str());
  H5G_info_t info;
  file.check(H5Gget_info(folder, &info));
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    char name[256];
    file.check(H5Lget_name_by_idx(folder, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT));
    if (auto d = file_->described(folder, name)) list.push_back(std::move(*d));
  }
  return list;
}

std::optional<stored_attribute> stored_file::attribute(const std::string& object, const std::string& name) const {
  const auto& file = file_->file;
  const handle of = file_->object(file_->root, object.c_str());
  if (of < 0 || file.check(H5Aexists(of, name.c_str())) == 0) return {};
  const handle a(file.check(H5Aopen(of, name.c_str(), H5P_DEFAULT)), H5Aclose);
  const handle type(file.check(H5Aget_type(a)), H5Tclose), space(file.check(H5Aget_space(a)), H5Sclose);
  const auto count = file.check(H5Sget_simple_extent_npoints(space));
  constexpr hssize_t most = 64;
  stored_attribute read;
  const auto class_of = H5Tget_class(type);
  if (class_of == H5T_STRING && count == 1) read.text = file_->text(a, type, space);
  if ((class_of == H5T_INTEGER || class_of == H5T_FLOAT) && count <= most) {
    read.numbers.resize(static_cast<std::size_t>(count));
    if (count > 0) file.check(H5Aread(a, H5T_NATIVE_DOUBLE, read.numbers.data()));
  }
  return read;
}

double stored_file::number(const std::string& object, const std::string& name) const {
  const auto found = attribute(object, name);
  if (!found || found->numbers.size() != 1) file_->fail(fmt::format("{}/{} is not one number", object, name));
  return found->numbers[0];
}

std::vector<double> stored_file::reals(const std::string& dataset) const {
  return file_->values<double>(file_->dataset(dataset), H5T_NATIVE_DOUBLE);
}

stored_file::integers stored_file::whole_numbers(const std::string& dataset) const {
  const handle set = file_->dataset(dataset);
  const handle type(file_->file.check(H5Dget_type(set)), H5Tclose);
  if (H5Tget_sign(type) == H5T_SGN_NONE) return {file_->values<std::uint64_t>(set, H5T_NATIVE_UINT64), false};
  return {file_->values<std::uint64_t>(set, H5T_NATIVE_INT64), true};
}

}  // namespace tetsuame::output
