// Tables: written from equations and read back, both forms, what is refused, and that pieces are monotone.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <eos/surface.hpp>
#include <eos/tabulate.hpp>
#include <foundation/error.hpp>
#include <sstream>

#include "materials.hpp"

namespace eos = tetsuame::eos;
namespace foundation = tetsuame::foundation;

namespace {

const eos::description nobody{"table", "", false};

eos::tabulated written_and_read(const eos::any& m, const eos::table_axes& axes) {
  std::stringstream text;
  eos::write_table(text, eos::tabulate(eos::caloric(m), axes));
  return {nobody, eos::parse_table(text.str(), "t.txt")};
}

struct errors {
  double p = 0.0, p_of_K = 0.0, c = 0.0, T = 0.0,
         rho = 0.0;  // largest, relative; p of p, or of K_T/1000 near no pressure
};

// At places between the nodes all over the table. c is that of the energy (eos/caloric.hpp): of liquid_iron, which has
// no potential, that of `evaluate` is another.
errors against(const eos::any& m, const eos::table_axes& axes) {
  const eos::tabulated read = written_and_read(m, axes);
  const eos::caloric own(m), back{eos::any(read)};
  errors most;
  for (int i = 0; i < 97; ++i)
    for (int j = 0; j < 53; ++j) {
      const double rho = axes.rho_low * std::pow(axes.rho_high / axes.rho_low, (i + 0.37) / 97.0);
      const double T = axes.T_low * std::pow(axes.T_high / axes.T_low, (j + 0.41) / 53.0);
      const double u = own.internal_energy(rho, T);
      const eos::properties want = eos::evaluate(m, rho, T), got = read.evaluate(rho, T);
      most.p_of_K = std::max(most.p_of_K, std::abs(got.p - want.p) / std::abs(want.K_T));
      most.p = std::max(most.p, std::abs(got.p - want.p) / std::max(std::abs(want.p), 1e-3 * std::abs(want.K_T)));
      most.c = std::max(most.c, std::abs(got.sound_speed / own.at(rho, u).c - 1.0));
      const eos::caloric_state s = back.at(rho, u);
      most.T = std::max(most.T, std::abs(s.T / T - 1.0));
      most.rho = std::max(most.rho, std::abs(read.density(got.p, T) / rho - 1.0));
    }
  return most;
}

auto bad_input_saying(const std::string& word) {
  return [word](const foundation::error& e) {
    const bool good =
        e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(word) != std::string::npos;
    if (!good) BOOST_TEST_MESSAGE(e.what());
    return good;
  };
}

// Two densities above 0 and two temperatures, with zeros before them.
const std::string head = "# a table\n20260101\n3 3\n0 1000 2000\n0 300 600\n";
std::string rows(const std::string& fifth = "1e5 1e9 3e3 1\n") {
  return "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n" + fifth + "2e5 9e9 4e3 1\n0 0 0 0\n3e5 2e9 3e3 2\n4e5 1e10 4e3 2\n";
}
void refuse(const std::string& text, const std::string& word) {
  BOOST_CHECK_EXCEPTION(eos::parse_table(text, "t.txt"), foundation::error, bad_input_saying(word));
}

}  // namespace

