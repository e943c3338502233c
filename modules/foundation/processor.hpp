// The same program for two generations of processors: DIR/NAME for AVX2, DIR/avx512/NAME for AVX-512,
// which sums eight neighbours at a time instead of four.
#pragma once

namespace tetsuame::foundation {

// Where this processor has AVX-512 and the program was built for it too, that one takes this process's place
// (same process, arguments and environment); else, and with TETSUAME_SIMD=avx2 in the environment,
// nothing happens. To be called first, before MPI starts.
void hand_over_to_widest(char** argv);

}  // namespace tetsuame::foundation
