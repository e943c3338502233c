// DIR/NAME: starts DIR/avx512/NAME, which sums eight neighbours at a time, where this processor has AVX-512,
// else DIR/avx2/NAME, which sums four; the latter too where it alone was built, or with TETSUAME_SIMD=avx2 in the
// environment. The program takes this process's place: same process, arguments, environment. Free of MPI and OpenMP,
// so that neither is started, or binds the process to a core, twice.
#include <unistd.h>

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
