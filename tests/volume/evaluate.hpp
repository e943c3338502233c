// An evaluation of a scene by the passes of a program with these modules, as problems have it.
#pragma once

#include <gradient/pattern_1.hpp>
#include <liquid/evaluation.hpp>

#include "../support/scene.hpp"

namespace tetsuame::test {

template <class Volume, class Pressure>
struct program_of {
  using volume = Volume;
  using pressure = Pressure;
  using gradient = gradient::pattern_1;
};

template <class Pressure, class Volume, int D>
void evaluate(hydrostatic::scene<D>& scene, Volume& how, const volume::smoothing_options& smoothing = {}) {
  auto& w = scene.w;
  auto& s = w.s;
  w.first_fault = {};
  const std::size_t fields_before = s.extras.size();
  {
    passes::evaluation<D> e(scene);
    e.integrate_motion({});
    e.integrate(s.T, {"T"});
    e.integrate(s.u, {"u"});
    passes::fields rates{s.x, s.v, s.T, s.u};
    if (Volume::carried == volume::carries::density) e.integrate(s.rho, {"rho"}), rates.add({s.rho});
    if (Volume::carried == volume::carries::weight) e.integrate(s.Y, {"Y"}), rates.add({s.Y});
    const volume::pressure_rule none;
    volume::options settings;
    settings.smoothing = smoothing;
    liquid::list_of_passes<program_of<Volume, Pressure>, D> list(scene, how, settings, none);
    list.declare(e, rates, false, [&] { return liquid::rates_in_order<D>(e.rates()); });
    e.complete(passes::behind<D>(scene));
    BOOST_TEST_MESSAGE(e.describe());
    std::vector<std::vector<double>> rate(e.fields().size(), std::vector<double>(s.fluid));
    std::vector<double*> to;
    for (auto& r : rate) to.push_back(r.data());
    e.run(to);
  }
  w.agree();
  // The fields that the list has declared go with it.
  while (s.extras.size() > fields_before) s.extras.pop_back();
  scene.walls.volume = scene.walls.density = scene.walls.kernel_sum = nullptr;
}

// The state's ghosts as the time integration would have them.
template <int D>
void refresh(hydrostatic::scene<D>& scene) {
  auto& w = scene.w;
  for (auto& component : w.s.v) w.exchange_fluid({component.data()});
  w.exchange_fluid({w.s.T.data(), w.s.rho.data(), w.s.Y.data()});
}

}  // namespace tetsuame::test
