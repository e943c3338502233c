#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <foundation/error.hpp>
#include <fstream>
#include <map>
#include <namelist/document.hpp>
#include <namelist/text.hpp>
#include <system_error>
#include <utility>

namespace tetsuame::namelist {

namespace {

// A file has comments, terminators and further keys; the argument of --set is one
// assignment, in which only blanks and commas separate, so that a path needs no quotes.
enum class syntax { file, argument };

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

class reader {
 public:
  reader(std::string_view text, std::string name, syntax mode) : text_(text), name_(std::move(name)), mode_(mode) {}

  // As in Fortran, what stands between groups is ignored, save for what can only be meant as a group or as a key of
  // one, and for what a / leaves behind on its line.
  std::vector<group> groups() {
    if (text_.size() > maximum_bytes) fail(fmt::format("longer than {} bytes: this is no input", maximum_bytes));
    expect_text();
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (text_.starts_with(byte_order_mark)) at_ = byte_order_mark.size();
    std::vector<group> result;
    std::map<std::string, std::size_t> lines;
    bool line_begins = true;
    while (!ended()) {
      if (starts_comment(at_)) {
        step_to(after_comment(at_));
        continue;
      }
      if (!next_is('&') && !next_is('$')) {
        line_begins = next() == '\n' || (line_begins && is_blank(next()));
        if (next() == '=' && lost_.empty()) lost_ = excerpt(line_at(at_)), lost_in_ = line_;
        step();
        continue;
      }
      group found{read_group_name(line_begins), line_, {}};
      line_begins = false;
      if (found.name.empty() || found.name == "end") continue;
      expect_nothing_lost();
      const auto [earlier, first] = lines.emplace(found.name, line_);
      if (!first && std::ranges::find(repeated_groups, found.name) == repeated_groups.end())
        fail(fmt::format("group &{} was given before, in line {}", found.name, earlier->second));
      count_item();
      read_group(found);
      expect_nothing_behind(found.name);
      result.push_back(std::move(found));
    }
    if (result.empty()) fail("the input has no group (&name ... /): is this a namelist file?");
    expect_nothing_lost();
    return result;
  }

  assignment argument(std::string& group_name) {
    constexpr std::string_view form = "expected --set group.key=value";
    group_name = lower(name());
    if (group_name.empty() || !next_is('.')) fail(std::string(form));
    step();
    if (ended() || !is_letter(next())) fail(std::string(form));
    assignment result = read_key();
    read_values(result);
    result.line = 0;
    for (value& v : result.values) v.line = 0;
    if (result.values.empty()) fail("expected a value after =; an empty text is written ''");
    return result;
  }

 private:
  bool ended() const { return at_ == text_.size(); }
  char next() const { return text_[at_]; }
  bool next_is(char c) const { return !ended() && next() == c; }
  bool starts_comment(std::size_t at) const { return mode_ == syntax::file && text_[at] == '!'; }
  void step() { line_ += text_[at_++] == '\n' ? 1 : 0; }
  [[noreturn]] void fail(const std::string& message) const { fail(line_, message); }
  [[noreturn]] void fail(std::size_t line, const std::string& message) const {
    if (mode_ == syntax::argument) foundation::fail_input(fmt::format("{}: {}", name_, message));
    foundation::fail_input(fmt::format("{}:{}: {}", name_, line, message));
  }

  // Other files are easily given for an input.
  void expect_text() const {
    const auto fault = not_text(text_, "a namelist");
    if (fault.empty()) return;
    foundation::fail_input(fmt::format("{}: {}{}", name_, fault,
                                       fault.find("HDF5") == std::string::npos
                                           ? ""
                                           : ": a checkpoint is continued by --restart " + name_ + ", without INPUT"));
  }

  // The line around that place, without blanks at its ends and without a comment.
  std::string_view line_at(std::size_t at) const {
    const std::size_t before = text_.find_last_of("\r\n", at);
    std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
    std::size_t end = std::min(text_.find_first_of("\r\n!", at), text_.size());
    while (begin < end && is_blank(text_[begin])) ++begin;
    while (end > begin && is_blank(text_[end - 1])) --end;
    return text_.substr(begin, end - begin);
  }

