// Times the right-hand side in the programs' own time loop: `./run bench`. The cases are in
// bench/rig.hpp; what is written, in docs/performance.md.
#include <fmt/format.h>
#include <mpi.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <bench/measure.hpp>
#include <cmath>
#include <command.hpp>
#include <domain/communicator.hpp>
#include <filesystem>
#include <fstream>
#include <json_file.hpp>
#include <pairs/records.hpp>

namespace {

using namespace tetsuame;
using json = nlohmann::ordered_json;

struct settings {
  bool quick = false;
  std::string output = "output/bench";
  std::vector<int> threads{1};
  std::vector<std::string> cases = bench::case_names;
  std::vector<int> dimensions{2, 3};
  std::vector<std::string> precisions{"double"};
  std::vector<std::int64_t> particles;  // empty: the plan's own
  double seconds = 1.0;
  std::int64_t steps_a_list = 20;
};

// Status to leave with, or -1 to go on.
int parse(int argc, char** argv, settings& o) {
  const int cores = omp_get_num_procs();
  if (cores > 1) o.threads.push_back(cores);
  CLI::App app{
      "Measures the speed of the right-hand side on this machine. Writes DIR/bench.json; ./run bench makes a page of "
      "it. Use a machine that does nothing else.",
      "bench"};
  app.add_flag("--quick", o.quick, "fewer cases and sizes: under a minute");
  app.add_option("--output", o.output, "directory for bench.json")->type_name("DIR")->capture_default_str();
  app.add_option("--threads", o.threads, "numbers of threads, each measured")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  auto* cases = app.add_option("--cases", o.cases, "which cases (quick: of the schemes for gas gdisph alone)");
  cases->delimiter(',')->check(CLI::IsMember(bench::case_names))->capture_default_str();
  app.add_option("--dimensions", o.dimensions, "2, 3 or both")
      ->delimiter(',')
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option("--precision", o.precisions, "of pairs: double, single or both (remix: double alone)")
      ->delimiter(',')
      ->check(CLI::IsMember({"double", "single"}))
      ->capture_default_str();
  app.add_option("--particles", o.particles, "about how many, instead of the sizes of the plan")
      ->delimiter(',')
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1} << 30));
  auto* seconds =
      app.add_option("--seconds", o.seconds, "to measure each case with each number of threads (quick: 0.2)")
          ->check(CLI::Range(1e-3, 1e4));
  app.add_option("--steps-per-list", o.steps_a_list, "steps that share the making of one list")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  if (const int status = tools::parse(app, argc, argv); status >= 0) return status;
  if (o.quick && seconds->count() == 0) o.seconds = 0.2;
  if (o.quick && cases->count() == 0)
    std::erase_if(o.cases, [](const std::string& name) { return bench::is_scheme(name) && name != "gdisph"; });
  return -1;
}

// The box of about n particles, wide enough for support and skin (7.6 spacings) to fit into it.
std::int64_t side_of(std::int64_t n, int dimension) {
  const auto side = static_cast<std::int64_t>(std::lround(std::pow(static_cast<double>(n), 1.0 / dimension)));
  return std::max<std::int64_t>(side, 8);
}

