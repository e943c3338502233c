#include <mpi.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <domain/communicator.hpp>
#include <filesystem>
#include <foundation/agree.hpp>
#include <iostream>
#include <map>
#include <namelist/text.hpp>
#include <new>
#include <run/command_line.hpp>
#include <run/interrupt.hpp>
#include <run/processors.hpp>
#include <run/restart.hpp>
#include <sstream>

namespace {

constexpr const char* tried = "TETSUAME_MPI_STARTS";  // in the environment: how often MPI could not be started
constexpr int most_starts = 6;
char** arguments = nullptr;  // of a start that may be tried again; none: MPI has started
pid_t starts = 0;            // this process, not one that Open MPI begins

int starts_so_far() {
  const char* told = std::getenv(tried);
  return told == nullptr ? 0 : std::atoi(told);
}

void start_again() {
  if (tetsuame::run::stop_requested() != 0) return;
  std::fputs("MPI could not be started; once more, in a moment\n", stderr);
  // Not all of those that met at the same time again, and later each time.
  const int failed = starts_so_far() + 1;
  const timespec pause{(failed - 1) / 2, 300'000'000 + getpid() % 100 * 5'000'000};
  nanosleep(&pause, nullptr);
  setenv(tried, std::to_string(failed).c_str(), 1);
  execv("/proc/self/exe", arguments);
}

// This process's rank as a launcher tells it, before MPI has started; none without a launcher.
const char* launched_as() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (const char* rank = std::getenv(name)) return rank;
  return nullptr;
}

bool first_of_all() { return launched_as() == nullptr || std::atoi(launched_as()) == 0; }

}  // namespace

// Open MPI leaves a failed MPI_Init by _exit, which no handler of exit or of MPI sees; a program's own definition is
// called before the C library's.
extern "C" __attribute__((noreturn)) void _exit(int status) {
  if (arguments != nullptr && status != 0 && getpid() == starts) start_again();
  for (;;) syscall(SYS_exit_group, status);
}

