#include <algorithm>
#include <elements/options.hpp>
#include <namelist/refuse.hpp>
#include <theory/partition.hpp>

namespace tetsuame::elements {

using namelist::for_expert, namelist::positive, namelist::refuse;

void declare(namelist::schema& schema, options& o) {
  schema.group("element", "dissolved in metal and silicate, exchanged at their contact");
  schema.add("element", "name", o.name,
             {.choices = {"none", "constant", "nickel", "cobalt"},
              .meaning = "whose partition coefficient: none, a constant one, or by pressure and temperature (Rubie et "
                         "al. 2015)"});
  schema.add("element", "partition_coefficient", o.partition_coefficient,
             for_expert(positive("1", "'constant': metal over silicate at equilibrium")));
  schema.add(
      "element", "iron_ratio", o.iron_ratio,
      for_expert(positive("1", "nickel, cobalt: mole fraction of Fe in the metal over that of FeO in the silicate")));
  schema.add("element", "diffusivity_silicate", o.diffusivity_silicate,
             for_expert(positive("m^2/s", "of the element")));
  schema.add("element", "diffusivity_metal", o.diffusivity_metal, for_expert(positive("m^2/s", "of the element")));
  schema.add("element", "concentration_silicate", o.concentration_silicate,
             {.minimum = 0.0, .expert = true, .meaning = "at the start, amount per mass, in a unit of choice"});
  schema.add("element", "concentration_metal", o.concentration_metal,
             {.minimum = 0.0, .expert = true, .meaning = "at the start, in the same unit"});
}

void check(const namelist::schema& schema, const options& o) {
  if (!o.any())
    refuse(schema, "element",
           {"diffusivity_silicate", "diffusivity_metal", "concentration_silicate", "concentration_metal"},
           "there is no element: name is 'none'");
  else if (!(o.concentration_silicate + o.concentration_metal > 0.0))
    schema.fail("element", "concentration_silicate", "there is nothing of the element in either material");
  if (o.name != "constant") refuse(schema, "element", {"partition_coefficient"}, "belongs to name = 'constant'");
  if (!o.any() || o.name == "constant") refuse(schema, "element", {"iron_ratio"}, "belongs to a named element");
}

double partition_coefficient(const options& o, double p, double T) {
  if (o.name == "constant") return o.partition_coefficient;
  T = std::max(T, 1000.0);
  return theory::partition_coefficient(o.name == "nickel" ? theory::nickel : theory::cobalt, p, T, o.iron_ratio);
}

}  // namespace tetsuame::elements
