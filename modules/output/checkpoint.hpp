// Checkpoints: the full state in double precision, from which a run continues with the
// same bits on any number of ranks. The module knows names and arrays, not physics.
//
// checkpoint_NNNNNNNN.h5 (the step) holds /reals, /integers, /texts, /blobs and
// /particles/TABLE/FIELD, rows in the order of the particle IDs; in its user block an
// index with checksums over every byte (checkpoint.cpp). It is written under a
// temporary name, synced to disk and renamed, then all but the two newest are removed.
#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <foundation/error.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tetsuame::output {

// Values by name; one that is missing is an error of the file.
template <class T>
struct named_values : std::map<std::string, T> {
  using std::map<std::string, T>::map;
  const T& at(const std::string& name) const {
    const auto found = this->find(name);
    if (found == this->end())
      foundation::fail_file("the checkpoint has no '" + name + "': another version of the program wrote it");
    return found->second;
  }
};

// The same on every rank; written as rank 0 has them. Names are without '/'.
struct checkpoint_globals {
  named_values<double> reals;
  named_values<std::int64_t> integers;
  named_values<std::string> texts;
  named_values<std::vector<double>> blobs;
};

// What one rank holds of a kind of particles, to be written. The names are the same on
// every rank, and an ID occurs once in the table over all ranks.
struct table_view {
  std::string name;
  std::size_t n = 0;
  const std::int64_t* ids = nullptr;
  std::vector<std::pair<std::string, const double*>> reals;
  std::vector<std::pair<std::string, const std::int64_t*>> integers;
};

// As read: ascending in ID, in equal parts, of which the first N mod p of p ranks have one row more.
struct table {
  std::vector<std::int64_t> ids;
  named_values<std::vector<double>> reals;
  named_values<std::vector<std::int64_t>> integers;
};

struct checkpoint {
  checkpoint_globals globals;
  named_values<table> tables;
};

std::string checkpoint_name(std::int64_t step);  // checkpoint_00001200.h5

// All that follows is collective, and throws fail_file on every rank with path and reason.

// Returns the path. Where it fails, the checkpoints that were there are untouched.
std::string write_checkpoint(MPI_Comm comm, const std::string& directory, std::int64_t step,
                             const checkpoint_globals& globals, const std::vector<table_view>& tables);

// All checksums are verified before anything is handed out.
checkpoint read_checkpoint(MPI_Comm comm, const std::string& path);

// On this process alone, without MPI: what is not of particles, its checksums verified.
checkpoint_globals read_globals(const std::string& path);
// Of the newest checkpoint in the directory whose globals are whole.
checkpoint_globals newest_globals(const std::string& directory);

struct latest_checkpoint {
  std::string path;
  checkpoint state;
  std::vector<std::string> messages;  // why newer ones were passed over
};

// The newest checkpoint in the directory that is whole.
latest_checkpoint find_latest(MPI_Comm comm, const std::string& directory);

// After a restart. Removes the checkpoints of later steps than the one that
// the run continues from: damaged ones, or of a course that is given up.
void forget_checkpoints_after(MPI_Comm comm, const std::string& directory, std::int64_t step);

}  // namespace tetsuame::output
