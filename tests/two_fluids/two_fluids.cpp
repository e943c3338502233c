// The start column, the fit of a growth rate, and the sums over the start lattice.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <kernels/kernel.hpp>
#include <namelist/document.hpp>
#include <numbers>
#include <two_fluids/cloud.hpp>
#include <two_fluids/column.hpp>
#include <two_fluids/lattice.hpp>
#include <two_fluids/options.hpp>

using namespace tetsuame;
using namespace tetsuame::two_fluids;
namespace tt = boost::test_tools;

namespace {

eos::any linear(double rho0) {
  eos::material_options o;
  o.reference_density = rho0;
  o.reference_pressure = 0.0;
  o.bulk_modulus = 5e11;
  o.thermal_expansivity = 0.0;
  return eos::make(o);
}

eos::any named(const char* name) {
  eos::material_options o;
  o.name = name;
  return eos::make(o);
}

parameters resolved(const std::string& text, problem_kind kind, options& o) {
  namelist::schema schema;
  declare(schema, kind, o);
  schema.read(namelist::parse_text(text, "test.nml"));
  return resolve(schema, kind, o);
}

domain::options box_of(std::int64_t dimension, std::array<double, 3> length, std::array<bool, 3> periodic) {
  return {
      .dimension = dimension, .length = length, .particles = {}, .periodic = periodic, .ranks_x = {}, .jitter = 0.0};
}

}  // namespace

// dp/dy = -ρ0 (1 + p/K) g:  1 + p/K = (1 + p_top/K) exp(ρ0 g depth/K), layer upon layer.
BOOST_AUTO_TEST_CASE(column_of_linear_liquids) {
  const auto silicate = linear(3000.0), iron = linear(7000.0);
  const double K = 5e11, g = 10.0, H = 1.5e6, interface = 7.6e5, p_top = 1e9;
  const column c({&silicate, 0.0, 2500.0, false}, {&iron, p_top, 2500.0, false}, interface, H, g);
  const auto upper = [&](double y) { return (1.0 + p_top / K) * std::exp(7000.0 * g * (H - y) / K); };
  const auto lower = [&](double y) { return upper(interface) * std::exp(3000.0 * g * (interface - y) / K); };
  for (const double y : {0.0, 1e4, 3.3e5, 7.59e5}) {
    BOOST_TEST(c.at(y).pressure / K + 1.0 == lower(y), tt::tolerance(1e-11));
    BOOST_TEST(c.at(y).density == 3000.0 * lower(y), tt::tolerance(1e-11));
  }
  for (const double y : {7.6e5, 1e6, 1.49e6}) BOOST_TEST(c.at(y).density == 7000.0 * upper(y), tt::tolerance(1e-11));
}

// On an adiabat d ln T/d ln ρ = γ_th, and over a column dp/dy = -ρ g.
BOOST_AUTO_TEST_CASE(column_on_adiabats) {
  const auto silicate = named("liquid_silicate"), iron = named("liquid_iron");
  const column c({&silicate, 0.0, 2600.0, true}, {&iron, 1e5, 2600.0, true}, 7.5e5, 1.5e6, 10.0);
  BOOST_TEST(c.at(7.5e5 * (1.0 - 1e-12)).temperature == c.at(7.5e5).temperature, tt::tolerance(1e-9));
  for (const double y : {1e5, 5e5, 9e5, 1.4e6}) {
    const double dy = 2e3;
    const auto low = c.at(y - dy), high = c.at(y + dy), here = c.at(y);
    const auto& material = y < 7.5e5 ? silicate : iron;
    const auto e = eos::evaluate(material, here.density, here.temperature);
    const double gamma = e.alpha * e.K_T / (here.density * e.c_V);
    BOOST_TEST(std::log(low.temperature / high.temperature) / std::log(low.density / high.density) == gamma,
               tt::tolerance(1e-4));
    BOOST_TEST((low.pressure - high.pressure) / (2.0 * dy) == here.density * 10.0, tt::tolerance(1e-5));
    BOOST_TEST(eos::pressure(material, here.density, here.temperature) == here.pressure, tt::tolerance(1e-9));
  }
}

