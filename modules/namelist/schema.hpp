// What a program's input may hold. Each module declares its groups and keys and binds
// them to its own option structs, whose value at declaration is the default:
//
//   options o;                                     // double g = 10.0;
//   namelist::schema input;
//   input.group("gravity", "uniform gravity");
//   input.add("gravity", "g", o.g, {.unit = "m/s2", .minimum = 0.0, .meaning = "acceleration"});
//   input.read(namelist::parse_file("case.nml"));  // o.g is what the file says
//
// Reading follows Fortran: the last of several assignments counts; an array's elements not given keep their defaults.
// Unlike Fortran, an unknown group or key, a value of the wrong type, not finite, out of range or too much is an error
// of status bad_input, which names file and line, what was expected and the nearest valid name. Wrong declarations (a
// key twice, a default out of its range) are std::logic_error. Keys that only an expert turns stand in one group
// &expert behind all others, and are known in the group that declares them too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <foundation/error.hpp>
#include <iosfwd>
#include <limits>
#include <map>
#include <namelist/document.hpp>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace tetsuame::namelist {

// What a text names: nothing, a file that the run reads, or one that it reads only where it does not go on from a
// checkpoint.
enum class file_of { nothing, run, start };

struct key_info {
  std::string unit = "";
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool exclusive_minimum = false;
  std::vector<std::string> choices = {};  // of a text: matched in any case, stored as spelled here
  std::size_t maximum_size = 4096;        // of an array; at least its default's size
  // Of an array: elements that are not given before the last one are zero, empty, or the first of the choices, and no
  // error.
  bool sparse = false;
  bool may_be_left_open = false;  // of a sparse array of reals: such an element is not a number, and not zero
  // Of an optional number that follows from other keys where it is not given: a resolved input leaves it open, with
  // what it came to as a comment, so that it follows them again where a restart changes these.
  bool stays_open = false;
  // Whether a restart may change it: how long a run is, how it is written, and who does the work. All else is the
  // state's.
  bool may_change = false;
  bool expert = false;           // stands in &expert
  std::string expert_name = "";  // there, where the key's own says too little without its group
  // Of a text, or of each of a list: a path that begins at the folder of the input, or that of --set at the current
  // one.
  file_of file = file_of::nothing;
  bool formula = false;  // a text that may also be a number, without quotes
  std::string meaning = "";
};
// Of a number above 0.
inline key_info positive(std::string unit, std::string meaning) {
  return {.unit = std::move(unit), .minimum = 0.0, .exclusive_minimum = true, .meaning = std::move(meaning)};
}
inline key_info between(double minimum, double maximum, std::string meaning) {
  return {.minimum = minimum, .maximum = maximum, .meaning = std::move(meaning)};
}
// Above 0.
inline key_info up_to(double maximum, std::string meaning) {
  return {.minimum = 0.0, .maximum = maximum, .exclusive_minimum = true, .meaning = std::move(meaning)};
}
inline key_info for_expert(key_info k) {
  k.expert = true;
  return k;
}
inline key_info changing(key_info k) {
  k.may_change = true;
  return k;
}

// The targets outlive the schema and stay where they are.
using target = std::variant<double*, std::int64_t*, bool*, std::string*, std::optional<double>*, std::vector<double>*,
                            std::vector<std::int64_t>*, std::vector<std::string>*>;

struct key {
  std::string name;
  std::string declared_in, declared_as;  // the group and the name there, also of a key of &expert
  std::string older = {};                // an older name there; empty: none
  target bound;
  key_info info;
  std::string default_text;          // as in a namelist; empty: none
  std::string origin = "default";    // "file:line", "--set group.key=value"
  std::string given_in;              // the group, of its own or &expert
  std::vector<bool> filled;          // array: which elements have a value
  std::vector<std::string> origins;  // and where each came from; empty, or shorter: `origin`

  std::string type_name() const;  // "integer", "list of reals", …
  std::string limits() const;     // "> 0", "in (0, 1]", "one of 'a', 'b'"; empty: none
  std::string expected() const;   // type, unit and limits, for messages
  std::string value() const;      // as in a namelist; empty if there is none or it is not finite
  bool allows(double number) const;
};

// A file that the input names.
struct named_file {
  std::string where;  // "file:line: &group key"
  std::string* path;  // of the option that holds it, completed; not empty
  file_of what;
};
// Of a key of a resolved input, "&group key".
struct key_at_restart {
  bool may_change;
  std::string where;  // its value came from
};

struct key_group {
  std::string name, meaning;
  std::vector<key> keys;
};

class schema {
 public:
  // May be called again for the same name: modules may share a group.
  void group(const std::string& name, const std::string& meaning);
  // A group that other programs read from the same file: passed over, whatever is in it.
  void pass_over(const std::string& group);
  // Keys of a group that is there, which another program reads: passed over as well, and told by passed().
  void pass_over(const std::string& group, const std::vector<std::string>& keys);
  // An older name of a key that is declared in this group.
  void also_known(const std::string& group, const std::string& older, const std::string& key);
  const std::vector<std::string>& passed() const { return passed_; }  // "&group key", as the input has them
  void add(const std::string& group, const std::string& key, target bound, key_info info = {});

  template <class T>
  void add(const std::string& group, const std::string& key, T& bound, key_info info = {}) {
    add(group, key, target(&bound), std::move(info));
  }

  bool has_group(const std::string& name) const;
  // "key=value" as "group.key=value", of the one group that declares the key.
  std::string with_group(const std::string& argument) const;

  // Assigns and validates. After an error some targets may have been assigned.
  void read(const document& input);

  // Every group and key with type, unit, default, range and meaning as comments, and the defaults as values: a valid
  // input. What has no default is printed as a null value, `key =`.
  void describe(std::ostream& out) const;
  // All keys with what the targets hold now, in a form that reads back exactly.
  void write_resolved(std::ostream& out) const;

  // Where the value came from: "file:line", "--set group.key=value" or "default".
  std::string where(const std::string& group, const std::string& key) const;
  bool given(const std::string& group, const std::string& key) const;
  std::map<std::string, key_at_restart> at_restart() const;  // by "&group key"
  // Whether the target holds another value than the default: a resolved input gives every key.
  bool changed(const std::string& group, const std::string& key) const;
  // In the order of their declaration; before read() there are none.
  std::vector<named_file> files() const;
  // For checks that span keys: an error placed at this key, exit status 2.
  [[noreturn]] void fail(const std::string& group, const std::string& key, const std::string& message) const;
  // Of element n of a list, from 0: placed where that is given.
  [[noreturn]] void fail_at(const std::string& group, const std::string& key, std::size_t n,
                            const std::string& message) const;
  // work() on what the input says, before anything else has begun: what it fails at, where the input is not known, is
  // placed at this key.
  template <class Work>
  auto placed(const std::string& group, const std::string& key, Work&& work) const {
    try {
      return work();
    } catch (const foundation::error& e) {
      using foundation::exit_status;
      if (e.status() != exit_status::bad_input && e.status() != exit_status::calculation_failed) throw;
      fail(group, key, e.what());
    }
  }

 private:
  const key& find(const std::string& group, const std::string& key) const;
  std::vector<key_group> groups_;
  std::vector<std::string> passed_over_;                               // groups
  std::vector<std::pair<std::string, std::string>> keys_passed_over_;  // group, key
  std::vector<std::string> passed_;
};

}  // namespace tetsuame::namelist
