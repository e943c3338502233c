// Vectors that leave new values as they are: large arrays that are written at once are not filled before, by one thread
// whose pages they would become.
#pragma once

#include <memory>
#include <vector>

namespace tetsuame::foundation {

template <class T>
struct uninitialised : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = uninitialised<U>;
  };
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
};

template <class T>
using unfilled = std::vector<T, uninitialised<T>>;

}  // namespace tetsuame::foundation
