// The group &region of a planet: materials of layers, temperatures and velocities somewhere, by places from the centre.
#include <fmt/format.h>

#include <planet/options.hpp>

namespace tetsuame::planet {

namespace {

regions::abilities what_regions_give(const options& o) {
  return {.materials = o.names,
          .more_materials = true,
          .named_by = "&layer",
          .origin = " from the planet's centre",
          .temperature = true,
          .velocity = true};
}

}  // namespace

void declare_regions(namelist::schema& schema, options& o) {
  regions::declare(schema, what_regions_give(o), o.of_regions);
}

void resolve_regions(const namelist::schema& schema, options& o) {
  const auto& box = o.gas.domain;
  o.regions =
      regions::all(schema, what_regions_give(o), o.of_regions, static_cast<int>(box.dimension), box.length, box.dx());
  if (!o.regions.any()) return;
  if (o.impact_of) schema.fail("impact", "target", "a snapshot says what is where, and so does &region");
  if (!o.gas.common.start.file.empty())
    schema.fail("initial", "file", "a snapshot says what is where, and so does &region");
  if (o.mode) schema.fail("planet", "degree", "is of layers by the profile: no &region");
  if (!o.gas.common.start.settles()) return;
  using regions::what;
  for (const what w : {what::velocity_x, what::velocity_y, what::velocity_z})
    if (o.regions.give(w)) schema.fail("initial", "settle", "the start moves: &region gives velocities");
}

changed_by_regions::changed_by_regions(const options& o) : o_(o) {
  for (const auto& m : o.materials) materials_.push_back(eos::make(m));
}

void changed_by_regions::apply(const gas::point& from_centre, gas::placed& p) {
  const auto given = o_.regions.at(from_centre, *p.now.temperature, counts_);
  for (std::size_t a = 0; a < 3; ++a) p.now.v[a] = given.velocity[a].value_or(p.now.v[a]);
  if (!given.material && !given.temperature) return;
  if (given.material) p.now.material = o_.material_of(static_cast<std::size_t>(*given.material));
  if (given.temperature) p.now.temperature = *given.temperature;
  const std::size_t layer = o_.layer_of(p.now.material);
  double rho = 0.0;
  try {
    rho = eos::density(materials_[layer], p.now.p, *p.now.temperature);
  } catch (const foundation::error& e) {
    foundation::fail_input(fmt::format("&region: of layer '{}': {}", o_.names[layer], e.what()));
  }
  p.mass *= rho / p.now.rho;
  p.now.rho = rho;
}

void changed_by_regions::expect_used() const { o_.regions.expect_used(counts_); }

}  // namespace tetsuame::planet