  void expect_nothing_lost() const {
    if (!lost_.empty())
      fail(lost_in_, fmt::format("'{}' stands outside of all groups and would be lost: a group begins with & and its "
                                 "name, and ends with /",
                                 lost_));
  }

  // But for a comment and a further group.
  void expect_nothing_behind(const std::string& group_name) const {
    std::size_t at = at_;
    while (at < text_.size() && is_blank(text_[at]) && text_[at] != '\n') ++at;
    if (at == text_.size() || text_[at] == '\n' || starts_comment(at)) return;
    const bool group_begins = text_[at] == '&' || text_[at] == '$';
    if (group_begins && at + 1 < text_.size() && is_letter(text_[at + 1])) return;
    const auto rest = text_.substr(at, line_at(at).data() + line_at(at).size() - (text_.data() + at));
    fail(
        fmt::format("'{}' stands behind the end of group &{} and would be lost: a / closes the group unless it is in "
                    "quotes (write numbers out, not as 1/4), and a comment begins with !",
                    excerpt(rest), group_name));
  }

  bool is_separator(char c) const {
    return is_blank(c) || c == ',' || (mode_ == syntax::file && (c == ';' || c == '/' || c == '!'));
  }

  // Past blanks, ends of lines and comments, which all mean the same between items.
  std::size_t after_blanks(std::size_t at) const {
    while (at < text_.size() && (is_blank(text_[at]) || starts_comment(at)))
      at = starts_comment(at) ? after_comment(at) : at + 1;
    return at;
  }

  // The end of its line.
  std::size_t after_comment(std::size_t at) const {
    const std::size_t end = std::min(text_.find('\n', at), text_.size());
    const std::size_t turn = text_.substr(at, end - at).find('\r');
    if (turn != std::string_view::npos &&
        text_.substr(at + turn, end - at - turn).find_first_not_of('\r') != std::string_view::npos)
      fail("a comment goes on behind a carriage return, and would swallow the next line: end lines with a line feed");
    return end;
  }
  void step_to(std::size_t at) {
    while (at_ < at) step();
  }

  void skip_blanks() {
    const std::size_t end = after_blanks(at_);
    while (at_ < end) step();
  }

  void skip_separators() {
    for (skip_blanks(); next_is(',') || next_is(';'); skip_blanks()) step();
  }

  std::string_view name() {
    const std::size_t begin = at_;
    if (!ended() && is_letter(next()))
      while (!ended() && is_name_character(next())) step();
    if (at_ - begin > maximum_name)
      fail(fmt::format("the name '{}' has more than {} letters", excerpt(text_.substr(begin, at_ - begin)),
                       maximum_name));
    return text_.substr(begin, at_ - begin);
  }

  void count_item() {
    if (++items_ > maximum_items) fail(fmt::format("more than {} groups, keys and values", maximum_items));
  }

  // Empty if this & or $ is part of the text between groups.
  std::string read_group_name(bool line_begins) {
    const bool dollar = next_is('$');
    step();
    std::string result = lower(name());
    if (!result.empty() && (ended() || is_separator(next()))) return result;
    if (line_begins && result.empty() && !dollar) fail("expected the name of a group directly behind &");
    if (line_begins && !result.empty()) fail(fmt::format("expected a blank behind the name of group &{}", result));
    return "";
  }

  void read_group(group& into) {
    for (skip_separators(); !group_ends(into); skip_separators()) {
      assignment found = read_key();
      read_values(found);
      into.assignments.push_back(std::move(found));
    }
  }

  bool group_ends(const group& into) {
    const std::string opened = fmt::format("group &{}, opened in line {}, is not closed", into.name, into.line);
    if (ended()) fail(opened + ": expected / at its end");
    if (next() == '/') {
      step();
      return true;
    }
    if (next() != '&' && next() != '$') return false;
    const std::size_t begin = at_;
    step();
    const std::string found = lower(name());
    if (found != "end" || (!ended() && !is_separator(next())))
      fail(fmt::format("{}: expected / before '{}'", opened,
                       excerpt(text_.substr(begin, std::max<std::size_t>(at_ - begin, 1)))));
    return true;
  }

