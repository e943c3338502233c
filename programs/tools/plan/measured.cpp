#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cmath>
#include <foundation/error.hpp>
#include <fstream>
#include <map>
#include <plan/measured.hpp>
#include <two_fluids/options.hpp>
#include <vector>

namespace tetsuame::plan {

namespace {

std::ifstream open(const std::string& path) {
  std::ifstream file(path);
  if (!file) foundation::fail_file(path + ": cannot be read; is it the output folder of a run?");
  return file;
}

// The columns of history.csv by name, without units.
std::map<std::string, std::vector<double>> read_history(const std::string& path) {
  auto file = open(path);
  std::vector<std::string> names, cells;
  std::string line;
  const auto split = [&](std::vector<std::string>& into) {
    boost::algorithm::split(into, line, boost::is_any_of(","));
  };
  if (!std::getline(file, line)) foundation::fail_file(path + ": is empty");
  split(names);
  for (auto& name : names) name = name.substr(0, name.find(" ["));
  std::map<std::string, std::vector<double>> columns;
  for (std::size_t row = 2; std::getline(file, line); ++row) {
    split(cells);
    if (cells.size() != names.size())
      foundation::fail_file(fmt::format("{}:{}: {} values under {} names", path, row, cells.size(), names.size()));
    try {
      for (std::size_t k = 0; k < names.size(); ++k) columns[names[k]].push_back(std::stod(cells[k]));
    } catch (const std::exception&) {
      foundation::fail_file(fmt::format("{}:{}: is no line of numbers", path, row));
    }
  }
  for (const char* name : {"time", "step", "fall_velocity"})
    if (columns[name].empty()) foundation::fail_file(fmt::format("{}: has no values of {}", path, name));
  return columns;
}

std::optional<double> maybe(const nlohmann::json& j, const std::string& key) {
  const auto found = j.find(key);
  return found != j.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

}  // namespace

measured_overturn read_run(const std::string& folder) {
  measured_overturn m{};
  m.folder = folder;
  nlohmann::json summary;
  try {
    auto file = open(folder + "/summary.json");
    summary = nlohmann::json::parse(file);
    m.program = summary.at("program").get<std::string>();
    m.status = summary.at("status").get<std::string>();
    m.time = summary.at("time").get<double>();
    m.steps = summary.at("steps").get<double>();
    m.evaluations = summary.at("rhs_evaluations").get<double>();
  } catch (const nlohmann::json::exception& e) {
    foundation::fail_file(fmt::format("{}/summary.json: is no summary of a run: {}", folder, e.what()));
  }
  if (m.program != "rti" && m.program != "drop")
    foundation::fail_input(
        fmt::format("--run {}: a run of {}; metal through silicate is run by rti and drop", folder, m.program));

  two_fluids::options o;
  namelist::schema schema;
  two_fluids::declare(
      schema, m.program == "rti" ? two_fluids::problem_kind::rayleigh_taylor : two_fluids::problem_kind::drop, o);
  schema.read(namelist::parse_file(folder + "/resolved.nml"));
  const auto& [lower, upper] = o.material;
  m.dimension = static_cast<int>(o.domain.dimension);
  m.n = o.domain.particles[1];
  m.eta_lower = lower.viscosity;
  m.eta_upper = upper.viscosity;
  m.system.L = o.domain.length[1];
  m.system.g = o.gravity;
  m.system.rho_min = std::min(lower.density, upper.density);
  m.system.delta_rho = std::abs(upper.density - lower.density);
  m.system.eta = std::max(lower.viscosity, upper.viscosity);
  m.sound_known = lower.eos == "linear" && upper.eos == "linear";
  if (m.sound_known) {
    m.system.c = 0.0;
    for (const auto& one : o.material)
      m.system.c = std::max(m.system.c, std::sqrt(one.bulk_modulus.value_or(o.bulk_modulus) / one.density));
  }

  const auto columns = read_history(folder + "/history.csv");
  const auto& velocity = columns.at("fall_velocity");
  m.V = *std::max_element(velocity.begin(), velocity.end());
  m.dt = m.steps > 0.0 ? m.time / m.steps : 0.0;
  const auto metrics = summary.value("metrics", nlohmann::json::object());
  m.tau = maybe(metrics, "time_of_fall_0.3");
  m.v_rms_max = maybe(metrics, "v_rms_max");
  m.seconds = maybe(summary, "stepping_seconds");
  if (m.tau) {
    const auto& time = columns.at("time");
    const auto at = std::lower_bound(time.begin(), time.end(), *m.tau) - time.begin();
    m.steps_to_tau = columns.at("step")[std::min(static_cast<std::size_t>(at), time.size() - 1)];
  }
  return m;
}

json as_json(const measured_overturn& m) {
  const auto or_null = [](const std::optional<double>& x) { return x ? json(*x) : json(nullptr); };
  return {{"folder", m.folder},
          {"program", m.program},
          {"status", m.status},
          {"n", m.n},
          {"eta_lower_Pa_s", m.eta_lower},
          {"eta_upper_Pa_s", m.eta_upper},
          {"V_m_s", m.V},
          {"v_rms_max_m_s", or_null(m.v_rms_max)},
          {"tau_s", or_null(m.tau)},
          {"steps_to_tau", or_null(m.steps_to_tau)},
          {"time_s", m.time},
          {"steps", m.steps},
          {"rhs_evaluations", m.evaluations},
          {"dt_s", m.dt},
          {"run_time_s", or_null(m.seconds)}};
}

}  // namespace tetsuame::plan
