#include <fmt/format.h>

#include <eos/caloric.hpp>
#include <foundation/error.hpp>
#include <gas/setup_parts.hpp>
#include <memory>

namespace tetsuame::gas {

namespace {

// A start that regions change, by the sides' gases or equations of state.
class changed_start {
 public:
  changed_start(const options& o, const setup& test)
      : sides_{o.shock.l, o.shock.r}, left_(test.material_l), before_(test.start), regions_(o.regions) {
    if (o.any_eos())
      for (const auto& side : sides_) materials_.emplace_back(eos_of(side));
  }

  state at(const point& x) {
    state s = before_(x);
    const auto v = regions_.at(x, sides_[side_of(s)].temperature.value_or(0.0), counts_);
    if (v.material) s.material = *v.material == 0 ? left_ : 1 - left_;
    for (std::size_t a = 0; a < 3; ++a)
      if (v.velocity[a]) s.v[a] = *v.velocity[a];
    if (v.pressure) s.p = *v.pressure;
    if (v.density) s.rho = *v.density;
    materials_.empty() ? complete_gas(x, v, s) : complete_material(v, s);
    return s;
  }
  void expect_used() const { regions_.expect_used(counts_); }

 private:
  std::size_t side_of(const state& s) const { return s.material == left_ ? 0 : 1; }

  void complete_gas(const point& x, const regions::values& v, state& s) const {
    const auto& side = sides_[side_of(s)];
    if (v.energy) s.p = (*side.gamma - 1.0) * s.rho * *v.energy - *side.gamma * side.p_infinity;
    if (!(s.p + side.p_infinity > 0.0))
      foundation::fail_input(fmt::format(
          "&region: the gas would start with p = {:.6g} Pa at ({:.6g}, {:.6g}, {:.6g}) m: expected more than {:.6g}",
          s.p, x[0], x[1], x[2], -side.p_infinity));
  }
  void complete_material(const regions::values& v, state& s) const {
    const auto n = side_of(s);
    s.temperature = v.temperature ? *v.temperature : *sides_[n].temperature;
    if (!v.density && (v.material || v.pressure || v.temperature))
      s.rho = eos::density(eos_of(sides_[n]), s.p, *s.temperature);
    if (v.energy) s.temperature = materials_[n].temperature(s.rho, *v.energy);
  }

  std::array<side_options, 2> sides_;
  std::int32_t left_;
  std::function<state(const point&)> before_;
  regions::all regions_;
  std::vector<eos::caloric> materials_;
  std::vector<std::int64_t> counts_;
};

}  // namespace

void forget_solution(setup& test) {
  test.exact = {};
  test.measured = {};
  test.known = {};
  test.traces = {};
  test.measures = {};
}

setup with_regions(const options& o, setup test) {
  const auto changed = std::make_shared<changed_start>(o, test);
  test.start = [changed](const point& x) { return changed->at(x); };
  test.expect_used = [changed] { changed->expect_used(); };
  return test;
}

}  // namespace tetsuame::gas
