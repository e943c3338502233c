// The group &sample of oracle.f90 as our schema sees it: same keys, same defaults.
#pragma once

#include <cstdint>
#include <namelist/schema.hpp>
#include <string>
#include <vector>

struct sample {
  double r = -1.5, r2 = -2.5, inf = -3.5;
  std::vector<double> ra{-0.25, -0.5, -0.75, -1.0, -1.25, -1.5, -1.75, -2.0};
  std::int64_t i = -101, j = -102;
  std::vector<std::int64_t> ia{-10, -20, -30, -40, -50, -60, -70, -80};
  bool flag = false, flag2 = true;
  std::string s = "default s", t = "default t";
  std::vector<std::string> sa{"first", "second", "third", "fourth"};

  bool operator==(const sample&) const = default;
};

tetsuame::namelist::schema schema_of(sample& to);
// In the oracle's own format, without the lines "file" and "status".
std::string printed(const sample& values);
