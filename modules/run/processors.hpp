// Whether the ranks and threads of a run have the processors that they ask for.
#pragma once

#include <domain/communicator.hpp>
#include <string>

namespace tetsuame::run {

// Collective. What is to be said, and set, where on some machine there are more threads of all ranks than processors
// that these may use: those that wait then keep others from what they wait for. Empty: there are enough.
std::string crowded_processors(const domain::communicator& ranks);

}  // namespace tetsuame::run