// Steps of 1 % in density, 3 % in temperature: the cubics' error is h^4/384 of fourth derivatives, the slopes' h^4/30
// of fifth ones, some 1e-6.
BOOST_AUTO_TEST_CASE(written_from_vinet_and_tillotson) {
  const struct {
    const char* name;
    eos::any m;
    eos::table_axes axes;
  } all[] = {{"liquid_iron", material("liquid_iron"), {7000.0, 20000.0, 1500.0, 12000.0, 120, 70}},
             {"tillotson iron", tillotson("iron"), {7800.0, 30000.0, 300.0, 5000.0, 140, 90}},
             {"tillotson granite", tillotson("granite"), {2680.0, 8000.0, 300.0, 4000.0, 120, 90}},
             {"tillotson basalt", tillotson("basalt"), {2700.0, 8000.0, 300.0, 4000.0, 120, 90}},
             {"iron_hcp", material("iron_hcp"), {8500.0, 30000.0, 300.0, 12000.0, 130, 120}},
             {"liquid_mgsio3", material("liquid_mgsio3"), {2700.0, 10000.0, 1800.0, 12000.0, 140, 70}},
             {"ideal_gas", material("ideal_gas"), {1e-3, 1e3, 10.0, 1e5, 700, 250}}};
  for (const auto& [name, m, axes] : all) {
    const errors e = against(m, axes);
    BOOST_TEST_MESSAGE(name << ": p " << e.p << ", c " << e.c << ", T " << e.T << ", rho " << e.rho);
    BOOST_TEST(e.p < 1e-4, name << ": p within " << e.p);
    BOOST_TEST(e.c < 1e-4, name << ": c within " << e.c);
    BOOST_TEST(e.T < 1e-4, name << ": T within " << e.T);
    BOOST_TEST(e.rho < 1e-9, name << ": rho within " << e.rho);
  }
}

// Through Tillotson's rho0, where second derivatives of p and u by density jump, by some K_T: h^2/12 of it in the cell
// where it is, 1e-5 K_T. Their errors go together, so that sound has none of this size.
BOOST_AUTO_TEST_CASE(across_a_kink) {
  const errors e = against(tillotson("iron"), {7500.0, 30000.0, 300.0, 5000.0, 140, 90});
  BOOST_TEST(e.p_of_K < 1e-5, "p within " << e.p_of_K << " K_T");
  BOOST_TEST(e.c < 1e-4, "c within " << e.c);
  BOOST_TEST(e.T < 1e-3, "T within " << e.T);
}

// The same table four times as coarse in each coordinate: the errors grow by 4^4, not by 4.
BOOST_AUTO_TEST_CASE(fourth_order) {
  const eos::any m = material("liquid_iron");
  const errors fine = against(m, {7000.0, 20000.0, 1500.0, 12000.0, 81, 61}),
               coarse = against(m, {7000.0, 20000.0, 1500.0, 12000.0, 21, 16});
  BOOST_TEST(coarse.p / fine.p > 64.0, coarse.p << ", " << fine.p);
  BOOST_TEST(coarse.c / fine.c > 64.0, coarse.c << ", " << fine.c);
}

BOOST_AUTO_TEST_CASE(nothing_outside) {
  const eos::tabulated t = written_and_read(material("liquid_iron"), {7000.0, 9000.0, 1500.0, 3000.0, 12, 12});
  for (const auto& [rho, T] : {std::pair{6999.0, 2000.0},
                               {9001.0, 2000.0},
                               {8000.0, 1499.0},
                               {8000.0, 3001.0},
                               {-1.0, 2000.0},
                               {8000.0, 0.0}}) {
    BOOST_TEST(std::isnan(t.evaluate(rho, T).p));
    BOOST_TEST(std::isnan(t.internal_energy(rho, T)));
  }
  BOOST_TEST(std::isfinite(t.evaluate(7000.0, 1500.0).p));
  BOOST_TEST(std::isfinite(t.evaluate(9000.0, 3000.0).sound_speed));
  BOOST_TEST(std::isnan(t.temperature(8000.0, t.internal_energy(8000.0, 3000.0) * 1.001)));
  const auto fails = [](const foundation::error& e) {
    return e.status() == foundation::exit_status::calculation_failed;
  };
  BOOST_CHECK_EXCEPTION(t.density(1e9, 4000.0), foundation::error, fails);
  BOOST_CHECK_EXCEPTION(t.density(1e12, 2000.0), foundation::error, fails);
}

