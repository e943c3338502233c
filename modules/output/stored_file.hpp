// An existing HDF5 file, of this program or another, as one rank reads it: what it holds, and numbers of it.
//
// It is read by itself: a link into another file is not followed, and a dataset whose values lie in other files is not
// read, as those may be anything, a pipe that never ends too. HDF5 prints nothing: its reason becomes part of the
// message.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tetsuame::output {

struct stored_dataset {
  enum class content { reals, integers, other, elsewhere };  // elsewhere: a link out of the file, or to nowhere

  std::string name;
  content holds = content::other;
  std::size_t bytes_per_value = 8;
  std::vector<std::uint64_t> shape;  // empty: one value

  bool is_of_numbers() const { return holds == content::reals || holds == content::integers; }
};

// Neither numbers nor a text: it is of another type, or of more numbers than any attribute of a snapshot.
struct stored_attribute {
  std::vector<double> numbers;
  std::optional<std::string> text;
};

class stored_file {
 public:
  // Opens a plain file. Throws fail_file, as all that follows does where HDF5 fails, with its reason.
  explicit stored_file(const std::string& path);
  ~stored_file();
  stored_file(const stored_file&) = delete;
  stored_file& operator=(const stored_file&) = delete;

  const std::string& path() const { return path_; }
  bool has_group(const std::string& name) const;
  // Those right in the group, by name; "/" is the root. Empty if there is no such group.
  std::vector<stored_dataset> datasets(const std::string& group) const;
  // None where there is no such object or attribute.
  std::optional<stored_attribute> attribute(const std::string& object, const std::string& name) const;
  // One number, which must be there.
  double number(const std::string& object, const std::string& name) const;

  // A dataset of numbers, by rows.
  std::vector<double> reals(const std::string& dataset) const;
  // A dataset of integers, by rows; its signed ones as two's complement.
  struct integers {
    std::vector<std::uint64_t> values;
    bool are_signed = false;
  };
  integers whole_numbers(const std::string& dataset) const;

 private:
  struct opened;
  std::string path_;
  std::unique_ptr<opened> file_;
};

}  // namespace tetsuame::output