namespace tetsuame::run {

namespace {

using foundation::error;
using foundation::exit_status;

// MPI_Init. A program without mpirun makes and removes Open MPI's directory of the session in /tmp, as does any other
// that starts or ends at that moment; the one that loses ends in MPI_Init. It is then started again, a few times at
// most.
void start_mpi(int& argc, char**& argv) {
  starts = getpid();
  if (launched_as() == nullptr && starts_so_far() + 1 < most_starts) arguments = argv;
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  arguments = nullptr;
  unsetenv(tried);
}

namespace fs = std::filesystem;

std::string output_of(const command_line& line) {
  return line.output.empty() ? "output/" + line.program + "/" + fs::path(line.input).stem().string() : line.output;
}

// Of a run that goes on; empty: it begins.
std::string folder_of_earlier_run(const command_line& line) {
  if (line.restart.empty()) return "";
  if (line.restart == "latest") return output_of(line);
  const auto folder = fs::path(line.restart).parent_path();
  return folder.empty() ? "." : folder.string();
}

// A run that goes on has its input in its directory.
void take_input_of_run(command_line& line) {
  if (line.restart != "latest" && line.output.empty())
    line.output = fs::path(line.restart).has_parent_path() ? fs::path(line.restart).parent_path().string() : ".";
  if (line.output.empty()) throw CLI::RequiredError("INPUT, or --output DIR of the run that is to go on,");
  const auto of = line.restart == "latest" ? fs::path(line.output) : fs::path(line.restart).parent_path();
  line.input = (of / "resolved.nml").string();
  std::error_code missing;
  if (fs::exists(line.input, missing) && !fs::is_regular_file(line.input, missing))
    throw CLI::ValidationError(line.input + " is not a plain file");
}

void check_restart_path(const std::string& restart) {
  namespace fs = std::filesystem;
  std::error_code unknown;
  if (restart.empty() || restart == "latest") return;
  if (fs::is_directory(restart, unknown))
    foundation::fail_input(fmt::format(
        "--restart {0}: is a directory, and a checkpoint in it, or 'latest', was expected: --restart latest "
        "--output {0} continues the run in it",
        restart));
  if (fs::symlink_status(restart, unknown).type() == fs::file_type::not_found)
    foundation::fail_file(fmt::format("cannot read checkpoint {}: there is no such file", restart));
}

// Whether an argument of --set names the group: group.key=value, not key=value.
bool has_group(const std::string& argument) {
  return argument.find('.') < std::min(argument.find('='), argument.size());
}

// Of an option that is not there: the nearest that is.
std::string nearest_option(const CLI::App& app, const std::vector<std::string>& arguments) {
  std::vector<std::string> known;
  for (const auto* option : app.get_options())
    for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  for (const auto& argument : arguments)
    if (argument.starts_with("--"))
      return "; the nearest option is " + namelist::nearest(argument.substr(0, argument.find('=')), known);
  return "";
}

// Parses on every rank alike; only rank 0 speaks. Returns a status to leave with, or -1 to go on.
int parse(int argc, char** argv, bool speaks, const program_input& in, command_line& line) {
  CLI::App app{"Tetsuame " + release() + ": density-independent SPH for planetary interiors", line.program};
  app.add_option("INPUT", line.input, "namelist file")->type_name("INPUT.nml");
  app.add_option("--set", line.set, "group.key=value, over what the file says; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("group.key=value");
  app.add_option("--output", line.output, "directory for the results (default: output/PROGRAM/INPUT's name)")
      ->type_name("DIR");
  if (in.restarts)
    app.add_option("--restart", line.restart,
                   "continue from a checkpoint, or from the latest in the output directory; without INPUT, as that run "
                   "was told")
        ->type_name("FILE|latest");
  if (in.restarts)
    app.add_flag("--plan", line.plan,
                 "take a few steps, tell what the whole run will need of steps, time and memory, and stop; nothing is "
                 "written");
  if (in.add_options) in.add_options(app, line);
  app.add_flag("--force", line.force, "replace the results of an earlier run in the output directory");
  app.add_flag("--check", line.check, "read and check the input, print it resolved, and stop");
  app.add_flag("--describe", line.describe, "print every group and key with type, unit, default, range and meaning");
  app.set_version_flag("--version", fmt::format("{} {}, commit {}", line.program, release(), version()));
  try {
    app.parse(argc, argv);
    if (line.input.empty() && !line.restart.empty()) take_input_of_run(line);
    if (!line.describe && line.input.empty()) throw CLI::RequiredError("INPUT");
    if (line.force && line.restart == "latest")
      throw CLI::ValidationError("--force and --restart latest exclude each other");
    if (line.plan && !line.restart.empty())
      throw CLI::ValidationError("--plan tells of a run from its start, and --restart excludes it");
  } catch (const CLI::Success& e) {
    if (speaks) app.exit(e);
    return 0;
  } catch (const CLI::ParseError& e) {
    const bool unknown = dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr;
    const auto hint = unknown ? nearest_option(app, app.remaining()) : "";
    if (speaks)
      std::cerr << line.program << ": " << e.what() << hint << "\nTry --help, or --describe for the input's keys.\n";
    return static_cast<int>(exit_status::bad_input);
  }
  return -1;
}

// Those that take a while to be read and checked.
void tell_large_files(const command_line& line) {
  constexpr double large = 5e6;  // bytes
  for (const auto& f : line.files) {
    std::error_code unknown;
    const auto bytes = static_cast<double>(fs::file_size(f.from, unknown));
    if (!unknown && bytes > large)
      std::fputs(fmt::format("{}: reads and checks {}, {:.0f} MB\n", line.program, f.from, bytes / 1e6).c_str(),
                 stderr);
  }
}

// The input as resolved; none if that is all that was asked for.
std::string read_input(const std::function<std::string(const std::string&)>& text_of, bool speaks, command_line& line,
                       const program_input& in) {
  namelist::document document;
  if (!line.input.empty()) {
    document = namelist::parse_text(text_of(line.input), line.input);
    for (const auto& argument : line.set)
      if (has_group(argument)) document.set(argument);
    if (in.choose) in.choose(document);
  }
  namelist::schema schema;
  in.declare(schema);
  if (line.describe) {
    std::ostringstream described;
    schema.describe(described);
    if (speaks) print(described.str());
    return "";
  }
  for (const auto& argument : line.set)
    if (!has_group(argument)) document.set(schema.with_group(argument));
  for (const auto& group : document.groups())
    if (const auto of = group.name == "smoothing" ? "disph_a to disph_f" : program_of_group(group.name);
        group.line > 0 && !schema.has_group(group.name) && !of.empty())
      foundation::fail_input(
          fmt::format("{}:{}: &{}: this input is for program {}", document.name(), group.line, group.name, of));
  schema.read(document);
  line.files = find_input_files(schema, folder_of_earlier_run(line));
  if (speaks) tell_large_files(line);
  in.complete(schema);
  const auto first_line = fmt::format("! {}, every key as run", in.program);
  line.keys = schema.at_restart();
  line.output = output_of(line);
  if (line.check) {
    if (!line.restart.empty()) {
      const auto text = resolved_with_copies(schema, line.files, first_line);
      const auto was = read_saved_run(line.restart, line.output);
      check_restart(was, {line.program, text, line.keys});
      check_end(was, {line.program, text, line.keys});
    }
    if (speaks) print(resolved_with_copies(schema, {}, first_line));
    return "";
  }
  if (in.need) {
    const auto& [group, key] = in.particles_key;
    line.particles_at = schema.where(group, key) + ": &" + group + " " + key;
  }
  return resolved_with_copies(schema, line.files, first_line);
}

// The status of the work; an error is told by one.
int guarded(bool speaks, const std::string& program, const std::function<void()>& work) {
  try {
    work();
    return 0;
  } catch (const error& e) {
    if (speaks) std::cerr << program << ": " << e.what() << '\n';
    return static_cast<int>(e.status());
  }
}

void run_input(const domain::communicator& ranks, command_line& line, const program_input& in,
               const std::function<void(const command_line&, const std::string&)>& run) {
  const auto text_of = [&](const std::string& path) {
    std::string text;
    foundation::on_rank_0(ranks.comm, [&] { text = namelist::read_file(path); });
    return ranks.broadcast(text);
  };
  const auto resolved = read_input(text_of, ranks.rank == 0, line, in);
  if (in.need) check_memory(ranks, in.program, in.need(), line.particles_at);
  run(line, resolved);
}

// Where one rank cannot go on, and the others may be waiting for it.
void end_all(const domain::communicator& ranks) {
  std::fflush(nullptr);
  if (ranks.size == 1) std::_Exit(static_cast<int>(exit_status::calculation_failed));
  MPI_Abort(ranks.comm, static_cast<int>(exit_status::calculation_failed));
}

}  // namespace

void check_standard_output() {
  if (std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  // What failed may have done so some calls ago: the reason is the one that it has now.
  errno = 0;
  const bool works_now = ::write(STDOUT_FILENO, "\n", 1) == 1;
  foundation::fail_file(
      fmt::format("cannot write to the standard output{}", works_now ? "" : std::string(": ") + std::strerror(errno)));
}

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  check_standard_output();
}

std::string program_of_group(const std::string& group) {
  static const std::map<std::string, std::string> of = {{"shock", "shock"},
                                                        {"convection", "convection"},
                                                        {"relaxation", "convection"},
                                                        {"conduction", "conduction"},
                                                        {"rti", "rti"},
                                                        {"drop", "drop"},
                                                        {"flow", "flow"},
                                                        {"planet", "planet"},
                                                        {"layer", "planet"},
                                                        {"granular", "granular"},
                                                        {"grain", "granular"},
                                                        {"packing", "granular"},
                                                        {"machine", "balance"},
                                                        {"distribution", "balance"}};
  const auto found = of.find(group);
  return found == of.end() ? "" : found->second;
}

int start(int argc, char** argv, const program_input& input,
          const std::function<void(const command_line&, const std::string&)>& run) {
  command_line line;
  line.program = input.program;
  line.started_as = argv[0];
  // What only reads needs no MPI: it answers at once, and where none may be started (a cluster's login node).
  int status = parse(argc, argv, first_of_all(), input, line);
  if (!input.restarts || line.check || line.describe || line.plan || status >= 0) end_by_signals();
  if (status > 0) return status;
  if (status == 0) return guarded(first_of_all(), line.program, check_standard_output);
  status = guarded(first_of_all(), line.program, [&] { check_restart_path(line.restart); });
  if (status > 0) return status;
  if (line.check || line.describe)
    return guarded(first_of_all(), line.program, [&] { read_input(namelist::read_file, first_of_all(), line, input); });

  if (line.plan && first_of_all()) line.rehearsed = rehearse(line, input.rehearsed_with, input.particles_key);
  start_mpi(argc, argv);
  const auto ranks = domain::communicator::world();
  if (const auto crowded = crowded_processors(ranks); ranks.rank == 0 && !crowded.empty())
    std::fprintf(stderr, "%s: warning: %s\n", input.program.c_str(), crowded.c_str());
  try {
    status = guarded(ranks.rank == 0, line.program, [&] { run_input(ranks, line, input, run); });
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "%s: out of memory on rank %d of %d: take more nodes, fewer ranks on each, or fewer particles\n",
                 input.program.c_str(), ranks.rank, ranks.size);
    end_all(ranks);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: rank %d: %s\n", input.program.c_str(), ranks.rank, e.what());
    end_all(ranks);
  }
  MPI_Finalize();
  return status;
}

}  // namespace tetsuame::run
