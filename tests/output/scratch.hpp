// What the output tests share: main with MPI, a fresh directory, particles spread over ranks.
#pragma once

#include <mpi.h>

#include <array>
#include <boost/test/unit_test.hpp>
#include <cstdint>
#include <filesystem>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <fstream>
#include <iterator>
#include <output/groups.hpp>
#include <string>
#include <vector>

namespace test {

namespace foundation = tetsuame::foundation;
namespace output = tetsuame::output;
namespace fs = std::filesystem;
using tetsuame::foundation::exit_status;

inline int rank() { return foundation::rank_of(MPI_COMM_WORLD); }
inline int ranks() { return foundation::size_of(MPI_COMM_WORLD); }

// An empty directory that all ranks share and no other test uses.
inline std::string fresh_directory(const std::string& name) {
  const auto path = fs::path(TETSUAME_BINARY_DIR) / "tests" / "output_scratch" / (name + "." + std::to_string(ranks()));
  if (rank() == 0) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return path.string();
}

inline std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void overwrite(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc).write(text.data(), static_cast<std::streamsize>(text.size()));
}

inline std::vector<std::string> names_in(const std::string& directory) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

// Collective: does it throw foundation::error with this status, on this rank too? The message is kept.
template <class Work>
bool fails(exit_status status, std::string& message, Work work) {
  try {
    work();
  } catch (const tetsuame::foundation::error& e) {
    message = e.what();
    return e.status() == status;
  }
  return false;
}

// A communicator of the first n ranks; MPI_COMM_NULL on the others.
inline MPI_Comm first_ranks(int n) {
  MPI_Comm part = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, rank() < n ? 0 : MPI_UNDEFINED, rank(), &part);
  return part;
}

// Values that depend on the ID alone, so that any distribution must give the same files.
inline double value(std::int64_t id, int field) {
  return (static_cast<double>(id) + 0.1) / 3.0 * (field + 1) * (id % 2 == 0 ? 1e-12 : -1e12);
}

struct particles {
  std::vector<std::int64_t> ids;
  std::vector<double> x, y, u, v, rho;
};

// IDs first … first + n - 1, dealt out in disorder; the last of several ranks gets none.
inline particles deal(MPI_Comm comm, std::int64_t first, std::int64_t n, std::int64_t stride = 7) {
  const int me = foundation::rank_of(comm), all = foundation::size_of(comm), holders = all > 1 ? all - 1 : 1;
  particles p;
  for (std::int64_t k = 0; k < n; ++k) {
    const std::int64_t id = first + (k * stride) % n;
    if ((k / 3) % holders != me) continue;
    p.ids.push_back(id);
    p.x.push_back(value(id, 0));
    p.y.push_back(value(id, 1));
    p.u.push_back(value(id, 2));
    p.v.push_back(value(id, 3));
    p.rho.push_back(value(id, 4));
  }
  return p;
}

inline output::particle_group group_of(const particles& p, int type) {
  return {type,
          p.ids.size(),
          p.ids.data(),
          {{"Coordinates", "m", "position", {p.x.data(), p.y.data()}, true},
           {"Velocities", "m/s", "velocity", {p.u.data(), p.v.data()}, true},
           {"Density", "kg/m^3", "density", {p.rho.data()}, false}}};
}

}  // namespace test

inline bool init_unit_test() { return true; }

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int failed = boost::unit_test::unit_test_main(&init_unit_test, argc, argv);
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return failed;
}
