#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <passes/ghost_plan.hpp>
#include <passes/refusals.hpp>
#include <stdexcept>
#include <utility>

namespace tetsuame::passes {

namespace {

using kind = pass::kind;

class builder {
 public:
  builder(const std::vector<pass>& passes, const known_fields& known)
      : passes_(passes), known_(known), plan_(passes, known) {
    insert(positions_, known.positions);
    for (field_set* ready : {&ghosts_, &walls_, &owned_}) insert(*ready, known.given);
    insert(owned_, known.integrated);
    insert(owned_, known.remembered);
    if (known.images) insert(walls_, known.positions);
    for (const auto& p : passes) {
      if (p.of == kind::walls) insert(given_by_passes_, p.uses.gives);
      if (p.of == kind::sum && p.sees_walls) insert(asked_of_walls_, p.uses.at_neighbours);
      if (p.everywhere) insert(asked_of_walls_, p.uses.reads);
    }
    find_groups();
  }

  std::vector<step> build() {
    for (std::size_t i = 0; i < passes_.size(); ++i) {
      begin_if_due(i);
      const auto& p = passes_[i];
      if (p.of == kind::each) add_each(i);
      if (p.of == kind::sum) add_sum(i);
      if (p.of == kind::walls) is_lazy(p) ? waiting_.push_back(i) : add_once(i);
      if (p.of == kind::whole) add_once(i);
    }
    flush();
    return std::move(steps_);
  }

 private:
  // What travels together: all that one pass is the first to need.
  struct group {
    std::vector<field*> all;
    std::size_t from = 0;  // the first pass before which all is complete
  };

  static bool is_lazy(const pass& p) { return p.uses.writes.empty() && p.uses.updates.empty(); }

  // The fields that have to travel so that this one is known of ghosts.
  void collect(const field* f, const field_set& there, field_set& to_send) const {
    if (there.contains(f)) return;
    if (const auto w = plan_.writer.find(f); w != plan_.writer.end()) {
      for (const field* g : passes_[w->second].uses.reads) collect(g, there, to_send);
      return;
    }
    if (plan_.travels.contains(f)) to_send.insert(f);
  }
  // What a pass asks of ghosts, with what the boundary treatment needs for it.
  field_set asked_by(const pass& p) const {
    field_set all;
    if (p.of == kind::each) {
      if (!p.everywhere) return all;
      insert(all, p.uses.reads);
      insert(all, asked_of_ghosts(p, known_));
      return all;
    }
    all = asked_of_ghosts(p, known_);
    if (p.of == kind::sum && p.sees_walls)
      for (const auto& other : passes_)
        if (other.of == kind::walls && is_lazy(other)) {
          field_set gives;
          insert(gives, other.uses.gives);
          if (any_in(p.uses.at_neighbours, gives)) insert(all, other.uses.at_neighbours);
        }
    return all;
  }
  void find_groups() {
    field_set there, at_start;
    insert(there, known_.given);
    // What is known from the start goes with the first.
    for (const auto* some : {&known_.integrated, &known_.remembered})
      for (const field* f : *some)
        if (plan_.travels.contains(f) && !plan_.complete_by.contains(f)) at_start.insert(f);
    for (const auto& p : passes_) {
      if (p.of == kind::walls && is_lazy(p)) continue;
      field_set to_send;
      for (const field* f : asked_by(p)) collect(f, there, to_send);
      insert(there, p.uses.spreads);
      if (to_send.empty()) continue;
      insert(to_send, std::exchange(at_start, {}));
      group g;
      const auto add = [&](const fields& some) {
        for (field* f : some)
          if (to_send.erase(f) > 0) g.all.push_back(f);
      };
      add(known_.positions);
      add(known_.integrated);
      add(known_.remembered);
      for (const auto& writer : passes_) add(writer.uses.writes);
      for (const field* f : g.all)
        if (const auto by = plan_.complete_by.find(f); by != plan_.complete_by.end())
          g.from = std::max(g.from, by->second + 1);
      there.insert(g.all.begin(), g.all.end());
      groups_.push_back(std::move(g));
    }
  }

