// What every use of SUNDIALS here shares: the context all its objects belong to, and a
// handler that keeps SUNDIALS' messages instead of printing them, so that each becomes
// a foundation::error or a result's reason. Also carries exceptions through C code.
#pragma once

#include <sundials/sundials_context.h>
#include <sundials/sundials_nvector.h>

#include <exception>
#include <functional>
#include <memory>
#include <string>

namespace tetsuame::integrators {

class sundials_context {
 public:
  sundials_context();  // fail_calculation if SUNDIALS cannot make one
  SUNContext get() const { return context_.get(); }

 private:
  struct release {
    void operator()(SUNContext context) const { SUNContext_Free(&context); }
  };
  std::unique_ptr<_SUNContext, release> context_;
};

struct release_vector {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
using vector_handle = std::unique_ptr<_generic_N_Vector, release_vector>;

// SUNDIALS' last error message; warnings are not kept. An address of it is the handler's data.
struct sundials_messages {
  std::string last;
  static void handler(int code, const char* module, const char* function, char* text, void* messages);
};

// Calls that SUNDIALS must not see fail with an exception: the first one thrown waits here.
class exception_carrier {
 public:
  // call()'s own value, or -1 when it threw.
  int guard(const std::function<int()>& call) noexcept;
  bool waiting() const { return static_cast<bool>(waiting_); }
  void rethrow();  // if one waits

 private:
  std::exception_ptr waiting_;
};

}  // namespace tetsuame::integrators