std::vector<bench::request> plan(const settings& o) {
  std::vector<bench::request> all;
  for (const int dimension : o.dimensions)
    for (const auto& name : o.cases) {
      std::vector<std::int64_t> sizes = o.particles;
      if (sizes.empty() && !o.quick) sizes = {10'000, 40'000, 160'000, 1'000'000, 4'000'000};
      if (sizes.empty() && dimension == 2) sizes = {160'000};
      if (sizes.empty()) sizes = {27'000};
      // One case from small to large, to see whether a particle's time stays the same.
      if (o.quick && o.particles.empty() && name == "program_c" && dimension == 2) sizes = {10'000, 40'000, 160'000};
      for (const auto n : sizes)
        for (const auto& precision : o.precisions)
          if (precision == "double" || name != "remix")
            all.push_back({name, dimension, side_of(n, dimension), o.threads, o.seconds, o.steps_a_list, precision});
    }
  return all;
}

// What a file of /proc says of something, or else.
std::string said(const char* path, const char* of, const char* otherwise) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(of)) return line.substr(line.find(':') + 2);
  return otherwise;
}

// Bytes that can still be had, infinite where the system does not say.
double memory_free() { return 1024.0 * std::stod(said("/proc/meminfo", "MemAvailable:", "inf")); }

// Roughly what a case takes at its largest moment, in bytes: refused beforehand rather than killed.
double memory_needed(const bench::request& asked) {
  // The lists of clusters; all else, with what is sorted while lists are made. Ghosts and walls add to small cases
  // only.
  const double list = asked.dimension == 2 ? 45.0 : 220.0;
  return static_cast<double>(asked.particles()) * (list + 800.0);
}

json as_json(const bench::result& r, const settings& o, const std::string& processor_name) {
  json j;
  j["name"] = r.name;
  j["precision"] = r.precision;
  j["dimension"] = r.dimension;
  j["particles"] = r.particles;
  j["threads"] = r.threads;
  j["neighbours"] = r.neighbours;
  j["list_entries"] = r.list_entries;
  j["passes"] = r.passes;
  j["updates_per_second"] = r.updates_per_second();
  j["updates_per_second_per_core"] = r.updates_per_second() / r.threads;
  j["pairs_per_second"] = r.pairs_per_second();
  j["pairs_per_second_per_core"] = r.pairs_per_second() / r.threads;
  j["ns_per_pair"] = r.ns_per_pair();
  j["threads_speedup"] = r.speedup_over_first;
  j["bytes_per_particle"] = r.bytes_per_particle;
  j["list_bytes_per_particle"] = r.list_bytes_per_particle;
  j["stages"] = r.stages;
  j["list_seconds"] = r.list_seconds;
  j["steps_per_list"] = o.steps_a_list;
  if (r.speedup_over_scalar) {
    j["speedup_over_scalar"] = *r.speedup_over_scalar;
    j["scalar_ns_per_pair"] = r.scalar_ns_per_pair;
    j["deviation_from_scalar"] = *r.deviation_from_scalar;
  }
  j["load_average"] = r.load_average;
  j["processor"] = processor_name;
  j["simd_lanes"] = pairs::lanes;
  j["version"] = run::version();
  return j;
}

void print_head() {
  fmt::print("{:<22}{:>3}{:>10}{:>8}{:>7}{:>7}{:>10}{:>10}{:>9}{:>9}{:>7}{:>8}{:>8}\n", "case", "D", "particles",
             "threads", "faster", "pairs", "Mupd/s", "Mpairs/s", "ns/pair", "scalar/", "walls", "bytes/", "list");
  fmt::print("{:<22}{:>3}{:>10}{:>8}{:>7}{:>7}{:>10}{:>10}{:>9}{:>9}{:>7}{:>8}{:>8}\n", "", "", "", "", "", "each",
             "per core", "per core", "per core", "engine", "share", "particle", "bytes");
}

void print_row(const bench::result& r) {
  const auto walls = r.stages.find("walls");
  fmt::print("{:<22}{:>3}{:>10}{:>8}{:>7.2f}{:>7.1f}{:>10.3f}{:>10.1f}{:>9.2f}{:>9}{:>6.1f}%{:>8.0f}{:>8.0f}\n",
             r.precision == "single" ? r.name + " single" : r.name, r.dimension, r.particles, r.threads,
             r.speedup_over_first, r.neighbours, 1e-6 * r.updates_per_second() / r.threads,
             1e-6 * r.pairs_per_second() / r.threads, r.ns_per_pair(),
             r.speedup_over_scalar ? fmt::format("{:.2f}", *r.speedup_over_scalar) : "",
             walls != r.stages.end() ? 100.0 * walls->second : 0.0, r.bytes_per_particle, r.list_bytes_per_particle);
  std::fflush(stdout);
}

void measure_all(const settings& o) {
  if (domain::communicator::world().size > 1)
    foundation::fail_input("bench measures one process and its threads: start it without mpirun");
  std::error_code failed;
  std::filesystem::create_directories(o.output, failed);
  if (failed) foundation::fail_file(o.output + ": cannot be made: " + failed.message());

  const auto requests = plan(o);
  const bool watched = isatty(STDERR_FILENO) != 0;
  const std::string name = said("/proc/cpuinfo", "model name", "unknown");
  fmt::print("{}, {} lanes of double, version {}\n", name, pairs::lanes, run::version());
  print_head();
  json all = json::array();
  for (std::size_t n = 0; n < requests.size(); ++n) {
    const auto& asked = requests[n];
    if (memory_needed(asked) > 0.9 * memory_free()) {
      fmt::print("{:<22}{:>3}{:>10}  left out: needs about {:.1f} GB, {:.1f} GB are free\n", asked.name,
                 asked.dimension, asked.particles(), 1e-9 * memory_needed(asked), 1e-9 * memory_free());
      continue;
    }
    if (watched)
      fmt::print(stderr, "[{}/{}] {} {}-D {} \r", n + 1, requests.size(), asked.name, asked.dimension,
                 asked.particles());
    for (const auto& r : (asked.dimension == 2 ? bench::measure_2d : bench::measure_3d)(asked)) {
      print_row(r);
      all.push_back(as_json(r, o, name));
    }
    tools::write_json(std::filesystem::path(o.output) / "bench.json",
                      all);  // after each case: what was measured is not lost
  }
  if (all.empty()) foundation::fail_input("nothing was measured: every case needs more memory than is free");
  fmt::print("{}/bench.json\n", o.output);
}

}  // namespace

int main(int argc, char** argv) {
  run::end_by_signals();
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  settings o;
  int status = parse(argc, argv, o);
  if (status < 0)
    status = tools::carry_out("bench", foundation::exit_status::calculation_failed, [&] {
      measure_all(o);
      return 0;
    });
  MPI_Finalize();
  return status;
}