  void begin_if_due(std::size_t i) {
    if (under_way_ || next_group_ == groups_.size() || groups_[next_group_].from > i || !window_.empty()) return;
    const auto& g = groups_[next_group_];
    step s{step::kind::begin_exchange};
    for (field* f : g.all) positions_.contains(f) ? void(s.positions = true) : s.fields.push_back(f);
    steps_.push_back(std::move(s));
    under_way_ = &g;
    ++next_group_;
  }
  void end_exchange() {
    if (!under_way_) return;
    steps_.push_back({step::kind::end_exchange});
    steps_.back().positions = any_in(under_way_->all, positions_);
    ghosts_.insert(under_way_->all.begin(), under_way_->all.end());
    under_way_ = nullptr;
  }

  void push_each(std::size_t i, step::block where) {
    if (steps_.empty() || steps_.back().of != step::kind::each || steps_.back().where != where)
      steps_.push_back({.of = step::kind::each, .where = where});
    steps_.back().passes.push_back(i);
  }
  void add_each(std::size_t i) {
    const auto& p = passes_[i];
    if (!window_.empty()) flush();
    push_each(i, step::block::owned);
    insert(owned_, p.uses.writes);
    if (plan_.computed[i]) of_ghosts_.push_back(i);
    if (p.everywhere) of_walls_.push_back(i);
  }

  // Of ghosts and behind walls: all that can be known by now.
  void resolve() {
    for (bool more = true; more;) {
      more = false;
      const auto take = [&](std::vector<std::size_t>& waiting, const auto& f) {
        for (auto at = waiting.begin(); at != waiting.end();) {
          if (!f(*at)) {
            ++at;
            continue;
          }
          at = waiting.erase(at);
          more = true;
        }
      };
      take(of_ghosts_, [&](std::size_t i) {
        if (!all_in(passes_[i].uses.reads, ghosts_)) return false;
        push_each(i, step::block::ghosts);
        insert(ghosts_, passes_[i].uses.writes);
        return true;
      });
      more = fill_images() || more;
      take(of_walls_, [&](std::size_t i) {
        if (known_.any_walls && !all_in(passes_[i].uses.reads, walls_)) return false;
        push_each(i, step::block::walls);
        insert(walls_, passes_[i].uses.writes);
        return true;
      });
      take(waiting_, [&](std::size_t i) {
        const auto& p = passes_[i];
        if (!all_in(p.uses.at_neighbours, ghosts_) || !all_in(p.uses.at_neighbours, owned_) ||
            !all_in(p.uses.reads, owned_))
          return false;
        steps_.push_back({.of = step::kind::once, .passes = {i}});
        insert(walls_, p.uses.gives);
        return true;
      });
    }
  }
  bool fill_images() {
    if (!known_.images) return false;
    field_set by_each;
    for (const auto& p : passes_)
      if (p.everywhere) insert(by_each, p.uses.writes);
    step s{step::kind::images};
    const auto follows_from_known = [&](const field* f) {
      const auto by = known_.image_by.find(f);
      return by == known_.image_by.end() || std::ranges::all_of(by->second, [&](const field* source) {
               return owned_.contains(source) && ghosts_.contains(source);
             });
    };
    const auto add = [&](const fields& some) {
      for (field* f : some)
        if (follows_from_known(f) && asked_of_walls_.contains(f) && ghosts_.contains(f) && owned_.contains(f) &&
            !walls_.contains(f) && !given_by_passes_.contains(f) && !by_each.contains(f)) {
          s.fields.push_back(f);
          walls_.insert(f);
        }
    };
    add(known_.integrated);
    add(known_.remembered);
    for (const auto& p : passes_) add(p.uses.writes);
    if (s.fields.empty()) return false;
    steps_.push_back(std::move(s));
    return true;
  }

  // Sums whose rows at the border wait for ghosts get them.
  void flush() {
    if (window_.empty()) return;
    end_exchange();
    resolve();
    for (const std::size_t i : window_) {
      require(i);
      steps_.push_back({.of = step::kind::sum, .passes = {i}, .which = rows::border});
      insert(owned_, passes_[i].uses.writes);
    }
    window_.clear();
    pending_.clear();
  }

  bool is_complete(const pass& p) const {
    const field_set asked = asked_by(p);
    if (!all_in(asked, ghosts_)) return false;
    return !known_.any_walls || p.of != kind::sum || !p.sees_walls || all_in(p.uses.at_neighbours, walls_);
  }
  void require(std::size_t i) const {
    const auto& p = passes_[i];
    for (const field* f : asked_by(p))
      if (!ghosts_.contains(f))
        throw std::logic_error(
            fmt::format("list of passes: '{}' reads {} of ghosts, which do not have it", p.stage, known_.name(f)));
    if (!known_.any_walls || p.of != kind::sum || !p.sees_walls) return;
    for (const field* f : p.uses.at_neighbours)
      if (!walls_.contains(f))
        throw std::logic_error(
            fmt::format("list of passes: '{}' reads {} behind walls, where no pass gives it", p.stage, known_.name(f)));
  }