// Data with a step, which cubics through them would overshoot: pressure rises with density all over, and energy with
// temperature, without a fall between nodes; on the level part the pressure stays as it is.
BOOST_AUTO_TEST_CASE(monotone_where_the_data_are) {
  eos::table_data t;
  for (int i = 0; i < 8; ++i) t.rho.push_back(1000.0 * std::pow(1.3, i)), t.T.push_back(300.0 * std::pow(1.5, i));
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {
      t.p.push_back((i < 3 ? 1e8 : i < 5 ? 1.001e8 : 5e10 + 1e10 * i) * (1.0 + 0.3 * j * (i % 3)));
      t.u.push_back(1e6 * (j < 4 ? 1.0 + 0.001 * j : 4.0 + j) + 1e5 * (i % 2));
    }
  for (std::size_t j = 0; j < 8; ++j)  // pressures that rise along each row
    for (std::size_t i = 1; i < 8; ++i) t.p[8 * j + i] = std::max(t.p[8 * j + i], t.p[8 * j + i - 1]);
  const eos::tabulated table(nobody, t);
  for (int j = 0; j <= 200; ++j) {
    double last_p = -1.0, last_u = -1.0;
    for (int i = 0; i <= 400; ++i) {
      const double a = i / 400.0, b = j / 200.0;
      const double p = table
                           .evaluate(t.rho.front() * std::pow(t.rho.back() / t.rho.front(), a) * (1.0 - 1e-14 * i),
                                     t.T.front() * std::pow(t.T.back() / t.T.front(), b) * (1.0 - 1e-14 * j))
                           .p;
      const double u =
          table.internal_energy(t.rho.front() * std::pow(t.rho.back() / t.rho.front(), b) * (1.0 - 1e-14 * j),
                                t.T.front() * std::pow(t.T.back() / t.T.front(), a) * (1.0 - 1e-14 * i));
      BOOST_REQUIRE(p >= last_p * (1.0 - 1e-10));
      BOOST_REQUIRE(u >= last_u * (1.0 - 1e-10));
      last_p = p, last_u = u;
    }
  }
}

// Energy that falls with temperature is made level, and told.
BOOST_AUTO_TEST_CASE(falling_energy) {
  const eos::tabulated t(nobody,
                         {"", {1000.0, 2000.0}, {300.0, 400.0, 500.0}, {1, 2, 1, 2, 1, 2}, {5, 1, 3, 2, 4, 3}, {}, {}});
  BOOST_TEST(t.lowered() == 1U);
  BOOST_TEST(std::abs(t.internal_energy(1000.0, 300.0) - 3.0) < 1e-12);
}

BOOST_AUTO_TEST_CASE(swift_form) {
  const auto plain = eos::parse_table(head + rows(), "t.txt");
  BOOST_TEST(plain.title == "a table");
  BOOST_TEST((plain.rho == std::vector{1000.0, 2000.0} && plain.T == std::vector{300.0, 600.0}));
  BOOST_TEST((plain.p == std::vector{1e9, 9e9, 2e9, 1e10} && plain.u == std::vector{1e5, 2e5, 3e5, 4e5}));
  // Without a date, with a mark and line ends of other systems, axes over several lines, not a number at no density.
  std::string other = "\xef\xbb\xbf# a table\n3 3\n0 1000\n2000\n0 300 600\n" + rows();
  other.replace(other.find("0 0 0 0\n"), 8, "0 nan 0 0\n");
  for (std::size_t at = 0; (at = other.find('\n', at)) != std::string::npos; at += 2) other.replace(at, 1, "\r\n");
  const auto read = eos::parse_table(other, "t.txt");
  BOOST_TEST((read.rho == plain.rho && read.T == plain.T && read.p == plain.p && read.u == plain.u));
}

