// The job script as text: the templates with their values.
#pragma once

#include <string>
#include <submit/options.hpp>

namespace submit {

// In single quotes where the shell would read it otherwise.
std::string quoted(const std::string& word);

// sbatch, pjsub or qsub.
std::string submit_command(const std::string& scheduler);

// The whole script. `directory`: where the run's relative paths begin.
std::string script(const options& o, const std::string& directory);

}  // namespace submit
