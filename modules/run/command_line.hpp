// The command line all programs share, and the end all programs come to.
#pragma once

#include <functional>
#include <map>
#include <namelist/schema.hpp>
#include <run/amounts.hpp>
#include <run/input_files.hpp>
#include <run/rehearsal.hpp>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tetsuame::run {

struct command_line {
  std::string program;           // disph_c
  std::string started_as;        // build/programs/disph_c
  std::string input;             // path of the namelist
  std::vector<std::string> set;  // group.key=value
  std::string output;            // directory
  std::string restart;           // checkpoint file, or "latest"; empty: none
  bool check = false, describe = false, force = false, plan = false;
  std::string particles_at;                              // where their number was given
  std::vector<input_file> files;                         // that the input names
  std::map<std::string, namelist::key_at_restart> keys;  // of the input
  rehearsal rehearsed;                                   // of --plan, where rank 0 is
};

// A program with an input of its own.
struct program_input {
  std::string program;
  bool restarts = false;                                  // knows --restart and --plan
  std::function<void(namelist::schema&)> declare;         // all groups and keys
  std::function<void(const namelist::schema&)> complete;  // fills and checks what takes more than one key
  std::function<memory_need()> need = {};                 // after complete; none: it is no matter
  std::pair<std::string, std::string> particles_key = {"domain", "particles_x"};  // where their number is given
  // Settings for a rehearsal of the run, group.key=value (rehearsal.hpp).
  std::vector<std::string> rehearsed_with = {};
  // Before declare: what the input's groups say of the problem. None: there is but one.
  std::function<void(const namelist::document&)> choose = {};
  std::function<void(CLI::App&, command_line&)> add_options = {};  // of its own
};
// Starts MPI, reads the command line and the input, handles --describe, --check, --help and
// --version, then calls `run` with the input as resolved, a namelist. Returns the exit status; every error is told
// once, by rank 0.
int start(int argc, char** argv, const program_input& input,
          const std::function<void(const command_line&, const std::string& resolved)>& run);

// What somebody asked for, to the standard output. Throws fail_file where that cannot be written, and may have been cut
// short.
void print(const std::string& text);
void check_standard_output();

// The program that a group of an input is for, where it is for no other; empty: several.
std::string program_of_group(const std::string& group);

// Of the source: the git commit it was built from; and the last number of CHANGELOG.md.
std::string version();
std::string release();

}  // namespace tetsuame::run