// The sum's value for a quadratic is exact with the weights of fourth order, and for x⁴ + 2 x²y² + y⁴ = r⁴ it vanishes
// at 0.
BOOST_AUTO_TEST_CASE(viscous_weights_by_moments) {
  for (const auto& name : {"quintic", "wendland_c4", "wendland_c6"}) {
    const double dx = 0.7;
    const auto kernel = kernels::make<2>(name, kernels::find(name).default_h_over_dx * dx);
    const auto w = fourth_order_weights<2>(kernel, dx);
    double second = 0.0, fourth = 0.0;
    std::visit(
        [&](const auto& k) {
          for (int a = -8; a <= 8; ++a)
            for (int b = -8; b <= 8; ++b) {
              const double r2 = dx * dx * (a * a + b * b);
              if (r2 == 0.0) continue;
              const double F = dx * dx * k.gradient_over_r(std::sqrt(r2)) * (w.a0 - w.a1 * r2);
              second -= 2.0 * F * 0.5 * dx * dx * a * a;  // of x²/2
              fourth += F * r2 * r2;
            }
        },
        kernel);
    BOOST_TEST(second == 1.0, tt::tolerance(1e-12));
    BOOST_TEST(std::abs(fourth) < 1e-12);
    // No wave grows, and none dies faster than what bounds the step.
    const auto bound = rates_of_lattice<2>(kernel, dx, w);
    BOOST_TEST(bound.viscous > rates_of_lattice<2>(kernel, dx, {}).viscous);
    for (int m = 1; m <= 40; ++m)
      for (int n = 0; n <= m; ++n) {
        double decay = 0.0;
        std::visit(
            [&](const auto& k) {
              for (int a = -8; a <= 8; ++a)
                for (int b = -8; b <= 8; ++b) {
                  const double r2 = dx * dx * (a * a + b * b);
                  if (r2 == 0.0) continue;
                  decay -= 2.0 * dx * dx * k.gradient_over_r(std::sqrt(r2)) * (w.a0 - w.a1 * r2) *
                           (1.0 - std::cos(std::numbers::pi / 40.0 * (m * a + n * b)));
                }
            },
            kernel);
        BOOST_TEST_REQUIRE(decay > 0.0);
        BOOST_TEST_REQUIRE(decay * dx * dx < 1.01 * bound.viscous);
      }
  }
}

// Values that two other methods gave (docs/theory/rayleigh_taylor.md), through the input.
BOOST_AUTO_TEST_CASE(theory_through_the_input) {
  options o;
  const auto p = resolved("&rti viscosity_upper = 1e11 viscosity_lower = 1e11 /\n", problem_kind::rayleigh_taylor, o);
  BOOST_TEST(*p.growth == 0.00344235, tt::tolerance(2e-6));
  BOOST_TEST(*p.growth_incompressible == 0.00341109486, tt::tolerance(1e-8));
  options odd;
  BOOST_TEST(resolved("&domain particles_x = 75 particles_y = 75 /\n", problem_kind::rayleigh_taylor, odd).interface ==
                 1.5e6 * 38 / 75,
             tt::tolerance(1e-14));
}

