#include <algorithm>
#include <array>
#include <namelist/text.hpp>
#include <tables/cells.hpp>

namespace tetsuame::tables {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_quote(char c) { return c == '"' || c == '\''; }

// The quoted cell that begins at `at`, which moves behind its closing quote. None: there is no such quote.
std::optional<cell> quoted_cell(std::string_view line, std::size_t& at) {
  const char mark = line[at];
  cell result{"", true};
  for (++at; at < line.size(); ++at) {
    if (line[at] != mark) {
      result.text += line[at];
      continue;
    }
    if (at + 1 == line.size() || line[at + 1] != mark) {
      ++at;
      result.text = trimmed(result.text);
      return result;
    }
    result.text += line[++at];
  }
  return {};
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<std::vector<cell>> cells_of(std::string_view line, char separator) {
  line = trimmed(line);
  const auto separates = [&](char c) { return separator == ' ' ? is_blank(c) : c == separator; };
  const auto skip_blanks = [&](std::size_t at) {
    while (at < line.size() && is_blank(line[at]) && (separator == ' ' || !separates(line[at]))) ++at;
    return at;
  };
  std::vector<cell> all;
  std::size_t at = 0;
  while (true) {
    at = skip_blanks(at);
    if (at < line.size() && is_quote(line[at])) {
      auto found = quoted_cell(line, at);
      if (!found) return {};
      all.push_back(std::move(*found));
      at = skip_blanks(at);
      // Text behind the quote belongs to the cell, which then is no number.
      while (separator != ' ' && at < line.size() && !separates(line[at])) all.back().text += line[at++];
    } else {
      const std::size_t begin = at;
      while (at < line.size() && !separates(line[at])) ++at;
      all.push_back({std::string(trimmed(line.substr(begin, at - begin)))});
    }
    if (at >= line.size()) break;
    if (separator == ' ') continue;
    if (++at == line.size()) {
      all.emplace_back();  // behind the last separator
      break;
    }
  }
  return all;
}

std::optional<double> number_of(std::string_view text) {
  constexpr std::string_view letters = "eEdDqQ";
  for (std::size_t k = 1; k < text.size(); ++k)
    if ((text[k] == '-' || text[k] == '+') && letters.find(text[k - 1]) == std::string_view::npos) return {};
  return namelist::to_real(text);
}

char separator_of(std::string_view line) {
  bool inside = false;
  char mark = ' ';
  std::string plain;
  for (const char c : trimmed(line)) {
    if (!inside && is_quote(c))
      inside = true, mark = c;
    else if (inside && c == mark)
      inside = false;
    else if (!inside)
      plain += c;
  }
  if (plain.find(",\t") != std::string::npos) return ',';  // with tabs as blanks
  for (const char c : {';', '\t', ','})
    if (plain.find(c) != std::string::npos) return c;
  return ' ';
}

bool begins_with_number(std::string_view line) {
  line = trimmed(line);
  std::string first;
  if (!line.empty() && is_quote(line.front())) {
    std::size_t at = 0;
    const auto found = quoted_cell(line, at);
    if (!found) return false;
    first = found->text;
  } else {
    first = line.substr(0, line.find_first_of(" \t,;"));
  }
  const std::string word = namelist::lower(first);
  return number_of(first).has_value() || word == "na" || word == "n/a" || word == "null";
}

std::optional<unit> unit_of(std::string_view text) {
  struct named {
    std::string_view name;
    unit is;
  };
  static constexpr std::array all = {
      named{"s", {"s", 1.0}},
      named{"sec", {"s", 1.0}},
      named{"ms", {"s", 1e-3}},
      named{"us", {"s", 1e-6}},
      named{"min", {"s", 60.0}},
      named{"h", {"s", 3600.0}},
      named{"m", {"m", 1.0}},
      named{"mm", {"m", 1e-3}},
      named{"cm", {"m", 1e-2}},
      named{"km", {"m", 1e3}},
      named{"Pa", {"Pa", 1.0}},
      named{"hPa", {"Pa", 1e2}},
      named{"mbar", {"Pa", 1e2}},
      named{"kPa", {"Pa", 1e3}},
      named{"bar", {"Pa", 1e5}},
      named{"MPa", {"Pa", 1e6}},
      named{"GPa", {"Pa", 1e9}},
      named{"N", {"N", 1.0}},
      named{"kN", {"N", 1e3}},
      named{"MN", {"N", 1e6}},
      named{"N m", {"N m", 1.0}},
      named{"N*m", {"N m", 1.0}},
      named{"Nm", {"N m", 1.0}},
      named{"kN m", {"N m", 1e3}},
      named{"kNm", {"N m", 1e3}},
      named{"deg", {"degrees", 1.0}},
      named{"degree", {"degrees", 1.0}},
      named{"degrees", {"degrees", 1.0}},
      named{"rad", {"degrees", 57.29577951308232}},
      named{"K", {"K", 1.0}},
      named{"C", {"Celsius", 1.0}},
      named{"degC", {"Celsius", 1.0}},
      named{"Pa s", {"Pa s", 1.0}},
      named{"Pa*s", {"Pa s", 1.0}},
      named{"Pas", {"Pa s", 1.0}},
      named{"mPa s", {"Pa s", 1e-3}},
  };
  for (const auto& u : all)
    if (u.name == text) return u.is;
  return {};
}

heading heading_of(std::string_view text) {
  text = trimmed(text);
  for (const std::string_view marks : {"[]", "()"}) {
    const std::size_t open = text.rfind(marks[0]);
    if (text.empty() || text.back() != marks[1] || open == std::string_view::npos) continue;
    return {std::string(trimmed(text.substr(0, open))),
            std::string(trimmed(text.substr(open + 1, text.size() - open - 2)))};
  }
  return {std::string(text), ""};
}

}  // namespace tetsuame::tables
