#include <fmt/core.h>

#include <algorithm>
#include <foundation/agree.hpp>
#include <foundation/error.hpp>
#include <limits>
#include <numeric>
#include <output/order.hpp>

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

}  // namespace tetsuame::output
