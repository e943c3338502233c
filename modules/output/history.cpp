#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <iterator>
#include <output/agree.hpp>
#include <output/file.hpp>
#include <output/history.hpp>

namespace tetsuame::output {

namespace {

std::string header_of(const std::vector<history_column>& columns) {
  std::string line = "step [1]";
  for (const auto& c : columns) line += fmt::format(",{} [{}]", c.name, c.units);
  return line + "\n";
}

// The whole lines up to the step.
std::string kept_lines(const std::string& path, const std::string& header, std::int64_t last_step) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) foundation::fail_file(fmt::format("cannot read {}", path));
  if (!text.starts_with(header))
    foundation::fail_file(fmt::format(
        "cannot continue {}: its columns are not those of this run. Move it away to start a new one", path));
  std::string kept = header;
  for (std::size_t at = header.size(), end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    std::int64_t step = 0;
    const auto [after, problem] = std::from_chars(text.data() + at, text.data() + end, step);
    if (problem != std::errc() || *after != ',')
      foundation::fail_file(fmt::format("cannot continue {}: a line does not begin with a step: \"{}\"", path,
                                        text.substr(at, end - at)));
    if (step <= last_step) kept += text.substr(at, end + 1 - at);
  }
  return kept;
}

}  // namespace

history::history(MPI_Comm comm, const std::string& path) : comm_(comm), path_(path) {
  on_rank_0(comm, [&] {
    file_.reset(std::fopen(path.c_str(), "ae"));
    if (!file_) fail_system("write", path);
  });
}

history history::start(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns) {
  write_text(comm, path, header_of(columns));
  return history(comm, path);
}

history history::resume(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns,
                        std::int64_t step) {
  on_rank_0(comm, [&] {
    const auto header = header_of(columns);
    replace_text(path, std::filesystem::exists(path) ? kept_lines(path, header, step) : header);
  });
  return history(comm, path);
}

void history::append(std::int64_t step, std::span<const double> values, const std::string& text) {
  on_rank_0(comm_, [&] {
    auto line = std::to_string(step);
    for (const double x : values) line += fmt::format(",{}", x);
    if (!text.empty()) line += fmt::format(",\"{}\"", text);
    line += '\n';
    if (std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size() || std::fflush(file_.get()) != 0)
      fail_system("write", path_);
  });
}

}  // namespace tetsuame::output
