// The rules for the output directory: nothing is overwritten unasked, only our own files are removed.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <output/directory.hpp>
#include <output/snapshot.hpp>

#include "scratch.hpp"

namespace {

using namespace test;
using output::directory_mode;

void open(const std::string& directory, directory_mode mode) {
  output::open_directory(MPI_COMM_WORLD, directory, mode);
  MPI_Barrier(MPI_COMM_WORLD);
}

void fill(const std::string& directory, const std::vector<std::string>& names) {
  if (rank() == 0)
    for (const auto& name : names) overwrite(directory + "/" + name, "x");
  MPI_Barrier(MPI_COMM_WORLD);
}

// Files of a run, as it begins them.
void fill_as_a_run(const std::string& directory) {
  fill(directory, {"checkpoint_00000010.h5", "history.csv", "resolved.nml", "run.log", "series.xdmf",
                   "snapshot_0002.h5.tmp", "summary.json"});
  if (rank() == 0) {
    overwrite(directory + "/history.csv", "step [1],time [s]\n");
    overwrite(directory + "/checkpoint_00000010.h5", "tetsuame checkpoint 1 \n");
  }
  MPI_Barrier(MPI_COMM_WORLD);
  output::write_snapshot(MPI_COMM_WORLD, directory + "/snapshot_0001.h5", {}, {}, {"disph_c", "1", "&run\n/\n"});
}

const std::vector<std::string> ours = {
    "checkpoint_00000010.h5", "history.csv",          "resolved.nml", "run.log", "series.xdmf",
    "snapshot_0001.h5",       "snapshot_0002.h5.tmp", "summary.json"};
// Also those that have a name as a run might give it, but that no run wrote.
const std::vector<std::string> others = {"balance.csv",       "checkpoint_2024.h5", "checkpoint_old.h5",
                                         "notes.txt",         "residuals.csv",      "snapshot_.h5",
                                         "snapshot_1.h5.bak", "snapshot_2024.h5",   "times.csv"};

}  // namespace

BOOST_AUTO_TEST_CASE(new_and_empty_directories_are_taken) {
  const auto base = fresh_directory("directory_new");
  open(base, directory_mode::fresh);
  open(base + "/a/b", directory_mode::fresh);
  open(base + "/c", directory_mode::force);
  BOOST_TEST(fs::is_directory(base + "/a/b"));
  BOOST_TEST(fs::is_empty(base + "/a/b"));
  BOOST_TEST(fs::is_directory(base + "/c"));
}

BOOST_AUTO_TEST_CASE(a_filled_directory_is_refused_untouched) {
  const auto directory = fresh_directory("directory_full");
  fill(directory, ours);
  std::string message;
  BOOST_TEST(fails(exit_status::bad_input, message, [&] { open(directory, directory_mode::fresh); }));
  BOOST_TEST(message.find("--force") != std::string::npos, message);
  BOOST_TEST((names_in(directory) == ours));
}

BOOST_AUTO_TEST_CASE(force_removes_our_files_only) {
  const auto directory = fresh_directory("directory_force");
  fill_as_a_run(directory);
  fill(directory, others);
  open(directory, directory_mode::force);
  auto left = others;
  std::sort(left.begin(), left.end());
  BOOST_TEST((names_in(directory) == left));
}

// As a second job would: another description of the open directory holds the lock.
BOOST_AUTO_TEST_CASE(a_directory_that_another_run_writes_to_is_refused_until_that_ends) {
  const auto directory = fresh_directory("directory_locked");
  fill(directory, ours);
  int other = -1;
  if (rank() == 0) {
    other = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY);
    BOOST_REQUIRE(::flock(other, LOCK_EX | LOCK_NB) == 0);
  }
  for (const auto mode : {directory_mode::force, directory_mode::restart}) {
    std::string message;
    BOOST_TEST(fails(exit_status::bad_input, message, [&] { open(directory, mode); }));
    BOOST_TEST(message.find("another run") != std::string::npos, message);
  }
  BOOST_TEST((names_in(directory) == ours));
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) ::close(other);
  BOOST_CHECK_NO_THROW(open(directory, directory_mode::restart));
  BOOST_CHECK_NO_THROW(open(directory, directory_mode::restart));  // this run's own lock is in nobody's way
}

BOOST_AUTO_TEST_CASE(restart_keeps_results_and_clears_halves) {
  const auto directory = fresh_directory("directory_restart");
  fill(directory, ours);
  open(directory, directory_mode::restart);
  auto left = ours;
  std::erase(left, "snapshot_0002.h5.tmp");
  BOOST_TEST((names_in(directory) == left));
  std::string message;
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { open(directory + "/absent", directory_mode::restart); }));
  BOOST_TEST(!fs::exists(directory + "/absent"));
}

BOOST_AUTO_TEST_CASE(what_cannot_be_a_directory) {
  const auto base = fresh_directory("directory_file");
  fill(base, {"file"});
  std::string message;
  BOOST_TEST(fails(exit_status::bad_input, message, [&] { open(base + "/file", directory_mode::force); }));
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { open(base + "/file/below", directory_mode::fresh); }));
  BOOST_TEST(message.find("Not a directory") != std::string::npos, message);
  // /proc takes no directories or files, whoever asks.
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { open("/proc/tetsuame", directory_mode::fresh); }));
  BOOST_TEST(message.find("/proc/tetsuame") != std::string::npos, message);
}
