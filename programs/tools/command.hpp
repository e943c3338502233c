// What the tools' command lines share: how they are parsed, and how their errors are told.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <foundation/error.hpp>
#include <functional>
#include <run/command_line.hpp>
#include <run/interrupt.hpp>

namespace tetsuame::tools {

// The status of the work; others: of errors that are not ours (out of memory, say).
inline int carry_out(const char* program, foundation::exit_status others, const std::function<int()>& work) {
  try {
    const int status = work();
    run::check_standard_output();
    return status;
  } catch (const foundation::error& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return static_cast<int>(e.status());
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return static_cast<int>(others);
  }
}

// Status to leave with, or -1 to go on. check: what options must be together; throws CLI::ParseError.
inline int parse(
    CLI::App& app, int argc, char** argv, const std::function<void()>& check = [] {}) {
  run::end_by_signals();
  app.set_version_flag("--version", fmt::format("{} {}, commit {}", app.get_name(), run::release(), run::version()));
  try {
    app.parse(argc, argv);
    check();
    return -1;
  } catch (const CLI::Success& e) {
    app.exit(e);
    return carry_out(app.get_name().c_str(), foundation::exit_status::file_failed, [] { return 0; });
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "{}: {}\nTry --help.\n", app.get_name(), e.what());
    return static_cast<int>(foundation::exit_status::bad_input);
  }
}

// The path of a program that is named: beside this one, or a path. fail_input, with those that are there, if it is
// none.
inline std::string program_path(const std::string& name) {
  namespace fs = std::filesystem;
  const auto folder = fs::read_symlink("/proc/self/exe").parent_path();
  const auto is_program = [](const fs::path& path) {
    return access(path.c_str(), X_OK) == 0 && !fs::is_directory(path);
  };
  const auto path = name.find('/') == std::string::npos ? folder / name : fs::absolute(name);
  if (is_program(path)) return path.lexically_normal().string();
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const auto other = entry.path().filename().string();
    if (other != "submit" && other != "bench" && other != "plan" && entry.is_regular_file() && is_program(entry.path()))
      known.push_back(other);
  }
  std::sort(known.begin(), known.end());
  foundation::fail_input(
      fmt::format("program {}: {} is no program; there are {}", name, path.string(), fmt::join(known, ", ")));
}

// An option that may be repeated.
inline void add_many(CLI::App& app, const char* name, std::vector<std::string>& values, const char* meaning,
                     const char* type) {
  app.add_option(name, values, meaning)->expected(1)->take_all()->type_name(type);
}
inline void add_settings(CLI::App& app, std::vector<std::string>& set) {
  add_many(app, "--set", set, "group.key=value, over what the file says; may be repeated", "group.key=value");
}

}  // namespace tetsuame::tools
