// MPI_Init for a program that may be started beside others.
#pragma once

namespace tetsuame::run {

// A program without mpirun makes and removes Open MPI's directory of the session in /tmp, as does any other that starts
// or ends at that moment; the one that loses ends in MPI_Init. It is then started once more.
void start_mpi(int& argc, char**& argv);

}  // namespace tetsuame::run
