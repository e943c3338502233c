// history.csv, summary.json, resolved.nml, run.log and the progress line.
#include <sys/resource.h>
#include <sys/stat.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <nlohmann/json.hpp>
#include <output/file.hpp>
#include <output/history.hpp>
#include <output/progress.hpp>

#include "scratch.hpp"

namespace {

using namespace test;

const std::vector<output::history_column> columns = {{"time", "s"}, {"kinetic energy", "J/m"}};

}  // namespace

BOOST_AUTO_TEST_CASE(history_after_a_restart_has_no_step_twice) {
  const auto path = fresh_directory("history") + "/history.csv";
  output::table_mark of_step_20;
  {
    auto h = output::history::start(MPI_COMM_WORLD, path, columns);
    for (const int step : {0, 10, 20, 30}) {
      h.append(step, std::array{0.1 * step, 1.0 / 3.0});
      if (step == 20) of_step_20 = h.mark();
    }
    // Flushed after each line: a reader sees it while the file is still open.
    BOOST_TEST(contents(path).ends_with("30,3,0.3333333333333333\n"));
    MPI_Barrier(MPI_COMM_WORLD);
  }
  if (rank() == 0) overwrite(path, contents(path) + "40,4,0.33");  // killed within a line
  MPI_Barrier(MPI_COMM_WORLD);
  auto h = output::history::resume(MPI_COMM_WORLD, path, columns, of_step_20);
  h.append(30, std::array{-0.0, std::nan("")});
  BOOST_TEST(contents(path) ==
             "step [1],time [s],kinetic energy [J/m]\n0,0,0.3333333333333333\n10,1,0.3333333333333333\n"
             "20,2,0.3333333333333333\n30,-0,nan\n");
  MPI_Barrier(MPI_COMM_WORLD);
  // The mark of a table that was resumed is that of one that was not.
  const auto mark = h.mark();
  if (rank() == 0) overwrite(path, contents(path) + "40,4,0.33");
  MPI_Barrier(MPI_COMM_WORLD);
  output::history::resume(MPI_COMM_WORLD, path, columns, mark);
  BOOST_TEST(contents(path).ends_with("30,-0,nan\n"));
}

BOOST_AUTO_TEST_CASE(a_history_that_is_not_what_was_written_is_refused) {
  const auto path = fresh_directory("history_damaged") + "/history.csv";
  output::table_mark mark;
  {
    auto h = output::history::start(MPI_COMM_WORLD, path, columns);
    for (const int step : {0, 10, 20}) h.append(step, std::array{0.1 * step, 1.0 / 3.0});
    mark = h.mark();
  }
  const auto whole = contents(path);
  for (const auto& damaged :
       {[](std::string text) { return text[text.size() / 2] ^= 1, text; }(whole), whole.substr(0, whole.size() - 1)}) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) overwrite(path, damaged);
    MPI_Barrier(MPI_COMM_WORLD);
    std::string message;
    BOOST_TEST(fails(exit_status::file_failed, message,
                     [&] { output::history::resume(MPI_COMM_WORLD, path, columns, mark); }));
    BOOST_TEST(message.find("history.csv") != std::string::npos, message);
    BOOST_TEST(contents(path) == damaged);
  }
  // An empty one is as good as none.
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) overwrite(path, "");
  MPI_Barrier(MPI_COMM_WORLD);
  output::history::resume(MPI_COMM_WORLD, path, columns, mark);
  BOOST_TEST(contents(path) == "step [1],time [s],kinetic energy [J/m]\n");
}

