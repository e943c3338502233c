// A scheme of program shock on the bench: a periodic box of gas, a square of it four times as dense (a cube in 3-D),
// particles on one lattice and then off their places and moving. Steps as in the other cases (rig.hpp): forward Euler,
// so small that nothing changes.
#pragma once

#include <fmt/format.h>

#include <bench/turns.hpp>
#include <gas/rates.hpp>
#include <gas/start.hpp>
#include <integrators/explicit_integrator.hpp>

namespace tetsuame::bench {

inline std::string box_of_gas(const request& asked) {
  const auto n = asked.side;
  return fmt::format(
      "&domain dimension = {} length_x = {} particles_x = {} periodic_x = T periodic_y = T periodic_z = T /\n"
      "&shock test = 'square' scheme = '{}' masses = 'equal_spacing' rho_l = 4 p_l = 2.5 rho_r = 1 p_r = 2.5 /\n"
      "&time method = 'euler' dt = 1e-15 t_end = 1 /\n",
      asked.dimension, n, n, asked.name);
}

template <int D>
class shock_rig {
 public:
  explicit shock_rig(const request& asked) : asked_(asked), heap_before_(heap_bytes()) {
    namelist::schema schema;
    gas::declare(schema, o_);
    schema.read(namelist::parse_text(box_of_gas(asked), "bench"));
    gas::resolve(schema, o_);
    gas::set_up(g_.emplace(o_, gas::make_setup(o_)));
    gas::make_lists(*g_, false);
    gas::settle(*g_);
    auto& s = g_->w.s;
    for (std::size_t i = 0; i < s.fluid; ++i)
      for (std::size_t a = 0; a < D; ++a) {
        s.x[a][i] += 0.05 * g_->w.dx * scatter(s.id[i], a);
        s.v[a][i] = scatter(s.id[i], 3 + a);  // m/s
      }
    make_lists();
    integrators::explicit_options how;
    how.method = o_.common.time.method;
    how.dt = *o_.common.time.dt;
    integrator_.emplace(g_->ranks().comm, gas::integrated_fields(*g_), s.fluid, 0.0, how,
                        [this](double, std::span<double* const> rate) {
                          gas::evaluate(*g_, rate);
                          return 0;
                        });
    step();
    count_pairs(found_, g_->w, [&](std::size_t i) { return g_->S[i] * g_->S[i]; });
    count_bytes(found_, g_->w, heap_before_);
    found_.name = asked.name;
    found_.dimension = D;
    found_.particles = asked.particles();
    found_.passes = o_.evolves_density() ? 4 : o_.godunov() ? 3 : 2;
  }

  std::vector<result> measure() {
    auto all = with_threads(found_, asked_.threads);
    time_steps(all, asked_, {[&] { make_lists(); }, [&] { step(); }, g_->w.times});
    return all;
  }

 private:
  void make_lists() {
    gas::make_lists(*g_, false);
    if (integrator_) integrator_->resize(gas::integrated_fields(*g_), g_->w.s.fluid);
  }

  // As the time loop does it, whether lists are due or not.
  void step() {
    gas::moved(*g_);
    run::largest_speed(*g_);
    gas::next_supports(*g_);
    {
      const foundation::stage timed(g_->w.times, "integration");
      integrator_->step(1.0);
    }
    walls::reflect(g_->walls, g_->w.s);
  }

  request asked_;
  double heap_before_;
  gas::options o_;
  std::optional<gas::world<D>> g_;
  std::optional<integrators::explicit_integrator> integrator_;
  result found_;
};

template <int D>
void measure_scheme(const request& asked, const std::function<void(const result&)>& take) {
  shock_rig<D> bench(asked);
  for (const result& r : bench.measure()) take(r);
}

}  // namespace tetsuame::bench
