// The vector SUNDIALS works on: a list of scalar fields (x, y, v_x, …), each a plain
// array, most with one value a particle, spread over ranks. A "home" vector points at arrays
// that belong to others (the particles); its clones own their storage.
//
// Sums over all values (dot products, weighted root-mean-square norm
//   |x|_w = sqrt( sum_i (x_i w_i)^2 / N ),   N: all values of all ranks)
// are exact before one rounding [foundation::exact_sum], extrema are exact anyway: every
// result has the same bits for any number of ranks, threads and any order of particles.
// A rank may hold no particles. The extrema take not-a-number as infinite.
//
// Copying is lazy: a copy of a clone shares its storage until one of the two is written, and a home vector remembers
// which storage holds the same values. Of the nine copies that ARKODE makes of its state in a step one remains.
#pragma once

#include <mpi.h>
#include <sundials/sundials_nvector.h>

#include <cstddef>
#include <integrators/sundials.hpp>
#include <span>
#include <vector>

namespace tetsuame::integrators {

// An array of a state: n values on this rank.
struct state_field {
  double* values;
  std::size_t n;
};

// A home vector over these arrays. Collective over `communicator`, which
// must outlive the vector, as must `context`. N_VGetLength is the global number of values.
vector_handle make_state_vector(SUNContext context, MPI_Comm communicator, const std::vector<state_field>& fields);

std::span<const double* const> values(N_Vector v);         // one pointer a field
std::span<double* const> values_to_overwrite(N_Vector v);  // the same, to be written in full: old values are lost

// A clone's values will not be read again: its storage is free, where it does not share it.
void forget_values(N_Vector clone);

// The arrays behind a home vector were written by others, or are others now (same n).
void home_was_changed(N_Vector home);
void set_home_arrays(N_Vector home, std::vector<double*> fields);

// True if the home arrays are known to hold the values of v.
bool holds_values_of(N_Vector home, N_Vector v);

// Copies of whole vectors that really moved data, by this home vector and its clones.
long long copies_made(N_Vector v);

}  // namespace tetsuame::integrators
