#include <fcntl.h>
#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <limits>
#include <numeric>
#include <output/shared_file.hpp>

namespace tetsuame::output {

namespace {

std::vector<int> offsets_of(const std::vector<int>& counts) {
  std::vector<int> offsets(counts.size());
  std::exclusive_scan(counts.begin(), counts.end(), offsets.begin(), 0);
  return offsets;
}

template <class T>
std::vector<T> exchange(const id_order& order, const T* values, MPI_Datatype type) {
  std::vector<T> send(order.send_from.size());
  for (std::size_t k = 0; k < send.size(); ++k) send[k] = values[order.send_from[k]];
  std::vector<T> received(static_cast<std::size_t>(order.receive_offsets.back() + order.receive_counts.back()));
  MPI_Alltoallv(send.data(), order.send_counts.data(), order.send_offsets.data(), type, received.data(),
                order.receive_counts.data(), order.receive_offsets.data(), type, order.comm);
  return received;
}

template <class T>
std::vector<T> take_rows(const id_order& order, const std::vector<T>& received) {
  std::vector<T> slab(order.take.size());
  for (std::size_t k = 0; k < slab.size(); ++k) slab[k] = received[order.take[k]];
  return slab;
}

// The rank that each local particle goes to.
std::vector<int> owners(MPI_Comm comm, std::size_t n, const std::int64_t* ids) {
  // The complement of the largest, so that one reduction finds both ends.
  std::int64_t ends[2] = {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};
  for (std::size_t i = 0; i < n; ++i) {
    ends[0] = std::min(ends[0], ids[i]);
    ends[1] = std::min(ends[1], ~ids[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_INT64_T, MPI_MIN, comm);
  const auto low = static_cast<std::uint64_t>(ends[0]), high = static_cast<std::uint64_t>(~ends[1]);
  const std::uint64_t width = (high - low) / static_cast<std::uint64_t>(foundation::size_of(comm)) + 1;
  std::vector<int> owner(n, 0);
  if (width == 0) return owner;  // one rank, IDs over the whole range of 64 bits
  for (std::size_t i = 0; i < n; ++i) owner[i] = static_cast<int>((static_cast<std::uint64_t>(ids[i]) - low) / width);
  return owner;
}

void refuse_duplicates(const id_order& order) {
  // Equal IDs have one owner, so looking within the slab is enough.
  const auto twice = std::adjacent_find(order.ids.begin(), order.ids.end());
  foundation::agree(
      order.comm,
      twice == order.ids.end() ? "" : fmt::format("particle ID {} occurs twice: the state cannot be written", *twice),
      foundation::exit_status::calculation_failed);
}

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

id_order order_by_id(MPI_Comm comm, std::size_t n, const std::int64_t* ids) {
  const auto ranks = static_cast<std::size_t>(foundation::size_of(comm));
  id_order order;
  order.comm = comm;

  const auto owner = owners(comm, n, ids);
  order.send_from.resize(n);
  std::iota(order.send_from.begin(), order.send_from.end(), std::size_t{0});
  std::stable_sort(order.send_from.begin(), order.send_from.end(),
                   [&](std::size_t i, std::size_t j) { return owner[i] < owner[j]; });
  order.send_counts.assign(ranks, 0);
  for (const int o : owner) ++order.send_counts[static_cast<std::size_t>(o)];
  order.receive_counts.resize(ranks);
  MPI_Alltoall(order.send_counts.data(), 1, MPI_INT, order.receive_counts.data(), 1, MPI_INT, comm);
  order.send_offsets = offsets_of(order.send_counts);
  order.receive_offsets = offsets_of(order.receive_counts);

  const auto received = exchange(order, ids, MPI_INT64_T);
  order.take.resize(received.size());
  std::iota(order.take.begin(), order.take.end(), std::size_t{0});
  std::sort(order.take.begin(), order.take.end(),
            [&](std::size_t i, std::size_t j) { return received[i] < received[j]; });
  order.ids = take_rows(order, received);

  const std::uint64_t rows = order.take.size();
  MPI_Exscan(&rows, &order.first_row, 1, MPI_UINT64_T, MPI_SUM, comm);
  if (foundation::rank_of(comm) == 0) order.first_row = 0;  // Exscan leaves it undefined there
  MPI_Allreduce(&rows, &order.total_rows, 1, MPI_UINT64_T, MPI_SUM, comm);
  refuse_duplicates(order);
  return order;
}

std::vector<double> arrange(const id_order& order, const double* values) {
  return take_rows(order, exchange(order, values, MPI_DOUBLE));
}

std::vector<std::int64_t> arrange(const id_order& order, const std::int64_t* values) {
  return take_rows(order, exchange(order, values, MPI_INT64_T));
}

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