// A kernel whose lattice is elastic is used, and spoken of.
BOOST_AUTO_TEST_CASE(elastic_lattices_are_told_of) {
  options o, stiff;
  const auto good = resolved("&rti /\n", problem_kind::rayleigh_taylor, o);
  BOOST_TEST(good.lines.empty());
  BOOST_TEST(good.spurious_modulus < 5e-4);
  const auto bad = resolved("&kernel name = 'quintic' h_over_dx = 1.2 /\n", problem_kind::rayleigh_taylor, stiff);
  BOOST_REQUIRE(bad.lines.size() == 1);
  BOOST_TEST(bad.lines[0].find("0.0036 p along its rows") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(input_that_makes_no_sense) {
  for (const char* text :
       {"&rti wavelength = 4e5 /\n", "&rti interface = 1.5e6 /\n", "&walls sides = 'no_slip' /\n",
        "&rti delta = 0.1 /\n", "&walls lid = 'free_surface' /\n", "&rti conductivity = 1.0 /\n",
        "&rti eos_upper = 'liquid_iron' density_upper = 8000.0 /\n", "&rti viscous_order = 3 /\n",
        "&rti viscous_order = 1 /\n",
        "&rti volume = 'our_method' reference_pressure = 'lightest' /\n&walls lid = 'free_surface' /\n",
        "&rti wavelength_z = 1e6 /\n", "&domain particles_x = 50 /\n"}) {
    options o;
    BOOST_CHECK_EXCEPTION(resolved(text, problem_kind::rayleigh_taylor, o), foundation::error,
                          [](const auto& e) { return e.status() == foundation::exit_status::bad_input; });
  }
  for (const char* text : {"&drop y = 1.4e6 /\n", "&drop measure_at = 0.9 /\n", "&drop radius = 8e5 /\n"}) {
    options o;
    BOOST_CHECK_EXCEPTION(resolved(text, problem_kind::drop, o), foundation::error,
                          [](const auto& e) { return e.status() == foundation::exit_status::bad_input; });
  }
}

// No two nearer than the gap, across periodic sides too, nor a wall; another seed, other places; too many are refused.
BOOST_AUTO_TEST_CASE(drawn_drops_keep_their_distance) {
  for (const int dimension : {2, 3}) {
    const auto box = box_of(dimension, {2.0, 3.0, 1.5}, {true, false, false});
    const double radius = 0.15, gap = 0.05;
    const auto places = drawn_places(box, radius, gap, 12, 7);
    BOOST_REQUIRE(places.has_value());
    double across = 10.0, straight = 10.0;
    for (std::size_t i = 0; i < places->size(); ++i) {
      const auto& a = (*places)[i];
      for (std::size_t k = 1; k < static_cast<std::size_t>(dimension); ++k)
        BOOST_TEST((a[k] >= radius + gap && a[k] <= box.length[k] - radius - gap));
      for (std::size_t j = 0; j < i; ++j) {
        const auto& b = (*places)[j];
        // Over the images by hand.
        for (const double shift : {-2.0, 0.0, 2.0}) {
          const double d = std::hypot(a[0] - b[0] + shift, a[1] - b[1], a[2] - b[2]);
          (shift == 0.0 ? straight : across) = std::min(shift == 0.0 ? straight : across, d);
        }
      }
    }
    BOOST_TEST(std::min(across, straight) >= 2.0 * radius + gap);
    BOOST_TEST(across < 1.0);  // the sides are near enough to matter
    BOOST_TEST((*drawn_places(box, radius, gap, 12, 7) == *places));
    BOOST_TEST((*drawn_places(box, radius, gap, 12, 8) != *places));
  }
  // 60 disks of radius 0.15 would fill 0.71 of the plane: above the limit of 0.547.
  BOOST_TEST(!drawn_places(box_of(2, {2.0, 3.0, 0.0}, {true, false, false}), 0.15, 0.0, 60, 7).has_value());
  BOOST_TEST(!drawn_places(box_of(2, {0.2, 3.0, 0.0}, {true, false, false}), 0.15, 0.0, 1, 7).has_value());
}

// Against every pair by itself; a chain over the periodic side is one body.
BOOST_AUTO_TEST_CASE(bodies_are_chains_of_near_points) {
  const auto points = *drawn_places(box_of(3, {1.0, 1.0, 1.0}, {true, false, true}), 1e-9, 0.0, 400, 3);
  for (const int dimension : {2, 3})
    for (const bool periodic : {false, true})
      for (const double reach : {0.02, 0.05, 0.09, 0.6}) {
        const auto box = box_of(dimension, {1.0, 1.0, 1.0}, {periodic, false, false});
        std::vector<std::size_t> label(points.size());
        for (std::size_t i = 0; i < label.size(); ++i) label[i] = i;
        for (bool changed = true; changed;) {
          changed = false;
          for (std::size_t i = 0; i < label.size(); ++i)
            for (std::size_t j = 0; j < i; ++j) {
              double dx = std::abs(points[i][0] - points[j][0]);
              if (periodic) dx = std::min(dx, 1.0 - dx);
              const double d =
                  std::hypot(dx, points[i][1] - points[j][1], dimension == 3 ? points[i][2] - points[j][2] : 0.0);
              if (d <= reach && label[i] != label[j]) {
                label[i] = label[j] = std::min(label[i], label[j]);
                changed = true;
              }
            }
        }
        std::vector<std::int64_t> count(points.size(), 0), sizes;
        for (const auto l : label) ++count[l];
        for (const auto n : count)
          if (n > 0) sizes.push_back(n);
        std::sort(sizes.rbegin(), sizes.rend());
        BOOST_TEST(connected_sizes(box, points, reach) == sizes, tt::per_element());
      }
  const std::vector<std::array<double, 3>> pair{{0.01, 0.5, 0.0}, {0.98, 0.5, 0.0}};
  BOOST_TEST(connected_sizes(box_of(2, {1.0, 1.0, 0.0}, {false, false, false}), pair, 0.05).size() == 2u);
  BOOST_TEST(connected_sizes(box_of(2, {1.0, 1.0, 0.0}, {true, false, false}), pair, 0.05).size() == 1u);
}

BOOST_AUTO_TEST_CASE(many_drops_through_the_input) {
  const std::string start =
      "&domain length_x = 1e6 length_y = 1.5e6 particles_x = 40 particles_y = 60 periodic_x = .true. / &drop ";
  const std::string walls = " / &walls floor = 'free_slip' lid = 'free_slip' /";
  options o;
  const auto p = resolved(start + "radius = 1e5 drops = 4 viscosity_drop = 6e12 viscosity_outside = 6e12" + walls,
                          problem_kind::drop, o);
  BOOST_TEST(p.places.size() == 4u);
  BOOST_TEST(p.theory_fall.has_value());
  BOOST_TEST(*p.fall_alone > 0.0);
  BOOST_TEST(*p.fall_array > 0.0);
  // At c = 4 pi 1e10/1.5e12, creeping.
  BOOST_TEST(*p.hindered == std::pow(1.0 - 4.0 * std::numbers::pi / 150.0, 4.65), tt::tolerance(1e-9));
  for (const char* bad :
       {"radius = 1e5 drops = 40", "radius = 1e5 drops = 4 x = 3e5", "radius = 1e5 drops = 4 measure_at = 0.6",
        "radius = 1e5 drops = 4 shape = 'square'", "radius = 1e5 seed = 3", "radius = 1e5 measure_from = 3.0",
        "radius = 1e5 places_x = 3e5, 6e5 places_y = 3e5", "radius = 1e5 places_x = 3e5, 4e5 places_y = 3e5, 3e5",
        "radius = 1e5 places_x = 3e5, 6e5 places_y = 3e5, 3e5 drops = 3",
        "radius = 1e5 places_x = 3e5, 6e5 places_y = 3e5, 3e4", "radius = 1e5 places_x = 3e5 places_y = 3e5"}) {
    options other;
    BOOST_TEST_CONTEXT(bad)
    BOOST_CHECK_THROW(resolved(start + bad + walls, problem_kind::drop, other), foundation::error);
  }
}

// A contact without gravity: each layer of equal masses has a lattice of its own, the denser one the finer.
BOOST_AUTO_TEST_CASE(lattices_of_equal_masses) {
  const std::string box =
      "&domain length_x = 2.5e4 length_y = 1e5 particles_x = 16 particles_y = 64 periodic_x = .true. /\n";
  const auto contact = [&](const std::string& more, const char* start = "coloured", const char* amplitude = "0") {
    return box + "&rti density_upper = 2000 density_lower = 8000 gravity = 0 p_top = 1e10 start = '" + start +
           "' amplitude = " + amplitude + " " + more + " /\n";
  };
  {
    options o;
    const auto p = resolved(contact("masses = 'equal_mass'"), problem_kind::rayleigh_taylor, o);
    BOOST_TEST(p.layers[0].number[0] == 32);
    BOOST_TEST(p.layers[0].number[1] == 64);
    BOOST_TEST(p.layers[1].number[0] == 16);
    BOOST_TEST(p.layers[1].number[1] == 32);
    BOOST_TEST(p.layers[1].low == 5e4);
    BOOST_TEST(p.layers[0].volume * 8000.0 == p.layers[1].volume * 2000.0, tt::tolerance(1e-12));
    BOOST_TEST(particles_at_start(o, p) == 32.0 * 64.0 + 16.0 * 32.0);
    BOOST_TEST(p.base->at(1e3).pressure == 1e10, tt::tolerance(1e-12));
  }
  {
    options o;
    const auto p = resolved(contact(""), problem_kind::rayleigh_taylor, o);
    BOOST_TEST(p.layers[0].number[1] == 32);
    BOOST_TEST(particles_at_start(o, p) == 16.0 * 64.0);
  }
  for (const auto& wrong :
       {contact("masses = 'equal_mass'", "coloured", "1e3"), contact("masses = 'equal_mass' shear = 1", "displaced"),
        contact("shear = 1", "displaced")}) {
    options o;
    BOOST_CHECK_THROW(resolved(wrong, problem_kind::rayleigh_taylor, o), foundation::error);
  }
}
