// Keys of gravity, which problems have in groups of their own.
#pragma once

#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::gravity {

// g: m/s2, towards -y. may_vanish: 0 is none. where: the case that has it, for --describe.
inline void declare(namelist::schema& schema, const std::string& group, const std::string& key, double& g,
                    bool may_vanish = true, const std::string& where = "") {
  schema.add(group, key, g,
             {.unit = "m/s^2",
              .minimum = 0.0,
              .exclusive_minimum = !may_vanish,
              .meaning = where + "acceleration of gravity, towards -y"});
}

// Of self-gravity, over the support of a particle's kernel at the start.
inline void declare_softening(namelist::schema& schema, const std::string& group, double& softening,
                              const std::string& where) {
  schema.add(group, "softening", softening,
             namelist::for_expert(namelist::up_to(10.0, where + "radius beyond which a particle's field is that of a "
                                                                "point, over its kernel's support at the start")));
}

}  // namespace tetsuame::gravity
