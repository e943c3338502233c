#include <fcntl.h>

#include <exception>
#include <foundation/agree.hpp>
#include <output/shared_file.hpp>
#include <vector>

namespace tetsuame::output {

namespace {

// The message of what the work threw, or the first problem if there is one already.
template <class Work>
void guarded(std::string& problem, Work work) {
  if (!problem.empty()) return;
  try {
    work();
  } catch (const std::exception& e) {
    problem = e.what();
  }
}

}  // namespace

shared_file::shared_file(MPI_Comm comm, const std::string& path, layout& contents) : comm_(comm), path_(path) {
  const auto temporary = temporary_name(path);
  std::vector<std::uint64_t> places;
  try {
    foundation::on_rank_0(comm, [&] {
      places.push_back(create_layout(temporary, contents));
      for (const auto& d : contents.datasets) places.insert(places.end(), {d.offset, d.bytes});
    });
    places.resize(1 + 2 * contents.datasets.size());
    MPI_Bcast(places.data(), static_cast<int>(places.size()), MPI_UINT64_T, 0, comm);
    size_ = places[0];
    for (std::size_t k = 0; k < contents.datasets.size(); ++k) {
      contents.datasets[k].offset = places[1 + 2 * k];
      contents.datasets[k].bytes = places[2 + 2 * k];
    }
    guarded(problem_, [&] { file_ = descriptor(temporary, O_RDWR); });
    check();
  } catch (...) {
    if (foundation::rank_of(comm) == 0) remove_quietly(temporary);
    throw;
  }
}

shared_file::~shared_file() {
  if (!finished_ && foundation::rank_of(comm_) == 0) remove_quietly(temporary_name(path_));
}

void shared_file::write(const dataset& d, std::uint64_t first_byte, const void* data, std::size_t bytes) {
  write_raw(d.offset + first_byte, data, bytes);
}

void shared_file::write_raw(std::uint64_t offset, const void* data, std::size_t bytes) {
  guarded(problem_, [&] { write_at(file_, path_, data, bytes, offset); });
}

void shared_file::read_raw(std::uint64_t offset, void* data, std::size_t bytes) {
  guarded(problem_, [&] { read_at(file_, path_, data, bytes, offset); });
}

void shared_file::check() { foundation::agree(comm_, problem_); }

void shared_file::finish() {
  guarded(problem_, [&] { sync(file_.get(), path_); });
  check();
  foundation::on_rank_0(comm_, [&] { replace_by_temporary(path_); });
  finished_ = true;
}

}  // namespace tetsuame::output
