// MPI for a whole executable of tests: BOOST_TEST_GLOBAL_FIXTURE(mpi_environment).
#pragma once

#include <mpi.h>

namespace tetsuame::test {

struct mpi_environment {
  mpi_environment() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  }
  ~mpi_environment() { MPI_Finalize(); }
};

}  // namespace tetsuame::test
