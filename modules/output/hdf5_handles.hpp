// What calls HDF5's C library: its handles, closed at the end of their scope, and its errors with their reasons. For
// the sources of this module alone.
#pragma once

#include <fmt/core.h>
#include <hdf5.h>

#include <foundation/error.hpp>
#include <string>
#include <utility>

namespace tetsuame::output::hdf5 {

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
inline std::string reason() {
  std::string text = "unknown reason";
  const auto keep_first = [](unsigned n, const H5E_error2_t* e, void* out) -> herr_t {
    if (n == 0 && e->desc != nullptr) *static_cast<std::string*>(out) = e->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  return text;
}

struct file_context {
  const std::string& path;
  const char* verb;
  quiet silence{};

  template <class T>
  T check(T result) const {
    if (result < 0) foundation::fail_file(fmt::format("cannot {} {}: HDF5: {}", verb, path, reason()));
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

// Locks fail on some network file systems, and nothing here needs them.
inline handle access_without_locks(const file_context& file) {
  handle access(file.check(H5Pcreate(H5P_FILE_ACCESS)), H5Pclose);
  file.check(H5Pset_file_locking(access, false, true));
  return access;
}

}  // namespace tetsuame::output::hdf5
