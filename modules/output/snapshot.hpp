// Snapshots for looking at: HDF5 in GADGET's layout, which yt, SPLASH and h5py open, and a time series of them.
//
//   /Header           NumPart_ThisFile, NumPart_Total, NumPart_Total_HighWord, MassTable, Time, Redshift,
//                     BoxSize, NumFilesPerSnapshot, Flag_*, … [V. Springel, GADGET-2 user guide, table 4]
//                     and Dimension, BoxLengths, Periodic, Unit* (SI, told in cgs as is the custom), and KernelSupport:
//                     SmoothingLength is the h of the kernel, where GADGET has the radius of its support, KernelSupport
//                     h
//   /PartType0, 1     ParticleIDs and the columns, fluid and wall; each with units and description
//   /Connectivity0, 1 0 … N-1, which ParaView needs to draw points
//   /Provenance       ResolvedInput, and Program and Version as attributes
//
// Rows in the order of the particle IDs: the same bytes on any number of ranks. Two lines more make yt read SI:
//
//   yt.load(file, unit_base={"length": (1.0, "m"), "mass": (1.0, "kg"), "velocity": (1.0, "m/s")})
#pragma once

#include <mpi.h>

#include <array>
#include <output/groups.hpp>
#include <string>
#include <vector>

namespace tetsuame::output {

struct snapshot_header {
  double time = 0.0;  // s
  std::int64_t step = 0;
  int dimension = 2;
  std::array<double, 3> box_lengths{};  // m; 0 beyond the dimension
  std::array<bool, 3> periodic{};
  double kernel_support = 0.0;  // radius of the kernel's support over SmoothingLength
};

struct provenance {
  std::string program, version, resolved_input;
};

std::string snapshot_name(int number);  // snapshot_0007.h5

// What of the columns is written, and how.
struct snapshot_form {
  std::vector<std::string> fields;  // none: all; Coordinates and ParticleIDs stand in every file
  bool single = false;  // real columns but Coordinates, of which rounding could carry a particle out of its box
  bool compressed = false;
};

// Of the values of these groups in that form, before compression.
std::uint64_t bytes_of(std::vector<particle_group> groups, const snapshot_form& form);

// Collective. Written under a temporary name, then renamed. Throws fail_file on every
// rank with path and reason (disk full, no permission), and leaves an older file as it was.
void write_snapshot(MPI_Comm comm, const std::string& path, const snapshot_header& header,
                    std::vector<particle_group> groups, const provenance& origin, const snapshot_form& form = {});

// series.xdmf, and walls.xdmf where particles stand in the walls: the snapshots of a directory as a time series that
// ParaView opens, and meshio's TimeSeriesReader, which knows no grids within the grid of a time. A temporal collection
// of points. Polyvertex with an explicit connectivity array: without it ParaView's default reader shows nothing and
// says nothing. A snapshot is added in place of the file's last lines, which then follow it: its cost does not grow
// with their number. Meaningful on rank 0; empty on the others.
struct series {
  std::array<std::uint64_t, 2> end{};  // bytes of each file before its last lines; 0: there is none yet
  std::vector<std::string> messages;   // snapshots that could not be read and were left out
};

// Collective: adds the snapshot just written to these files in DIRECTORY. Throws fail_file on every rank.
void add_to_series(MPI_Comm comm, const std::string& directory, const std::string& snapshot_file, series& all);

// Collective; after a restart. Snapshots numbered below `next` make up the series again,
// as their files tell; those from `next` on, which the run is about to repeat, are
// removed. Throws fail_file on every rank if they cannot be written.
series continue_series(MPI_Comm comm, const std::string& directory, int next);

}  // namespace tetsuame::output
