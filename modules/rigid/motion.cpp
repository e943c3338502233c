#include <algorithm>
#include <rigid/motion.hpp>

namespace tetsuame::rigid {

template <int D>
solids::bounds<D> ever_in_box(const box<D>& in, const solids::body<D>& of, const motion_of_body<D>& how) {
  const auto period = period_of(in);
  auto where = solids::bounds_of<D>(of);
  bool has_images = false;
  for (std::size_t a = 0; a < D; ++a) {
    if (!period.along[a]) continue;
    if (solids::runs_through<D>(of, period, a))
      solids::keep_one_period<D>(where, of, period, a);
    else
      has_images = true;
  }
  const auto poses = how.course.poses();
  const bool turns = std::ranges::any_of(poses, [](const auto& p) {
    double by = 0.0;
    for (std::size_t a = 0; a < D; ++a) by += solids::norm<D>(p.turned[a] - solids::unit<D>(a));
    return by > 0.0;
  });
  if (how.free || (turns && has_images)) return where;
  // The box as the body sees it on its way; across periodic sides the box has no end.
  auto whole = where, seen = solids::bounds<D>::none();
  for (std::size_t a = 0; a < D; ++a)
    if (!period.along[a]) {
      whole.low[a] = -in.lattice.spacing;
      whole.high[a] = in.lattice.length[a] * (in.is_open(a) ? 2.0 : 1.0) + in.lattice.spacing;
    }
  for (const auto& pose : poses)
    for (std::size_t corner = 0; corner < std::size_t{1} << D; ++corner)
      seen.widen(pose.to_body(
          solids::point<D>::of([&](std::size_t a) { return (corner >> a & 1U) != 0 ? whole.high[a] : whole.low[a]; })));
  for (std::size_t a = 0; a < D; ++a)
    if (period.along[a]) seen.low[a] = where.low[a], seen.high[a] = where.high[a];
  return where.within(seen);
}
template solids::bounds<2> ever_in_box<2>(const box<2>&, const solids::body<2>&, const motion_of_body<2>&);
template solids::bounds<3> ever_in_box<3>(const box<3>&, const solids::body<3>&, const motion_of_body<3>&);

}  // namespace tetsuame::rigid
