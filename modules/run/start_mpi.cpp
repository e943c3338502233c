#include <mpi.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <initializer_list>
#include <run/start_mpi.hpp>

namespace {

constexpr const char* mark = "TETSUAME_MPI_STARTED_AGAIN";  // in the environment of the second start
char** arguments = nullptr;                                 // of a start that may be tried again; none: MPI has started
pid_t starts = 0;                                           // this process, not one that Open MPI begins

void start_again() {
  std::fputs("MPI could not be started; once more, in a moment\n", stderr);
  // Not all of those that met at the same time again.
  const timespec pause{0, 300'000'000 + getpid() % 100 * 5'000'000};
  nanosleep(&pause, nullptr);
  setenv(mark, "1", 1);
  execv("/proc/self/exe", arguments);
}

bool under_a_launcher() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

}  // namespace

// Open MPI leaves a failed MPI_Init by _exit, which no handler of exit or of MPI sees; a program's own definition is
// called before the C library's.
extern "C" [[noreturn]] void _exit(int status) {
  if (arguments != nullptr && status != 0 && getpid() == starts) start_again();
  for (;;) syscall(SYS_exit_group, status);
}

namespace tetsuame::run {

void start_mpi(int& argc, char**& argv) {
  starts = getpid();
  if (!under_a_launcher() && std::getenv(mark) == nullptr) arguments = argv;
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  arguments = nullptr;
  unsetenv(mark);
}

}  // namespace tetsuame::run
