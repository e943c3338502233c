// Writes, and on request submits, the job script of a run for a batch system. The script continues itself by
// `--restart latest` until the run is complete; its text is in programs/tools/submit/*.sh, which says more.
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <command.hpp>
#include <cstdio>
#include <filesystem>
#include <foundation/error.hpp>
#include <kernels/kernel.hpp>
#include <namelist/document.hpp>
#include <output/directory.hpp>
#include <output/file.hpp>
#include <run/amounts.hpp>
#include <sstream>
#include <submit/script.hpp>

namespace {

namespace fs = std::filesystem;
using namespace tetsuame;
using foundation::fail_file;
using foundation::fail_input;

// What is run, on what.
void add_run(CLI::App& app, submit::options& o) {
  app.add_option("PROGRAM", o.program, "a program beside this one (disph_c), or a path")->required();
  app.add_option("INPUT", o.input, "namelist file")->required()->type_name("INPUT.nml");
  app.add_option("--scheduler", o.scheduler,
                 "slurm; pjm (Fujitsu Technical Computing Suite); pbs (PBS Professional, OpenPBS); nqsv (NEC)")
      ->required()
      ->check(CLI::IsMember({"slurm", "pjm", "pbs", "nqsv"}));
  app.add_option("--ranks", o.ranks, "MPI processes")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--threads", o.threads, "cores, and threads, of each")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--nodes", o.nodes, "nodes; the ranks are spread over them evenly")->check(CLI::Range(1, 1000000));
  app.add_option("--time", o.time, "of one job")->required()->type_name("HH:MM:SS");
  app.add_option("--margin", o.margin,
                 "s before the time is up at which the run writes its checkpoint (default: a twentieth of the time, "
                 "between 60 and 600, but no more than half)")
      ->check(CLI::Range(1L, 1000000L));
}

// Whose job it is, what stands in its script, and how it goes on.
void add_job(CLI::App& app, submit::options& o) {
  app.add_option("--queue,--partition", o.queue, "queue, partition or resource group")->type_name("NAME");
  app.add_option("--account", o.account, "whom the time is charged to")->type_name("NAME");
  app.add_option("--group", o.group, "the same, where it goes by group")->type_name("NAME");
  app.add_option("--name", o.name, "of the job (default: the program's)")->type_name("NAME");
  app.add_option("--output", o.output, "directory for script and results (default: output/PROGRAM/INPUT's name)")
      ->type_name("DIR");
  tools::add_settings(app, o.set);
  tools::add_many(app, "--before", o.before,
                  "a command to stand before the run, such as 'module load openmpi'; may be repeated", "COMMAND");
  tools::add_many(app, "--directive", o.directives,
                  "one more line for the scheduler, such as '--mem=8G'; may be repeated", "TEXT");
  app.add_option("--launcher", o.launcher, "what starts the ranks, in place of the scheduler's usual; taken as it is")
      ->type_name("COMMAND");
  app.add_option("--max-jobs", o.max_jobs, "the chain ends after so many")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--chain", o.chain,
                 "self: each job submits the next; ahead: --max-jobs jobs are submitted at once, each waiting for the "
                 "one before, where jobs may not submit")
      ->check(CLI::IsMember({"self", "ahead"}))
      ->capture_default_str();
  app.add_flag("--submit", o.submit, "submit it, too");
  app.add_flag("--force", o.force, "start anew, in place of the results that are in the output directory");
}

// Status to leave with, or -1 to go on.
int parse(int argc, char** argv, submit::options& o) {
  CLI::App app{
      "Writes DIR/job.sh, a job script that runs PROGRAM on INPUT under a batch system and continues it, job "
      "after job, until it is complete.",
      "submit"};
  add_run(app, o);
  add_job(app, o);
  return tools::parse(app, argc, argv, [&] {
    if (o.chain != "ahead") return;
    if (app.count("--max-jobs") == 0) throw CLI::RequiredError("--chain ahead: --max-jobs");
    if (o.max_jobs > 100) throw CLI::ValidationError("--chain ahead: --max-jobs", "at most 100");
    if (o.scheduler == "nqsv") throw CLI::ValidationError("--chain ahead", "not for nqsv: its jobs submit the next");
  });
}

// ---- checks ------------------------------------------------------------------------------------

long seconds_of(const std::string& time) {
  std::string shape = time;
  for (char& c : shape)
    if (c >= '0' && c <= '8') c = '9';
  int hours = 0, minutes = 0, rest = 0;
  std::sscanf(time.c_str(), "%d:%d:%d", &hours, &minutes, &rest);
  if (shape.size() < 7 || !std::string("9999:99:99").ends_with(shape) || minutes > 59 || rest > 59)
    fail_input(fmt::format("--time {}: expected HH:MM:SS, such as 24:00:00", time));
  const long seconds = 3600L * hours + 60L * minutes + rest;
  if (seconds < 2) fail_input(fmt::format("--time {}: expected at least two seconds", time));
  return seconds;
}

