// What a run takes: as text, as numbers that follow from the lattice, and its memory, before the lattice is built.
#pragma once

#include <cstdint>
#include <domain/communicator.hpp>
#include <run/options.hpp>
#include <string>

namespace tetsuame::run {

std::string duration_text(double seconds);  // "35 s", "1.2 h", "2.1 days"
std::string size_text(double bytes);        // "675 kB", "1.2 GB"

// Particles of a lattice within r spacings of one of them.
double particles_within(double r_over_dx, std::int64_t dimension);

struct memory_need {
  double particles, bytes_each;
  double total() const { return particles * bytes_each; }  // B
};

// particles: of the fluid, of all ranks together. bytes: of each, beside its list: fields, their copies in the
// integrator, and what writing a snapshot takes, as measured of the largest resident size. The list has the particles
// within the kernel's support and the skin (o: resolved), as on a lattice.
memory_need need_of(double particles, double bytes, const kernel_options& o, std::int64_t dimension);

// What a run allocates of each particle, wherever these are.
struct allocated {
  double fields;         // B, particles::bytes_each()
  double integrated;     // numbers of the state of the time integration
  double vectors = 5.0;  // of these, that the integrator has
};
// The same from what is allocated. Nothing is of the box: a cloud of particles takes as much of cells, with some far
// from all others too, and no longer lists than on the lattice.
memory_need need_of(double particles, const allocated& each, const kernel_options& o, std::int64_t dimension);

// Collective. Says how much it will be where that is worth knowing, and throws bad_input where this machine has less:
// without it the system would end the program, or others, some time later. `where` is the place in the input, as its
// errors begin.
void check_memory(const domain::communicator& ranks, const std::string& program, const memory_need& need,
                  const std::string& where);

// Collective. B, the largest that all ranks together have had.
double resident_bytes(const domain::communicator& ranks);

}  // namespace tetsuame::run
