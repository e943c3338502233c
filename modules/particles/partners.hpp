// Values of pairs of particles that last from step to step: the history of a contact, as the stretch of its tangential
// spring. They are kept by the partner's ID, so that they survive new neighbour lists, migration and a restart.
//
// Each particle that this rank owns has a row, in the order of the particles: its partners, ascending in ID, and for
// each as many values as a pair has. Either particle of a pair has the other in its row, with values of its own. IDs
// of partners may be those of another set of particles: one `partners` for each ordered pair of sets.
//
// An evaluation reads the values of the last commit and writes new ones; a pair that it does not write is gone once it
// is committed, and starts anew with zeros if it returns:
//
//   history.begin();
//   for each owned i, its neighbours j in contact:           // one thread writes a row, in any order
//     const auto value = history.insert(i, s.id[j]);         // as committed, or zeros; to be overwritten
//   history.commit();                                        // or discard(), or begin() again
//
// Bits do not depend on the order of insertion, nor on ranks and threads. Misuse throws std::logic_error and leaves
// everything as it was.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <foundation/threads.hpp>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tetsuame::particles {

class partners {
 public:
  // The number of values a pair has, at least one; no rows.
  explicit partners(std::size_t values_per_pair) : width_(values_per_pair) {
    if (width_ == 0) throw std::logic_error("a pair needs at least one value");
  }

  std::size_t values_per_pair() const { return width_; }
  std::size_t rows() const { return owners_.size(); }
  std::size_t pairs() const { return ids_.size(); }
  std::span<const std::int64_t> owners() const { return owners_; }  // ID of the particle of each row

  // IDs of the partners of particle i, ascending, as committed.
  std::span<const std::int64_t> row(std::size_t i) const {
    return {ids_.data() + start_[i], ids_.data() + start_[i + 1]};
  }
  // Values of the k-th of them.
  std::span<const double> values(std::size_t i, std::size_t k) const {
    return {values_.data() + (start_[i] + k) * width_, width_};
  }
  // The committed values of the pair; empty where there are none.
  std::span<const double> find(std::size_t i, std::int64_t partner) const {
    const auto of_i = row(i);
    const auto at = std::lower_bound(of_i.begin(), of_i.end(), partner);
    if (at == of_i.end() || *at != partner) return {};
    return values(i, static_cast<std::size_t>(at - of_i.begin()));
  }

  // ---- an evaluation ----

  // Forgets what was inserted since the last commit.
  void begin() {
    inserted_.resize(rows());
    foundation::for_all(rows(), [&](std::size_t i) { inserted_[i].clear(); });
    open_ = true;
  }
  // Values of the pair for the next commit: those it has, or zeros. They stay where they are until the next insertion
  // in the row. A partner twice in a row is an error of commit().
  std::span<double> insert(std::size_t i, std::int64_t partner) {
    if (!open_) throw std::logic_error("values of pairs are inserted between begin() and commit()");
    if (i >= rows())
      throw std::logic_error("particle " + std::to_string(i) + " has no row of partners: there are " +
                             std::to_string(rows()));
    auto& r = inserted_[i];
    r.ids.push_back(partner);
    const auto before = find(i, partner);
    if (before.empty())
      r.values.resize(r.values.size() + width_, 0.0);
    else
      r.values.insert(r.values.end(), before.begin(), before.end());
    return std::span<double>(r.values).last(width_);
  }
  // Whether something may have been inserted that is neither committed nor discarded.
  bool is_open() const { return open_; }
  void discard() { open_ = false; }

