// What restrains free bodies, as the input gives it: lists of &motions.
#pragma once

#include <functional>
#include <namelist/schema.hpp>
#include <solids/motion.hpp>

namespace tetsuame::solids {

struct restraint_options {
  std::vector<std::string> freedom;
  std::array<std::vector<double>, 3> stiffness, damping, rest;
  std::vector<double> stiffness_angle, damping_angle, rest_angle;
};

// list: what a list of numbers is, of this unit and meaning and with this minimum.
using list_of_numbers = std::function<namelist::key_info(const char*, const char*, double)>;
void declare(namelist::schema& schema, std::size_t most, const list_of_numbers& list, restraint_options& o);

// Of motion n. fail: with the key and what is wrong; does not return.
using fail_at_key = std::function<void(const std::string&, const std::string&)>;
template <int D>
restraint<D> restraint_of(const restraint_options& o, std::size_t n, const fail_at_key& fail);
// Where the motion is none of a free body.
void expect_unrestrained(const restraint_options& o, std::size_t n, const fail_at_key& fail);

}  // namespace tetsuame::solids
