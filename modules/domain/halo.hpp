// Ghosts of one block of particles (fluid or walls): which particles go to which ranks, and the traffic that
// refreshes their values, one message a neighbour however many fields. Between begin_exchange and
// end_exchange a rank may compute what needs no ghost.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <domain/communicator.hpp>
#include <foundation/error.hpp>
#include <foundation/threads.hpp>
#include <foundation/waiting.hpp>
#include <particles/particles.hpp>
#include <span>
#include <stdexcept>
#include <vector>

namespace tetsuame::domain {

template <int D>
struct halo {
  // What one rank sends to, or receives from, another (or itself, over a periodic border).
  struct index_range {
    int rank = 0;
    std::size_t begin = 0, count = 0;  // of `sources`, or of the ghosts
  };
  static constexpr std::size_t shifts = D == 1 ? 3 : D == 2 ? 9 : 27;

  std::vector<std::uint32_t> sources;                    // local indices sent
  std::vector<std::uint8_t> shift;                       // of each source, into `shift_by`
  std::array<std::array<double, D>, shifts> shift_by{};  // m, added to the coordinates of what is sent
  std::vector<index_range> to, from;                     // by rank
  std::size_t ghosts_begin = 0, ghosts = 0;              // local indices received
  int tag = 0;

  // Traffic under way. Buffers keep their size from one exchange to the next.
  struct field {
    double* values = nullptr;
    int shifted_along = -1;  // axis of a coordinate; -1: no coordinate
  };
  mutable std::vector<field> fields;
  mutable std::vector<double> out, in;
  mutable std::vector<MPI_Request> requests;
  mutable bool under_way = false;
};

// Starts to refresh the ghosts' values of the arrays, which may not change before end_exchange, and
// of the positions where these are given. One exchange of a halo at a time.
template <int D>
void begin_exchange(const communicator& ranks, const halo<D>& h, std::span<double* const> fields,
                    std::array<particles::array, D>* positions = nullptr) {
  if (h.under_way) throw std::logic_error("an exchange of this halo is under way already");
  h.under_way = true;
  h.fields.clear();
  if (positions != nullptr)
    for (std::size_t a = 0; a < D; ++a) h.fields.push_back({(*positions)[a].data(), static_cast<int>(a)});
  for (double* f : fields) h.fields.push_back({f, -1});
  const std::size_t n = h.fields.size();
  h.requests.clear();
  // A rank's own images need no buffer.
  const auto room = [&](std::vector<double>& buffer, const auto& parts) {
    std::size_t end = 0;
    for (const auto& s : parts)
      if (s.rank != ranks.rank) end = (s.begin + s.count) * n;
    if (buffer.size() < end) buffer.resize(end);
  };
  room(h.out, h.to);
  room(h.in, h.from);
  std::size_t own = 0;  // where among the ghosts the images of this rank's own particles begin
  for (const auto& s : h.from) {
    if (s.rank == ranks.rank) {
      own = s.begin;
      continue;
    }
    h.requests.emplace_back();
    MPI_Irecv(h.in.data() + s.begin * n, static_cast<int>(s.count * n), MPI_DOUBLE, s.rank, h.tag, ranks.comm,
              &h.requests.back());
  }
#pragma omp parallel if (h.sources.size() * n > foundation::values_worth_threads)
  for (const auto& s : h.to)
    for (std::size_t f = 0; f < n; ++f) {
      double* packed =
          s.rank == ranks.rank ? h.fields[f].values + h.ghosts_begin + own : h.out.data() + s.begin * n + f * s.count;
#pragma omp for schedule(static) nowait
      for (std::size_t k = 0; k < s.count; ++k) {
        const std::size_t source = s.begin + k;
        const double value = h.fields[f].values[h.sources[source]];
        const int axis = h.fields[f].shifted_along;
        packed[k] = axis < 0 ? value : value + h.shift_by[h.shift[source]][static_cast<std::size_t>(axis)];
      }
    }
  for (const auto& s : h.to) {
    if (s.rank == ranks.rank) continue;
    h.requests.emplace_back();
    MPI_Isend(h.out.data() + s.begin * n, static_cast<int>(s.count * n), MPI_DOUBLE, s.rank, h.tag, ranks.comm,
              &h.requests.back());
    ++foundation::sent.halo_messages;
    foundation::sent.halo_bytes += static_cast<std::int64_t>(s.count * n * sizeof(double));
  }
}

// From here on the ghosts hold what was sent.
template <int D>
void end_exchange(const communicator& ranks, const halo<D>& h) {
  if (!h.requests.empty()) {
    const foundation::waiting timed;
    MPI_Waitall(static_cast<int>(h.requests.size()), h.requests.data(), MPI_STATUSES_IGNORE);
  }
  const std::size_t n = h.fields.size();
#pragma omp parallel if (h.ghosts * n > foundation::values_worth_threads)
  for (const auto& s : h.from) {
    if (s.rank == ranks.rank) continue;
    for (std::size_t f = 0; f < n; ++f) {
      const double* packed = h.in.data() + s.begin * n + f * s.count;
      double* ghosts = h.fields[f].values + h.ghosts_begin + s.begin;
#pragma omp for schedule(static) nowait
      for (std::size_t k = 0; k < s.count; ++k) ghosts[k] = packed[k];
    }
  }
  h.under_way = false;
}

template <int D>
void exchange(const communicator& ranks, const halo<D>& h, std::span<double* const> fields,
              std::array<particles::array, D>* positions = nullptr) {
  begin_exchange<D>(ranks, h, fields, positions);
  end_exchange(ranks, h);
}

}  // namespace tetsuame::domain
