// What plan is asked, and what its questions share: the machine's speed, the tables they print and the file for
// machines.
#pragma once

#include <functional>
#include <map>
#include <namelist/document.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <relaxation/steps.hpp>
#include <string>
#include <vector>

namespace tetsuame::plan {

using json = nlohmann::ordered_json;

// Right-hand sides a step of the methods of &time with fixed steps.
inline const std::map<std::string, double> evaluations{{"euler", 1},   {"ab2", 1}, {"kdk", 1}, {"order_2", 2}, {"ssp_rk3", 3},
                                                       {"order_3", 3}, {"rk4", 4}, {"order_4", 5}, {"order_5", 6}};

struct shared_options {
  std::string method, kind;                        // of time integration; the case of bench
  std::optional<double> steps = {}, seconds = {};  // backwards
  std::optional<double> rate = {};                 // updates a second, instead of bench's
  std::string bench = "output/bench/bench.json";
  bool bench_given = false;  // then it must be there
  int threads = 0;           // 0: as many as were measured at most
  std::string json = {};     // file to write
};

struct relaxation_question {
  shared_options shared{"rk4", "transport"};
  std::string input;
  std::vector<std::string> set;
  bool describe = false;
  double fraction = 0.1;
  std::optional<double> L, dT, rho, kappa, nu, g, alpha, c_p, K;
  std::optional<std::int64_t> n;
  // Of two layers.
  double error = 0.01;   // of the growth rate
  std::int64_t map = 0;  // points along zeta and xi
  bool convection_only() const {
    return L || dT || rho || kappa || nu || g || alpha || c_p || K || n || shared.steps || shared.seconds;
  }
};
void answer_relaxation(const relaxation_question& q);
void answer_overturn(const relaxation_question& q, const namelist::document& document);  // of an input of rti

struct timestep_question {
  shared_options shared{"euler", "program_c"};  // the note's method
  relaxation::two_layers system;
  std::int64_t n = 75;
  int dimension = 2;
  std::string run;                  // folder of a run; empty: none
  std::function<void()> say_again;  // assigns anew what the command line says
};
void answer_timestep(timestep_question& q);

struct eos_question {
  std::string name, tillotson, file, curve;
  std::vector<std::string> set;                 // key=value of &material
  std::vector<double> temperatures, pressures;  // K, Pa; empty: chosen
  std::string output;                           // folder for eos.csv; empty: none
  std::string table;                            // file to write a table to; empty: none
  std::vector<double> rho, T;                   // its range, kg/m^3, K: low, high
  std::vector<std::size_t> nodes{200, 100};     // of densities, temperatures
  std::string json;
};
void answer_eos(eos_question& q);

// Defaults: core over mantle, and iron in both, by the compositions of docs/theory/magma_ocean.md.
struct ocean_question {
  double nickel = 26.5, cobalt = 23.8;  // metal over silicate, by weight
  double iron_ratio = 13.8;             // mole fraction of Fe in the metal over that of FeO in the silicate
  double melt_fraction = 1.0;           // where metal and silicate meet: 1 the liquidus, 0 the solidus
  double g = 9.9;                       // m/s2, of the column above
  std::string composition = "peridotitic", rock = "liquid_mgsio3";
  std::string json;
};
void answer_ocean(ocean_question& q);

struct machine {
  relaxation::cost cost;
  std::string note;  // where the rate comes from
};
// The speed by the record of bench nearest in size (by ratio), of that case, dimension and number of threads. fail_file
// if the file is damaged, fail_input if it was asked for and has no such record, or a run time needs one.
machine this_machine(const shared_options& o, int dimension, double particles);

// Rows of texts in aligned columns: the first left, as is the last; `right` says which are set right.
struct table {
  std::string title;
  std::vector<std::vector<std::string>> rows;  // the first is the head, if has_head
  std::vector<bool> right;
  bool has_head = false;
  std::string notes = {};  // whole lines
};

// A line of an answer.
struct quantity {
  const char* symbol;
  std::string place;  // in the file, a JSON pointer; empty: nowhere
  json value;         // null: none
  const char* unit = "";
  std::string meaning = {}, source = {}, mark = {};
};

// Everything said: the file for machines, and the tables.
struct answer {
  json all;
  std::vector<table> tables;

  void add(const std::string& title, const std::vector<quantity>& rows);
  // Checks, prints, and writes the file if one is wanted. fail_calculation where a number is not finite: those of the
  // question are too far apart.
  void give(const shared_options& o, const char* sources) const;
};

// What the steps cost on this machine; seconds: of the run, 0 where it is not known. `plan`: pointer to their object.
std::vector<quantity> costs(const machine& m, double particles, double seconds, const std::string& plan, answer& a);

// Four digits: 1000, 2.673e-07, 0.0843
std::string number(double value);
// null where it is not known.
inline json or_null(double value) { return value > 0.0 ? json(value) : json(nullptr); }

}  // namespace tetsuame::plan
