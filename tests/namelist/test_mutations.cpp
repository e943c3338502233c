// The fuzz entry over changed copies of its corpus: the same ones in every run.
#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::vector<std::string> corpus() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(TETSUAME_SOURCE_DIR "/tests/namelist/corpus"))
    paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> result;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    result.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return result;
}

std::string changed(std::string text, const std::vector<std::string>& others, std::mt19937_64& bits) {
  static const std::vector<std::string> pieces{"&",
                                               "$",
                                               "/",
                                               "&end",
                                               "'",
                                               "\"",
                                               "''",
                                               ",",
                                               ",,",
                                               "=",
                                               "(",
                                               ")",
                                               ":",
                                               "%",
                                               "!",
                                               "\n",
                                               "\r",
                                               "\t",
                                               ";",
                                               "*",
                                               "2*",
                                               "1e99",
                                               "-",
                                               "+",
                                               ".",
                                               "inf",
                                               "nan",
                                               "T",
                                               "9999999999999999999*1",
                                               "(2)",
                                               "(:)",
                                               "(3:1:-1)",
                                               "\xff",
                                               std::string(1, '\0'),
                                               "1d-999999999999",
                                               " r = 1 ",
                                               "sa = 'a' "};
  const auto place = [&] { return bits() % (text.size() + 1); };
  for (std::uint64_t k = 1 + bits() % 4; k > 0; --k) {
    const std::size_t at = place();
    switch (bits() % 5) {
      case 0:
        text.insert(at, pieces[bits() % pieces.size()]);
        break;
      case 1:
        text.erase(at, bits() % 8);
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(bits());
        break;
      case 3:
        text.insert(at, text.substr(place(), bits() % 16));
        break;
      default: {
        const std::string& other = others[bits() % others.size()];
        text.insert(at, other.substr(bits() % (other.size() + 1), bits() % 32));
      }
    }
  }
  return text;
}

}  // namespace

BOOST_AUTO_TEST_CASE(changed_corpus) {
  const auto texts = corpus();
  BOOST_TEST_REQUIRE(texts.size() >= 10U);
  std::mt19937_64 bits(20240229);
  for (const std::string& text : texts) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
    for (int k = 0; k < 15000; ++k) {
      std::string other = text;
      for (std::uint64_t rounds = bits() % 3 + 1; rounds > 0; --rounds) other = changed(other, texts, bits);
      BOOST_TEST_CONTEXT("input: " << other)
      BOOST_CHECK_NO_THROW(LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(other.data()), other.size()));
    }
  }
}
