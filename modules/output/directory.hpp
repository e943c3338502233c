// The output directory: made, or refused before anything in it is touched.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetsuame::output {

enum class directory_mode {
  fresh,    // a new or empty directory
  force,    // --force: results of an earlier run in it are removed, other files stay
  restart,  // --restart: an earlier run is continued in it
};

// An output directory that this process holds until it ends; the two steps of opening one, for a run that has to read
// or to set up something before it may change anything.
class claimed_directory {
 public:
  // Collective: rank 0 looks, all agree. Makes the directory where it may, and keeps other runs out.
  //   fail_input   the directory is not empty (fresh), the path is a file, or another run writes there
  //   fail_file    it cannot be made or written, or there is nothing to continue (restart)
  // Nothing that stands in it was touched. From here on a file-size limit fails a write instead of ending the program
  // by a signal. own_names: beside those that every run gives to its files, what this program calls its own.
  claimed_directory(MPI_Comm comm, const std::string& directory, directory_mode mode,
                    std::vector<std::string> own_names = {});
  // Removes the directories that were made, as far as they are empty still.
  ~claimed_directory();
  claimed_directory(const claimed_directory&) = delete;
  claimed_directory& operator=(const claimed_directory&) = delete;

  // Collective. Removes what a killed run left half written (*.tmp of our own names), and with `force` the results of
  // an earlier run, but for the file `kept`, and its copies of files that its input named. A table, a snapshot or a
  // checkpoint that no run wrote stays, whatever it is called.
  void clear(directory_mode mode, const std::string& kept = {}, const std::vector<std::string>& copies = {});

 private:
  MPI_Comm comm_;
  std::string directory_;
  std::vector<std::string> own_names_;
  std::vector<std::string> made_;  // rank 0; the innermost first
};

// On the rank that holds it: where a directory is that was claimed by this name, and may have been moved since. The
// name itself where that is not known.
std::string present_place(const std::string& directory);

void open_directory(MPI_Comm comm, const std::string& directory, directory_mode mode,
                    const std::vector<std::string>& own_names = {});

// On this rank: whether this is one of the names that a run gives to its files; whether the directory holds a file that
// a run wrote; the files PREFIX<digits>SUFFIX with their numbers, ascending.
bool is_our_file(const std::string& name);
bool holds_a_run(const std::string& directory);
std::vector<std::pair<std::int64_t, std::string>> numbered_files(const std::string& directory,
                                                                 const std::string& prefix, const std::string& suffix);

}  // namespace tetsuame::output
