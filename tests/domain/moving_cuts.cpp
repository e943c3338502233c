// Cuts that move while a program runs: nobody's result changes, whoever computes it.
#include <gradient/pattern_1.hpp>
#include <hydrostatic/hydrostatic.hpp>
#include <liquid/passes.hpp>
#include <liquid/scheme_of.hpp>
#include <volume/our_method.hpp>

#include "../support/scene.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

struct program {
  using volume = tetsuame::volume::our_method;
  using pressure = tetsuame::volume::smoothed;
  using gradient = tetsuame::gradient::pattern_1;
};

// Walls below and above drag the fluid along in opposite directions; periodic sideways.
hydrostatic::options channel(hydrostatic::options o) {
  o.domain.periodic[1] = false;
  o.walls.sides[2].velocity = -700.0;
  o.walls.sides[3].velocity = 700.0;
  o.material.viscosity = 2e6;
  o.time.dt = 4e-5;
  o.time.steps = 60;
  o.time.t_end = 1.0;
  o.balance.follows = "off";  // cuts are the test's
  return o;
}

struct outcome {
  std::string hash;
  int moves = 0;
  std::size_t distinct_sizes = 0;  // numbers of particles that this rank has had
};

template <int D, class Propose>
outcome run_with(const hydrostatic::options& o, const domain::communicator& ranks, Propose&& propose) {
  hydrostatic::problem<D> box(o, std::make_unique<liquid::scheme_of<program, D>>(o.scheme), ranks);
  box.rebuild(false);
  integrators::explicit_integrator integrator(ranks.comm, box.arrays().fields, box.arrays().size, 0.0,
                                              {.method = o.time.method, .dt = *o.time.dt},
                                              [&](double, std::span<double* const> rate) {
                                                box.evaluate({}, rate);
                                                return 0;
                                              });
  outcome found;
  std::vector<std::size_t> sizes;
  for (int n = 0; n < o.time.steps; ++n) {
    const double reach =
        run::on_all(ranks, box.moved()).length() + 1.6 * run::on_all(ranks, box.speed()).length() * *o.time.dt;
    const bool due = n > 0 && reach > box.allowance();
    if (due) {
      sizes.push_back(box.arrays().size);
      box.move_cuts(propose(box.world.w.d.cuts, found.moves++));
    }
    if (box.renew(due, n, o.time.steps - n)) integrator.resize(box.arrays().fields, box.arrays().size);
    integrator.step(integrator.time() + *o.time.dt);
    box.complete_step(n + 1);
  }
  std::vector<particles::array> rates(box.fields().size(), particles::array(box.arrays().size));
  std::vector<double*> pointers;
  for (auto& a : rates) pointers.push_back(a.data());
  box.evaluate({}, pointers);
  found.hash = box.hash();
  std::sort(sizes.begin(), sizes.end());
  found.distinct_sizes = static_cast<std::size_t>(std::unique(sizes.begin(), sizes.end()) - sizes.begin());
  return found;
}

template <int D>
void compare(hydrostatic::options o) {
  const auto stay = [](const balance::cuts<D>& now, int) { return now; };
  const auto alone_hash = run_with<D>(o, alone(), stay);
  BOOST_TEST(alone_hash.moves > 3);  // lists were made anew so often

  // Cuts thrown anywhere, anew each time; every fourth time all particles go to the first rank.
  const auto world = domain::communicator::world();
  o.domain.ranks_x.number = world.size % 2 == 0 ? 2 : 1;
  const auto thrown = [&](balance::cuts<D> cuts, int n) {
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t g = 0; g < cuts.groups(a); ++g) {
        double* c = cuts.group(a, g);
        for (int i = 1; i < cuts.counts[a]; ++i)
          c[i] = n % 4 == 3 ? o.domain.length[a]
                            : o.domain.length[a] * 0.5 * (1.0 + noise(1000 * n + 100 * static_cast<int>(g) + i, a));
        std::sort(c + 1, c + cuts.counts[a]);
      }
    return cuts;
  };
  const auto moved = run_with<D>(o, world, thrown);
  BOOST_TEST(moved.hash == alone_hash.hash);
  BOOST_TEST(moved.moves == alone_hash.moves);
  if (world.size > 1) BOOST_TEST(moved.distinct_sizes > 1U);
}

}  // namespace

BOOST_AUTO_TEST_CASE(in_two_dimensions) { compare<2>(channel(box<2>({24, 12}, true, "virtual_marker"))); }
BOOST_AUTO_TEST_CASE(in_three_dimensions) {
  compare<3>(channel(box<3>({12, 8, 6}, true, "virtual_marker", "wendland_c2")));
}
