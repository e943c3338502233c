#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <nlohmann/json.hpp>
#include <output/file.hpp>
#include <utility>

namespace tetsuame::output {

void fail_system(const std::string& verb, const std::string& path) {
  const int code = errno;
  foundation::fail_file(fmt::format("cannot {} {}: {}", verb, path, std::strerror(code)));
}

descriptor::descriptor(const std::string& path, int flags) {
  const bool reads = (flags & O_ACCMODE) == O_RDONLY;
  const char* verb = reads ? "read" : "write";
  // O_NONBLOCK: a pipe opens, or fails, at once.
  descriptor opened;
  opened.fd_ = open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | (reads ? 0 : O_NOFOLLOW), 0666);
  if (opened.fd_ < 0 && errno == ELOOP && !reads)
    foundation::fail_file(fmt::format("cannot write {}: it is a symbolic link, which is not followed", path));
  if (opened.fd_ < 0) fail_system(verb, path);
  struct stat about {};
  if (fstat(opened.fd_, &about) != 0) fail_system(verb, path);
  if ((flags & O_DIRECTORY) == 0 && !S_ISREG(about.st_mode))
    foundation::fail_file(fmt::format("cannot {} {}: it is not a plain file", verb, path));
  std::swap(fd_, opened.fd_);
}
descriptor::descriptor(descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
descriptor& descriptor::operator=(descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}
descriptor::~descriptor() {
  if (fd_ >= 0) close(fd_);
}

growing_file::growing_file(const std::string& path) : path_(path), file_(path, O_WRONLY | O_APPEND | O_CREAT) {
  bytes_ = size_of(file_, path);
}

void growing_file::add(const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(file_.get(), text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_system("write", path_);
    done += static_cast<std::size_t>(written);
    bytes_ += static_cast<std::uint64_t>(written);
  }
}

void growing_file::sync() { output::sync(file_.get(), path_); }

growing_file::damage growing_file::mend() {
  struct stat own {};
  struct stat there {};
  if (fstat(file_.get(), &own) != 0) fail_system("write", path_);
  const bool in_place = lstat(path_.c_str(), &there) == 0 && there.st_dev == own.st_dev && there.st_ino == own.st_ino;
  const auto bytes = static_cast<std::uint64_t>(own.st_size);
  if (in_place && bytes == bytes_) return {};
  // What was opened is there as long as it is open, whatever has become of its name.
  auto text = beginning_of("/proc/self/fd/" + std::to_string(file_.get()), bytes);
  damage found;
  found.lost = bytes != bytes_;
  if (found.lost) {
    text.resize(text.find_last_of('\n') + 1);
    found.text = fmt::format("{} was changed by another program, and had {} bytes instead of {}: lines may be lost",
                             path_, bytes, bytes_);
    found.kept = text;
  } else {
    found.text = path_ + " was taken away or replaced: it is written again, with all its lines";
  }
  replace_text(path_, text);
  *this = growing_file(path_);
  return found;
}

void write_at(const descriptor& file, const std::string& path, const void* data, std::size_t bytes,
              std::uint64_t offset) {
  const auto* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = pwrite(file.get(), from, bytes, static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail_system("write", path);
    from += done;
    bytes -= static_cast<std::size_t>(done);
    offset += static_cast<std::uint64_t>(done);
  }
}

void read_at(const descriptor& file, const std::string& path, void* data, std::size_t bytes, std::uint64_t offset) {
  auto* to = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t done = pread(file.get(), to, bytes, static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail_system("read", path);
    if (done == 0) foundation::fail_file(fmt::format("cannot read {}: it ends early, at byte {}", path, offset));
    to += done;
    bytes -= static_cast<std::size_t>(done);
    offset += static_cast<std::uint64_t>(done);
  }
}

std::uint64_t size_of(const descriptor& file, const std::string& path) {
  struct stat about {};
  if (fstat(file.get(), &about) != 0) fail_system("read", path);
  return static_cast<std::uint64_t>(about.st_size);
}

std::string beginning_of(const std::string& path, std::uint64_t bytes) {
  const descriptor file(path, O_RDONLY);
  std::string text(std::min(bytes, size_of(file, path)), '\0');
  read_at(file, path, text.data(), text.size(), 0);
  return text;
}

void reserve(const descriptor& file, const std::string& path, std::uint64_t bytes) {
  while (bytes > 0 && fallocate(file.get(), 0, 0, static_cast<off_t>(bytes)) != 0) {
    if (errno == EINTR) continue;
    if (errno == EOPNOTSUPP || errno == ENOSYS || errno == EINVAL) return;
    fail_system(fmt::format("reserve {} bytes for", bytes), path);
  }
}

std::string temporary_name(const std::string& path) { return path + ".tmp"; }

descriptor create_temporary(const std::string& path) {
  remove_quietly(path);
  return descriptor(path, O_WRONLY | O_CREAT | O_EXCL);
}

void sync(int file, const std::string& path) {
  if (fsync(file) != 0 && errno != EINVAL && errno != EROFS) fail_system("write", path);
}

void replace_by_temporary(const std::string& path) {
  if (std::rename(temporary_name(path).c_str(), path.c_str()) != 0) fail_system("replace", path);
  const auto parent = std::filesystem::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  sync(descriptor(folder, O_RDONLY | O_DIRECTORY).get(), folder);
}

void remove_quietly(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

void replace_text(const std::string& path, const std::string& text) {
  const auto temporary = temporary_name(path);
  try {
    const auto file = create_temporary(temporary);
    write_at(file, path, text.data(), text.size(), 0);
    sync(file.get(), path);
    replace_by_temporary(path);
  } catch (...) {
    remove_quietly(temporary);
    throw;
  }
}

void write_text(MPI_Comm comm, const std::string& path, const std::string& text) {
  foundation::on_rank_0(comm, [&] { replace_text(path, text); });
}

void write_summary(MPI_Comm comm, const std::string& path, const nlohmann::ordered_json& summary) {
  write_text(comm, path, summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void let_size_limits_fail_writes() { std::signal(SIGXFSZ, SIG_IGN); }

}  // namespace tetsuame::output
