// DIR/NAME: starts DIR/avx512/NAME, which sums eight neighbours at a time, where this processor has AVX-512,
// else DIR/avx2/NAME, which sums four; the latter too where it alone was built, or with TETSUAME_SIMD=avx2 in the
// environment. The program takes this process's place: same process, arguments, environment but for what OpenMP is to
// do with several ranks. Free of MPI and OpenMP, so that neither is started, or binds the process to a core, twice.
#include <sched.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

// What -march=x86-64-v4 asks for.
bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}

// A signal that asks a run to stop waits until the program can note it (modules/run/interrupt.cpp).
void hold_signals_back(int, char**, char**) {
  sigset_t all;
  sigemptyset(&all);
  for (const int number : {SIGINT, SIGTERM, SIGUSR1, SIGHUP, SIGXCPU}) sigaddset(&all, number);
  sigprocmask(SIG_BLOCK, &all, nullptr);
}
[[gnu::used, gnu::section(".preinit_array")]] void (*hold_at_once)(int, char**, char**) = hold_signals_back;

// Ranks of this run on this machine, as their launcher tells; 1 without one.
int ranks_here() {
  for (const char* name : {"OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"})
    if (const char* number = std::getenv(name)) return std::atoi(number);
  return 1;
}

// OpenMP reads its variables when it is loaded. Where nobody says how many threads a rank is to have, the ranks on a
// machine share its processors, as far as each may use them; where they have more threads than processors all the same,
// who waits sleeps, and does not keep others from what it waits for.
void share_processors() {
  cpu_set_t mine;
  const int ranks = ranks_here() > 1 ? ranks_here() : 1, whole = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  if (sched_getaffinity(0, sizeof mine, &mine) != 0) return;
  const int share = whole / ranks > 1 ? whole / ranks : 1, allowed = CPU_COUNT(&mine);
  const char* given = std::getenv("OMP_NUM_THREADS");
  const int threads = given != nullptr ? std::atoi(given) : share < allowed ? share : allowed;
  if (given == nullptr && ranks > 1) setenv("OMP_NUM_THREADS", std::to_string(threads).c_str(), 0);
  if (threads * ranks > whole) setenv("OMP_WAIT_POLICY", "passive", 0);
}

bool is_there(const std::string& program) { return access(program.c_str(), X_OK) == 0; }

}  // namespace

int main(int, char** argv) {
  char self[4096];
  const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  if (length <= 0) {
    std::perror("/proc/self/exe");
    return 4;
  }
  self[length] = '\0';
  char* name = std::strrchr(self, '/');
  *name++ = '\0';
  const std::string wide = std::string(self) + "/avx512/" + name, narrow = std::string(self) + "/avx2/" + name;
  const char* wanted = std::getenv("TETSUAME_SIMD");
  const bool narrow_wanted = wanted != nullptr && std::strcmp(wanted, "avx2") == 0;
  const std::string& program = has_avx512() && !narrow_wanted && is_there(wide) ? wide : narrow;
  share_processors();
  execv(program.c_str(), argv);  // returns only where it cannot
  if (is_there(wide) && !is_there(narrow))
    std::fprintf(stderr, "%s: built for processors with AVX-512 alone, %s; ./run build --portable builds both kinds\n",
                 name, has_avx512() ? "and TETSUAME_SIMD asks for AVX2" : "which this one does not have");
  else if (!is_there(narrow))
    std::fprintf(stderr, "%s: not built: neither %s nor %s is there; ./run build builds it\n", name, wide.c_str(),
                 narrow.c_str());
  else
    std::perror(program.c_str());
  return 4;
}
