#include <boost/test/unit_test.hpp>
#include <cmath>
#include <melting/latent_heat.hpp>
#include <melting/melting.hpp>

namespace eos = tetsuame::eos;
namespace melting = tetsuame::melting;

namespace {

eos::caloric basalt() {
  eos::material_options m;
  m.name = "tillotson";
  m.tillotson = "basalt";
  m.reference_temperature = 1e-6;
  m.heat_capacity = 790.0;
  return eos::caloric(eos::make(m));
}

}  // namespace

// Energy to temperature and back, below, within and above the range; the fraction is that of temperature and pressure.
BOOST_AUTO_TEST_CASE(latent_heat) {
  const eos::caloric rock = basalt();
  melting::options o;
  o.curve = "mantle";
  int molten = 0, mush = 0, solid = 0;
  for (const double rho : {2700.0, 3000.0, 3400.0})
    for (double T = 1500.0; T < 3200.0; T += 37.0) {
      const double u = melting::internal_energy(rock, o, rho, T), f = melting::melt_fraction(rock, o, rho, u);
      const auto now = rock.at(rho, u - o.latent_heat * f);
      BOOST_TEST(std::abs(now.T - T) < 1e-7);
      const auto [T_s, T_l] = melting::range(o, now.p);
      BOOST_TEST(std::abs(f - melting::melt_fraction(T, T_s, T_l)) < 1e-10);
      ++(f == 0.0 ? solid : f == 1.0 ? molten : mush);
    }
  BOOST_TEST((molten > 10 && mush > 10 && solid > 10));
  o.latent_heat = 0.0;
  const double u = rock.internal_energy(3000.0, 2500.0);
  BOOST_TEST(melting::internal_energy(rock, o, 3000.0, 2500.0) == u);
  BOOST_TEST((melting::melt_fraction(rock, o, 3000.0, u) > 0.0));
}

// Where solidus and liquidus cross there is no fraction.
BOOST_AUTO_TEST_CASE(no_range) {
  melting::options o;
  o.curve = "constant";
  o.solidus = 2000.0;
  o.liquidus = 1900.0;
  BOOST_TEST(std::isnan(melting::melt_fraction(basalt(), o, 3000.0, 2e6)));
}
