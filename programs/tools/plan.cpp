// Plans a run before it is started: `plan INPUT.nml` by a few steps of the program that it is for, `plan relaxation`
// and `plan timestep` by formulas (modules/relaxation); `plan eos` shows an equation of state. Here is the command
// line.
#include <fmt/format.h>
#include <unistd.h>

#include <command.hpp>
#include <namelist/document.hpp>
#include <plan/shared.hpp>
#include <run/amounts.hpp>

namespace {

using namespace tetsuame;

struct trial_question {
  std::string input, program;
  std::vector<std::string> set;
  int ranks = 1;
};

// The program that runs such an input, where none is named.
std::string program_for(const std::string& input) {
  const auto document = namelist::parse_file(input);
  std::string found = "disph_c";
  bool chooses_walls = false;
  for (const auto& group : document.groups()) {
    if (auto of = run::program_of_group(group.name); !of.empty() && found == "disph_c") found = of;
    for (const auto& of : group.assignments) chooses_walls |= group.name == "walls" && of.key == "treatment";
  }
  if (found == "balance")
    foundation::fail_input(input + ": is an input of balance, which takes no time steps: balance INPUT.nml");
  // rti and drop have walls of their own; the programs of the notes choose them.
  return chooses_walls && (found == "rti" || found == "drop") ? "disph_c" : found;
}

// PROGRAM INPUT --plan, in place of this process.
void try_steps(const trial_question& q) {
  std::vector<std::string> words{tools::program_path(q.program.empty() ? program_for(q.input) : q.program), q.input,
                                 "--plan"};
  for (const auto& setting : q.set) words.insert(words.end(), {"--set", setting});
  if (q.ranks > 1) words.insert(words.begin(), {"mpirun", "-n", std::to_string(q.ranks)});
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  foundation::fail_file(fmt::format("{} cannot be started", words[0]));
}

void add_trial(CLI::App& app, trial_question& q) {
  app.add_option("INPUT", q.input, "namelist file")->required()->type_name("INPUT.nml");
  app.add_option("--program", q.program, "that is to run it (default: by its groups; a box at rest: disph_c)")
      ->type_name("NAME");
  app.add_option("--ranks", q.ranks, "MPI processes to try it with")->check(CLI::Range(1, 4096));
  tools::add_settings(app, q.set);
}

// Beyond that no quantity is meant, and products would overflow.
constexpr double largest = 1e100;

// A number that is finite and lies between the two, the lower excluded or not.
CLI::Validator finite(double least, double most, bool least_excluded) {
  const auto refusal = [=](const std::string& text) {
    double x = 0.0;
    const bool good = CLI::detail::lexical_cast(text, x) && (least_excluded ? x > least : x >= least) && x <= most;
    return good
               ? std::string()
               : fmt::format("expected a number in {}{}, {}], found {}", least_excluded ? '(' : '[', least, most, text);
  };
  return CLI::Validator(refusal, least_excluded ? "POSITIVE" : "NUMBER");
}

// Of a number, or an optional one, above zero.
CLI::Option* add_positive(CLI::App& app, const char* option, auto& value, const char* meaning) {
  return app.add_option(option, value, meaning)->check(finite(0.0, largest, true));
}

CLI::Option* add_particles(CLI::App& app, auto& n, const char* meaning) {
  return app.add_option("--n", n, meaning)->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 30));
}

void add_shared(CLI::App& app, plan::shared_options& o) {
  add_positive(app, "--steps", o.steps, "backwards: what can be afforded in so many steps");
  app.add_option("--run-time,--seconds", o.seconds,
                 "backwards: what can be afforded in so long a run (s, or 90s, 20min, 8h, 3d)")
      ->transform(CLI::AsNumberWithUnit(std::map<std::string, double>{{"s", 1}, {"min", 60}, {"h", 3600}, {"d", 86400}},
                                        CLI::AsNumberWithUnit::CASE_SENSITIVE, "TIME"))
      ->check(finite(0.0, largest, true));
  app.add_option("--method", o.method, "time integration: its right-hand sides a step count for the run time")
      ->check(CLI::IsMember(plan::evaluations))
      ->capture_default_str();
  add_positive(app, "--rate", o.rate, "particles times right-hand sides a second (default: what bench measured)");
  app.add_option("--bench", o.bench, "file of bench")
      ->type_name("FILE")
      ->each([&o](const std::string&) { o.bench_given = true; })
      ->capture_default_str();
  app.add_option("--case", o.kind, "case of bench")->capture_default_str();
  app.add_option("--threads", o.threads, "threads of the run (default: the most that bench measured)")
      ->check(CLI::Range(1, 4096));
  app.add_option("--json", o.json, "write everything to this file as well")->type_name("FILE");
}

