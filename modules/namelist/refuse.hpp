#pragma once

#include <namelist/schema.hpp>

namespace tetsuame::namelist {

// Keys that mean nothing here; with their defaults, as a resolved input has them, they may stand.
inline void refuse(const schema& of, const std::string& group, const std::vector<std::string>& keys,
                   const std::string& why) {
  for (const auto& key : keys)
    if (of.changed(group, key)) of.fail(group, key, why);
}

}  // namespace tetsuame::namelist
