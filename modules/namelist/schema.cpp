#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <foundation/error.hpp>
#include <functional>
#include <limits>
#include <map>
#include <namelist/schema.hpp>
#include <namelist/text.hpp>
#include <stdexcept>
#include <utility>

namespace tetsuame::namelist {

namespace {

// One assignment on its way to its key.
struct context {
  const document& input;
  const assignment& from;
  const std::string& group;
  const key& to;
  std::int64_t behind = 0;  // elements that earlier groups of this name gave

  [[noreturn]] void fail(const value* at, const std::string& message) const {
    const std::string place = at != nullptr ? input.where(from, *at) : input.where(from);
    // A key of &expert may have another name in its own group.
    const auto& name = group == to.declared_in ? to.declared_as : to.name;
    foundation::fail_input(fmt::format("{}: &{} {}: {}", place, group, name, message));
  }
  [[noreturn]] void fail_found(const value& at) const {
    const std::string found =
        at.what == value::kind::text ? "the text " + quote(excerpt(at.content)) : excerpt(at.content);
    fail(&at, fmt::format("expected {}, found {}", to.expected(), found));
  }
};

double convert(const context& c, const value& v, double*) {
  const auto number = v.what == value::kind::word ? to_real(v.content) : std::nullopt;
  if (!number) c.fail_found(v);
  if (!std::isfinite(*number))
    c.fail(&v, fmt::format("expected {}, found {}, which is not finite", c.to.expected(), excerpt(v.content)));
  if (!c.to.allows(*number)) c.fail_found(v);
  return *number;
}

std::int64_t convert(const context& c, const value& v, std::int64_t*) {
  bool out_of_range = false;
  const auto number = v.what == value::kind::word ? to_integer(v.content, out_of_range) : std::nullopt;
  if (out_of_range)
    c.fail(&v, fmt::format("expected {}, found {}, which 64 bits cannot hold", c.to.expected(), excerpt(v.content)));
  if (!number || !c.to.allows(static_cast<double>(*number))) c.fail_found(v);
  return *number;
}

bool convert(const context& c, const value& v, bool*) {
  const auto truth = v.what == value::kind::word ? to_logical(v.content) : std::nullopt;
  if (!truth) c.fail_found(v);
  return *truth;
}

// Blanks at the end do not count when Fortran compares texts.
std::string_view without_trailing_blanks(std::string_view text) {
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

// From the folder of the input, or that of --set from the current one.
std::string completed(const context& c, const std::string& path) {
  namespace fs = std::filesystem;
  if (path.empty() || fs::path(path).is_absolute() || !c.from.set.empty()) return path;
  return (fs::path(c.input.name()).parent_path() / path).lexically_normal().string();
}

std::string convert(const context& c, const value& v, std::string*) {
  const std::vector<std::string>& choices = c.to.info.choices;
  const bool bare = v.what == value::kind::word;
  if (bare && c.to.info.formula && to_real(v.content)) return v.content;
  if (bare && c.from.set.empty()) {
    const std::string meant = choices.empty() ? v.content : nearest(v.content, choices);
    c.fail(&v, fmt::format("expected {} in quotes, found {}; did you mean {}?", c.to.expected(), excerpt(v.content),
                           quote(excerpt(meant))));
  }
  if (c.to.info.file != file_of::nothing) return completed(c, std::string(without_trailing_blanks(v.content)));
  if (choices.empty()) return v.content;
  const std::string wanted = lower(without_trailing_blanks(v.content));
  for (const std::string& choice : choices)
    if (lower(choice) == wanted) return choice;
  c.fail(&v, fmt::format("expected {}, found {}; the nearest is {}", c.to.expected(), quote(excerpt(v.content)),
                         quote(nearest(v.content, choices))));
}

template <class T>
T convert(const context& c, const value& v, std::optional<T>*) {
  return convert(c, v, static_cast<T*>(nullptr));
}

template <class T>
void assign(const context& c, T& to, key&) {
  if (c.from.index) c.fail(nullptr, "takes a single value: no subscript is possible");
  for (std::size_t k = 0; k < c.from.values.size(); ++k) {
    const value& v = c.from.values[k];
    // Empty places behind a comma too much mean nothing.
    if (k > 0 && v.what == value::kind::null && !v.counted) continue;
    if (k > 0 || v.repeat > 1)
      c.fail(&v, fmt::format("takes a single value, found {}",
                             v.repeat > 1 ? fmt::format("{} of them", v.repeat) : "a second, " + excerpt(v.content)));
    if (v.what != value::kind::null) to = convert(c, v, static_cast<T*>(nullptr));
  }
}

// The elements that an assignment's values go to, from 1: first, first + stride, …
struct elements {
  std::int64_t first = 1, last = 0, stride = 1;
};

elements addressed(const context& c) {
  const auto size = static_cast<std::int64_t>(c.to.info.maximum_size) - c.behind;
  elements e{1, size, 1};
  if (!c.from.index) return e;
  const subscript& index = *c.from.index;
  e.stride = index.stride;
  e.first = index.first.value_or(e.stride > 0 ? 1 : size);
  // As in gfortran, a(2) = 5, 6 goes on with a(3).
  e.last = index.last.value_or(e.stride > 0 ? size : 1);
  const auto inside = [&](std::int64_t k) { return k >= 1 && k <= size; };
  if (!inside(e.first) || !inside(e.last))
    c.fail(nullptr, fmt::format("the subscript {} is outside 1 to {}", inside(e.first) ? e.last : e.first, size));
  if ((e.last - e.first) * (e.stride > 0 ? 1 : -1) < 0)
    c.fail(nullptr, fmt::format("the section {}:{}:{} is empty", e.first, e.last, e.stride));
  return e;
}

// Of an element that is not given, where that is no error.
template <class T>
T absent(const context&) {
  return {};
}
template <>
double absent(const context& c) {
  return c.to.info.may_be_left_open ? std::numeric_limits<double>::quiet_NaN() : 0.0;
}
template <>
std::string absent(const context& c) {
  return c.to.info.choices.empty() ? "" : c.to.info.choices.front();
}

// With a repeat count each value counts as often; nulls count too, and keep what is there.
std::uint64_t size_of(const assignment& from) {
  std::uint64_t size = 0;
  for (const value& v : from.values) size += v.repeat;
  return size;
}

template <class T>
void assign(const context& c, std::vector<T>& to, key& of) {
  const elements e = addressed(c);
  const auto room = static_cast<std::uint64_t>((e.last - e.first) / e.stride + 1);
  std::uint64_t used = 0;
  for (const value& v : c.from.values) {
    const bool null = v.what == value::kind::null;
    if (used == room && null && !v.counted) continue;
    if (v.repeat > room - used) c.fail(&v, fmt::format("too many values: at most {} fit, found more", room));
    if (null) {
      used += v.repeat;
      continue;
    }
    const T content = convert(c, v, static_cast<T*>(nullptr));
    for (std::uint64_t k = 0; k < v.repeat; ++k, ++used) {
      const auto at = static_cast<std::size_t>(c.behind + e.first + static_cast<std::int64_t>(used) * e.stride - 1);
      if (at >= to.size()) {
        to.resize(at + 1, absent<T>(c));
        of.filled.resize(at + 1, c.to.info.sparse);
      }
      to[at] = content;
      of.filled[at] = true;
      if (at >= of.origins.size()) of.origins.resize(at + 1);
      of.origins[at] = c.input.where(c.from, v);
    }
  }
}

template <class Items>
auto find_name(Items& items, const std::string& name) {
  return std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
}

template <class T>
std::size_t array_size(const T&) {
  return 0;
}
template <class T>
std::size_t array_size(const std::vector<T>& list) {
  return list.size();
}

// The longest of a group's lists.
std::int64_t length_of(const key_group& g) {
  std::size_t most = 0;
  for (const key& k : g.keys) most = std::max(most, std::visit([](auto* to) { return array_size(*to); }, k.bound));
  return static_cast<std::int64_t>(most);
}

bool has_lists(const key_group& g) {
  return std::ranges::any_of(g.keys, [](const key& k) { return k.type_name().starts_with("list"); });
}

// What --set gives a whole array takes the place of all that the file says of it, also where it is shorter. Of each
// array with its default: makes what stands behind so many elements the default again.
using shortening = std::function<void(std::size_t)>;

template <class T>
shortening shortened(T*) {
  return {};
}
template <class T>
shortening shortened(std::vector<T>* list) {
  return [list, whole = *list](std::size_t count) {
    if (list->size() > count) list->resize(count);
    for (std::size_t n = list->size(); n < whole.size(); ++n) list->push_back(whole[n]);
  };
}

// Before an assignment of --set.
void shorten(key& k, const shortening& keep_first, const assignment& from) {
  if (!keep_first || from.set.empty() || from.index) return;
  const auto count = static_cast<std::size_t>(size_of(from));
  keep_first(count);
  k.filled.resize(std::min(k.filled.size(), count));
  k.filled.resize(std::visit([](auto* to) { return array_size(*to); }, k.bound), true);
}

constexpr const char* expert_group = "expert";

// The key of that group, by its name or an older one; a key of &expert is as well known in the group that declared it.
// None: null.
template <class Groups>
auto find_key(Groups& groups, const std::string& group, const std::string& name)
    -> decltype(&groups.front().keys.front()) {
  for (auto& g : groups)
    for (auto& k : g.keys) {
      const bool declared = k.declared_in == group && (k.declared_as == name || k.older == name);
      if (declared || (g.name == group && k.name == name)) return &k;
    }
  return nullptr;
}

[[noreturn]] void fail_unknown_key(const std::string& where, const key_group& g, const std::string& name,
                                   const std::vector<key_group>& groups) {
  std::vector<std::string> known;
  std::string others;
  for (const key_group& other : groups)
    for (const key& k : other.keys) {
      if (&other == &g || k.declared_in == g.name) known.push_back(&other == &g ? k.name : k.declared_as);
      if (k.name == name) others += fmt::format("; &{} has a key of this name", other.name);
    }
  const std::string hint =
      known.empty() ? "the group has no keys" : fmt::format("the nearest valid key is {}", nearest(name, known));
  foundation::fail_input(fmt::format("{}: &{}: unknown key {}; {}{}", where, g.name, name, hint, others));
}

[[noreturn]] void fail_unknown_group(const std::string& where, const std::string& name,
                                     const std::vector<key_group>& groups) {
  std::vector<std::string> known;
  for (const key_group& g : groups) known.push_back(g.name);
  const std::string hint = known.empty() ? "there are none" : "the nearest valid group is &" + nearest(name, known);
  foundation::fail_input(fmt::format("{}: unknown group &{}; {}", where, name, hint));
}

// Whether a default is what the key would take of an input.
bool is_allowed(const key& k, double number) { return !std::isfinite(number) || k.allows(number); }
bool is_allowed(const key& k, std::int64_t number) { return k.allows(static_cast<double>(number)); }
bool is_allowed(const key&, bool) { return true; }
bool is_allowed(const key& k, const std::string& text) {
  return k.info.choices.empty() || std::ranges::count(k.info.choices, text) > 0;
}
bool is_allowed(const key& k, const std::optional<double>& number) { return !number || is_allowed(k, *number); }
template <class T>
bool is_allowed(const key& k, const std::vector<T>& list) {
  return std::ranges::all_of(list, [&](const T& content) { return is_allowed(k, content); });
}

}  // namespace

void schema::group(const std::string& name, const std::string& meaning) {
  if (find_name(groups_, lower(name)) == groups_.end())
    groups_.insert(find_name(groups_, expert_group), {lower(name), meaning, {}});
}

void schema::pass_over(const std::string& group) { passed_over_.push_back(lower(group)); }

void schema::pass_over(const std::string& group, const std::vector<std::string>& keys) {
  for (const auto& key : keys) keys_passed_over_.emplace_back(group, key);
}

void schema::also_known(const std::string& group, const std::string& older, const std::string& key) {
  namelist::key* const k = find_key(groups_, group, key);
  if (!k || !k->older.empty())
    throw std::logic_error(fmt::format("namelist key {}.{} is not declared, or has an older name", group, key));
  k->older = older;
}

void schema::add(const std::string& group, const std::string& name, target bound, key_info info) {
  const std::string full = fmt::format("namelist key {}.{}", group, name);
  if (find_name(groups_, lower(group)) == groups_.end()) throw std::logic_error(full + ": the group is not declared");
  if (info.expert) this->group(expert_group, "what only an expert turns, each key as one of the group it belongs to");
  const auto g = find_name(groups_, info.expert ? expert_group : lower(group));
  const std::string shown = lower(info.expert_name.empty() ? name : info.expert_name);
  if (find_name(g->keys, shown) != g->keys.end()) throw std::logic_error(full + " is declared twice");
  key k;
  k.name = shown;
  k.declared_in = lower(group);
  k.declared_as = lower(name);
  k.bound = bound;
  k.info = std::move(info);
  k.default_text = k.value();
  if (!std::visit([&](auto* content) { return is_allowed(k, *content); }, bound))
    throw std::logic_error(fmt::format("{}: the default {} is not {}", full, k.default_text, k.expected()));
  if (std::visit([](auto* content) { return array_size(*content); }, bound) > k.info.maximum_size)
    throw std::logic_error(full + ": the default is longer than maximum_size");
  g->keys.push_back(std::move(k));
}

bool schema::has_group(const std::string& name) const {
  return find_name(groups_, name) != groups_.end() || std::ranges::find(passed_over_, name) != passed_over_.end();
}

std::string schema::with_group(const std::string& argument) const {
  const std::string name = lower(argument.substr(0, argument.find_first_of("=( ")));
  std::vector<std::string> found, known;
  for (const key_group& g : groups_)
    for (const key& k : g.keys) {
      if (k.name == name) found.push_back(g.name + "." + argument);
      known.push_back(k.name);
    }
  if (found.size() == 1) return found.front();
  const std::string hint = known.empty() ? "there are none" : "the nearest is " + nearest(name, known);
  foundation::fail_input(
      fmt::format("--set {}: {}", argument,
                  found.empty() ? fmt::format("unknown key {}; {}; expected group.key=value", name, hint)
                                : fmt::format("several groups have this key: write {}", fmt::join(found, " or "))));
}

void schema::read(const document& input) {
  std::map<const key*, shortening> shortenings;
  for (key_group& g : groups_)
    for (key& k : g.keys) {
      k.origin = "default";
      k.given_in.clear();
      k.origins.clear();
      k.filled.assign(std::visit([](auto* to) { return array_size(*to); }, k.bound), true);
      shortenings[&k] = std::visit([](auto* to) { return shortened(to); }, k.bound);
    }
  std::map<std::string, std::size_t> begun;  // groups, and their first lines
  for (const namelist::group& from : input.groups()) {
    const auto g = find_name(groups_, from.name);
    if (g == groups_.end() && std::ranges::find(passed_over_, from.name) != passed_over_.end()) continue;
    if (g == groups_.end()) {
      const bool in_file = from.line > 0;
      fail_unknown_group(
          in_file ? fmt::format("{}:{}", input.name(), from.line) : input.where(from.assignments.front()), from.name,
          groups_);
    }
    const auto [earlier, first] = begun.emplace(g->name, from.line);
    if (!first && from.line > 0 && !has_lists(*g))
      foundation::fail_input(fmt::format("{}:{}: group &{} was given before, in line {}", input.name(), from.line,
                                         g->name, earlier->second));
    const std::int64_t behind = first ? 0 : length_of(*g);
    for (const assignment& a : from.assignments) {
      key* const k = find_key(groups_, g->name, a.key);
      if (!k && std::ranges::find(keys_passed_over_, std::pair(g->name, a.key)) != keys_passed_over_.end()) {
        passed_.push_back("&" + g->name + " " + a.key);
        continue;
      }
      if (!k) fail_unknown_key(input.where(a), *g, a.key, groups_);
      if (!k->given_in.empty() && k->given_in != g->name)
        foundation::fail_input(
            fmt::format("{}: &{} {}: is given in &{} too", input.where(a), g->name, a.key, k->given_in));
      const context c{input, a, g->name, *k, a.set.empty() ? behind : 0};
      shorten(*k, shortenings[k], a);
      std::visit([&](auto* to) { assign(c, *to, *k); }, k->bound);
      const auto written =
          std::find_if(a.values.begin(), a.values.end(), [](const value& v) { return v.what != value::kind::null; });
      if (written == a.values.end()) continue;
      k->origin = input.where(a, *written);
      k->given_in = g->name;
    }
  }
  for (const key_group& g : groups_)
    for (const key& k : g.keys) {
      const auto gap = std::find(k.filled.begin(), k.filled.end(), false);
      if (gap != k.filled.end())
        foundation::fail_input(fmt::format("{}: &{} {}: element {} has neither a value nor a default", k.origin, g.name,
                                           k.name, gap - k.filled.begin() + 1));
    }
}

const key& schema::find(const std::string& group, const std::string& name) const {
  if (const key* k = find_key(groups_, lower(group), lower(name))) return *k;
  throw std::logic_error(fmt::format("namelist key {}.{} is not declared", group, name));
}

std::string schema::where(const std::string& group, const std::string& key) const { return find(group, key).origin; }

bool schema::given(const std::string& group, const std::string& key) const {
  return !find(group, key).given_in.empty();
}

std::map<std::string, key_at_restart> schema::at_restart() const {
  std::map<std::string, key_at_restart> all;
  for (const key_group& g : groups_)
    for (const key& k : g.keys) all["&" + g.name + " " + k.name] = {k.info.may_change, k.origin};
  return all;
}

bool schema::changed(const std::string& group, const std::string& key) const {
  const auto& k = find(group, key);
  return k.value() != k.default_text;
}

std::vector<named_file> schema::files() const {
  std::vector<named_file> all;
  for (const key_group& g : groups_)
    for (const key& k : g.keys) {
      if (k.info.file == file_of::nothing) continue;
      const auto add = [&](std::string& path) {
        if (!path.empty())
          all.push_back({fmt::format("{}: &{} {}", k.origin, k.declared_in, k.declared_as), &path, k.info.file});
      };
      if (auto* const* one = std::get_if<std::string*>(&k.bound)) add(**one);
      if (auto* const* list = std::get_if<std::vector<std::string>*>(&k.bound))
        for (std::string& path : **list) add(path);
    }
  return all;
}

namespace {

[[noreturn]] void fail_from(const std::string& origin, const key& k, const std::string& message) {
  foundation::fail_input(fmt::format("{}: &{} {}: {}", origin == "default" ? "default value" : origin,
                                     k.info.expert ? expert_group : k.declared_in, k.name, message));
}

}  // namespace

void schema::fail(const std::string& group, const std::string& name, const std::string& message) const {
  const key& k = find(group, name);
  fail_from(k.origin, k, message);
}

void schema::fail_at(const std::string& group, const std::string& name, std::size_t n,
                     const std::string& message) const {
  const key& k = find(group, name);
  fail_from(n < k.origins.size() && !k.origins[n].empty() ? k.origins[n] : k.origin, k, message);
}

}  // namespace tetsuame::namelist
