// Files that an input names: one rule for all of them, in every program.
//
// A path begins at the folder of the input, that of --set at the current one (namelist/schema.hpp). A file is copied
// beside the results under a name by which the input as resolved finds it, so that the run goes on from anywhere, also
// where the original is gone. A checkpoint holds a hash of each, and a run is not continued with others. A snapshot to
// start from matters to the start alone: it is not asked for where a run goes on, and is copied if it is small.
#pragma once

#include <map>
#include <namelist/schema.hpp>
#include <string>
#include <vector>

namespace tetsuame::run {

struct input_file {
  std::string where;  // "file:line: &group key"
  std::string from;   // the path that is read
  std::string name;   // of its copy; of a file that is not copied its own
  bool copied = true;
  bool of_start = false;

  std::string label() const;  // of its hash: "initial.file", the key of a snapshot to start from; else the name
};

// At a restart copies in `earlier`, the folder of the run that goes on, take the place of files that are gone. Fails,
// with bad_input at the file's key, where one is not there or no plain file. Empty: the run begins.
std::vector<input_file> find_input_files(const namelist::schema& schema, const std::string& earlier);

// The input as resolved, with the copies' names in place of paths, after `first_line`.
std::string resolved_with_copies(const namelist::schema& schema, const std::vector<input_file>& files,
                                 const std::string& first_line);

// Names of the copies that the run in this folder made, as far as its resolved input tells them.
std::vector<std::string> copies_in(const std::string& folder);

// By the files' labels; of those that are there.
std::map<std::string, std::string> hashes_of(const std::vector<input_file>& files);

// Fails where a file is another than that of the checkpoint, whose hashes are `saved`. A snapshot that the run started
// from may be gone.
void expect_same_files(const std::vector<input_file>& files, const std::map<std::string, std::string>& saved);

}  // namespace tetsuame::run
