// What every use of SUNDIALS here shares, for versions 6.4 to 7: the context all its objects belong to, and a
// handler that keeps SUNDIALS' messages instead of printing them, so that each becomes
// a foundation::error or a result's reason. Also carries exceptions through C code.
#pragma once

#include <fmt/format.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_nvector.h>

#include <exception>
#include <foundation/error.hpp>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

namespace tetsuame::integrators {

class sundials_context {
 public:
  sundials_context() {
    SUNContext context = nullptr;
#if SUNDIALS_VERSION_MAJOR >= 7
    const int status = SUNContext_Create(SUN_COMM_NULL, &context);
#else
    const int status = SUNContext_Create(nullptr, &context);
#endif
    if (status != 0) foundation::fail_calculation("SUNDIALS could not create its context: is there enough memory?");
    context_.reset(context);
  }
  SUNContext get() const { return context_.get(); }

 private:
  struct release {
    void operator()(SUNContext context) const { SUNContext_Free(&context); }
  };
  std::unique_ptr<std::remove_pointer_t<SUNContext>, release> context_;
};

struct release_vector {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
using vector_handle = std::unique_ptr<_generic_N_Vector, release_vector>;

// SUNDIALS' last error message; warnings are not kept. An address of it is the handler's data.
struct sundials_messages {
  std::string last;
  static void handler(int code, const char* /*module*/, const char* function, char* text, void* messages) {
    constexpr int warning_code = 99;  // ARK_WARNING and KIN_WARNING
    if (code != warning_code) static_cast<sundials_messages*>(messages)->last = fmt::format("{}: {}", function, text);
  }
#if SUNDIALS_VERSION_MAJOR >= 7
  static void of_context(int /*line*/, const char* function, const char* /*file*/, const char* text,
                         SUNErrCode /*code*/, void* messages, SUNContext /*context*/) {
    static_cast<sundials_messages*>(messages)->last = fmt::format("{}: {}", function, text);
  }
#endif
};

// Whether a solver's messages are kept from here on. Each solver has a function for it (`set`); since 7 the context
// has.
#if SUNDIALS_VERSION_MAJOR >= 7
#define TETSUAME_KEEP_MESSAGES(set, memory, context, messages) \
  (SUNContext_ClearErrHandlers((context).get()) == 0 &&        \
   SUNContext_PushErrHandler((context).get(), sundials_messages::of_context, &(messages)) == 0)
#else
#define TETSUAME_KEEP_MESSAGES(set, memory, context, messages) \
  (set(memory, sundials_messages::handler, &(messages)) == 0)
#endif

// Calls that SUNDIALS must not see fail with an exception: the first one thrown waits here.
class exception_carrier {
 public:
  // call()'s own value, or -1 when it threw.
  template <class Call>
  int guard(const Call& call) noexcept {
    try {
      return call();
    } catch (...) {
      if (!waiting_) waiting_ = std::current_exception();
      return -1;
    }
  }
  void rethrow() {  // if one waits
    if (waiting_) std::rethrow_exception(std::exchange(waiting_, nullptr));
  }

 private:
  std::exception_ptr waiting_;
};

}  // namespace tetsuame::integrators
