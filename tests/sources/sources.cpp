// Forces and heat of &sources as a pass: their values by place, time and material, what they supply, and the pressure
// that images hold against them, whose sources may be another rank's.
#include <namelist/document.hpp>
#include <run/start.hpp>
#include <sources/fields.hpp>

#include "../support/numbers.hpp"

using namespace tetsuame;
using namespace tetsuame::test;

namespace {

constexpr int D = 2;

// Particles that sources alone move and heat; a pressure of 0 behind whose walls images stand.
struct pushed {
  domain::options domain;
  run::state<D> box;
  passes::evaluation<D> e{box};
  sources::fields<D> sources;
  particles::array& pressure = particles::declare(box.w.s, "TestPressure", "Pa", particles::role::derived);
  particles::array& seen = particles::declare(box.w.s, "Seen", "Pa", particles::role::derived);

  explicit pushed(const std::string& input) {
    sources::options o;
    regions::constants named;
    namelist::schema schema;
    regions::declare(schema, named);
    sources::declare(schema, {}, o);
    schema.read(namelist::parse_text(input, "test.nml"));
    domain.length = {2.0, 1.0, 1.0};
    domain.particles = {24, 12, 12};
    domain.periodic = {true, false, false};
    run::kernel_options kernel;
    kernel.name = "wendland_c2";
    kernel.h_over_dx = 1.3;
    kernel.skin = 0.2;
    const walls::options walls;
    run::set_up<D>(box, domain::communicator::world(), domain, walls, kernel, 0.0);
    auto& s = box.w.s;
    box.w.g[1] = -9.0;
    for (std::size_t i = 0; i < s.fluid; ++i) {
      s.rho[i] = 1.0 + s.x[0][i];
      s.material[i] = s.x[0][i] < 1.0 ? 0 : 1;
      s.v[0][i] = 3.0;
      s.v[1][i] = -2.0;
    }
    run::rebuild(box, false);
    box.state_time = 0.5;
    declare(sources::all(schema, o, named, D, domain.length, domain.dx()));
  }
  std::vector<std::vector<double>> rates() {
    std::vector<std::vector<double>> all(e.fields().size(), std::vector<double>(box.w.s.fluid));
    std::vector<double*> to;
    for (auto& one : all) to.push_back(one.data());
    e.run(to);
    return all;
  }

 private:
  void declare(const sources::all& given) {
    auto& s = box.w.s;
    sources.declare(given, box, e);
    e.integrate_motion({});
    e.remembered({s.rho});
    sources.account(e, 1.0);
    e.mirrored(walls::hydrostatic(pressure, s.rho, box.w));
    e.each("pressure", {.reads = {s.rho}, .writes = {pressure}}, [this](std::size_t i) { pressure[i] = 0.0; });
    e.sum("neighbours", {.at_neighbours = {pressure}, .writes = {seen}}, [](const pairs::row_range&) {});
    e.each("rates", {.reads = {s.v, passes::of_sources(box)}, .rates = {s.x, s.v}}, [this](std::size_t i) {
      for (std::size_t a = 0; a < D; ++a) {
        e.rate(a)[i] = box.w.s.v[a][i];
        e.rate(D + a)[i] = box.w.gravity(a, i);
      }
    });
    e.complete(passes::behind_walls::images);
  }
};

const std::string input = R"(&constants name = 'a' value = 4 /
&sources force_x = 'a*x*t'  force_y = 'y - 0.25*length_x'  heating = 'material == 1 ? 7*t : 0.5' /
)";

}  // namespace

BOOST_AUTO_TEST_CASE(values_by_place_time_and_material) {
  pushed box(input);
  const auto rate = box.rates();
  const auto& s = box.box.w.s;
  for (std::size_t i = 0; i < s.fluid; ++i) {
    const double K_x = 4.0 * s.x[0][i] * 0.5, K_y = s.x[1][i] - 0.5, J = s.material[i] == 1 ? 3.5 : 0.5;
    BOOST_TEST(rate[2][i] == K_x);
    BOOST_TEST(std::abs(rate[3][i] - (K_y - 9.0)) < 1e-14);
    BOOST_TEST(std::abs(rate[4][i] - (3.0 * K_x - 2.0 * K_y)) < 1e-13);  // work of K alone, not of gravity
    BOOST_TEST(rate[5][i] == J);
  }
}

// p = 0 at the source: what is left is ρ (g + K)·(x_image - x_source), of the source's place, on every rank.
BOOST_AUTO_TEST_CASE(images_hold_fluid_against_forces) {
  pushed box(input);
  box.rates();
  const auto& s = box.box.w.s;
  const auto& set = box.box.walls;
  BOOST_TEST(set.source.size() > 0u);
  double largest = 0.0;
  walls::for_each_image(set, s, [&](const walls::image& of) {
    const double x = s.x[0][of.j] - 2.0 * std::floor(s.x[0][of.j] / 2.0);  // of a ghost across the periodic side, too
    const double K_y = s.x[1][of.j] - 0.5;
    const double right = (1.0 + x) * (K_y - 9.0) * (s.x[1][of.i] - s.x[1][of.j]);
    BOOST_TEST(std::abs(box.pressure[of.i] - right) < 1e-12);
    largest = std::max(largest, std::abs(right));
  });
  BOOST_TEST(largest > 0.1);
}

BOOST_AUTO_TEST_CASE(what_is_not_given_is_not_there) {
  pushed box("&constants name = 'a' value = 4 /");
  const auto rate = box.rates();
  BOOST_TEST(rate.size() == 4u);
  BOOST_TEST(!box.box.w.gravity_varies);
  BOOST_TEST((box.box.w.heating == nullptr));
  BOOST_TEST(box.sources.supplied() == 0.0);
  pushed of_heat("&sources heating = 2 /");
  BOOST_TEST(of_heat.rates().size() == 5u);
  BOOST_TEST(!of_heat.box.w.gravity_varies);
}

BOOST_AUTO_TEST_CASE(what_is_no_number_somewhere_is_refused) {
  try {
    pushed("&sources force_x = '1/(x - x)' /");
    BOOST_ERROR("expected a refusal");
  } catch (const foundation::error& e) {
    BOOST_TEST((e.status() == foundation::exit_status::bad_input));
    BOOST_TEST(std::string(e.what()).find("&sources force_x = '1/(x - x)' is not finite at t = 0.5 s") !=
               std::string::npos);
  }
}
