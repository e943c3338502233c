// A pass: one item of the list that an evaluation of the right-hand side consists of, with the fields that it reads and
// writes. What travels between ranks, what is mirrored behind walls and in which order rows are summed follows from
// these (schedule.hpp).
//
//   each    a value a particle, from its own fields
//   sum     over the neighbours of particles
//   walls   what a boundary treatment gives the particles that stand behind walls
//   whole   anything else, once an evaluation: an iteration with sums of its own
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <pairs/cluster.hpp>
#include <particles/named_fields.hpp>
#include <utility>
#include <vector>

namespace tetsuame::passes {

using field = particles::array;

// Fields of the particles' table; a vector stands for its components. A field that the run lacks is left out.
class fields {
 public:
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }
  bool empty() const { return all_.empty(); }

  class part {
   public:
    part(field& f) { add(f); }
    template <std::size_t N>
    part(std::array<field, N>& vector) {
      for (field& component : vector) add(component);
    }
    template <std::size_t N>
    part(const particles::vector_field<N>& vector) {
      for (std::size_t k = 0; k < N; ++k) add(vector[k]);
    }
    part(const fields& some) : all(some.begin(), some.end()) {}

    std::vector<field*> all;

   private:
    void add(field& f) {
      if (&f != &particles::no_values()) all.push_back(&f);
    }
  };

  fields() = default;
  fields(std::initializer_list<part> parts) {
    for (const auto& p : parts) all_.insert(all_.end(), p.all.begin(), p.all.end());
  }
  void add(const fields& others) { all_.insert(all_.end(), others.begin(), others.end()); }

 private:
  std::vector<field*> all_;
};

struct access {
  fields reads{};          // of the particle itself
  fields at_neighbours{};  // of neighbours as well: of ghosts, and of what stands behind walls
  fields writes{};         // of which it is the only writer
  fields updates{};        // of what an earlier pass has written, or what is known at the start
  fields rates{};          // dy/dt of these integrated fields, of which it is the last writer
  fields accumulates{};    // what stands in the place of a rate until then: sums to be divided by masses
  fields spreads{};        // of what it writes or updates: that of ghosts as well, which it brings there itself
  fields gives{};          // what it leaves of particles that stand behind walls
};

// The rows that a sum is for: all of them at once, or first those that wait for no ghosts and then the others.
enum class rows { all, interior, border };

struct pass {
  enum class kind { each, sum, walls, whole };

  const char* stage;  // in the times that are told
  kind of;
  access uses;
  bool everywhere = false;  // each: computed of ghosts and of what stands behind walls, too
  bool sees_walls = true;   // sum: what stands behind walls is among the neighbours

  std::function<void(std::size_t, std::size_t)> each{};  // particles [first, last), on one thread
  std::function<void(const pairs::row_range&, rows)> sum{};
  std::function<void()> once{};  // walls and whole
};

}  // namespace tetsuame::passes