  void add_sum(std::size_t i) {
    const auto& p = passes_[i];
    // What it reads is to be complete, of the owned particles.
    if (any_in(p.uses.reads, pending_) || any_in(p.uses.at_neighbours, pending_) || any_in(p.uses.updates, pending_))
      flush();
    begin_if_due(i);
    if (window_.empty()) {
      // An exchange that brings nothing to this pass goes on.
      if (under_way_) {
        const field_set here(under_way_->all.begin(), under_way_->all.end());
        field_set to_send;
        for (const field* f : asked_by(p)) collect(f, ghosts_, to_send);
        if (to_send.empty()) resolve();
      } else {
        resolve();
      }
      if (!under_way_ || is_complete(p)) {
        require(i);
        steps_.push_back({.of = step::kind::sum, .passes = {i}});
        insert(owned_, p.uses.writes);
        return;
      }
      field_set to_send;
      for (const field* f : asked_by(p)) collect(f, ghosts_, to_send);
      if (!all_in(to_send, field_set(under_way_->all.begin(), under_way_->all.end()))) {
        end_exchange();
        return add_sum(i);
      }
    } else {
      // With those that wait, if it waits for the same.
      field_set there = ghosts_, to_send;
      if (under_way_) there.insert(under_way_->all.begin(), under_way_->all.end());
      for (const field* f : asked_by(p)) collect(f, there, to_send);
      if (!to_send.empty()) {
        flush();
        return add_sum(i);
      }
    }
    steps_.push_back({.of = step::kind::sum, .passes = {i}, .which = rows::interior});
    window_.push_back(i);
    insert(pending_, p.uses.writes);
    insert(pending_, p.uses.updates);
  }

  void add_once(std::size_t i) {
    const auto& p = passes_[i];
    flush();
    if (!p.uses.spreads.empty()) end_exchange();  // its own come next
    resolve();
    while (!all_in(p.uses.at_neighbours, ghosts_)) {
      begin_if_due(i);
      if (!under_way_) break;
      end_exchange();
      resolve();
    }
    if (p.of == kind::whole && !all_in(p.uses.at_neighbours, ghosts_)) require(i);
    steps_.push_back({.of = step::kind::once, .passes = {i}});
    insert(owned_, p.uses.writes);
    insert(ghosts_, p.uses.spreads);
    insert(walls_, p.uses.gives);
  }

  const std::vector<pass>& passes_;
  const known_fields& known_;
  const ghost_plan plan_;
  field_set positions_, given_by_passes_, asked_of_walls_;
  std::vector<group> groups_;
  std::size_t next_group_ = 0;
  const group* under_way_ = nullptr;

  field_set owned_, ghosts_, walls_;                         // who is known where
  std::vector<std::size_t> of_ghosts_, of_walls_, waiting_;  // `each`, and passes of walls, that are due there
  std::vector<std::size_t> window_;                          // sums whose rows at the border wait
  field_set pending_;                                        // what they write
  std::vector<step> steps_;
};

}  // namespace

std::vector<step> schedule(const std::vector<pass>& passes, const known_fields& known) {
  refuse_faults(passes, known);
  return builder(passes, known).build();
}

std::string describe(const std::vector<step>& steps, const std::vector<pass>& passes, const known_fields& known) {
  std::string text;
  for (const auto& s : steps) {
    std::vector<std::string> names;
    if (s.positions) names.emplace_back("positions");
    for (const auto i : s.passes) names.emplace_back(passes[i].stage);
    for (const auto* f : s.fields) names.push_back(known.name(f));
    constexpr std::array what{"begin exchange", "end exchange", "each", "sum", "images", "once"};
    constexpr std::array where{"", " of ghosts", " behind walls"}, which{"", ", interior", ", border"};
    text += fmt::format("{}{} {}{}\n", what[static_cast<std::size_t>(s.of)], where[static_cast<std::size_t>(s.where)],
                        fmt::join(names, " "), which[static_cast<std::size_t>(s.which)]);
  }
  return text;
}

}  // namespace tetsuame::passes
