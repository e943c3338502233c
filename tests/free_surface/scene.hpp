// What the tests of water share: an input as a scene of its own.
#pragma once

#include <mpi.h>

#include <free_surface/loads.hpp>
#include <free_surface/start.hpp>
#include <namelist/document.hpp>
#include <optional>
#include <run/passes.hpp>

namespace tetsuame::free_surface {

struct mpi_environment {
  mpi_environment() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  }
  ~mpi_environment() { MPI_Finalize(); }
};

// An input, and what begins with it, with lists.
template <int D>
struct scene {
  options o;
  parameters p;
  std::optional<water<D>> f;

  explicit scene(const std::string& text) {
    namelist::schema schema;
    declare(schema, o);
    schema.read(namelist::parse_text(text, "test.nml"));
    p = resolve(schema, o);
    f.emplace(o, p);
    set_up(*f);
    rebuild();
  }
  void rebuild() {
    place_bodies_for_lists(*f, false);
    run::rebuild(f->world, false);
    f->make_room();
    find_beside_bodies(*f);
    group_walls(*f);
  }
  particles::particles<D>& particles() { return f->world.w.s; }

  // Rates of x, v, ρ, and of free bodies.
  std::vector<particles::array> rates() {
    std::vector<particles::array> all(2 * D + 1, particles::array(particles().fluid, 0.0));
    for (const auto& component : f->free.state) all.emplace_back(component.size(), 0.0);
    std::vector<double*> places;
    for (auto& a : all) places.push_back(a.data());
    evaluate(*f, std::span<double* const>(places));
    return all;
  }
  template <class Value>
  double sum(Value&& value) {
    foundation::exact_sum all;
    for (std::size_t i = 0; i < particles().fluid; ++i) all.add(value(i));
    return f->ranks().exact(all);
  }
};

}  // namespace tetsuame::free_surface