  // Replaces all values by those inserted.
  void commit() {
    if (!open_) throw std::logic_error("commit() of values of pairs without begin()");
    std::vector<std::size_t> start(rows() + 1, 0);
    for (std::size_t i = 0; i < rows(); ++i) start[i + 1] = start[i] + inserted_[i].ids.size();
    std::vector<std::int64_t> ids(start.back());
    std::vector<double> values(start.back() * width_);
    std::size_t with_duplicate = rows();
#pragma omp parallel reduction(min : with_duplicate) if (rows() > foundation::values_worth_threads)
    {
      std::vector<std::size_t> order;
#pragma omp for schedule(static)
      for (std::size_t i = 0; i < rows(); ++i) {
        const auto& r = inserted_[i];
        order.resize(r.ids.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return r.ids[a] < r.ids[b]; });
        for (std::size_t k = 0; k < order.size(); ++k) {
          const std::size_t to = start[i] + k;
          ids[to] = r.ids[order[k]];
          std::copy_n(r.values.data() + order[k] * width_, width_, values.data() + to * width_);
          if (k > 0 && ids[to] == ids[to - 1]) with_duplicate = std::min(with_duplicate, i);
        }
      }
    }
    if (with_duplicate < rows()) {
      const auto first = ids.begin() + static_cast<std::ptrdiff_t>(start[with_duplicate]);
      fail_duplicate(owners_[with_duplicate], *std::adjacent_find(first, ids.end()));
    }
    start_ = std::move(start);
    ids_ = std::move(ids);
    values_ = std::move(values);
    open_ = false;
  }

  // ---- rows follow the particles ----

  // One row for each of these particles, without partners. An ID occurs once.
  void reset(std::span<const std::int64_t> owners) {
    sorted_by_id(owners);
    owners_.assign(owners.begin(), owners.end());
    start_.assign(rows() + 1, 0);
    ids_.clear();
    values_.clear();
    open_ = false;
  }
  // As particles::reorder does with the particles: the new k-th row is the old order[k]. Rows that `order` does not
  // name are gone.
  void reorder(std::span<const std::uint32_t> order) {
    refuse_open("reordered");
    std::vector<char> taken(rows(), 0);
    for (const std::uint32_t i : order) {
      if (i >= rows())
        throw std::logic_error("an order of rows of partners names row " + std::to_string(i) + " of " +
                               std::to_string(rows()));
      if (std::exchange(taken[i], 1) != 0)
        throw std::logic_error("an order of rows of partners names that of particle " + std::to_string(owners_[i]) +
                               " twice");
    }
    std::vector<std::int64_t> owners(order.size());
    std::vector<std::size_t> start(order.size() + 1, 0);
    for (std::size_t k = 0; k < order.size(); ++k) {
      owners[k] = owners_[order[k]];
      start[k + 1] = start[k] + row(order[k]).size();
    }
    std::vector<std::int64_t> ids(start.back());
    std::vector<double> values(start.back() * width_);
    foundation::for_all(order.size(), [&](std::size_t k) {
      const std::size_t from = start_[order[k]], n = start[k + 1] - start[k];
      std::copy_n(ids_.data() + from, n, ids.data() + start[k]);
      std::copy_n(values_.data() + from * width_, n * width_, values.data() + start[k] * width_);
    });
    owners_ = std::move(owners);
    start_ = std::move(start);
    ids_ = std::move(ids);
    values_ = std::move(values);
  }
  // The same by ID: row k becomes that of the particle of the k-th ID. The IDs are those of the rows, each once.
  void arrange(std::span<const std::int64_t> owners) {
    const auto wanted = sorted_by_id(owners), have = sorted_by_id(owners_);
    std::vector<std::uint32_t> order(owners.size());
    std::size_t h = 0;
    for (const std::uint32_t w : wanted) {
      if (h < have.size() && owners_[have[h]] < owners[w]) break;
      if (h == have.size() || owners_[have[h]] != owners[w])
        throw std::logic_error("particle " + std::to_string(owners[w]) + " has no row of partners here");
      order[w] = have[h++];
    }
    if (h < have.size())
      throw std::logic_error("particle " + std::to_string(owners_[have[h]]) +
                             " has a row of partners here, but is not among the particles");
    reorder(order);
  }
  // Throws where the rows are not those of these particles, in their order, or amid an evaluation.
  void require_rows_of(std::span<const std::int64_t> particle_ids) const {
    refuse_open("handed on");
    if (rows() != particle_ids.size())
      throw std::logic_error("there are " + std::to_string(rows()) + " rows of partners for " +
                             std::to_string(particle_ids.size()) + " particles");
    for (std::size_t i = 0; i < rows(); ++i)
      if (owners_[i] != particle_ids[i])
        throw std::logic_error("row " + std::to_string(i) + " of the partners is of particle " +
                               std::to_string(owners_[i]) + ", and the particle there is " +
                               std::to_string(particle_ids[i]) + ": rows were not reordered with the particles");
  }

  // A row as numbers that travel with the particle, behind what `out` has: the number of its partners, then the ID's
  // bits and the values of each.
  void pack(std::size_t i, std::vector<double>& out) const {
    const auto of_i = row(i);
    out.push_back(static_cast<double>(of_i.size()));
    for (std::size_t k = 0; k < of_i.size(); ++k) {
      out.push_back(std::bit_cast<double>(of_i[k]));
      const auto v = values(i, k);
      out.insert(out.end(), v.begin(), v.end());
    }
  }
  // A row for one more particle, behind the others, from what pack() wrote; returns the end of that.
  const double* append(std::int64_t owner, const double* packed) {
    refuse_open("given new rows");
    const auto n = static_cast<std::size_t>(*packed++);
    for (std::size_t k = 0; k < n; ++k, packed += width_) {
      ids_.push_back(std::bit_cast<std::int64_t>(*packed++));
      values_.insert(values_.end(), packed, packed + width_);
    }
    owners_.push_back(owner);
    start_.push_back(ids_.size());
    return packed;
  }
  // One without partners.
  void append(std::int64_t owner) {
    constexpr double none = 0.0;
    append(owner, &none);
  }

 private:
  // What an evaluation has inserted in a row, in its order.
  struct insertions {
    std::vector<std::int64_t> ids;
    std::vector<double> values;
    void clear() {
      ids.clear();
      values.clear();
    }
  };

  [[noreturn]] static void fail_duplicate(std::int64_t owner, std::int64_t partner) {
    throw std::logic_error("particle " + std::to_string(owner) + " has partner " + std::to_string(partner) + " twice");
  }
  void refuse_open(const char* what) const {
    if (open_)
      throw std::logic_error(std::string("partners are ") + what +
                             " amid an evaluation: commit or discard what was inserted first");
  }
  // Indices in ascending order of ID.
  static std::vector<std::uint32_t> sorted_by_id(std::span<const std::int64_t> all) {
    std::vector<std::uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return all[a] < all[b]; });
    for (std::size_t k = 1; k < order.size(); ++k)
      if (all[order[k]] == all[order[k - 1]])
        throw std::logic_error("particle " + std::to_string(all[order[k]]) + " is there twice");
    return order;
  }

  std::size_t width_;
  std::vector<std::int64_t> owners_;   // of each row
  std::vector<std::size_t> start_{0};  // of each row, into `ids_`; one more at the end
  std::vector<std::int64_t> ids_;      // of partners
  std::vector<double> values_;         // width_ a pair
  std::vector<insertions> inserted_;   // of each row, while open_
  bool open_ = false;
};

