// Snapshots and series.xdmf, as other programs read them.
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>
#include <output/snapshot.hpp>

#include "scratch.hpp"

namespace {

using namespace test;

constexpr std::int64_t fluid_n = 500, wall_n = 31;

void write(MPI_Comm comm, const std::string& directory, int number) {
  const auto fluid = deal(comm, 0, fluid_n), wall = deal(comm, fluid_n, wall_n, 3);
  output::snapshot_header header;
  header.time = 0.5 * number;
  header.dimension = 2;
  header.box_lengths = {2.0, 1.0, 0.0};
  header.periodic = {true, false, false};
  header.kernel_support = 3.0;
  output::write_snapshot(comm, directory + "/" + output::snapshot_name(number), header,
                         {group_of(fluid, 0), group_of(wall, 1)},
                         {"disph_c", "abc123", "&domain\n  length_x = 2.0 ! \xe9\x89\x84\n/\n"});
}

int run_check(const std::string& directory, int snapshots) {
  int status = 0;
  if (rank() == 0) {
    // Not a child of mpirun: h5py's library would take this for its own start-up.
    const auto command = "env -i HDF5_USE_FILE_LOCKING=FALSE " TETSUAME_PYTHON " " TETSUAME_SOURCE_DIR
                         "/tests/output/check_snapshot.py '" +
                         directory + "' " + std::to_string(fluid_n) + " " + std::to_string(wall_n) + " " +
                         std::to_string(snapshots);
    status = std::system(command.c_str());
  }
  MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return status;
}

}  // namespace

BOOST_AUTO_TEST_CASE(other_programs_read_what_was_written) {
  const auto directory = fresh_directory("snapshot");
  output::series series;
  for (const int number : {0, 1, 2}) {
    write(MPI_COMM_WORLD, directory, number);
    output::add_to_series(MPI_COMM_WORLD, directory, output::snapshot_name(number), series);
  }
  BOOST_TEST(run_check(directory, 3) == 0);
}

BOOST_AUTO_TEST_CASE(a_series_goes_on_after_a_restart) {
  const auto directory = fresh_directory("series");
  for (const int number : {0, 1, 2, 3}) write(MPI_COMM_WORLD, directory, number);
  if (rank() == 0) overwrite(directory + "/series.xdmf", "lost");
  MPI_Barrier(MPI_COMM_WORLD);
  auto series = output::continue_series(MPI_COMM_WORLD, directory, 2);
  BOOST_TEST(series.messages.empty());
  BOOST_TEST(!fs::exists(directory + "/snapshot_0003.h5"));
  BOOST_TEST(run_check(directory, 2) == 0);
  write(MPI_COMM_WORLD, directory, 2);
  output::add_to_series(MPI_COMM_WORLD, directory, output::snapshot_name(2), series);
  BOOST_TEST(run_check(directory, 3) == 0);

  if (rank() == 0) overwrite(directory + "/snapshot_0001.h5", "no HDF5");
  MPI_Barrier(MPI_COMM_WORLD);
  series = output::continue_series(MPI_COMM_WORLD, directory, 3);
  if (rank() == 0) {
    BOOST_TEST(contents(directory + "/series.xdmf").find("snapshot_0001") == std::string::npos);
    BOOST_TEST(series.messages.size() == 1U);
  }
}

BOOST_AUTO_TEST_CASE(the_file_does_not_depend_on_the_ranks) {
  const auto directory = fresh_directory("snapshot_ranks");
  std::string first;
  for (int p = 1; p <= ranks(); ++p) {
    const MPI_Comm part = first_ranks(p);
    if (part != MPI_COMM_NULL) write(part, directory, 0);
    MPI_Barrier(MPI_COMM_WORLD);
    const auto file = contents(directory + "/snapshot_0000.h5");
    if (p == 1) first = file;
    BOOST_TEST((file == first));
    MPI_Barrier(MPI_COMM_WORLD);
  }
}

BOOST_AUTO_TEST_CASE(a_refused_write_keeps_the_old_snapshot) {
  const auto directory = fresh_directory("snapshot_full");
  write(MPI_COMM_WORLD, directory, 0);
  const auto before = contents(directory + "/snapshot_0000.h5");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit tight{4000, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tight);
  std::string message;
  const bool told = fails(exit_status::file_failed, message, [&] { write(MPI_COMM_WORLD, directory, 0); });
  setrlimit(RLIMIT_FSIZE, &old);
  BOOST_TEST(told);
  BOOST_TEST(message.find("snapshot_0000.h5") != std::string::npos, message);
  MPI_Barrier(MPI_COMM_WORLD);
  BOOST_TEST((contents(directory + "/snapshot_0000.h5") == before));
  BOOST_TEST(names_in(directory).size() == 1U);

  BOOST_TEST(fails(exit_status::file_failed, message, [&] { write(MPI_COMM_WORLD, directory + "/absent", 0); }));
  BOOST_TEST(message.find("No such file or directory") != std::string::npos, message);
}
