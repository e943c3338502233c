#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <namelist/schema.hpp>
#include <namelist/text.hpp>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace tetsuame::namelist {

namespace {

// One assignment on its way to its key.
struct context {
  const document& input;
  const assignment& from;
  const std::string& group;
  const key& to;

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

int convert(const context& c, const value& v, int*) {
  const std::int64_t number = convert(c, v, static_cast<std::int64_t*>(nullptr));
  if (!std::in_range<int>(number))
    c.fail(&v, fmt::format("expected {}, found {}, which 32 bits cannot hold", c.to.expected(), number));
  return static_cast<int>(number);
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

std::string convert(const context& c, const value& v, std::string*) {
  const std::vector<std::string>& choices = c.to.info.choices;
  const bool bare = v.what == value::kind::word;
  if (bare && c.from.set.empty()) {
    const std::string meant = choices.empty() ? v.content : nearest(v.content, choices);
    c.fail(&v, fmt::format("expected {} in quotes, found {}; did you mean {}?", c.to.expected(), excerpt(v.content),
                           quote(excerpt(meant))));
  }
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
void assign(const context& c, T& to, std::vector<bool>&) {
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
  const auto size = static_cast<std::int64_t>(c.to.info.maximum_size);
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

template <class T>
void assign(const context& c, std::vector<T>& to, std::vector<bool>& filled) {
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
      const auto at = static_cast<std::size_t>(e.first + static_cast<std::int64_t>(used) * e.stride - 1);
      if (at >= to.size()) {
        to.resize(at + 1);
        filled.resize(at + 1, false);
      }
      to[at] = content;
      filled[at] = true;
    }
  }
}

template <class Items>
std::vector<std::string> names(const Items& items) {
  std::vector<std::string> result;
  for (const auto& item : items) result.push_back(item.name);
  return result;
}

template <class Items>
auto find_name(Items& items, const std::string& name) {
  return std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
}

std::size_t array_size(const target& bound) {
  return std::visit(
      [](auto* to) -> std::size_t {
        if constexpr (requires { to->resize(0); } && !std::is_same_v<decltype(to), std::string*>)
          return to->size();
        else
          return 0;
      },
      bound);
}

constexpr const char* expert_group = "expert";

// A key of &expert is as well known in the group that declared it. The end of the group's keys: there is none.
std::vector<key>::iterator find_in_group_or_expert(std::vector<key_group>& groups, key_group& g,
                                                   const std::string& name) {
  const auto own = find_name(g.keys, name);
  const auto expert = find_name(groups, expert_group);
  if (own != g.keys.end() || expert == groups.end()) return own;
  const auto rare = std::ranges::find_if(
      expert->keys, [&](const key& k) { return k.declared_as == name && k.declared_in == g.name; });
  return rare != expert->keys.end() ? rare : own;
}

[[noreturn]] void fail_unknown_key(const std::string& where, const key_group& g, const std::string& name,
                                   const std::vector<key_group>& groups) {
  auto known = names(g.keys);
  if (const auto expert = find_name(groups, expert_group); expert != groups.end() && g.name != expert_group)
    for (const key& k : expert->keys)
      if (k.declared_in == g.name) known.push_back(k.declared_as);
  std::string hint =
      known.empty() ? "the group has no keys" : fmt::format("the nearest valid key is {}", nearest(name, known));
  for (const key_group& other : groups)
    if (find_name(other.keys, name) != other.keys.end())
      hint += fmt::format("; &{} has a key of this name", other.name);
  foundation::fail_input(fmt::format("{}: &{}: unknown key {}; {}", where, g.name, name, hint));
}

[[noreturn]] void fail_unknown_group(const std::string& where, const std::string& name,
                                     const std::vector<key_group>& groups) {
  const std::string hint =
      groups.empty() ? "there are none" : "the nearest valid group is &" + nearest(name, names(groups));
  foundation::fail_input(fmt::format("{}: unknown group &{}; {}", where, name, hint));
}

bool default_is_allowed(const key& k) {
  const auto real_is_allowed = [&](double number) { return !std::isfinite(number) || k.allows(number); };
  const auto text_is_allowed = [&](const std::string& text) {
    return k.info.choices.empty() || std::count(k.info.choices.begin(), k.info.choices.end(), text) > 0;
  };
  return std::visit(
      [&](auto* to) {
        using T = std::remove_pointer_t<decltype(to)>;
        if constexpr (std::is_same_v<T, bool>)
          return true;
        else if constexpr (std::is_same_v<T, std::string>)
          return text_is_allowed(*to) || (k.info.required && to->empty());
        else if constexpr (std::is_same_v<T, std::vector<std::string>>)
          return std::all_of(to->begin(), to->end(), text_is_allowed);
        else if constexpr (requires { to->has_value(); })
          return !*to || real_is_allowed(static_cast<double>(**to));
        else if constexpr (requires { to->begin(); })
          return std::all_of(to->begin(), to->end(), [&](auto x) { return real_is_allowed(static_cast<double>(x)); });
        else
          return real_is_allowed(static_cast<double>(*to));
      },
      k.bound);
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
  older_names_.push_back({group, older, key});
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
  if (!default_is_allowed(k))
    throw std::logic_error(fmt::format("{}: the default {} is not {}", full, k.default_text, k.expected()));
  if (array_size(bound) > k.info.maximum_size)
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
  for (key_group& g : groups_)
    for (key& k : g.keys) {
      k.origin = "default";
      k.given_in.clear();
      k.filled.assign(array_size(k.bound), true);
    }
  for (const namelist::group& from : input.groups()) {
    const auto g = find_name(groups_, from.name);
    if (g == groups_.end() && std::ranges::find(passed_over_, from.name) != passed_over_.end()) continue;
    if (g == groups_.end()) {
      const bool in_file = from.line > 0;
      fail_unknown_group(
          in_file ? fmt::format("{}:{}", input.name(), from.line) : input.where(from.assignments.front()), from.name,
          groups_);
    }
    for (const assignment& a : from.assignments) {
      const auto older =
          std::ranges::find_if(older_names_, [&](const auto& n) { return n[0] == g->name && n[1] == a.key; });
      const auto k = find_in_group_or_expert(groups_, *g, older == older_names_.end() ? a.key : (*older)[2]);
      if (k == g->keys.end() &&
          std::ranges::find(keys_passed_over_, std::pair(g->name, a.key)) != keys_passed_over_.end()) {
        passed_.push_back("&" + g->name + " " + a.key);
        continue;
      }
      if (k == g->keys.end()) fail_unknown_key(input.where(a), *g, a.key, groups_);
      if (!k->given_in.empty() && k->given_in != g->name)
        foundation::fail_input(
            fmt::format("{}: &{} {}: is given in &{} too", input.where(a), g->name, a.key, k->given_in));
      const context c{input, a, g->name, *k};
      std::visit([&](auto* to) { assign(c, *to, k->filled); }, k->bound);
      const auto written =
          std::find_if(a.values.begin(), a.values.end(), [](const value& v) { return v.what != value::kind::null; });
      if (written == a.values.end()) continue;
      k->origin = input.where(a, *written);
      k->given_in = g->name;
    }
  }
  check_unassigned(input.name());
}

void schema::check_unassigned(const std::string& input_name) const {
  for (const key_group& g : groups_)
    for (const key& k : g.keys) {
      if (k.info.required && k.given_in.empty())
        foundation::fail_input(fmt::format("{}: &{} {} is missing: expected {}{}{}", input_name, g.name, k.name,
                                           k.expected(), k.info.meaning.empty() ? "" : ": ", k.info.meaning));
      const auto gap = std::find(k.filled.begin(), k.filled.end(), false);
      if (gap != k.filled.end())
        foundation::fail_input(fmt::format("{}: &{} {}: element {} has neither a value nor a default", k.origin, g.name,
                                           k.name, gap - k.filled.begin() + 1));
    }
}

std::pair<const key&, const std::string&> schema::find(const std::string& group, const std::string& name) const {
  for (const auto& g : groups_)
    for (const auto& k : g.keys)
      if ((k.name == lower(name) && g.name == lower(group)) ||
          (k.declared_as == lower(name) && k.declared_in == lower(group)))
        return {k, g.name};
  throw std::logic_error(fmt::format("namelist key {}.{} is not declared", group, name));
}

std::string schema::where(const std::string& group, const std::string& key) const {
  return find(group, key).first.origin;
}

bool schema::given(const std::string& group, const std::string& key) const {
  return !find(group, key).first.given_in.empty();
}

bool schema::changed(const std::string& group, const std::string& key) const {
  const auto& k = find(group, key).first;
  return k.value() != k.default_text;
}

void schema::fail(const std::string& group, const std::string& name, const std::string& message) const {
  const auto [k, stands_in] = find(group, name);
  foundation::fail_input(
      fmt::format("{}: &{} {}: {}", k.origin == "default" ? "default value" : k.origin, stands_in, k.name, message));
}

}  // namespace tetsuame::namelist
