// What every use of SUNDIALS here shares, for versions 6.4 to 7: handles, and a handler that keeps its messages instead
// of printing them, so that each becomes a foundation::error or a result's reason. Also carries exceptions through C
// code.
#pragma once

#include <fmt/format.h>
#include <mpi.h>
#include <sundials/sundials_config.h>
#include <sundials/sundials_nvector.h>

#include <sundials/sundials_context.hpp>

#include <exception>
#include <foundation/waiting.hpp>
#include <memory>
#include <string>
#include <utility>

namespace tetsuame::integrators {

// Gives back what one of SUNDIALS' functions does.
template <auto free>
struct freed_by {
  void operator()(auto* p) const { free(p); }
};
using vector_handle = std::unique_ptr<_generic_N_Vector, freed_by<N_VDestroy>>;

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
  (SUNContext_ClearErrHandlers(context) == 0 &&                \
   SUNContext_PushErrHandler(context, sundials_messages::of_context, &(messages)) == 0)
#else
#define TETSUAME_KEEP_MESSAGES(set, memory, context, messages) \
  (set(memory, sundials_messages::handler, &(messages)) == 0)
#endif

// Calls that SUNDIALS must not see fail with an exception: the first one thrown waits here.
class exception_carrier {
 public:
  // call()'s own value, or -1 when it threw; of all ranks' values the most severe: 0 only if all are 0, else the
  // smallest negative one if any is negative, else the largest. Collective.
  template <class Call>
  int guard(MPI_Comm communicator, const Call& call) noexcept {
    int status = -1;
    try {
      status = call();
    } catch (...) {
      if (!waiting_) waiting_ = std::current_exception();
    }
    int extremes[2] = {status, -status};
    const foundation::collective timed;
    MPI_Allreduce(MPI_IN_PLACE, extremes, 2, MPI_INT, MPI_MAX, communicator);
    return extremes[1] > 0 ? -extremes[1] : extremes[0];
  }
  void rethrow() {  // if one waits
    if (waiting_) std::rethrow_exception(std::exchange(waiting_, nullptr));
  }

 private:
  std::exception_ptr waiting_;
};

}  // namespace tetsuame::integrators
