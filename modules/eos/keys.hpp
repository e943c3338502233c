// The parameters of equations of state as keys of an input.
#pragma once

#include <eos/eos.hpp>
#include <namelist/schema.hpp>

namespace tetsuame::eos {

// Unit, range and meaning.
inline namelist::key_info key_of(const parameter& p) {
  using enum parameter::range;
  namelist::key_info info{.unit = std::string(p.unit), .meaning = std::string(p.meaning)};
  if (p.allowed == positive || p.allowed == not_negative) info.minimum = 0.0;
  if (p.allowed == above_one) info.minimum = 1.0;
  info.exclusive_minimum = p.allowed == positive || p.allowed == above_one;
  return info;
}

// Of the file of 'table'.
inline namelist::key_info key_of_table(const std::string& where = "") {
  return {.file = namelist::file_of::run,
          .meaning = "of the equation of state 'table'" + where +
                     ": pressure and energy by density and temperature, in the form of SWIFT and WoMa or a SESAME file "
                     "with record 301"};
}

}  // namespace tetsuame::eos
