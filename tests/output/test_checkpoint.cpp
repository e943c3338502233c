// Checkpoints: bits survive any change of ranks, damage is always seen, a failed or
// killed write leaves the last good one.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <limits>
#include <map>
#include <output/checkpoint.hpp>
#include <output/directory.hpp>

#include "scratch.hpp"

namespace {

using namespace test;

constexpr std::int64_t fluid_n = 1000, wall_n = 70;

output::checkpoint_globals globals() {
  output::checkpoint_globals g;
  g.reals = {{"time", 0.1 + 0.2}, {"tiny", 5e-324}, {"minus zero", -0.0}, {"nan", std::nan("")}};
  g.integers = {{"step", std::numeric_limits<std::int64_t>::min()}};
  g.texts = {{"input", "&domain\n/ \xe9\x89\x84"}, {"empty", ""}};
  g.blobs = {{"controller", {1.0 / 3.0, -1e300}}, {"nothing", {}}};
  return g;
}

std::string write(MPI_Comm comm, const std::string& directory, std::int64_t step, std::int64_t n = fluid_n) {
  const auto fluid = deal(comm, 0, n), wall = deal(comm, n, wall_n, 3);
  std::vector<std::int64_t> kind(fluid.ids.size());
  for (std::size_t i = 0; i < kind.size(); ++i) kind[i] = -fluid.ids[i] * fluid.ids[i];
  return output::write_checkpoint(comm, directory, step, globals(),
                                  {{"fluid",
                                    fluid.ids.size(),
                                    fluid.ids.data(),
                                    {{"x", fluid.x.data()}, {"rho", fluid.rho.data()}},
                                    {{"kind", kind.data()}}},
                                   {"wall", wall.ids.size(), wall.ids.data(), {{"x", wall.x.data()}}, {}},
                                   {"none", 0, nullptr, {{"x", nullptr}}, {}}});
}

boost::test_tools::assertion_result one_rank(boost::unit_test::test_unit_id) { return ranks() == 1; }

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

void check_state(MPI_Comm comm, const output::checkpoint& c) {
  const auto expected = globals();
  for (const auto& [name, x] : expected.reals) BOOST_TEST(same_bits(c.globals.reals.at(name), x), name);
  BOOST_TEST((c.globals.reals.size() == expected.reals.size()));
  BOOST_TEST((c.globals.integers == expected.integers));
  BOOST_TEST((c.globals.texts == expected.texts));
  BOOST_TEST((c.globals.blobs == expected.blobs));

  const auto& fluid = c.tables.at("fluid");
  std::int64_t rows = static_cast<std::int64_t>(fluid.ids.size()), before = 0, total = 0;
  MPI_Exscan(&rows, &before, 1, MPI_INT64_T, MPI_SUM, comm);
  MPI_Allreduce(&rows, &total, 1, MPI_INT64_T, MPI_SUM, comm);
  if (foundation::rank_of(comm) == 0) before = 0;
  BOOST_TEST(total == fluid_n);
  bool all = fluid.reals.at("rho").size() == fluid.ids.size() && fluid.integers.at("kind").size() == fluid.ids.size();
  for (std::size_t k = 0; k < fluid.ids.size() && all; ++k) {
    const std::int64_t id = before + static_cast<std::int64_t>(k);
    all = fluid.ids[k] == id && same_bits(fluid.reals.at("x")[k], value(id, 0)) &&
          same_bits(fluid.reals.at("rho")[k], value(id, 4)) && fluid.integers.at("kind")[k] == -id * id;
  }
  BOOST_TEST(all);
  const auto& wall = c.tables.at("wall");
  for (std::size_t k = 0; k < wall.ids.size(); ++k) BOOST_TEST(same_bits(wall.reals.at("x")[k], value(wall.ids[k], 0)));
  BOOST_TEST(c.tables.at("none").ids.empty());
  BOOST_TEST(c.tables.at("none").reals.count("x") == 1U);
}

}  // namespace

BOOST_AUTO_TEST_CASE(a_value_that_is_not_there_is_an_error_of_the_file) {
  const auto g = globals();
  std::string message;
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { g.integers.at("steps"); }));
  BOOST_TEST(message.find("'steps'") != std::string::npos, message);
  BOOST_TEST(g.reals.at("time") == 0.1 + 0.2);
}

