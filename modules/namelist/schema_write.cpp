#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <namelist/schema.hpp>
#include <namelist/text.hpp>
#include <ostream>

namespace tetsuame::namelist {

namespace {

std::string element(double number) { return std::isfinite(number) ? format_real(number) : ""; }
std::string element(std::int64_t number) { return std::to_string(number); }
std::string element(bool truth) { return truth ? ".true." : ".false."; }
std::string element(const std::string& text) { return quote(text); }

template <class T>
std::string element(const std::optional<T>& content) {
  return content ? element(*content) : "";
}

// An element that is left open is the null value 1*, which counts at the beginning of a list too.
std::string element(const std::vector<double>& list) {
  std::string result;
  for (std::size_t k = 0; k < list.size(); ++k)
    result += (k > 0 ? ", " : "") + (std::isfinite(list[k]) ? format_real(list[k]) : "1*");
  return result;
}

template <class T>
std::string element(const std::vector<T>& list) {
  std::string result;
  for (std::size_t k = 0; k < list.size(); ++k) result += (k > 0 ? ", " : "") + element(list[k]);
  return result;
}

// What a key's target is called, and what is expected of its elements: in the order of `target`.
struct names {
  const char *of_type, *expected;
};
constexpr names kinds[] = {{"real", "a real number"},
                           {"integer", "an integer"},
                           {"logical", "a logical (.true. or .false.)"},
                           {"text", "a text"},
                           {"optional real", "a real number"},
                           {"list of reals", "a real number"},
                           {"list of integers", "an integer"},
                           {"list of texts", "a text"}};
static_assert(std::size(kinds) == std::variant_size_v<target>);

// A comment of any number of lines.
std::string comment(const std::string& text, const std::string& indent) {
  std::string result = indent + "! ";
  for (const char c : text) {
    result += c;
    if (c == '\n') result += indent + "! ";
  }
  return result + '\n';
}

std::string line(const key& k, const std::string& text) {
  return fmt::format("  {} ={}{}\n", k.name, text.empty() ? "" : " ", text);
}

}  // namespace

std::string key::value() const {
  return std::visit([](auto* to) { return element(*to); }, bound);
}

bool key::allows(double number) const {
  return (info.exclusive_minimum ? number > info.minimum : number >= info.minimum) && number <= info.maximum;
}

std::string key::type_name() const { return kinds[bound.index()].of_type; }

std::string key::limits() const {
  const key_info& i = info;
  if (!i.choices.empty()) return "one of " + element(i.choices);
  const bool below = std::isfinite(i.minimum), above = std::isfinite(i.maximum);
  if (below && above)
    return fmt::format("in {}{}, {}]", i.exclusive_minimum ? '(' : '[', format_real(i.minimum), format_real(i.maximum));
  if (below) return fmt::format("{} {}", i.exclusive_minimum ? ">" : ">=", format_real(i.minimum));
  if (above) return "<= " + format_real(i.maximum);
  return "";
}

std::string key::expected() const {
  if (!info.choices.empty()) return limits();
  std::string result = kinds[bound.index()].expected;
  if (!info.unit.empty()) result += " in " + info.unit;
  const std::string range = limits();
  return range.empty() ? result : result + " " + range;
}

void schema::describe(std::ostream& out) const {
  for (const key_group& g : groups_) {
    if (g.keys.empty()) continue;  // all of them are of &expert
    if (!g.meaning.empty()) out << comment(g.meaning, "");
    out << '&' << g.name << '\n';
    for (const key& k : g.keys) {
      const std::string whose = k.declared_in == g.name ? "" : fmt::format("of &{}: ", k.declared_in);
      if (!(whose + k.info.meaning).empty()) out << comment(whose + k.info.meaning, "  ");
      std::string facts = k.type_name();
      if (facts.starts_with("list")) facts += fmt::format(", at most {}", k.info.maximum_size);
      if (k.info.file != file_of::nothing) facts += ", a path from the input's folder";
      if (!k.info.unit.empty()) facts += " [" + k.info.unit + "]";
      if (const std::string range = k.limits(); !range.empty()) facts += ", " + range;
      facts += ", default " + (k.default_text.empty() ? "none" : k.default_text);
      if (k.info.may_change) facts += "; a restart may change it";
      out << comment(facts, "  ") << line(k, k.default_text);
    }
    out << "/\n\n";
  }
}

void schema::write_resolved(std::ostream& out) const {
  for (const key_group& g : groups_) {
    if (g.keys.empty()) continue;
    out << '&' << g.name << '\n';
    for (const key& k : g.keys) out << line(k, k.info.stays_open && k.given_in.empty() ? "! " + k.value() : k.value());
    out << "/\n\n";
  }
}

}  // namespace tetsuame::namelist
