// What the tools' command lines share: how they are parsed, and how their errors are told.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <foundation/error.hpp>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <run/command_line.hpp>

namespace tetsuame::tools {

// Status to leave with, or -1 to go on. check: what options must be together; throws CLI::ParseError.
inline int parse(
    CLI::App& app, int argc, char** argv, const std::function<void()>& check = [] {}) {
  app.set_version_flag("--version", fmt::format("{} {}, commit {}", app.get_name(), run::release(), run::version()));
  try {
    app.parse(argc, argv);
    check();
    return -1;
  } catch (const CLI::Success& e) {
    app.exit(e);
    return 0;
  } catch (const CLI::ParseError& e) {
    fmt::print(stderr, "{}: {}\nTry --help.\n", app.get_name(), e.what());
    return static_cast<int>(foundation::exit_status::bad_input);
  }
}

// The status of the work; others: of errors that are not ours (out of memory, say).
inline int carry_out(const char* program, foundation::exit_status others, const std::function<int()>& work) {
  try {
    return work();
  } catch (const foundation::error& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return static_cast<int>(e.status());
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return static_cast<int>(others);
  }
}

// fail_file if it cannot be written.
inline void write_json(const std::string& path, const nlohmann::ordered_json& all) {
  std::ofstream file(path);
  file << all.dump(1) << '\n';
  file.close();
  if (!file) foundation::fail_file(path + ": cannot be written; is there space, and may you write there?");
}

// An option that may be repeated.
inline void add_many(CLI::App& app, const char* name, std::vector<std::string>& values, const char* meaning,
                     const char* type) {
  app.add_option(name, values, meaning)->expected(1)->take_all()->type_name(type);
}

}  // namespace tetsuame::tools