// Pairs as columns of plain arrays, a row a pair and owner, as checkpoints have them (output::table_view).
struct pair_table {
  std::vector<std::int64_t> ids;             // of the rows, each once over all ranks
  std::vector<std::int64_t> owner, partner;  // IDs of particles
  std::vector<std::vector<double>> values;   // of each component, a row's
};

// The committed pairs of this rank. The row of an owner's k-th partner has the ID owner * most + k, where `most` is no
// less than any particle's number of partners on any rank: rows ascend in owner and partner, and their IDs depend on
// neither ranks nor threads. Throws std::overflow_error where 64 bits do not suffice.
inline pair_table table_of(const partners& all, std::int64_t most) {
  pair_table t;
  t.values.resize(all.values_per_pair());
  for (std::size_t i = 0; i < all.rows(); ++i) {
    const auto of_i = all.row(i);
    std::int64_t first = 0, last = 0;
    if (__builtin_mul_overflow(all.owners()[i], most, &first) || __builtin_add_overflow(first, most, &last))
      throw std::overflow_error("the pairs of particle " + std::to_string(all.owners()[i]) +
                                " cannot be numbered with 64 bits");
    for (std::size_t k = 0; k < of_i.size(); ++k) {
      t.ids.push_back(first + static_cast<std::int64_t>(k));
      t.owner.push_back(all.owners()[i]);
      t.partner.push_back(of_i[k]);
      const auto v = all.values(i, k);
      for (std::size_t c = 0; c < v.size(); ++c) t.values[c].push_back(v[c]);
    }
  }
  return t;
}

}  // namespace tetsuame::particles