BOOST_AUTO_TEST_CASE(sesame_form) {
  const std::string start =
      " INDEX      MATID =      1    NWDS =        9\n 1. 2. 2. 1. 2.\n 201. 301. 5. 29.\n"
      " RECORD     TYPE =  201     NWDS =        5\n 10. 18. 1. 2e10 298.\n";
  const std::string numbers =
      " 3. 3. 0. 1. 2.\n 0. 300. 600. 0. 0.\n 0. 0. 1. 9. 0.\n 2. 10. 0. 0. 0.\n 0. 0.1 0.2 0. 0.3\n 0.4\n";
  const auto t = eos::parse_table(start + " RECORD     TYPE =  301     NWDS =       26\n" + numbers, "t.txt");
  BOOST_TEST((t.rho == std::vector{1000.0, 2000.0} && t.T == std::vector{300.0, 600.0}));
  BOOST_TEST((t.p == std::vector{1e9, 9e9, 2e9, 1e10}));
  BOOST_TEST(std::abs(t.u[3] - 4e5) < 1e-9);
  // With the free energy, and an exponent that has pushed out its letter.
  const std::string free = " 0. 0. 0. 0.\n 1.0-101 0. 0. 0. 0.\n";
  const auto more = eos::parse_table(start + " RECORD     TYPE =  301     NWDS =       35\n" + numbers + free, "t.txt");
  BOOST_TEST((more.p == t.p && more.u == t.u));
  refuse(start + " RECORD     TYPE =  301     NWDS =       27\n" + numbers + " 0.\n", "NWDS = 27");
  refuse(start + " RECORD     TYPE =  301     NWDS =       35\n" + numbers, "t.txt: ends after 26 of 35");
  refuse(start, "no record of TYPE = 301");
}

BOOST_AUTO_TEST_CASE(bad_tables_are_refused) {
  refuse("", "no line of numbers");
  refuse("# words\nonly words\n", "no line of numbers");
  refuse(head + rows("1e5 nan 3e3 1\n"), "t.txt:10: at 1000 kg/m^3 and 300 K");
  refuse(head + rows("1e5 1e9 3e3\n"), "t.txt:10: expected u, p, c, s");
  refuse(head + rows("1e5 1e9 3e3 1 7\n"), "t.txt:10: expected u, p, c, s");
  refuse(head + rows("1e5 1e9 three 1\n"), "t.txt:10: expected a number, found 'three'");
  refuse(head + rows(""), "t.txt: ends after 8 of 9 rows");
  refuse(head + rows() + "1 2 3 4\n", "t.txt:15: follows the last of 9 rows");
  refuse("20260101\n3 3\n0 2000 1000\n0 300 600\n" + rows(),
         "t.txt:3: density 3 of 3, 1000 kg/m^3, does not lie above 2000");
  refuse("20260101\n3 3\n0 1000 2000\n0 300 300\n" + rows(), "t.txt:4: temperature 3 of 3");
  refuse("20260101\n3 3\n0 -1 2000\n0 300 600\n" + rows(), "t.txt:3: density 2 of 3");
  refuse("20260101\n3 3\n0 1000 2000 3000\n0 300 600\n" + rows(), "t.txt:3: holds 1 more than 3 densities");
  refuse("20260101\n3 3\n0 1000\n0 300 600\n" + rows(), "t.txt:4: density 3 of 3");
  refuse("20260101\n3 3\n0 inf 2000\n0 300 600\n" + rows(), "t.txt:3: density 2 is not finite");
  refuse("20260101\n3\n", "t.txt:2: expected the numbers of densities and of temperatures");
  refuse("20260101\n1 3\n", "t.txt:2: expected the number of densities");
  refuse("20260101\n3 2.5\n", "t.txt:2: expected the number of temperatures");
}

BOOST_AUTO_TEST_CASE(a_table_needs_its_file) {
  eos::material_options o;
  o.name = "table";
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_saying("needs a file"));
  o.table = "nowhere.txt";
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_saying("nowhere.txt"));
  o.name = "linear";
  BOOST_CHECK_EXCEPTION(eos::make(o), foundation::error, bad_input_saying("has no parameter table"));
}
