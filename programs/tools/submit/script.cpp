#include <cmath>
#include <foundation/error.hpp>
#include <map>
#include <sstream>
#include <submit/script.hpp>
#include <submit/templates.hpp>

namespace submit {

namespace {

using values = std::map<std::string, std::string>;

// {{NAME}} becomes the value; a line with a placeholder whose value is empty is left out.
std::string filled(const std::string& text, const values& v) {
  std::string all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::string made;
    bool keep = true;
    std::size_t at = 0;
    for (std::size_t open; (open = line.find("{{", at)) != std::string::npos;) {
      const auto close = line.find("}}", open);
      const auto& value = v.at(line.substr(open + 2, close - open - 2));
      keep = keep && !value.empty();
      made += line.substr(at, open - at) + value;
      at = close + 2;
    }
    if (keep) all += made + line.substr(at) + "\n";
  }
  return all;
}

std::string joined(const std::vector<std::string>& words, const std::string& prefix, const std::string& between) {
  std::string all;
  for (const auto& word : words) all += (all.empty() ? "" : between) + prefix + word;
  return all;
}

const char* template_of(const std::string& scheduler) {
  if (scheduler == "slurm") return templates::slurm;
  if (scheduler == "pjm") return templates::pjm;
  return scheduler == "pbs" ? templates::pbs : templates::nqsv;
}

// The array `launch` replaced by what the user gave.
std::string with_launcher(const std::string& text, const std::string& launcher) {
  const auto from = text.find("\nlaunch=(") + 1, to = text.find(")\n", from);
  return text.substr(0, from) + "launch=(" + launcher + text.substr(to);
}

}  // namespace

std::string quoted(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string all = "'";
  for (const char c : word) all += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return all + "'";
}

std::string submit_command(const std::string& scheduler) {
  if (scheduler == "slurm") return "sbatch";
  return scheduler == "pjm" ? "pjsub" : "qsub";
}

std::string script(const options& o, const std::string& directory) {
  const bool slurm = o.scheduler == "slurm";
  const int nodes = std::max(1, o.nodes), ranks_per_node = o.ranks / nodes;
  const bool nodes_said = !slurm || o.nodes > 0;
  const std::string prefix = slurm ? "#SBATCH " : o.scheduler == "pjm" ? "#PJM " : "#PBS ";
  std::vector<std::string> settings;
  for (const auto& word : o.set) settings.push_back("--set " + quoted(word));
  std::string before;
  for (const auto& line : o.before) before.append("\n").append(line);
  // Where a scheduler knows one name for whom the time is charged to, either option gives it.
  const bool both = o.scheduler == "pbs" || o.scheduler == "nqsv";
  const values v{
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
      {"settings", joined(settings, "", " ")},
      {"directory", quoted(directory)},
      {"directives", joined(o.directives, prefix, "\n")},
      {"before", before},
      {"command", o.command},
      {"submit_command", submit_command(o.scheduler) + " " + o.output + "/job.sh"},
      {"max_jobs", std::to_string(o.max_jobs)},
      {"chain", o.chain},
  };
  auto how = filled(template_of(o.scheduler), v);
  if (!o.launcher.empty()) how = with_launcher(how, o.launcher);
  // The settings may be none, but the array they go into must be there.
  std::string body = templates::body;
  if (settings.empty()) body.replace(body.find("{{settings}}"), 12, "");
  return filled(templates::head, v) + how + filled(body, v);
}

}  // namespace submit