void add_relaxation(CLI::App& app, plan::relaxation_question& q) {
  app.add_option("INPUT", q.input, "namelist file of a convection problem (default: the mantle, case 1a), or of rti")
      ->type_name("INPUT.nml");
  tools::add_settings(app, q.set);
  app.add_flag("--describe", q.describe, "print every group and key that is read, and stop");
  add_positive(app, "--L", q.L, "height (m); the box keeps its shape");
  add_positive(app, "--dT", q.dT, "bottom less top, or of left and right hot less cold (K)");
  add_positive(app, "--rho", q.rho, "density (kg/m3)");
  add_positive(app, "--kappa", q.kappa, "thermal diffusivity (m2/s)");
  add_positive(app, "--nu", q.nu, "kinematic viscosity (m2/s)");
  add_positive(app, "--g", q.g, "gravity (m/s2)");
  add_positive(app, "--alpha", q.alpha, "thermal expansivity (1/K)");
  add_positive(app, "--c-p", q.c_p, "heat capacity (J/(kg K))");
  add_positive(app, "--K", q.K, "bulk modulus (Pa)");
  add_particles(app, q.n, "particles along the height");
  app.add_option("--fraction", q.fraction, "of the largest stable steps")
      ->check(finite(1e-6, 10.0, false))
      ->capture_default_str();
  add_positive(app, "--error", q.error, "of an input of rti: of the growth rate, that slowing may make")
      ->capture_default_str();
  app.add_option("--map", q.map, "of an input of rti: the error at N x N pairs of zeta and xi, into the file of --json")
      ->check(CLI::Range(2, 200));
  add_shared(app, q.shared);
}

void add_timestep(CLI::App& app, plan::timestep_question& q) {
  auto& s = q.system;
  add_particles(app, q.n, "particles along an edge")->capture_default_str();
  add_positive(app, "--L", s.L, "edge of the box (m)")->capture_default_str();
  add_positive(app, "--c", s.c, "speed of sound (m/s)")->capture_default_str();
  add_positive(app, "--rho-min", s.rho_min, "least density (kg/m3)")->capture_default_str();
  add_positive(app, "--delta-rho", s.delta_rho, "density difference (kg/m3)")->capture_default_str();
  add_positive(app, "--g", s.g, "gravity (m/s2)")->capture_default_str();
  add_positive(app, "--eta", s.eta, "viscosity (Pa s); default: c rho_min dx");
  add_positive(app, "--c-p", s.heat_capacity, "heat capacity (J/(kg K))")->capture_default_str();
  app.add_option("--k", s.conductivity, "thermal conductivity (W/(m K)); 0: no limit from it")
      ->check(finite(0.0, largest, false))
      ->capture_default_str();
  app.add_option("--run", q.run,
                 "output folder of a run of rti or drop: its system, and what it measured beside the estimates")
      ->type_name("DIR");
  app.add_option("--dimension", q.dimension, "of space")->check(CLI::IsMember({2, 3}))->capture_default_str();
  add_shared(app, q.shared);
  q.say_again = [&app] {
    for (auto* option : app.get_options([](const CLI::Option* o) { return o->count() > 0; })) option->run_callback();
  };
}

