// DIR/NAME: starts DIR/avx512/NAME, which sums eight neighbours at a time, where this processor has AVX-512,
// else DIR/avx2/NAME, which sums four; always the latter with TETSUAME_SIMD=avx2 in the environment. The program
// takes this process's place: same process, arguments, environment. Free of MPI and OpenMP, so that neither
// is started, or binds the process to a core, twice.
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
  const char* wanted = std::getenv("TETSUAME_SIMD");
  const bool wide = has_avx512() && (wanted == nullptr || std::strcmp(wanted, "avx2") != 0);
  const std::string program = std::string(self) + (wide ? "/avx512/" : "/avx2/") + name;
  execv(program.c_str(), argv);  // returns only where it cannot
  std::perror(program.c_str());
  return 4;
}