  assignment read_key() {
    count_item();
    assignment result;
    result.line = line_;
    const std::size_t begin = at_;
    result.key = lower(name());
    if (result.key.empty()) {
      while (!ended() && !is_separator(next()) && next() != '=') step();
      const auto found = at_ > begin ? text_.substr(begin, at_ - begin) : text_.substr(begin, 1);
      fail(fmt::format("expected 'key = value', found '{}'", excerpt(found)));
    }
    skip_blanks();
    if (next_is('%')) fail(fmt::format("'{}%': keys here have no components", result.key));
    if (next_is('(')) result.index = read_subscript(result.key);
    skip_blanks();
    if (next_is('(') || next_is('%'))
      fail(fmt::format("'{}': expected = after the subscript (substrings and components are not read)", result.key));
    if (!next_is('=')) fail(result.line, fmt::format("expected = after '{}'", result.key));
    step();
    return result;
  }

  subscript read_subscript(const std::string& key) {
    step();
    subscript result;
    result.first = read_index(key);
    if (next_is(':')) {
      result.section = true;
      step();
      result.last = read_index(key);
      if (next_is(':')) {
        step();
        const auto stride = read_index(key);
        if (!stride || *stride == 0) fail(fmt::format("'{}': expected a stride other than 0", key));
        result.stride = *stride;
      }
    } else if (!result.first) {
      fail(fmt::format("'{}': expected a subscript such as (2) or (1:3)", key));
    }
    if (!next_is(')')) fail(fmt::format("'{}': expected ) after the subscript; arrays here have one dimension", key));
    step();
    return result;
  }

  // Empty where none is written.
  std::optional<std::int64_t> read_index(const std::string& key) {
    skip_blanks();
    const std::size_t begin = at_;
    while (!ended() && (is_digit(next()) || next() == '+' || next() == '-')) step();
    const std::string_view word = text_.substr(begin, at_ - begin);
    skip_blanks();
    if (word.empty()) {
      if (!next_is(':') && !next_is(')')) fail(fmt::format("'{}': expected an integer as subscript", key));
      return {};
    }
    bool out_of_range = false;
    const auto number = to_integer(word, out_of_range);
    // Small enough that sums of subscripts and strides cannot overflow.
    constexpr std::int64_t largest = std::int64_t{1} << 40;
    if (!number || *number > largest || *number < -largest)
      fail(fmt::format("'{}': '{}' is no subscript", key, excerpt(word)));
    return number;
  }

  void read_values(assignment& into) {
    bool separated = true;  // a comma now would stand for a null value
    for (skip_blanks(); !ended(); skip_blanks()) {
      const char c = next();
      if (mode_ == syntax::file && (c == '/' || c == '&' || c == '$')) return;
      if (c == ',' || (mode_ == syntax::file && c == ';')) {
        if (separated) {
          count_item();
          into.values.push_back({value::kind::null, {}, 1, false, line_});
        }
        separated = true;
        step();
        continue;
      }
      if (mode_ == syntax::file && key_begins()) return;
      count_item();
      into.values.push_back(read_value(into.key));
      separated = false;
    }
  }

  // Whether `name =`, `name(…) =` or `name%…` follows: the one way to tell a value such
  // as T or inf from the next key. A subscript's length is bounded so that a file of
  // open brackets costs no quadratic time.
  bool key_begins() const {
    constexpr std::size_t longest_subscript = 256;
    std::size_t at = at_;
    if (!is_letter(text_[at])) return false;
    while (at < text_.size() && is_name_character(text_[at])) ++at;
    at = after_blanks(at);
    if (at < text_.size() && text_[at] == '%') return true;
    if (at < text_.size() && text_[at] == '(') {
      const std::size_t close = text_.substr(at, longest_subscript).find(')');
      if (close == std::string_view::npos) return false;
      at = after_blanks(at + close + 1);
    }
    return at < text_.size() && text_[at] == '=';
  }

