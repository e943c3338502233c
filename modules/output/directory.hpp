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

// Collective: rank 0 looks, all agree.
//   fail_input  the directory is not empty (fresh), the path is a file, or another run writes there: nothing was
//   written fail_file   it cannot be made or written, or there is nothing to continue (restart)
// Removes what a killed run left half written (*.tmp of our own names). From here on a
// file-size limit fails a write instead of ending the program by a signal.
void open_directory(MPI_Comm comm, const std::string& directory, directory_mode mode);

// Is this one of the names that a run gives to its files?
bool is_our_file(const std::string& name);

// On this rank: the files PREFIX<digits>SUFFIX with their numbers, ascending.
std::vector<std::pair<std::int64_t, std::string>> numbered_files(const std::string& directory,
                                                                 const std::string& prefix, const std::string& suffix);

}  // namespace tetsuame::output
