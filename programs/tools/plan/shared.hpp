// What both questions of plan share: options, the machine's speed, the tables they print and the file for machines.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <relaxation/steps.hpp>
#include <run/amounts.hpp>
#include <string>
#include <vector>

namespace tetsuame::plan {

using json = nlohmann::ordered_json;

struct shared_options {
  std::string json;
  std::optional<double> steps, seconds;  // backwards
  std::string method = "rk4";
  std::optional<double> rate;  // updates a second, instead of bench's
  std::string bench = "output/bench/bench.json";
  bool bench_given = false;        // then it must be there
  std::string kind = "transport";  // the case of bench
  int threads = 0;                 // 0: as many as were measured at most
};

// Beyond that no quantity is meant, and products would overflow.
inline constexpr double largest = 1e100;
// A number that is finite and lies between the two, the lower excluded (above_zero) or not.
CLI::Validator finite(double least, double most, bool least_excluded);
inline CLI::Validator above_zero() { return finite(0.0, largest, true); }

void add_shared(CLI::App& app, shared_options& o);

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

// The two questions; each adds its options and returns what runs it.
std::function<void()> relaxation_question(CLI::App& app);
std::function<void()> timestep_question(CLI::App& app);

}  // namespace tetsuame::plan
