#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cmath>
#include <foundation/error.hpp>
#include <kernels/kernel.hpp>
#include <optional>
#include <utility>
#include <vector>

namespace tetsuame::kernels {

const entry& find(std::string_view name) {
  for (const entry& line : table)
    if (line.name == name) return line;
  std::vector<std::string_view> names;
  for (const entry& line : table) names.push_back(line.name);
  foundation::fail_input(fmt::format("there is no kernel '{}': choose one of {}", name, fmt::join(names, ", ")));
}

namespace {

template <int D, std::size_t... K>
std::optional<any<D>> pick(std::string_view name, double support, std::index_sequence<K...>) {
  std::optional<any<D>> result;
  const auto attempt = [&]<class Kernel>(std::type_identity<Kernel>) {
    if (name == Kernel::name) result.emplace(Kernel(support));
  };
  (attempt(std::type_identity<std::variant_alternative_t<K, any<D>>>{}), ...);
  return result;
}

}  // namespace

template <int D>
any<D> make(std::string_view name, double h) {
  const entry& line = find(name);
  if (!(std::isfinite(h) && h > 0.0))
    foundation::fail_input(
        fmt::format("the smoothing length of kernel '{}' is {} m: it must be finite and positive", name, h));
  return *pick<D>(name, line.support_over_h * h, std::make_index_sequence<std::variant_size_v<any<D>>>{});
}

template any<1> make<1>(std::string_view, double);
template any<2> make<2>(std::string_view, double);
template any<3> make<3>(std::string_view, double);

}  // namespace tetsuame::kernels