  value read_value(const std::string& key) {
    value result;
    result.line = line_;
    const std::size_t begin = at_;
    std::size_t star = at_;
    while (star < text_.size() && is_digit(text_[star])) ++star;
    if (star > begin && star < text_.size() && text_[star] == '*') {
      const auto parsed = std::from_chars(text_.data() + begin, text_.data() + star, result.repeat);
      if (parsed.ec != std::errc()) fail(fmt::format("'{}': the repeat count is too large", key));
      if (result.repeat == 0) fail(fmt::format("'{}': a repeat count must be at least 1", key));
      result.counted = true;
      at_ = star + 1;
      if (ended() || is_separator(next())) return result;
    }
    if (next_is('\'') || next_is('"')) {
      read_text(result);
      if (!ended() && !is_separator(next()))
        fail(fmt::format("'{}': expected a blank or a comma after the closing quote, found '{}'", key,
                         excerpt(text_.substr(at_, 1))));
      return result;
    }
    read_word(result);
    if (mode_ == syntax::file && next_is('='))
      fail(fmt::format("'{}': misplaced = after '{}'", key, excerpt(result.content)));
    return result;
  }

  void read_word(value& into) {
    into.what = value::kind::word;
    const std::size_t begin = at_;
    while (!ended() && !is_separator(next()) && (mode_ == syntax::argument || next() != '=')) step();
    into.content = text_.substr(begin, at_ - begin);
    if (mode_ == syntax::file && into.content.find_first_of("&$") != std::string::npos)
      fail(fmt::format("expected a blank before & or $ in '{}'", excerpt(into.content)));
  }

  // As gfortran does, a text runs on over the ends of lines, which are not part of it.
  void read_text(value& into) {
    into.what = value::kind::text;
    const std::size_t begin = line_;
    const char mark = next();
    for (step(); !ended(); step()) {
      const char c = next();
      if (c == mark) {
        const bool doubled = at_ + 1 < text_.size() && text_[at_ + 1] == mark;
        step();
        if (!doubled) return;
      }
      if (c != '\n' && c != '\r') into.content += c;
    }
    fail(begin, fmt::format("the text {}{} has no closing quote", mark, excerpt(into.content)));
  }

  std::string_view text_;
  std::string name_;
  syntax mode_;
  std::size_t at_ = 0, line_ = 1, items_ = 0;
  std::string lost_;         // the first line with = outside of all groups; empty: none
  std::size_t lost_in_ = 0;  // its number
};

std::string place(const std::string& name, const std::string& set, std::size_t line) {
  return set.empty() ? fmt::format("{}:{}", name, line) : "--set " + set;
}

}  // namespace

std::string document::where(const assignment& from) const { return place(name_, from.set, from.line); }

std::string document::where(const assignment& from, const value& at) const { return place(name_, from.set, at.line); }

void document::set(const std::string& argument) {
  std::string name;
  assignment override = reader(argument, "--set " + excerpt(argument), syntax::argument).argument(name);
  override.set = excerpt(argument);
  for (auto g = groups_.rbegin(); g != groups_.rend(); ++g)
    if (g->name == name) {
      g->assignments.push_back(std::move(override));
      return;
    }
  groups_.push_back({name, 0, {std::move(override)}});
}

document parse_text(std::string_view text, std::string name) {
  document result;
  result.groups_ = reader(text, name, syntax::file).groups();
  result.name_ = std::move(name);
  return result;
}

std::string read_file(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    foundation::fail_input(fmt::format("{}: is a directory, not a namelist file", name));
  std::ifstream file(path, std::ios::binary);
  if (!file) foundation::fail_input(fmt::format("{}: the input file cannot be opened: is the path right?", name));
  std::string text(maximum_bytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad() || text.empty())
    foundation::fail_input(fmt::format("{}: the input file cannot be read, or is empty", name));
  return text;
}

}  // namespace tetsuame::namelist
