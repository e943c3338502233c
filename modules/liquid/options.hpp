// What the input says of a scheme for liquids: groups &smoothing and &hosono.
#pragma once

#include <volume/hosono_options.hpp>
#include <volume/shape.hpp>

namespace tetsuame::liquid {

struct options {
  volume::smoothing_options smoothing;
  volume::hosono_options hosono;
};

inline void declare(namelist::schema& schema, options& o) {
  volume::declare(schema, o.smoothing);
  volume::declare(schema, o.hosono);
}

}  // namespace tetsuame::liquid
