// series.xdmf: the snapshots of a directory as one time series that ParaView opens.
// A temporal collection; each time holds "fluid" and "wall" as separate grids of
// points. Polyvertex with an explicit connectivity array: without it ParaView's
// default reader shows nothing and says nothing. A snapshot is added in place of the
// file's last lines, which then follow it: its cost does not grow with their number.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

namespace tetsuame::output {

// Meaningful on rank 0; empty on the others.
struct series {
  std::uint64_t end = 0;              // bytes of series.xdmf before its last lines; 0: there is none yet
  std::vector<std::string> messages;  // snapshots that could not be read and were left out
};

// Collective: adds the snapshot just written to DIRECTORY/series.xdmf. Throws fail_file on every rank.
void add_to_series(MPI_Comm comm, const std::string& directory, const std::string& snapshot_file, series& all);

// Collective; after a restart. Snapshots numbered below `next` make up the series again,
// as their files tell; those from `next` on, which the run is about to repeat, are
// removed. Throws fail_file on every rank if series.xdmf cannot be written.
series continue_series(MPI_Comm comm, const std::string& directory, int next);

}  // namespace tetsuame::output
