// What `submit` is asked for, and the job script as text: the templates with their values.
#pragma once

#include <string>
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
std::string quoted(const std::string& word);

// sbatch, pjsub or qsub.
std::string submit_command(const std::string& scheduler);

// The whole script. `directory`: where the run's relative paths begin.
std::string script(const options& o, const std::string& directory);

}  // namespace submit