void add_eos(CLI::App& app, plan::eos_question& q) {
  app.add_option("NAME", q.name, "of an equation of state, as in an input")->required();
  app.add_option("--tillotson", q.tillotson, "of 'tillotson': iron, granite or basalt")->type_name("NAME");
  app.add_option("--curve", q.curve, "of 'liquid_silicate': vinet or birch_murnaghan")->type_name("NAME");
  app.add_option("--file", q.file, "of 'table'")->type_name("FILE");
  tools::add_many(app, "--set", q.set, "a parameter of &material, over its own value; may be repeated", "key=value");
  app.add_option("--temperature", q.temperatures, "K, of states and curves")
      ->check(finite(0.0, largest, true))
      ->type_name("T…");
  app.add_option("--pressure", q.pressures, "Pa, of states; curves go from the lowest to the highest")
      ->check(finite(-largest, largest, false))
      ->type_name("P…");
  app.add_option("--output", q.output, "folder for isotherm.csv, isentrope.csv and hugoniot.csv")->type_name("DIR");
  app.add_option("--table", q.table, "write a table in the form of SWIFT and WoMa")->type_name("FILE");
  app.add_option("--rho", q.rho, "kg/m3, of the table")->expected(2)->type_name("LOW HIGH");
  app.add_option("--T", q.T, "K, of the table")->expected(2)->type_name("LOW HIGH");
  app.add_option("--nodes", q.nodes, "of the table: densities, temperatures")
      ->expected(2)
      ->check(CLI::Range(2, 10000))
      ->type_name("N M")
      ->capture_default_str();
  app.add_option("--json", q.json, "write the states to this file as well")->type_name("FILE");
}

void add_ocean(CLI::App& app, plan::ocean_question& q) {
  add_positive(app, "--nickel", q.nickel, "core over mantle, by weight")->capture_default_str();
  add_positive(app, "--cobalt", q.cobalt, "core over mantle, by weight")->capture_default_str();
  add_positive(app, "--iron-ratio", q.iron_ratio, "mole fraction of Fe in the metal over that of FeO in the silicate")
      ->capture_default_str();
  app.add_option("--melt-fraction", q.melt_fraction, "where metal and silicate meet: 1 the liquidus, 0 the solidus")
      ->check(finite(0.0, 1.0, false))
      ->capture_default_str();
  app.add_option("--composition", q.composition, "of the liquidus")
      ->check(CLI::IsMember({"peridotitic", "chondritic"}))
      ->capture_default_str();
  app.add_option("--rock", q.rock, "equation of state of the column above")->capture_default_str();
  add_positive(app, "--g", q.g, "gravity (m/s2)")->capture_default_str();
  app.add_option("--json", q.json, "write everything to this file as well")->type_name("FILE");
}

}  // namespace

int main(int argc, char** argv) {
  // What is none of the questions is an input.
  const std::string first = argc > 1 ? argv[1] : "";
  const bool of_input = !first.empty() && first[0] != '-' && first != "relaxation" && first != "timestep" &&
                        first != "eos" && first != "ocean";
  trial_question trial;
  plan::relaxation_question relaxation;
  plan::timestep_question timestep;
  plan::eos_question equation;
  plan::ocean_question ocean;
  CLI::App app{"Time steps, their number, and the time and memory they take, before a run is started.", "plan"};
  if (of_input) {
    add_trial(app, trial);
  } else {
    app.footer("Or: plan INPUT.nml [--program NAME] [--ranks N] [--set group.key=value]…, by a few steps of that run.");
    app.require_subcommand(1);
    add_relaxation(*app.add_subcommand("relaxation", "convection with slowed sound and inertia: zeta, xi, steps"),
                   relaxation);
    add_timestep(*app.add_subcommand("timestep", "metal sinking through silicate with damped sound: eta, steps"),
                 timestep);
    add_eos(*app.add_subcommand("eos", "an equation of state: states, curves, and a table of it"), equation);
    add_ocean(*app.add_subcommand("ocean", "depth of a magma ocean by nickel and cobalt left in the mantle"), ocean);
  }
  if (const int status = tools::parse(app, argc, argv); status >= 0) return status;
  return tools::carry_out("plan", foundation::exit_status::calculation_failed, [&] {
    if (of_input)
      try_steps(trial);
    else if (app.got_subcommand("relaxation"))
      answer_relaxation(relaxation);
    else if (app.got_subcommand("eos"))
      answer_eos(equation);
    else if (app.got_subcommand("ocean"))
      answer_ocean(ocean);
    else
      answer_timestep(timestep);
    return 0;
  });
}
