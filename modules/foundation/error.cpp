#include <foundation/error.hpp>

namespace tetsuame::foundation {

void fail_input(const std::string& message) { throw error(exit_status::bad_input, message); }
void fail_calculation(const std::string& message) { throw error(exit_status::calculation_failed, message); }
void fail_file(const std::string& message) { throw error(exit_status::file_failed, message); }

}  // namespace tetsuame::foundation
