// The order in which the passes of an evaluation are carried out, found once from what they read and write:
//
//   - fields that neighbours are asked for travel to the ghosts as soon as they are complete, in one message a
//     neighbour; what follows from others that are there, by an `each`, is computed of the ghosts instead;
//   - while they travel, the next sums go over the rows that wait for no ghosts, and their other rows when all is
//   there;
//   - what stands behind walls is filled when its sources are complete: by parity (walls/images.hpp), or by the passes
//     of a boundary treatment;
//   - neighbouring `each` are one loop.
//
// A pass that reads what nobody has written before it, two that write one field, a rate that no pass writes or two do
// are refused by name (std::logic_error).
#pragma once

#include <map>
#include <passes/pass.hpp>
#include <string>
#include <vector>

namespace tetsuame::passes {

// What an evaluation begins with.
struct known_fields {
  fields integrated;  // known of the owned particles alone
  fields remembered;  // as these, but with no rate
  fields given;       // of ghosts and behind walls as well: they change with the lists
  fields positions;   // if they are integrated: sums need them
  std::map<const field*, std::vector<const field*>> image_by;  // an image follows from these of its source as well
  bool images = false;  // behind walls stand images, filled by parity; else only what passes give
  bool any_walls = true;
  std::function<std::string(const field*)> name;
};

struct step {
  enum class kind { begin_exchange, end_exchange, each, sum, images, once };
  // Of an `each`: of the owned particles, of ghosts, of what stands behind walls.
  enum class block { owned, ghosts, walls };

  kind of;
  std::vector<std::size_t> passes{};  // by their places in the list
  std::vector<field*> fields{};       // of exchanges, without positions, and images
  bool positions = false;             // of exchanges
  block where = block::owned;
  rows which = rows::all;
};

std::vector<step> schedule(const std::vector<pass>& passes, const known_fields& known);

// A line a step, for tests and logs: "sum smoothing, interior".
std::string describe(const std::vector<step>& steps, const std::vector<pass>& passes, const known_fields& known);

}  // namespace tetsuame::passes