BOOST_AUTO_TEST_CASE(a_table_that_is_taken_away_is_there_again) {
  const auto directory = fresh_directory("history_taken");
  const auto path = directory + "/history.csv";
  std::vector<std::string> told;
  auto h = output::history::start(MPI_COMM_WORLD, path, columns);
  h.when_damaged([&](const std::string& text) { told.push_back(text); });
  const auto after = [&](int step, auto&& damage) {
    h.append(step, std::array{0.1 * step, 0.5});
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) damage();
    MPI_Barrier(MPI_COMM_WORLD);
  };
  after(1, [&] { fs::remove(path); });
  after(2, [&] { fs::rename(path, directory + "/mine.csv"); });
  after(3, [&] {
    fs::remove(path);
    overwrite(path, "another's\n");
  });
  h.append(4, std::array{0.4, 0.5});
  const std::string header = "step [1],time [s],kinetic energy [J/m]\n";
  BOOST_TEST(contents(path) == header + "1,0.1,0.5\n2,0.2,0.5\n3,0.30000000000000004,0.5\n4,0.4,0.5\n");
  BOOST_TEST(told.size() == (rank() == 0 ? 3U : 0U));
  for (const auto& text : told) BOOST_TEST(text.find("history.csv was taken away or replaced") != std::string::npos);
  // Cut within a line: the whole lines stay, and the mark is that of what is there.
  const auto cut = [&](std::size_t bytes) {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) fs::resize_file(path, bytes);
    MPI_Barrier(MPI_COMM_WORLD);
  };
  cut(header.size() + 12);
  auto mark = h.mark();
  BOOST_TEST(contents(path) == header + "1,0.1,0.5\n");
  if (rank() == 0) BOOST_TEST(mark.bytes == static_cast<std::int64_t>(header.size() + 10));
  cut(0);
  h.append(5, std::array{0.5, 0.5});
  BOOST_TEST(contents(path) == header + "5,0.5,0.5\n");
  if (rank() == 0) BOOST_TEST(told.back().find("lines may be lost") != std::string::npos);
  mark = h.mark();
  output::history::resume(MPI_COMM_WORLD, path, columns, mark);
  // Where its directory is gone, no line is passed over in silence.
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) fs::rename(directory, directory + "_moved");
  MPI_Barrier(MPI_COMM_WORLD);
  std::string message;
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { h.append(6, std::array{0.6, 0.5}); }));
  if (rank() == 0) fs::remove_all(directory + "_moved");
}

BOOST_AUTO_TEST_CASE(links_and_pipes_are_not_written_to) {
  const auto directory = fresh_directory("links");
  if (rank() == 0) {
    overwrite(directory + "/elsewhere", "mine");
    fs::create_symlink("elsewhere", directory + "/run.log");
    fs::create_symlink("nowhere", directory + "/resolved.nml.tmp");
    BOOST_REQUIRE(::mkfifo((directory + "/pipe").c_str(), 0600) == 0);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  std::string message;
  BOOST_TEST(
      fails(exit_status::file_failed, message, [&] { output::run_log(MPI_COMM_WORLD, directory + "/run.log"); }));
  BOOST_TEST(message.find("symbolic link") != std::string::npos, message);
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { output::run_log(MPI_COMM_WORLD, directory + "/pipe"); }));
  output::write_text(MPI_COMM_WORLD, directory + "/resolved.nml", "text");
  BOOST_TEST(contents(directory + "/elsewhere") == "mine");
  BOOST_TEST(contents(directory + "/resolved.nml") == "text");
  BOOST_TEST(!fs::exists(directory + "/nowhere"));
}

BOOST_AUTO_TEST_CASE(history_of_other_columns_is_not_continued) {
  const auto path = fresh_directory("history_other") + "/history.csv";
  output::table_mark mark = output::history::start(MPI_COMM_WORLD, path, columns).mark();
  const auto before = contents(path);
  BOOST_TEST(before == "step [1],time [s],kinetic energy [J/m]\n");
  std::string message;
  BOOST_TEST(fails(exit_status::file_failed, message, [&] {
    output::history::resume(MPI_COMM_WORLD, path, {{"time", "h"}}, mark);
  }));
  BOOST_TEST(contents(path) == before);
}

