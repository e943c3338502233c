#include <fmt/core.h>
#include <fmt/ranges.h>

#include <foundation/error.hpp>
#include <kernels/kernel.hpp>
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

// Of those from number K on; the name is one of them.
template <int D, std::size_t K = 0>
any<D> pick(std::string_view name, double support) {
  using kernel = std::variant_alternative_t<K, any<D>>;
  if constexpr (K + 1 < std::variant_size_v<any<D>>)
    if (name != kernel::name) return pick<D, K + 1>(name, support);
  return kernel(support);
}

}  // namespace

template <int D>
any<D> make(std::string_view name, double h) {
  return pick<D>(name, find(name).support_over_h * h);
}

template any<1> make<1>(std::string_view, double);
template any<2> make<2>(std::string_view, double);
template any<3> make<3>(std::string_view, double);

}  // namespace tetsuame::kernels