BOOST_AUTO_TEST_CASE(written_on_p_ranks_read_on_q) {
  const auto directory = fresh_directory("checkpoint_pq");
  std::string first;
  for (int p = 1; p <= ranks(); ++p) {
    const MPI_Comm writers = first_ranks(p);
    if (writers != MPI_COMM_NULL) write(writers, directory, 10);
    MPI_Barrier(MPI_COMM_WORLD);
    const auto file = contents(directory + "/checkpoint_00000010.h5");
    if (p == 1) first = file;
    BOOST_TEST((file == first), "the file depends on the number of ranks");
    for (int q = 1; q <= ranks(); ++q) {
      const MPI_Comm readers = first_ranks(q);
      if (readers == MPI_COMM_NULL) continue;
      check_state(readers, output::read_checkpoint(readers, directory + "/checkpoint_00000010.h5"));
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

BOOST_AUTO_TEST_CASE(two_newest_are_kept) {
  const auto directory = fresh_directory("checkpoint_two");
  for (const int step : {100, 200, 300}) write(MPI_COMM_WORLD, directory, step);
  const std::vector<std::string> two = {"checkpoint_00000200.h5", "checkpoint_00000300.h5"};
  BOOST_TEST((names_in(directory) == two));
  MPI_Barrier(MPI_COMM_WORLD);
  output::forget_checkpoints_after(MPI_COMM_WORLD, directory, 200);
  BOOST_TEST(names_in(directory).size() == 1U);
  MPI_Barrier(MPI_COMM_WORLD);
  // A later file belongs to a course that was given up, and does not count as one of the two.
  write(MPI_COMM_WORLD, directory, 150);
  BOOST_TEST((names_in(directory) == std::vector<std::string>{"checkpoint_00000150.h5"}));
}

// Every byte of a small file in turn on one rank, a sample on more; one bit each.
BOOST_AUTO_TEST_CASE(every_flipped_byte_is_seen) {
  const auto directory = fresh_directory("checkpoint_flip");
  const auto path = write(MPI_COMM_WORLD, directory, 1, 50);
  const auto size = fs::file_size(path);
  std::fstream file;
  if (rank() == 0) file.open(path, std::ios::in | std::ios::out | std::ios::binary);
  const auto flip = [&](std::size_t at) {
    if (rank() == 0) {
      file.seekg(static_cast<std::streamoff>(at));
      const auto bad = static_cast<char>(file.get() ^ (1 << (at % 8)));
      file.seekp(static_cast<std::streamoff>(at));
      file.put(bad).flush();
    }
    MPI_Barrier(MPI_COMM_WORLD);
  };
  std::map<std::string, int> told;
  for (std::size_t at = 0; at < size; at += ranks() == 1 ? 1 : 97) {
    flip(at);
    std::string message;
    const bool seen = fails(exit_status::file_failed, message, [&] { output::read_checkpoint(MPI_COMM_WORLD, path); });
    if (!seen) BOOST_TEST(seen, "byte " << at << " of " << size);
    ++told[message];
    MPI_Barrier(MPI_COMM_WORLD);
    flip(at);
  }
  output::read_checkpoint(MPI_COMM_WORLD, path);  // whole again
  const auto says = [&](const std::string& what) {
    return told.count("checkpoint " + path + " is damaged: " + what) == 1U;
  };
  BOOST_TEST(says("dataset /particles/fluid/rho"));
  BOOST_TEST(says("the HDF5 structure around its datasets"));
  BOOST_TEST(says("the index at its beginning"));
}

BOOST_AUTO_TEST_CASE(foreign_and_truncated_files_are_refused) {
  const auto directory = fresh_directory("checkpoint_foreign");
  const auto good = contents(write(MPI_COMM_WORLD, directory, 1));
  const auto path = directory + "/other.h5";
  const std::vector<std::string> files = {"",
                                          "&domain length_x = 1.0 /\n",
                                          std::string(100000, '\0'),
                                          good.substr(0, 300),
                                          good.substr(0, 600),
                                          good.substr(0, good.size() / 2),
                                          good.substr(0, good.size() - 1),
                                          good + "x",
                                          good.substr(0, 22) + std::string(2000, 'z')};
  for (const auto& file : files) {
    if (rank() == 0) overwrite(path, file);
    MPI_Barrier(MPI_COMM_WORLD);
    std::string message;
    BOOST_TEST(fails(exit_status::file_failed, message, [&] { output::read_checkpoint(MPI_COMM_WORLD, path); }));
    BOOST_TEST(message.find(path) != std::string::npos, message);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  std::string message;
  for (const auto& no_file : {directory + "/absent.h5", directory})
    BOOST_TEST(fails(exit_status::file_failed, message, [&] { output::read_checkpoint(MPI_COMM_WORLD, no_file); }));
}

BOOST_AUTO_TEST_CASE(the_one_before_serves_when_the_newest_is_damaged) {
  const auto directory = fresh_directory("checkpoint_latest");
  std::string message;
  BOOST_TEST(fails(exit_status::file_failed, message, [&] { output::find_latest(MPI_COMM_WORLD, directory); }));
  BOOST_TEST(message.find("there is no checkpoint in") != std::string::npos, message);
  write(MPI_COMM_WORLD, directory, 99999999);
  const auto newest = write(MPI_COMM_WORLD, directory, 100000000);  // one digit more: later by number, not by name
  BOOST_TEST(output::find_latest(MPI_COMM_WORLD, directory).path == newest);
  MPI_Barrier(MPI_COMM_WORLD);
  if (rank() == 0) fs::resize_file(newest, fs::file_size(newest) - 8);
  MPI_Barrier(MPI_COMM_WORLD);
  const auto found = output::find_latest(MPI_COMM_WORLD, directory);
  BOOST_TEST(found.path == directory + "/checkpoint_99999999.h5");
  BOOST_TEST(found.messages.size() == 1U);
  BOOST_TEST(found.messages.at(0).find(newest) != std::string::npos);
  check_state(MPI_COMM_WORLD, found.state);
}

// A file-size limit on one rank or on all stands for a full disk: the kernel refuses the
// write in the same place, with EFBIG instead of ENOSPC.
BOOST_AUTO_TEST_CASE(a_refused_write_is_told_on_every_rank_and_harms_nothing) {
  const auto directory = fresh_directory("checkpoint_full");
  const auto before = contents(write(MPI_COMM_WORLD, directory, 1));
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  for (const rlim_t limit : {0, 1000, 8000})
    for (const int limited : {0, ranks() - 1}) {
      const rlimit tight{limit, old.rlim_max};
      if (rank() == limited) setrlimit(RLIMIT_FSIZE, &tight);
      std::string message;
      const bool told = fails(exit_status::file_failed, message, [&] { write(MPI_COMM_WORLD, directory, 2); });
      setrlimit(RLIMIT_FSIZE, &old);
      // The last rank's rows may lie below the limit, or it may have none.
      BOOST_TEST((told || limited != 0));
      if (!told) continue;
      BOOST_TEST(message.find("checkpoint_00000002.h5") != std::string::npos, message);
      BOOST_TEST(message.find("File too large") != std::string::npos, message);
      MPI_Barrier(MPI_COMM_WORLD);
      BOOST_TEST((names_in(directory) == std::vector<std::string>{"checkpoint_00000001.h5"}));
      MPI_Barrier(MPI_COMM_WORLD);
    }
  BOOST_TEST((contents(directory + "/checkpoint_00000001.h5") == before));
  write(MPI_COMM_WORLD, directory, 2);
  check_state(MPI_COMM_WORLD, output::find_latest(MPI_COMM_WORLD, directory).state);
}

// What a writer killed between two writes leaves: whatever stands under the temporary
// name, it is no candidate, and the next run clears it away.
BOOST_AUTO_TEST_CASE(a_half_written_checkpoint_is_no_candidate) {
  const auto directory = fresh_directory("checkpoint_killed");
  const auto good = write(MPI_COMM_WORLD, directory, 1);
  if (rank() == 0) overwrite(directory + "/checkpoint_00000002.h5.tmp", contents(good).substr(0, 9000));
  MPI_Barrier(MPI_COMM_WORLD);
  const auto found = output::find_latest(MPI_COMM_WORLD, directory);
  BOOST_TEST(found.path == good);
  BOOST_TEST(found.messages.empty());
  write(MPI_COMM_WORLD, directory, 2);
  BOOST_TEST(output::find_latest(MPI_COMM_WORLD, directory).path == directory + "/checkpoint_00000002.h5");
}

// Killed for good, at moments spread over many writes (one process: SIGKILL to one rank
// makes mpirun end all).
BOOST_AUTO_TEST_CASE(a_writer_killed_at_any_moment_leaves_a_good_one, *boost::unit_test::precondition(one_rank)) {
  const auto directory = fresh_directory("checkpoint_sigkill");
  write(MPI_COMM_WORLD, directory, 1);
  for (int k = 0; k < 12; ++k) {
    const pid_t child = fork();
    if (child == 0)
      for (std::int64_t step = 2;; ++step) write(MPI_COMM_SELF, directory, step);
    usleep(static_cast<useconds_t>(1000 + 2300 * k));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    BOOST_TEST((WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL));
    const auto found = output::find_latest(MPI_COMM_WORLD, directory);
    BOOST_TEST(found.messages.empty());
    check_state(MPI_COMM_WORLD, found.state);
  }
}

BOOST_AUTO_TEST_CASE(an_id_that_occurs_twice_is_refused) {
  const auto directory = fresh_directory("checkpoint_twice");
  const std::int64_t ids[2] = {7, 7};
  std::string message;
  BOOST_TEST(fails(exit_status::calculation_failed, message, [&] {
    output::write_checkpoint(MPI_COMM_WORLD, directory, 1, {}, {{"fluid", rank() == 0 ? 2U : 0U, ids, {}, {}}});
  }));
  BOOST_TEST(names_in(directory).empty());
}
