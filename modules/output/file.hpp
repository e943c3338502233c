// Plain files on one rank: whole writes or a reason, and replacing a file in one step.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tetsuame::output {

// An open file descriptor, closed at the end of its scope.
class descriptor {
 public:
  descriptor() = default;
  // A plain file, or with O_DIRECTORY a directory. What is written to is no symbolic link, which could lead anywhere;
  // a pipe is refused instead of waited for. Throws fail_file with path and reason.
  descriptor(const std::string& path, int flags);
  descriptor(descriptor&& other) noexcept;
  descriptor& operator=(descriptor&& other) noexcept;
  ~descriptor();

  int get() const { return fd_; }

 private:
  int fd_ = -1;
};

// "cannot VERB PATH: reason of errno"
[[noreturn]] void fail_system(const std::string& verb, const std::string& path);

// A file to which lines are added while the run goes on, and which somebody may take away or change meanwhile.
class growing_file {
 public:
  // What had become of it. Empty text: nothing.
  struct damage {
    std::string text;   // a sentence
    bool lost = false;  // whether lines are
    std::string kept;   // then, the whole lines that are left
  };

  growing_file() = default;
  // Begins with what stands there, and is made where it is missing. Throws as a descriptor does.
  explicit growing_file(const std::string& path);
  explicit operator bool() const { return file_.get() >= 0; }

  // Throw fail_file.
  void add(const std::string& text);
  void sync();
  // Where the file is gone or another stands in its place, it is written there again, with all its lines; where it was
  // changed, with the whole lines that are left.
  damage mend();

 private:
  std::string path_;
  descriptor file_;
  std::uint64_t bytes_ = 0;
};

// All bytes at the offset, however many calls it takes. Throw fail_file with path and reason.
void write_at(const descriptor& file, const std::string& path, const void* data, std::size_t bytes,
              std::uint64_t offset);
void read_at(const descriptor& file, const std::string& path, void* data, std::size_t bytes, std::uint64_t offset);
std::uint64_t size_of(const descriptor& file, const std::string& path);
// The first `bytes` of the file, or less where it is shorter.
std::string beginning_of(const std::string& path, std::uint64_t bytes);

// On the disk, so that a full one shows before the first byte is written, where the file system can.
void reserve(const descriptor& file, const std::string& path, std::uint64_t bytes);

std::string temporary_name(const std::string& path);  // path + ".tmp"
// A new file of that name; whatever had it is removed, and no link followed.
descriptor create_temporary(const std::string& path);
void sync(int file, const std::string& path);
// rename(temporary_name(path), path), made lasting by a sync of the directory.
void replace_by_temporary(const std::string& path);
void remove_quietly(const std::string& path);

// On this rank: the text under a temporary name, synced, renamed. Throws fail_file.
void replace_text(const std::string& path, const std::string& text);

// Collective; rank 0's text is written as above, and all ranks throw if it fails.
void write_text(MPI_Comm comm, const std::string& path, const std::string& text);
// The same of JSON, where a number that is not finite becomes null, and bytes that are not UTF-8 U+FFFD.
void write_summary(MPI_Comm comm, const std::string& path, const nlohmann::ordered_json& summary);

// A file-size limit (ulimit -f) then fails a write, which is told with path and
// reason, instead of ending the program by SIGXFSZ.
void let_size_limits_fail_writes();

}  // namespace tetsuame::output
