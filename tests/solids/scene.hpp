// Bodies that several tests look at.
#pragma once

#include <solids/body.hpp>
#include <vector>

namespace tetsuame::solids {

template <int D>
piece<D> made(operation how, faces<D> shape, const point<D>& at, const std::array<double, 3>& degrees = {},
              bool outside = false) {
  return {how, placed<D>(std::move(shape), turned_by<D>(degrees), at), outside};
}

template <int D>
body<D> of_one(const char* name, faces<D> shape, const point<D>& at = foundation::zero<double, D>(),
               const std::array<double, 3>& degrees = {}, bool outside = false) {
  return {name, {made<D>(operation::unite, std::move(shape), at, degrees, outside)}};
}

}  // namespace tetsuame::solids