// Schedulers read these from comment lines, each with quoting of its own.
void refuse_odd(const submit::options& o) {
  for (const auto& [option, text] : {std::pair{"--output", o.output},
                                     {"--name", o.name},
                                     {"--queue", o.queue},
                                     {"--account", o.account},
                                     {"--group", o.group}})
    if (const auto at = text.find_first_not_of(submit::plain); at != std::string::npos)
      fail_input(fmt::format("{} {}: '{}' cannot stand in a job script's directives; letters, digits and _-./+=,:@ can",
                             option, text, text[at]));
}

void refuse_line_ends(int argc, char** argv) {
  for (int k = 1; k < argc; ++k)
    if (std::string(argv[k]).find_first_of("\n\r") != std::string::npos)
      fail_input(fmt::format("argument {} holds a line end", k));
}

// Runs a command; its standard output comes back, its messages go where ours go.
struct outcome {
  int status = 0;  // 127: it could not be started
  std::string text;
};

outcome called(const std::vector<std::string>& words) {
  const auto line = "command -v " + submit::quoted(words[0]) + " >/dev/null || exit 127; exec " + submit::typed(words);
  std::FILE* pipe = popen(line.c_str(), "r");
  if (pipe == nullptr) output::fail_system("make", "a pipe");
  outcome o;
  std::array<char, 4096> buffer{};
  while (const auto n = std::fread(buffer.data(), 1, buffer.size(), pipe)) o.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  o.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return o;
}

// What a key of a group of the resolved input was given.
std::string text_in(const namelist::document& resolved, const std::string& group, const std::string& key,
                    const std::string& otherwise) {
  for (const auto& g : resolved.groups())
    for (const auto& a : g.assignments)
      if (g.name == group && a.key == key && !a.values.empty() && !a.values[0].content.empty())
        return a.values[0].content;
  return otherwise;
}

// A rank with fewer particles than one kernel holds would compute copies of others' for the most part.
void refuse_too_many_ranks(const submit::options& o, const namelist::document& resolved) {
  const auto kernel = text_in(resolved, "kernel", "name", "");
  if (kernel.empty()) return;
  const auto dimension = std::stoll(text_in(resolved, "domain", "dimension", "2"));
  double particles = 1.0;
  for (const char axis : std::string("xyz").substr(0, static_cast<std::size_t>(dimension)))
    particles *= std::stod(text_in(resolved, "domain", std::string("particles_") + axis, "1"));
  const double neighbours = run::particles_within(
      kernels::find(kernel).support_over_h * std::stod(text_in(resolved, "kernel", "h_over_dx", "1")), dimension);
  const double most = std::max(1.0, std::floor(particles / neighbours));
  if (o.ranks > most)
    fail_input(fmt::format("--ranks {}: for {:.0f} particles, of which a kernel holds {:.0f}, at most {:.0f} fit",
                           o.ranks, particles, neighbours, most));
}

// PROGRAM INPUT --check; what it refuses, it has said itself. Returns the status, and the limit in the input.
int check_input(submit::options& o) {
  std::vector<std::string> words{o.program, o.input};
  for (const auto& setting : o.set) words.insert(words.end(), {"--set", setting});
  words.emplace_back("--check");
  const auto [status, text] = called(words);
  if (status != 0) return status;
  const auto resolved = namelist::parse_text(text, "the resolved input");
  o.own_limit = std::stod(text_in(resolved, "run", "wall_clock_limit", "0"));
  refuse_too_many_ranks(o, resolved);
  return 0;
}

void complete(submit::options& o) {
  o.seconds = seconds_of(o.time);
  if (o.margin == 0) o.margin = std::clamp(o.seconds / 20, 60L, 600L);
  o.margin = std::min(o.margin, o.seconds / 2);
  if (o.nodes > 0 && o.ranks % o.nodes != 0)
    fail_input(fmt::format("--ranks {}: not a multiple of --nodes {}", o.ranks, o.nodes));
  o.program = tools::program_path(o.program);
  const auto program_name = fs::path(o.program).filename().string();
  if (o.output.empty()) o.output = "output/" + program_name + "/" + fs::path(o.input).stem().string();
  o.input = fs::absolute(o.input).lexically_normal().string();
  o.output = fs::absolute(o.output).lexically_normal().string();
  if (o.output.size() > 1 && o.output.back() == '/') o.output.pop_back();
  if (o.name.empty()) o.name = program_name;
  refuse_odd(o);
}

