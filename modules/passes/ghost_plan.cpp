#include <passes/ghost_plan.hpp>

namespace tetsuame::passes {

using kind = pass::kind;

field_set asked_of_ghosts(const pass& p, const known_fields& known) {
  field_set all;
  insert(all, p.uses.at_neighbours);
  if (p.of == kind::sum || !all.empty()) insert(all, known.positions);
  const auto insert_what_images_follow_from = [&](const fields& some) {
    for (const field* f : some)
      if (const auto by = known.image_by.find(f); by != known.image_by.end())
        all.insert(by->second.begin(), by->second.end());
  };
  if (known.images) insert_what_images_follow_from(p.uses.at_neighbours);
  if (known.images && p.everywhere) insert_what_images_follow_from(p.uses.reads);
  return all;
}

ghost_plan::ghost_plan(const std::vector<pass>& passes, const known_fields& known)
    : computed(passes.size(), false), passes_(passes), known_(known) {
  insert(given_, known.given);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const auto& p = passes[i];
    field_set brings;
    insert(brings, p.uses.spreads);
    for (const auto* some : {&p.uses.writes, &p.uses.updates})
      for (const field* f : *some)
        if (!brings.contains(f)) complete_by[f] = i;
    computed[i] = p.of == kind::each && p.everywhere;
  }
  find_travelling();
  for (std::size_t i = passes.size(); i-- > 0;) {
    if (computed[i] || !can_be_computed(i)) continue;
    const std::size_t before = travels.size();
    computed[i] = true;
    find_travelling();
    if (travels.size() <= before) continue;
    computed[i] = false;
    find_travelling();
  }
}

// Ghosts have values that are complete: not those from before a later pass.
bool ghost_plan::can_be_computed(std::size_t i) const {
  const auto& p = passes_[i];
  if (p.of != kind::each || !p.uses.updates.empty() || !any_in(p.uses.writes, needed_)) return false;
  return std::all_of(p.uses.reads.begin(), p.uses.reads.end(), [&](const field* f) {
    const auto by = complete_by.find(f);
    return by == complete_by.end() || by->second < i;
  });
}
// By what is computed.
void ghost_plan::find_travelling() {
  needed_.clear();
  writer.clear();
  travels.clear();
  for (std::size_t i = passes_.size(); i-- > 0;) {
    const auto& p = passes_[i];
    for (const field* f : p.uses.spreads) needed_.erase(f);
    insert(needed_, asked_of_ghosts(p, known_));
    if (!computed[i] || !(p.everywhere || any_in(p.uses.writes, needed_))) continue;
    insert(needed_, p.uses.reads);
    for (const field* f : p.uses.writes) writer[f] = i;
  }
  for (const field* f : needed_)
    if (!given_.contains(f) && !writer.contains(f)) travels.insert(f);
}

}  // namespace tetsuame::passes
