// series.xdmf: the snapshots of a directory as one time series that ParaView opens.
// A temporal collection; each time holds "fluid" and "wall" as separate grids of
// points. Polyvertex with an explicit connectivity array: without it ParaView's
// default reader shows nothing and says nothing.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <output/hdf5_layout.hpp>
#include <string>
#include <vector>

namespace tetsuame::output {

struct series_group {
  int type = 0;
  std::vector<stored_dataset> datasets;
  std::size_t connectivity_bytes = 4;  // of one number
};

struct series_entry {
  std::string file;   // name inside the directory
  double time = 0.0;  // s
  std::vector<series_group> groups;
};

// Meaningful on rank 0; empty on the others.
struct series {
  std::vector<series_entry> entries;
  std::vector<std::string> messages;  // snapshots that could not be read and were left out
};

// Collective: adds the snapshot just written and replaces DIRECTORY/series.xdmf in one
// step. Throws fail_file on every rank.
void add_to_series(MPI_Comm comm, const std::string& directory, const std::string& snapshot_file, series& all);

// Collective; after a restart. Snapshots numbered below `next` make up the series again,
// as their files tell; those from `next` on, which the run is about to repeat, are
// removed. Throws fail_file on every rank if series.xdmf cannot be written.
series continue_series(MPI_Comm comm, const std::string& directory, int next);

std::string xdmf_text(const series& all);

}  // namespace tetsuame::output
