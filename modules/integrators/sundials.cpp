#include <fmt/format.h>

#include <foundation/error.hpp>
#include <integrators/sundials.hpp>
#include <utility>

namespace tetsuame::integrators {

namespace {

constexpr int warning_code = 99;  // ARK_WARNING and KIN_WARNING

}  // namespace

sundials_context::sundials_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0)
    foundation::fail_calculation("SUNDIALS could not create its context: is there enough memory?");
  context_.reset(context);
}

void sundials_messages::handler(int code, const char*, const char* function, char* text, void* messages) {
  if (code == warning_code) return;
  static_cast<sundials_messages*>(messages)->last = fmt::format("{}: {}", function, text);
}

int exception_carrier::guard(const std::function<int()>& call) noexcept {
  try {
    return call();
  } catch (...) {
    if (!waiting_) waiting_ = std::current_exception();
    return -1;
  }
}

void exception_carrier::rethrow() {
  if (waiting_) std::rethrow_exception(std::exchange(waiting_, nullptr));
}

}  // namespace tetsuame::integrators
