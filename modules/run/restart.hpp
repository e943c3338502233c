// What a restart may change of an input: the keys that are declared so (namelist::key_info::may_change). All other keys
// are the state's, and must be as they were.
#pragma once

#include <cstdint>
#include <map>
#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::run {

// What a checkpoint says of the run that wrote it.
struct saved_run {
  std::string program, input;  // as resolved
  std::int64_t step = 0;
  double time = 0.0;  // s
};

// The present one; keys: of the input, by "&group key".
struct present_run {
  const std::string& program;
  const std::string& input;  // as resolved
  const std::map<std::string, namelist::key_at_restart>& keys;
};

// Throws bad_input, with the place, where the program is another, or a key that may not change has changed.
void check_restart(const saved_run& was, const present_run& is);
// And where the run is to end before the state that the checkpoint holds.
void check_end(const saved_run& was, const present_run& is);

// Of a resolved input: the number that "&group key" has there; 0: none.
double number_in(const std::string& resolved, const std::string& key);

// On this process alone, without MPI: of the checkpoint of that path, or of the newest good one in the directory, where
// `restart` is "latest". Throws fail_file.
saved_run read_saved_run(const std::string& restart, const std::string& directory);

}  // namespace tetsuame::run
