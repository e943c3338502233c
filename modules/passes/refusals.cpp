#include <fmt/format.h>

#include <passes/field_sets.hpp>
#include <passes/refusals.hpp>
#include <stdexcept>

namespace tetsuame::passes {

namespace {

class check {
 public:
  check(const std::vector<pass>& passes, const known_fields& known) : known_(known) {
    for (const auto* some : {&known.integrated, &known.remembered, &known.given}) insert(written_, *some);
    for (const auto& p : passes) of(p);
    for (const field* f : known.integrated)
      if (!rates_.contains(f)) fail(fmt::format("no pass writes the rate of {}", known.name(f)));
  }

 private:
  [[noreturn]] static void fail(const std::string& text) { throw std::logic_error("list of passes: " + text); }

  void of(const pass& p) {
    const auto need = [&](const fields& some, const char* verb) {
      for (const field* f : some)
        if (!written_.contains(f))
          fail(fmt::format("'{}' {} {}, which no pass before it writes", p.stage, verb, known_.name(f)));
    };
    need(p.uses.reads, "reads");
    need(p.uses.at_neighbours, "reads");
    need(p.uses.updates, "updates");
    for (const field* f : p.uses.writes) {
      if (const auto other = writers_.find(f); other != writers_.end())
        fail(fmt::format("'{}' and '{}' both write {}", other->second, p.stage, known_.name(f)));
      if (written_.contains(f)) fail(fmt::format("'{}' writes {}, which is known already", p.stage, known_.name(f)));
      written_.insert(f);
      writers_[f] = p.stage;
    }
    for (const field* f : p.uses.gives)
      if (const auto [other, is_new] = givers_.try_emplace(f, p.stage); !is_new)
        fail(fmt::format("'{}' and '{}' both give {} behind walls", other->second, p.stage, known_.name(f)));
    of_rates(p);
  }
  void of_rates(const pass& p) {
    field_set integrated;
    insert(integrated, known_.integrated);
    for (const auto* some : {&p.uses.rates, &p.uses.accumulates})
      for (const field* f : *some) {
        if (!integrated.contains(f))
          fail(fmt::format("'{}' writes the rate of {}, which is not integrated", p.stage, known_.name(f)));
        if (const auto other = rates_.find(f); other != rates_.end())
          fail(fmt::format("'{}' has written the rate of {} before '{}'", other->second, known_.name(f), p.stage));
      }
    for (const field* f : p.uses.rates) rates_[f] = p.stage;
  }

  const known_fields& known_;
  field_set written_;
  std::map<const field*, const char*> writers_, givers_, rates_;
};

}  // namespace

void refuse_faults(const std::vector<pass>& passes, const known_fields& known) { check(passes, known); }

}  // namespace tetsuame::passes