BOOST_AUTO_TEST_CASE(a_full_disk_is_told_on_every_rank) {
  std::string message;
  const std::vector<double> values = {1.0, 2.0};
  const auto directory = fresh_directory("history_full");
  auto h = output::history::start(MPI_COMM_WORLD, directory + "/history.csv", columns);
  output::write_text(MPI_COMM_WORLD, directory + "/resolved.nml", "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{fs::file_size(directory + "/history.csv") + 2, old.rlim_max};
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) setrlimit(RLIMIT_FSIZE, &tight);
  const bool history_told = fails(exit_status::file_failed, message, [&] { h.append(1, values); });
  const bool text_told = fails(exit_status::file_failed, message, [&] {
    output::write_text(MPI_COMM_WORLD, directory + "/resolved.nml", std::string(1000, 'x'));
  });
  setrlimit(RLIMIT_FSIZE, &old);
  BOOST_TEST(history_told);
  BOOST_TEST(text_told);
  BOOST_TEST(message.find("resolved.nml: File too large") != std::string::npos, message);
  BOOST_TEST(contents(directory + "/resolved.nml") == "old");
}

BOOST_AUTO_TEST_CASE(summary_is_json_whatever_happened) {
  const auto path = fresh_directory("summary") + "/summary.json";
  nlohmann::ordered_json summary;
  summary["status"] = "diverged";
  summary["errors"]["pressure_max"] = std::numeric_limits<double>::infinity();
  summary["time"] = std::nan("");
  summary["message"] = "bad byte \xff";
  output::write_summary(MPI_COMM_WORLD, path, summary);
  const auto back = nlohmann::ordered_json::parse(contents(path));
  BOOST_TEST(back["errors"]["pressure_max"].is_null());
  BOOST_TEST(back["time"].is_null());
  BOOST_TEST(back.begin().key() == "status");
  BOOST_TEST(back["message"] == "bad byte \xef\xbf\xbd");
}

BOOST_AUTO_TEST_CASE(run_log_goes_on) {
  const auto path = fresh_directory("log") + "/run.log";
  for (const auto* text : {"first", "second"}) {
    output::run_log log(MPI_COMM_WORLD, path);
    log.write(text);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  const auto text = contents(path);
  BOOST_TEST(std::count(text.begin(), text.end(), '\n') == 4);
  BOOST_TEST((text.find("s  first\n") < text.find("s  second\n") && text.ends_with("s  second\n")));
}

BOOST_AUTO_TEST_CASE(progress_counts_from_the_restart) {
  const output::progress_state begin{1000, 5000, 10.0, 0.0, 0.01, 1000000.0};
  const output::progress_state now{2000, 5000, 20.0, 0.0, 0.01, 3000000.0};
  // 1000 of 4000 steps in 60 s: 180 s left.
  BOOST_TEST(output::progress_line(now, begin, 60.0) ==
             "step 2000/5000 (40 %)  t = 20 s  dt = 0.01 s  3.3e+04 updates/s  3:00 left");
  // No step limit: by the time reached, 10 s of 30 s.
  BOOST_TEST(output::progress_line({2000, 0, 20.0, 40.0, 0.01, 0}, {1000, 0, 10.0, 40.0, 0.01, 0}, 3600.0) ==
             "step 2000 (50 %)  t = 20 s  dt = 0.01 s  0 updates/s  2:00:00 left");
  BOOST_TEST(output::progress_line(begin, begin, 0.0) == "step 1000/5000 (20 %)  t = 10 s  dt = 0.01 s");
}

BOOST_AUTO_TEST_CASE(progress_into_a_file_is_rare_and_plain) {
  const auto path = fresh_directory("progress") + "/out";
  if (rank() == 0) {
    std::FILE* out = std::fopen(path.c_str(), "w");
    output::progress bar(true, out, {});
    output::progress silent(false, out, {});
    for (std::int64_t step = 1; step <= 100000; ++step) bar.update({step, 100000, 0.0, 0.0, 0.0, 0});
    bar.finish({100000, 100000, 1.0, 0.0, 0.0, 0});
    silent.finish({});
    std::fclose(out);
    const auto text = contents(path);
    BOOST_TEST(text.starts_with("step 100000/100000 (100 %)"), text);
    BOOST_TEST(std::count(text.begin(), text.end(), '\n') == 1);
    BOOST_TEST(text.find('\r') == std::string::npos);
  }
}
