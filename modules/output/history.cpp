#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <output/history.hpp>

namespace tetsuame::output {

namespace {

std::string header_of(const std::vector<history_column>& columns) {
  std::string line = "step [1]";
  for (const auto& c : columns) line += fmt::format(",{} [{}]", c.name, c.units);
  return line + "\n";
}

// The lines up to the mark; none where there are none to keep.
std::string kept_text(const std::string& path, const table_mark& mark) {
  std::error_code missing;
  const auto here = std::filesystem::symlink_status(path, missing);
  if (!std::filesystem::exists(here)) return {};
  auto text = beginning_of(path, static_cast<std::uint64_t>(std::max<std::int64_t>(0, mark.bytes)));
  if (text.empty()) return {};
  if (static_cast<std::int64_t>(text.size()) != mark.bytes || hex(sum_of(text)) != mark.sum)
    foundation::fail_file(
        fmt::format("cannot continue {}: its first {} bytes are not those that the checkpoint knows: it is damaged, or "
                    "was edited. Move it away to start a new one",
                    path, mark.bytes));
  return text;
}

}  // namespace

void history::growing_sum::add(const std::string& text) {
  constexpr std::size_t word = sizeof(std::uint64_t);
  rest += text;
  const std::size_t whole = rest.size() / word * word;
  add_bytes(whole_words, bytes / word, rest.data(), whole);
  rest.erase(0, whole);
  bytes += text.size();
}

checksum history::growing_sum::now() const {
  checksum sum = whole_words;
  add_bytes(sum, bytes / sizeof(std::uint64_t), rest.data(), rest.size());
  return sum;
}

history::history(MPI_Comm comm, const std::string& path, const std::string& header, const std::string& contents)
    : comm_(comm), header_(header) {
  foundation::on_rank_0(comm, [&] {
    replace_text(path, contents);
    file_ = growing_file(path);
    sum_.add(contents);
  });
}

void history::mend() {
  const auto damage = file_.mend();
  if (damage.text.empty()) return;
  if (damage.lost) {
    sum_ = {};
    sum_.add(damage.kept);
    if (damage.kept.empty()) {
      file_.add(header_);
      sum_.add(header_);
    }
  }
  if (tell_) tell_(damage.text);
}

history history::start(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns) {
  const auto header = header_of(columns);
  return history(comm, path, header, header);
}

history history::resume(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns,
                        const table_mark& mark) {
  const auto header = header_of(columns);
  std::string kept;
  foundation::on_rank_0(comm, [&] {
    kept = kept_text(path, mark);
    if (kept.empty()) kept = header;
    if (!kept.starts_with(header))
      foundation::fail_file(fmt::format(
          "cannot continue {}: its columns are not those of this run. Move it away to start a new one", path));
  });
  return history(comm, path, header, kept);
}

void history::check(MPI_Comm comm, const std::string& path, const table_mark& mark) {
  foundation::on_rank_0(comm, [&] { kept_text(path, mark); });
}

void history::append(std::int64_t step, std::span<const double> values, const std::string& text) {
  foundation::on_rank_0(comm_, [&] {
    auto line = std::to_string(step);
    for (const double x : values) line += fmt::format(",{}", x);
    if (!text.empty()) line += fmt::format(",\"{}\"", text);
    line += '\n';
    mend();
    file_.add(line);
    sum_.add(line);
  });
}

table_mark history::mark() {
  foundation::on_rank_0(comm_, [&] {
    mend();
    file_.sync();
  });
  return {static_cast<std::int64_t>(sum_.bytes), hex(sum_.now())};
}

run_log::run_log(MPI_Comm comm, const std::string& path) {
  foundation::on_rank_0(comm, [&] {
    file_ = growing_file(path);
    const auto line = fmt::format("--- {:%Y-%m-%d %H:%M:%S} UTC, {} ranks\n", fmt::gmtime(std::time(nullptr)),
                                  foundation::size_of(comm));
    try {
      file_.add(line);
    } catch (const foundation::error&) {
      return;  // a full disk
    }
  });
}

void run_log::write(const std::string& text) {
  if (!file_) return;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin_;
  growing_file::damage damage;
  try {
    damage = file_.mend();
    file_.add(fmt::format("{:10.2f} s  {}\n", elapsed.count(), text));
  } catch (const foundation::error&) {
    return;
  }
  if (!damage.text.empty() && tell_) tell_(damage.text);
}

}  // namespace tetsuame::output
