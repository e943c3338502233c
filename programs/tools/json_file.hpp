// What a tool measured or found, for other programs.
#pragma once

#include <foundation/error.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tetsuame::tools {

// fail_file if it cannot be written.
inline void write_json(const std::string& path, const nlohmann::ordered_json& all) {
  std::ofstream file(path);
  file << all.dump(1) << '\n';
  file.close();
  if (!file) foundation::fail_file(path + ": cannot be written; is there space, and may you write there?");
}

}  // namespace tetsuame::tools
