// Every case is read by gfortran (oracle.f90) and by our reader; what both accept must
// have the same values, bit for bit, and both must accept the same. In cases/*.txt a
// case that is treated otherwise says so at the end of its line:
//   <stricter: reason>  gfortran accepts it, we refuse it
//   <wider: reason>     we accept what gfortran refuses
//   <standard: reason>  both accept it and the values differ, ours being the standard's
#include <fmt/format.h>

#include <boost/test/unit_test.hpp>
#include <cstdlib>
#include <filesystem>
#include <foundation/error.hpp>
#include <fstream>
#include <sstream>

#include "generate.hpp"
#include "sample.hpp"

using namespace tetsuame;

namespace {

struct outcome {
  bool accepted = false;
  std::string message, values;
};

struct test_case {
  std::string name, text, relation;
};

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  BOOST_REQUIRE_MESSAGE(file, path.string() + " cannot be opened");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string unescaped(const std::string& line) {
  std::string result;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] != '\\') {
      result += line[k];
      continue;
    }
    switch (line[++k]) {
      case 'n':
        result += '\n';
        break;
      case 't':
        result += '\t';
        break;
      case 'r':
        result += '\r';
        break;
      case '\\':
        result += '\\';
        break;
      case 'x':
        result += static_cast<char>(std::stoi(line.substr(k + 1, 2), nullptr, 16));
        k += 2;
        break;
      default:
        BOOST_FAIL("unknown escape in " + line);
    }
  }
  return result;
}

std::vector<test_case> written_cases() {
  std::vector<test_case> result;
  const std::filesystem::path folder = TETSUAME_SOURCE_DIR "/tests/namelist/cases";
  for (const char* file : {"group", "integer", "list", "logical", "real", "subscript", "text"}) {
    std::istringstream lines(contents(folder / fmt::format("{}.txt", file)));
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
      if (line.starts_with('#')) continue;
      test_case c{fmt::format("{}_{:03}", file, number), line, ""};
      if (const auto mark = line.rfind("   <"); mark != std::string::npos) {
        c.text = line.substr(0, mark);
        c.relation = line.substr(mark + 4, line.find(':', mark) - mark - 4);
      }
      c.text = c.text.starts_with('@') ? unescaped(c.text.substr(1)) : "&sample " + unescaped(c.text) + " /\n";
      result.push_back(std::move(c));
    }
  }
  return result;
}

// Writes the cases into a folder, has the oracle read them all, and takes its answers apart.
std::vector<outcome> ask_oracle(const std::vector<test_case>& cases, const std::string& folder_name) {
  const std::filesystem::path folder = std::filesystem::path(TETSUAME_BINARY_DIR) / "tests" / folder_name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ofstream list(folder / "list");
  for (const test_case& c : cases) {
    const auto path = folder / (c.name + ".nml");
    std::ofstream(path, std::ios::binary) << c.text;
    list << path.string() << '\n';
  }
  list.close();
  const std::string command =
      fmt::format("'{0}/tests/namelist_oracle' < '{1}/list' > '{1}/answers'", TETSUAME_BINARY_DIR, folder.string());
  BOOST_REQUIRE_EQUAL(std::system(command.c_str()), 0);
  std::vector<outcome> result;
  std::istringstream answers(contents(folder / "answers"));
  std::string line;
  while (std::getline(answers, line)) {
    if (line.starts_with("file ")) {
      result.emplace_back();
    } else if (line.starts_with("status ")) {
      result.back().accepted = line.starts_with("status 0 ");
      result.back().message = line;
    } else if (!result.empty() && (line.starts_with("reals") || line.starts_with("integers") ||
                                   line.starts_with("logicals") || line.starts_with("string "))) {
      result.back().values += line + '\n';  // else: what gfortran prints at a ?
    }
  }
  BOOST_REQUIRE_EQUAL(result.size(), cases.size());
  return result;
}

outcome ask_ours(const test_case& c) {
  sample values;
  outcome result;
  try {
    schema_of(values).read(namelist::parse_text(c.text, c.name));
    result.accepted = true;
  } catch (const foundation::error& e) {
    BOOST_TEST((e.status() == foundation::exit_status::bad_input));
    result.message = e.what();
  }
  result.values = printed(values);
  return result;
}

std::string shown(const test_case& c, const outcome& fortran, const outcome& ours) {
  return fmt::format("{}\n{}\ngfortran: {}\n{}ours: {}\n{}", c.name, c.text, fortran.message, fortran.values,
                     ours.message, ours.values);
}

}  // namespace

BOOST_AUTO_TEST_CASE(written_cases_agree_with_gfortran) {
  const auto cases = written_cases();
  BOOST_TEST_REQUIRE(cases.size() > 400U);
  const auto answers = ask_oracle(cases, "namelist_cases");
  std::size_t same = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const test_case& c = cases[k];
    const outcome ours = ask_ours(c);
    const std::string detail = shown(c, answers[k], ours);
    if (c.relation == "stricter") {
      BOOST_TEST((answers[k].accepted && !ours.accepted), detail);
    } else if (c.relation == "wider") {
      BOOST_TEST((!answers[k].accepted && ours.accepted), detail);
    } else if (c.relation == "standard") {
      BOOST_TEST((answers[k].accepted && ours.accepted && answers[k].values != ours.values), detail);
    } else {
      BOOST_TEST_REQUIRE(c.relation.empty(), detail);
      BOOST_TEST(answers[k].accepted == ours.accepted, detail);
      if (ours.accepted) BOOST_TEST(answers[k].values == ours.values, detail);
      same += answers[k].accepted && ours.accepted ? 1 : 0;
    }
  }
  BOOST_TEST(same > 250U);
}

BOOST_AUTO_TEST_CASE(generated_files_agree_with_gfortran) {
  std::vector<test_case> cases;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) cases.push_back({fmt::format("seed_{}", seed), generate(seed), ""});
  const auto answers = ask_oracle(cases, "namelist_generated");
  std::size_t same = 0;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const outcome ours = ask_ours(cases[k]);
    // gfortran reads what overflows as infinity.
    if (answers[k].accepted && ours.message.ends_with("which is not finite")) continue;
    const std::string detail = shown(cases[k], answers[k], ours);
    BOOST_TEST(answers[k].accepted == ours.accepted, detail);
    if (ours.accepted) BOOST_TEST(answers[k].values == ours.values, detail);
    same += answers[k].accepted && ours.accepted ? 1 : 0;
  }
  BOOST_TEST(same > 1000U);
}

// What we write, gfortran reads: the resolved input of every accepted generated file.
BOOST_AUTO_TEST_CASE(gfortran_reads_what_is_written) {
  std::vector<test_case> cases;
  std::vector<std::string> expected;
  for (std::uint64_t seed = 0; cases.size() < 300; ++seed) {
    sample values;
    namelist::schema input = schema_of(values);
    try {
      input.read(namelist::parse_text(generate(seed), "generated"));
    } catch (const foundation::error&) {
      continue;
    }
    std::ostringstream out;
    seed % 2 == 0 ? input.write_resolved(out) : schema_of(values).describe(out);
    cases.push_back({fmt::format("written_{}", seed), out.str(), ""});
    expected.push_back(printed(values));
  }
  const auto answers = ask_oracle(cases, "namelist_written");
  for (std::size_t k = 0; k < cases.size(); ++k) {
    BOOST_TEST(answers[k].accepted, cases[k].text + answers[k].message);
    BOOST_TEST(answers[k].values == expected[k], cases[k].text);
  }
}
