#include "generate.hpp"

#include <array>
#include <random>
#include <string_view>

namespace {

class writer {
 public:
  explicit writer(std::uint64_t seed) : bits_(seed) {}

  std::string file() {
    std::string result = one_in(6) ? "text before the group\n" : "";
    const char mark = one_in(8) ? '$' : '&';
    result += mark + spelled("sample") + blank();
    for (std::uint64_t k = below(8); k > 0; --k) result += assignment() + (one_in(3) ? "," : "") + blank();
    result += one_in(4) ? mark + spelled("end") : "/";
    return result + blank() + "\ntext behind it\n";
  }

 private:
  std::uint64_t below(std::uint64_t n) { return bits_() % n; }
  bool one_in(std::uint64_t n) { return below(n) == 0; }
  template <std::size_t N>
  std::string any(const std::array<std::string_view, N>& of) {
    return std::string(of[below(N)]);
  }

  std::string spelled(std::string word) {
    for (char& c : word)
      if (c >= 'a' && c <= 'z' && one_in(4)) c = static_cast<char>(c - 'a' + 'A');
    return word;
  }
  std::string blank() {
    return any(
        std::array<std::string_view, 7>{" ", "  ", "\n", "\t", " \r\n", " ! what 'it' is / &end r=4\n", "\n\n ! x\n"});
  }
  std::string space() { return any(std::array<std::string_view, 4>{"", " ", "  ", "\t"}); }
  std::string digits(std::uint64_t most) {
    std::string result;
    for (std::uint64_t k = 1 + below(most); k > 0; --k) result += static_cast<char>('0' + below(10));
    return result;
  }

  std::string real() {
    std::string result = any(std::array<std::string_view, 4>{"", "", "-", "+"});
    switch (below(4)) {
      case 0:
        result += digits(5);
        break;
      case 1:
        result += digits(3) + ".";
        break;
      case 2:
        result.append(".").append(digits(17));
        break;
      default:
        result += digits(3) + "." + digits(17);
    }
    if (one_in(2)) return result;
    result += any(std::array<std::string_view, 10>{"e", "E", "d", "D", "q", "e+", "d-", "E-", "+", "-"});
    if (one_in(8)) result.append("3");
    return result + digits(2);
  }
  std::string integer() { return any(std::array<std::string_view, 3>{"", "-", "+"}) + digits(18); }
  std::string logical() {
    return any(std::array<std::string_view, 12>{"T", "f", ".true.", ".FALSE.", ".t.", ".F", "true", "False", ".t", "F",
                                                "T", ".tRuE."});
  }
  std::string text() {
    const std::string mark = one_in(2) ? "'" : "\"";
    std::string result = mark;
    for (std::uint64_t k = below(10); k > 0; --k)
      result += one_in(6) ? mark + mark
                          : any(std::array<std::string_view, 15>{"a", "B", " ", "/", "!", "&", "$", "=", ",", ";", "é",
                                                                 "\n", "2*", "'\"", "\r\n"});
    // A lone foreign quote is ordinary; a pair of both is not: take the own one out.
    std::string clean = mark;
    for (std::size_t k = 1; k < result.size(); ++k)
      if (result[k] != mark[0])
        clean += result[k];
      else if (k + 1 < result.size() && result[k + 1] == mark[0])
        clean += mark + mark, ++k;
    return clean + mark;
  }

  // kind: r(eal), i(nteger), t(ext), l(ogical)
  std::string one(char kind) {
    return kind == 'r' ? real() : kind == 'i' ? integer() : kind == 't' ? text() : logical();
  }
  // Now and then the value is of another kind, which Fortran refuses if it does not fit.
  std::string scalar(char kind) {
    // gfortran takes T and inf for the next key where a value is missing before them.
    if (kind != 'l' && one_in(12)) return "";
    // A logical is no example: gfortran leaves a number alone where it finds T.
    if (one_in(40)) kind = kind == 'i' ? 'r' : kind == 't' ? 't' : 'i';
    return (one_in(10) ? "1*" : "") + one(kind);
  }
  // size: of the array; sometimes more values are written than it holds
  std::string list(char kind, std::uint64_t size) {
    std::string result;
    for (std::uint64_t k = below(size + 1); k > 0; --k) {
      // No comma at the beginning of a line, which gfortran reads against the standard.
      const bool at_line_begin = result.ends_with("\n ");
      switch (below(8)) {
        case 0:
          result += "2*" + one(kind);
          break;
        case 1:
          result += "1*";
          break;
        case 2:
          if (!at_line_begin) break;
          [[fallthrough]];
        default:
          result += one(kind);
      }
      result += any(std::array<std::string_view, 6>{",", ", ", " , ", " ", "\t", ",\n "});
    }
    return result + one(kind);
  }
  std::string index(std::uint64_t size) {
    const auto number = [&] { return std::to_string(1 + below(one_in(10) ? size + 2 : size)); };
    switch (below(8)) {
      case 0:
        return '(' + number() + ')';
      case 1:
        return '(' + number() + ':' + number() + ')';
      case 2:
        return "(:" + number() + ')';
      case 3:
        return '(' + number() + ":)";
      case 4:
        return '(' + number() + ':' + number() + ':' + any(std::array<std::string_view, 4>{"1", "2", "-1", "-2"}) + ')';
      case 5:
        return "(:)";
      default:
        return "";
    }
  }

  std::string assignment() {
    switch (below(11)) {
      case 0:
        return key("r") + scalar('r');
      case 1:
        return key("r2") + scalar('r');
      case 2:
        return spelled("inf") + "=" + scalar('r');
      case 3:
        return key("i") + scalar('i');
      case 4:
        return key("j") + scalar('i');
      case 5:
        return key("flag") + scalar('l');
      case 6:
        return key("s") + scalar('t');
      case 7:
        return spelled("t") + "=" + scalar('t');
      case 8:
        return spelled("ra") + index(8) + space() + '=' + space() + list('r', 8);
      case 9:
        return spelled("ia") + index(8) + space() + '=' + space() + list('i', 8);
      default:
        return spelled("sa") + index(4) + space() + '=' + space() + list('t', 4);
    }
  }
  std::string key(const std::string& name) { return spelled(name) + space() + '=' + space(); }

  std::mt19937_64 bits_;
};

}  // namespace

std::string generate(std::uint64_t seed) { return writer(seed).file(); }
