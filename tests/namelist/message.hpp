// What an action tells when it fails with bad input; another failure fails the test.
#pragma once

#include <foundation/error.hpp>
#include <string>

template <class Action>
std::string message(const Action& action) {
  try {
    action();
  } catch (const tetsuame::foundation::error& e) {
    return e.status() == tetsuame::foundation::exit_status::bad_input ? e.what() : "wrong status";
  }
  return "no error";
}
