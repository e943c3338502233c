// What `submit` is asked for, and the job script as text: the templates with their values.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <submit/templates.hpp>
#include <vector>

namespace submit {

struct options {
  std::string program, input;  // as given; absolute paths once resolved
  std::string scheduler;       // slurm, pjm, pbs, nqsv
  int ranks = 1, threads = 1;  // threads: of each rank
  int nodes = 0;               // 0: not said
  std::string time;            // HH:MM:SS
  long seconds = 0;            // the same
  long margin = 0;             // s; 0: chosen
  std::string queue, account, group, name, output, launcher;
  std::vector<std::string> set, before, directives;
  int max_jobs = 100;
  std::string chain = "self";
  bool submit = false, force = false;
  std::string command;   // this command line, to be typed again
  double own_limit = 0;  // s, run.wall_clock_limit of the resolved input
};

// What needs no quotes anywhere.
inline constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+=,:@";

// In single quotes where the shell would read it otherwise.
inline std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string all = "'";
  for (const char c : word) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return all + "'";
}

// Words as they would be typed.
inline std::string typed(const std::vector<std::string>& words) {
  std::string line;
  for (const auto& word : words) line += (line.empty() ? "" : " ") + quoted(word);
  return line;
}

// {{NAME}} becomes the value; a line with a placeholder whose value is empty is left out.
inline std::string filled(const std::string& text, const std::map<std::string, std::string>& values) {
  std::string all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::string made;
    bool keep = true;
    std::size_t at = 0;
    for (std::size_t open; (open = line.find("{{", at)) != std::string::npos;) {
      const auto close = line.find("}}", open);
      const auto& value = values.at(line.substr(open + 2, close - open - 2));
      keep = keep && !value.empty();
      made += line.substr(at, open - at) + value;
      at = close + 2;
    }
    if (keep) all += made + line.substr(at) + "\n";
  }
  return all;
}

// How each scheduler is spoken to.
struct dialect {
  const char *name, *command, *directive, *text;
};
constexpr dialect dialects[] = {{"slurm", "sbatch", "#SBATCH ", templates::slurm},
                                {"pjm", "pjsub", "#PJM ", templates::pjm},
                                {"pbs", "qsub", "#PBS ", templates::pbs},
                                {"nqsv", "qsub", "#PBS ", templates::nqsv}};

inline const dialect& dialect_of(const std::string& scheduler) {
  return *std::find_if(std::begin(dialects), std::end(dialects), [&](const auto& d) { return d.name == scheduler; });
}

// The array `launch` replaced by what the user gave.
inline std::string with_launcher(const std::string& text, const std::string& launcher) {
  const auto from = text.find("\nlaunch=(") + 1, to = text.find(")\n", from);
  return text.substr(0, from) + "launch=(" + launcher + text.substr(to);
}

// The whole script. `directory`: where the run's relative paths begin.
inline std::string script(const options& o, const std::string& directory) {
  const bool slurm = o.scheduler == "slurm";
  const int nodes = std::max(1, o.nodes), ranks_per_node = o.ranks / nodes;
  const bool nodes_said = !slurm || o.nodes > 0;
  const auto& dialect = dialect_of(o.scheduler);
  std::vector<std::string> settings;
  for (const auto& word : o.set) settings.insert(settings.end(), {"--set", word});
  std::string before, directives;
  for (const auto& line : o.before) before.append("\n").append(line);
  for (const auto& line : o.directives) directives += (directives.empty() ? "" : "\n") + (dialect.directive + line);
  // Where a scheduler knows one name for whom the time is charged to, either option gives it.
  const bool both = o.scheduler == "pbs" || o.scheduler == "nqsv";
  const std::map<std::string, std::string> v{
      {"name", o.name},
      {"queue", o.queue},
      {"account", !both && o.account.empty() ? o.group : o.account},
      {"group", o.group},
      {"nodes", nodes_said ? std::to_string(nodes) : ""},
      {"ranks", std::to_string(o.ranks)},
      {"ranks_per_node", nodes_said ? std::to_string(ranks_per_node) : ""},
      {"cores_per_node", std::to_string(ranks_per_node * o.threads)},
      {"threads", std::to_string(o.threads)},
      {"time", o.time},
      {"seconds", std::to_string(o.seconds)},
      {"margin", std::to_string(o.margin)},
      {"warning", std::to_string(std::max(1L, o.margin / 2))},
      {"own_limit", std::to_string(static_cast<long>(std::ceil(o.own_limit)))},
      {"output", quoted(o.output)},
      {"program", quoted(o.program)},
      {"program_name", o.program.substr(o.program.rfind('/') + 1)},
      {"input", quoted(o.input)},
      {"settings", typed(settings)},
      {"directory", quoted(directory)},
      {"directives", directives},
      {"before", before},
      {"command", o.command},
      {"submit_command", dialect.command + (" " + o.output) + "/job.sh"},
      {"max_jobs", std::to_string(o.max_jobs)},
      {"chain", o.chain},
  };
  auto how = filled(dialect.text, v);
  if (!o.launcher.empty()) how = with_launcher(how, o.launcher);
  // The settings may be none, but the array they go into must be there.
  std::string body = templates::body;
  if (settings.empty()) body.replace(body.find("{{settings}}"), 12, "");
  return filled(templates::head, v) + how + filled(body, v);
}

}  // namespace submit
