#include <algorithm>
#include <melting/melting.hpp>
#include <melting/options.hpp>
#include <namelist/refuse.hpp>
#include <vector>

namespace tetsuame::melting {

using namelist::for_expert, namelist::positive, namelist::refuse;

void declare(namelist::schema& schema, const std::string& of, options& o) {
  schema.group("melting", of);
  schema.add("melting", "curve", o.curve,
             {.choices = {"none", "mantle", "constant"},
              .meaning = "solidus and liquidus: it never melts, fits for the mantle by pressure, or two temperatures"});
  schema.add("melting", "composition", o.composition,
             {.choices = {"peridotitic", "chondritic"},
              .expert = true,
              .meaning = "curve 'mantle': of the liquidus above 20 GPa"});
  schema.add("melting", "solidus", o.solidus, for_expert(positive("K", "curve 'constant'")));
  schema.add("melting", "liquidus", o.liquidus, for_expert(positive("K", "curve 'constant'")));
  schema.add("melting", "latent_heat", o.latent_heat,
             {.unit = "J/kg", .minimum = 0.0, .expert = true, .meaning = "of fusion"});
  schema.add("melting", "viscosity_law", o.viscosity_law,
             {.choices = {"constant", "blended", "suspension"},
              .meaning = "the material's one viscosity; or by temperature and melt fraction, smooth or with the "
                         "crystals' sudden lock at 0.4"});
  schema.add("melting", "viscosity_min", o.viscosity_min,
             for_expert(positive("Pa s", "the law's viscosity is not below this")));
  schema.add("melting", "viscosity_max", o.viscosity_max, for_expert(positive("Pa s", "nor above this")));
  schema.add("melting", "inertia_viscosity", o.inertia_viscosity,
             {.unit = "Pa s",
              .minimum = 0.0,
              .expert = true,
              .meaning = "what is more viscous gets its inertia raised by the ratio, so that steps need not follow it "
                         "(0: inertia as it is)"});
}

void check(const namelist::schema& schema, options& o) {
  if (!o.melts()) {
    std::vector<std::string> keys{"solidus",       "liquidus",          "viscosity_min",
                                  "viscosity_max", "inertia_viscosity", "composition"};
    if (o.latent_heat != 0.0) keys.emplace_back("latent_heat");
    if (o.viscosity_law != "constant") keys.emplace_back("viscosity_law");
    refuse(schema, "melting", keys, "nothing melts: curve is 'none'");
    o.viscosity_law = "constant";
    o.latent_heat = 0.0;
    return;
  }
  if (o.curve == "constant" && !(o.liquidus > o.solidus))
    schema.fail("melting", "liquidus", "must be above the solidus");
  if (o.curve == "mantle") refuse(schema, "melting", {"solidus", "liquidus"}, "curve 'mantle' has one of its own");
  if (o.viscosity_max < o.viscosity_min) schema.fail("melting", "viscosity_max", "is below viscosity_min");
  if (!o.viscosity_varies())
    refuse(schema, "melting", {"viscosity_min", "viscosity_max"}, "viscosity_law is 'constant'");
}

std::array<double, 2> range(const options& o, double p) {
  if (o.curve == "constant") return {o.solidus, o.liquidus};
  const double above = std::max(p, 0.0);
  return {solidus(above),
          liquidus(o.composition == "chondritic" ? composition::chondritic : composition::peridotitic, above)};
}

double viscosity(const options& o, double T, double melt_fraction) {
  // The laws' liquid has a pole at 1000 K, far below every solidus: there all is solid.
  const double eta = T < 1100.0                     ? solid_viscosity(T)
                     : o.viscosity_law == "blended" ? blended_viscosity(T, melt_fraction)
                                                    : suspension_viscosity(T, melt_fraction);
  return std::clamp(eta, o.viscosity_min, o.viscosity_max);
}

}  // namespace tetsuame::melting
