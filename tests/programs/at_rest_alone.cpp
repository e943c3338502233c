// The problems that the disph_c of test_simd.py leaves out.
#include <foundation/error.hpp>
#include <problems/make.hpp>

namespace tetsuame::problems {

namespace {
[[noreturn]] void leave_out() { foundation::fail_input("this program of the tests runs boxes at rest alone"); }
}  // namespace

std::unique_ptr<run::problem> two_fluids_2d(two_fluids::problem_kind, const two_fluids::options&,
                                            const two_fluids::parameters&, const liquid::program*) {
  leave_out();
}
std::unique_ptr<run::problem> two_fluids_3d(two_fluids::problem_kind, const two_fluids::options&,
                                            const two_fluids::parameters&, const liquid::program*) {
  leave_out();
}

}  // namespace tetsuame::problems
