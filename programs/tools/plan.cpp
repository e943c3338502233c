// Plans a run before it is started: `plan INPUT.nml` by a few steps of the program that it is for, `plan relaxation`
// and `plan timestep` by formulas (modules/relaxation).
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
  for (const auto& group : document.groups())
    if (const auto of = run::program_of_group(group.name); !of.empty()) return of;
  return "disph_c";
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

}  // namespace

int main(int argc, char** argv) {
  // What is none of the questions is an input.
  const std::string first = argc > 1 ? argv[1] : "";
  const bool of_input = !first.empty() && first[0] != '-' && first != "relaxation" && first != "timestep";
  trial_question trial;
  std::function<void()> relaxation, timestep;
  CLI::App app{"Time steps, their number, and the time and memory they take, before a run is started.", "plan"};
  CLI::App* asked = nullptr;
  if (of_input) {
    app.add_option("INPUT", trial.input, "namelist file")->required()->type_name("INPUT.nml");
    app.add_option("--program", trial.program, "that is to run it (default: by its groups; a box at rest: disph_c)")
        ->type_name("NAME");
    app.add_option("--ranks", trial.ranks, "MPI processes to try it with")->check(CLI::Range(1, 4096));
    tools::add_many(app, "--set", trial.set, "group.key=value, over what the file says; may be repeated",
                    "group.key=value");
  } else {
    app.footer("Or: plan INPUT.nml [--program NAME] [--ranks N] [--set group.key=value]…, by a few steps of that run.");
    app.require_subcommand(1);
    asked = app.add_subcommand("relaxation", "convection with slowed sound and inertia: zeta, xi, steps");
    relaxation = plan::relaxation_question(*asked);
    auto* other = app.add_subcommand("timestep", "metal sinking through silicate with damped sound: eta, steps");
    timestep = plan::timestep_question(*other);
  }
  if (const int status = tools::parse(app, argc, argv); status >= 0) return status;
  return tools::carry_out("plan", foundation::exit_status::calculation_failed, [&] {
    if (of_input)
      try_steps(trial);
    else
      asked->parsed() ? relaxation() : timestep();
    return 0;
  });
}
