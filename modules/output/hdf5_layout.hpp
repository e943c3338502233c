// The skeleton of an HDF5 file, made by one rank: groups, attributes and datasets
// without their values, each dataset one contiguous block at a known place in the file.
//
// All ranks then write their rows to these places by plain pwrite (shared_file.hpp); who wants them compressed has the
// whole file made anew by one rank: in parallel HDF5 a write that fails on one rank (disk full, quota) can leave the
// others waiting for ever, and the file cannot be reserved on the disk beforehand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tetsuame::output {

using attribute_value = std::variant<double, std::int64_t, std::string, std::vector<double>, std::vector<std::int32_t>,
                                     std::vector<std::uint32_t>, std::vector<std::uint64_t>>;
using attributes = std::vector<std::pair<std::string, attribute_value>>;

// double, float, int64, int32, a fixed-length string of bytes
enum class element { real, single, integer, index, text };

struct dataset {
  std::string path;
  element type = element::real;
  std::vector<std::uint64_t> shape;  // rows, then columns if any; of a text: its bytes; empty: one value
  output::attributes attributes;

  std::uint64_t offset = 0, bytes = 0;  // of the values in the file: set by create_layout
};

std::uint64_t bytes_of(const dataset& d);

struct layout {
  std::uint64_t user_block = 0;  // bytes before HDF5's own: 0 or a power of 2, at least 512
  std::vector<std::pair<std::string, attributes>> groups;
  std::vector<dataset> datasets;
};

// On this rank alone. Replaces the file at path and fills in offsets and bytes; returns
// the size of the file. HDF5 prints nothing: its reason becomes part of the message.
// Throws fail_file.
std::uint64_t create_layout(const std::string& path, layout& contents);

// On this rank alone. Makes the file at path, which create_layout laid out and which holds its values, anew with its
// numbers compressed (deflate behind a shuffle of bytes, which every HDF5 library reads). Throws fail_file; the file is
// then as it was.
void compress(const std::string& path, const layout& contents);

}  // namespace tetsuame::output
