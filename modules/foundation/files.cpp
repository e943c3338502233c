#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <foundation/error.hpp>
#include <foundation/files.hpp>

namespace tetsuame::foundation {

namespace {

[[noreturn]] void fail_to_read(const std::string& path, int reason) {
  fail_input(reason == ENOENT ? fmt::format("there is no file {}", path)
                              : fmt::format("{} cannot be read: {}", path, std::strerror(reason)));
}

struct stat about_plain(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0) fail_to_read(path, errno);
  if (S_ISDIR(about.st_mode)) fail_input(path + " is a directory, not a file");
  if (!S_ISREG(about.st_mode)) fail_input(path + " is no plain file, but a pipe or a device");
  return about;
}

}  // namespace

void expect_plain_file(const std::string& path) { about_plain(path); }

std::string read_plain_file(const std::string& path) {
  const auto about = about_plain(path);
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) fail_to_read(path, errno);
  std::string content(static_cast<std::size_t>(about.st_size), '\0');
  std::size_t at = 0;
  int reason = 0;
  while (at < content.size()) {
    const auto got = ::read(file, content.data() + at, content.size() - at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) reason = errno;
    if (got <= 0) break;
    at += static_cast<std::size_t>(got);
  }
  ::close(file);
  if (reason != 0) fail_to_read(path, reason);
  content.resize(at);
  return content;
}

}  // namespace tetsuame::foundation
