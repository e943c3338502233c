// The one kind of error: thrown where the fault is known, told once at the top,
// with the exit status that scripts rely on.
#pragma once

#include <stdexcept>
#include <string>

namespace tetsuame::foundation {

enum class exit_status : int {
  completed = 0,
  bad_input = 2,           // input or usage; nothing was written
  calculation_failed = 3,  // diverged, not finite, p <= 0
  file_failed = 4,         // could not be read or written, or is damaged
  interrupted = 75,        // a checkpoint was written; continue with --restart latest
};

class error : public std::runtime_error {
 public:
  error(exit_status status, const std::string& message) : std::runtime_error(message), status_(status) {}
  exit_status status() const { return status_; }

 private:
  exit_status status_;
};

[[noreturn]] inline void fail_input(const std::string& message) { throw error(exit_status::bad_input, message); }
[[noreturn]] inline void fail_calculation(const std::string& message) {
  throw error(exit_status::calculation_failed, message);
}
[[noreturn]] inline void fail_file(const std::string& message) { throw error(exit_status::file_failed, message); }

}  // namespace tetsuame::foundation
