// What ghosts have: fields that travel, and fields that are computed of them from others that are there.
#pragma once

#include <passes/field_sets.hpp>

namespace tetsuame::passes {

// What a pass asks of ghosts. Whatever looks at neighbours looks at their places; an image may follow from more than
// its own field.
field_set asked_of_ghosts(const pass& p, const known_fields& known);

// Which `each` are computed of ghosts too, and which fields travel: as few as can be.
struct ghost_plan {
  std::vector<bool> computed;  // by pass
  field_set travels;
  std::map<const field*, std::size_t> writer;       // of what is computed of ghosts
  std::map<const field*, std::size_t> complete_by;  // the last pass that writes a field or adds to it

  ghost_plan(const std::vector<pass>& passes, const known_fields& known);

 private:
  bool can_be_computed(std::size_t i) const;
  void find_travelling();

  const std::vector<pass>& passes_;
  const known_fields& known_;
  field_set given_, needed_;
};

}  // namespace tetsuame::passes