// Results without a checkpoint would be lost by the first job.
void check_output(const submit::options& o) {
  std::error_code ignored;
  if (!fs::exists(o.output, ignored)) return;
  if (!fs::is_directory(o.output, ignored))
    fail_input(fmt::format("output {} is a file: give a directory by --output", o.output));
  if (o.force || !output::numbered_files(o.output, "checkpoint_", ".h5").empty()) return;
  for (const auto& entry : fs::directory_iterator(o.output))
    if (output::is_our_file(entry.path().filename().string()))
      fail_input(fmt::format(
          "output directory {} has results but no checkpoint: name another by --output, or replace them by --force; "
          "nothing was written",
          o.output));
}

// ---- writing and submitting --------------------------------------------------------------------

std::string write_script(const submit::options& o) {
  std::error_code problem;
  fs::create_directories(o.output, problem);
  if (problem) fail_file(fmt::format("cannot create directory {}: {}", o.output, problem.message()));
  auto path = o.output + "/job.sh";
  const auto old = output::numbered_files(o.output, "checkpoint_", ".h5");
  if (o.force)
    for (const auto& file : old) output::remove_quietly(o.output + "/" + file.second);
  output::replace_text(path, submit::script(o, fs::current_path().string()));
  output::remove_quietly(o.output + "/job.state");  // a new chain
  chmod(path.c_str(), 0755);
  fmt::print("{}: {} on {} x {} cores, {} a job, of which the last {} s are kept for the checkpoint\n", path,
             fs::path(o.program).filename().string(), o.ranks, o.threads, o.time, o.margin);
  if (!o.force && !old.empty()) fmt::print("it will continue from {}\n", old.back().second);
  return path;
}

// What submits the n-th of a chain; `last`: the ID of the one before. A job waits for that one, however it ended: the
// script sees whether anything is left to do. PJM deletes what follows unless the run was interrupted (75).
std::vector<std::string> submission(const submit::options& o, const std::string& path, int n, const std::string& last) {
  std::vector<std::string> words{submit::dialect_of(o.scheduler).command};
  if (o.chain == "ahead" && o.scheduler == "pjm")
    words.insert(words.end(), {"--step", "--sparam",
                               n == 0 ? "sn=0" : fmt::format("jid={},sn={},sd=ec!=75:all:{}", last, n, n - 1)});
  else if (n > 0 && o.scheduler == "slurm")
    words.push_back("--dependency=afterany:" + last);
  else if (n > 0)
    words.insert(words.end(), {"-W", "depend=afterany:" + last});
  words.push_back(path);
  return words;
}

// sbatch: "Submitted batch job 12"; pjsub: "[INFO.] PJM 0000 pjsub Job 12_0 submitted."; qsub: "12.server"
std::string job_in(const submit::options& o, const std::string& answer) {
  std::istringstream words(answer);
  for (std::string word, before; words >> word; before = word) {
    auto number = word.substr(0, word.find_first_not_of("0123456789"));
    if (o.scheduler == "pbs") return number.empty() ? "" : word;
    if (before.ends_with("ob") && !number.empty()) return number;
  }
  return "";
}

void submit_jobs(const submit::options& o, const std::string& path) {
  std::string last;
  const int jobs = o.chain == "ahead" ? o.max_jobs : 1;
  for (int n = 0; n < jobs; ++n) {
    const auto words = submission(o, path, n, last);
    const auto [status, text] = called(words);
    fmt::print("{}", text);
    const auto line = submit::typed(words);
    const auto done = n == 0 ? std::string("none was submitted") : fmt::format("{} were submitted", n);
    if (status == 127)
      fail_file(fmt::format("cannot run {}: is this the login node? {}; the script stands", line, done));
    if (status != 0) fail_file(fmt::format("{} ended with status {}; {}; the script stands", line, status, done));
    last = job_in(o, text);
    if (last.empty() && n + 1 < jobs)
      fail_file(
          fmt::format("{}: no job number in its answer, so the next cannot wait for it; {} submitted", line, n + 1));
  }
}

}  // namespace

int main(int argc, char** argv) {
  submit::options o;
  if (const int status = parse(argc, argv, o); status >= 0) return status;
  return tools::carry_out("submit", foundation::exit_status::file_failed, [&] {
    refuse_line_ends(argc, argv);
    o.command = submit::typed({argv, argv + argc});
    complete(o);
    check_output(o);
    if (const int status = check_input(o); status != 0) return status;
    const auto path = write_script(o);
    if (o.submit)
      submit_jobs(o, path);
    else
      fmt::print("submit it by: {} {}\n", submit::dialect_of(o.scheduler).command, path);
    return 0;
  });
}
