// history.csv and tables like it, and run.log: one line at a time, flushed, so that they can be watched while the run
// goes on. A table's first line names the columns with their units: time [s].
#pragma once

#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <output/file.hpp>
#include <output/hash.hpp>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::output {

struct history_column {
  std::string name, units;  // without commas and line ends; units "1" if there are none
};

// How far a table had come, kept in a checkpoint: its length, and the checksum of so many bytes.
struct table_mark {
  std::int64_t bytes = 0;
  std::string sum;  // 32 digits
};

class history {
 public:
  // Collective. A new file; one of that name is replaced. The first column, "step", is
  // added to those given. Throws fail_file on every rank.
  static history start(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns);
  // Collective; after a restart from the checkpoint that has this mark. What was written later is dropped, so that no
  // step stands twice. Where there is no file, or an empty one, a new one is begun. Throws fail_file on every rank if
  // the columns are others, or the part that is to be kept is not what was written.
  static history resume(MPI_Comm comm, const std::string& path, const std::vector<history_column>& columns,
                        const table_mark& mark);

  // Collective: that resume() would find what the mark says, or nothing. Throws fail_file on every rank.
  static void check(MPI_Comm comm, const std::string& path, const table_mark& mark);

  // Of rank 0, where somebody has taken the file away or changed it: what it has become again, as a sentence.
  void when_damaged(std::function<void(const std::string&)> tell) { tell_ = std::move(tell); }

  // Collective. Values in the columns' order, of which rank 0's are written with all
  // their digits; then the text, if there is one, in quotes (it has none itself). Throws fail_file on every rank.
  void append(std::int64_t step, std::span<const double> values, const std::string& text = {});

  // Collective. Of what was written so far, which is brought to the disk first. Meaningful on rank 0.
  table_mark mark();

 private:
  // The checksum of a text that grows.
  struct growing_sum {
    checksum whole_words;
    std::uint64_t bytes = 0;
    std::string rest;  // less than a word

    void add(const std::string& text);
    checksum now() const;
  };
  history(MPI_Comm comm, const std::string& path, const std::string& header, const std::string& contents);
  void mend();  // rank 0

  MPI_Comm comm_;
  std::string header_;
  growing_file file_;  // rank 0
  growing_sum sum_;
  std::function<void(const std::string&)> tell_;
};

// run.log: what the run said, line by line, with the seconds since it began. Rank 0 writes.
class run_log {
 public:
  // Collective; a file that is there is continued. Throws fail_file on every rank.
  run_log(MPI_Comm comm, const std::string& path);

  // Any rank may call it, rank 0's text counts. Never throws: a full disk costs the
  // lines, not the run (what matters goes to other files, which do tell).
  void write(const std::string& text);
  // As of history.
  void when_damaged(std::function<void(const std::string&)> tell) { tell_ = std::move(tell); }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  growing_file file_;
  std::function<void(const std::string&)> tell_;
};

}  // namespace tetsuame::output
