// Checksums that many ranks compute together: the sum, modulo 2^64 in two lanes, of one hash for each (index, 64-bit
// word), the same however an array's rows lie on the ranks.
//
//   m(x) = x, xor-shifted and multiplied by odd numbers, three times (a bijection)
//   a = sum_i m(w_i xor m(i + A)),   b = sum_i m(w_i + m(i xor B))
//
// A change confined to one word is always seen; any other accident is missed with a probability of 2^-128. It is no
// protection against intent. Constants: golden ratio; "variant 13" of D. Stafford (2011), the
// finaliser of SplitMix64 [G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014].
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetsuame::output {

constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

struct checksum {
  std::uint64_t a = 0, b = 0;

  void add_word(std::uint64_t index, std::uint64_t word) {
    a += mix(word ^ mix(index + 0x9e3779b97f4a7c15));
    b += mix(word + mix(index ^ 0xd1b54a32d192ed03));
  }
  bool operator==(const checksum&) const = default;
};

// Adds the bytes as words numbered from first_word; a last, partial word is filled with zeros.
void add_bytes(checksum& sum, std::uint64_t first_word, const void* data, std::size_t bytes);
checksum sum_of(const std::string& text);

std::string hex(const checksum& sum);  // 32 digits
// The checksum that hex() writes as this text; false on any other text.
bool parse_hex(const std::string& text, checksum& sum);

}  // namespace tetsuame::output
