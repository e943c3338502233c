// Blocks, order and null particle of the particle arrays, field by field along the table.
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdint>
#include <particles/named_fields.hpp>
#include <particles/storage.hpp>
#include <set>
#include <string>

using namespace tetsuame::particles;

namespace {

// A value that tells the field, its component and the particle.
double stamp(std::size_t field, std::int64_t id) {
  return 1e4 * static_cast<double>(field + 1) + static_cast<double>(id);
}

template <int D, class F>
void for_each_array(particles<D>& s, F&& f) {
  std::size_t n = 0;
  for_each_field<D>(s, [&](const field_info& field, const auto& components) {
    for (auto* a : components) f(n++, field, *a);
  });
}

// IDs: fluid 0, 1, …; walls 1000, 1001, …
template <int D>
particles<D> stamped(std::size_t fluid, std::size_t fluid_ghosts, std::size_t walls, std::size_t wall_ghosts) {
  particles<D> s;
  allocate(s, fluid, fluid_ghosts, walls, wall_ghosts);
  const auto mark = [&](std::size_t i, std::int64_t id) {
    s.id[i] = id;
    s.material[i] = static_cast<std::int32_t>(id % 7);
    for_each_array<D>(s, [&](std::size_t n, const field_info&, auto& a) { a[i] = stamp(n, id); });
  };
  for (std::size_t i = 0; i < fluid; ++i) mark(i, static_cast<std::int64_t>(i));
  for (std::size_t r = 0; r < walls; ++r) mark(s.first_wall() + r, static_cast<std::int64_t>(1000 + r));
  return s;
}

template <int D>
bool holds(particles<D>& s, std::size_t i, std::int64_t id) {
  bool all = s.id[i] == id && s.material[i] == static_cast<std::int32_t>(id % 7);
  for_each_array<D>(s, [&](std::size_t n, const field_info&, auto& a) { all = all && a[i] == stamp(n, id); });
  return all;
}

template <int D>
void check_null(particles<D>& s) {
  const std::size_t n = s.null();
  BOOST_TEST(n == s.fluid + s.fluid_ghosts + s.walls + s.wall_ghosts);
  BOOST_TEST(s.id.size() == n + 1);
  BOOST_TEST(s.dV[n] == 0.0);
  BOOST_TEST(s.Y[n] == 0.0);
  for (std::size_t a = 0; a < D; ++a) BOOST_TEST(s.x[a][n] > 1e50);
  for_each_array<D>(s, [&](std::size_t, const field_info& field, auto& a) {
    BOOST_TEST_CONTEXT(field.name) {
      BOOST_TEST(a.size() == n + 1);
      BOOST_TEST(std::isfinite(a[n]));
    }
  });
  // What stands below a fraction line in some term may not be zero.
  for (const auto* a : {&s.p, &s.rho, &s.m, &s.eta, &s.k}) BOOST_TEST((*a)[n] > 0.0);
}

}  // namespace

// Walls that move up, down by more and by less than their number (overlap), and not at all.
BOOST_AUTO_TEST_CASE(allocate_keeps_fluid_and_walls) {
  struct size {
    std::size_t fluid, ghosts, wall_ghosts;
  };
  for (const auto& [from, to] : {std::pair{size{20, 0, 0}, size{20, 3, 0}},
                                 {size{20, 0, 0}, size{20, 60, 0}},
                                 {size{20, 9, 5}, size{20, 7, 0}},
                                 {size{20, 60, 5}, size{20, 0, 0}},
                                 {size{20, 9, 5}, size{25, 4, 8}},
                                 {size{20, 9, 5}, size{2, 0, 0}},
                                 {size{0, 0, 0}, size{4, 0, 0}},
                                 {size{5, 2, 1}, size{0, 0, 0}}}) {
    auto s = stamped<2>(from.fluid, from.ghosts, 10, from.wall_ghosts);
    allocate(s, to.fluid, to.ghosts, 10, to.wall_ghosts);
    for (std::size_t i = 0; i < std::min(from.fluid, to.fluid); ++i)
      BOOST_TEST(holds<2>(s, i, static_cast<std::int64_t>(i)));
    for (std::size_t r = 0; r < 10; ++r)
      BOOST_TEST(holds<2>(s, s.first_wall() + r, static_cast<std::int64_t>(1000 + r)));
    check_null<2>(s);
  }
}

BOOST_AUTO_TEST_CASE(nothing_at_all_has_a_null_particle) {
  particles<3> s;
  allocate(s, 0, 0, 0, 0);
  check_null<3>(s);
}

BOOST_AUTO_TEST_CASE(reorder_permutes_every_travelling_field) {
  auto s = stamped<3>(12, 4, 6, 0);
  const std::vector<std::uint32_t> order{5, 0, 4, 1, 3, 2};
  for (const std::size_t begin : {std::size_t{3}, s.first_wall()}) {
    auto t = s;
    reorder(t, begin, std::span<const std::uint32_t>(order));
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto id = s.id[begin + order[k]];
      BOOST_TEST(t.id[begin + k] == id);
      BOOST_TEST(t.material[begin + k] == static_cast<std::int32_t>(id % 7));
      for_each_array<3>(t, [&](std::size_t n, const field_info& field, auto& a) {
        if (travels(field.kind)) BOOST_TEST_CONTEXT(field.name) BOOST_TEST(a[begin + k] == stamp(n, id));
      });
    }
    for (std::size_t i = 0; i < t.fluid; ++i)
      if (i < begin || i >= begin + order.size()) BOOST_TEST(holds<3>(t, i, static_cast<std::int64_t>(i)));
  }
}

// Names are data sets and keys of a checkpoint: one field each; what is derived does not travel.
BOOST_AUTO_TEST_CASE(table_names_each_field_once) {
  particles<2> s;
  s.keeps_start = true;
  std::set<std::string> names;
  std::set<const void*> arrays;
  std::size_t count = 0, fields = 0;
  for_each_field<2>(s, [&](const field_info& field, const auto& components) {
    ++fields;
    names.insert(field.name);
    for (auto* a : components) {
      ++count;
      arrays.insert(a);
    }
  });
  BOOST_TEST(names.size() == fields);
  BOOST_TEST(arrays.size() == count);
  // All of the struct's arrays stand in the table: it holds nothing else but counts, a choice, two vectors and a deque.
  BOOST_TEST(count == (sizeof s - 5 * sizeof(std::size_t) - sizeof(decltype(s.id)) - sizeof(decltype(s.material)) -
                       sizeof(decltype(s.extras))) /
                          sizeof(decltype(s.rho)));
  for (const role kind : {role::integrated, role::constant, role::memory}) BOOST_TEST(travels(kind));
  BOOST_TEST(!travels(role::derived));
}

// What declare() gives stays the field, whatever is declared after it and wherever allocate() moves its values.
BOOST_AUTO_TEST_CASE(fields_declared_by_name) {
  particles<2> s;
  array& first = declare(s, "First", "Pa", role::integrated);
  const auto force = declare_vector<2>(s, "Force", "m/s^2", role::memory, "per mass");
  for (int k = 0; k < 100; ++k) declare(s, "Other" + std::to_string(k), "1", role::derived);
  allocate(s, 4, 0, 0, 0);
  first[3] = 7.0;
  force[1][2] = 5.0;
  allocate(s, 1000, 0, 0, 0);
  BOOST_TEST(extra(s, "First")[3] == 7.0);
  BOOST_TEST(extra(s, "Force_1")[2] == 5.0);
  BOOST_TEST(&extra(s, "Force_0") == &force[0]);
  BOOST_TEST(force.data()[1] == extra(s, "Force_1").data());
  BOOST_TEST(s.extras[2].description == "per mass");
  BOOST_TEST(force.read()[0] == force.data()[0]);
  BOOST_CHECK_THROW(declare(s, "Force_0", "1", role::memory), std::logic_error);
}

// Only what the run has takes room; later fields have the room of those that are there; new lists clear what is
// derived.
BOOST_AUTO_TEST_CASE(fields_of_some_runs) {
  particles<2> s;
  const array& absent = declare_if(false, s, "Melt", "1", role::derived);
  const auto absent_vector = declare_vector_if<2>(false, s, "Gradient", "1/m", role::derived);
  BOOST_TEST(s.extras.empty());
  allocate(s, 4, 2, 3, 1);
  BOOST_TEST(absent.empty());
  BOOST_TEST(absent_vector.data()[1] == nullptr);
  array& melt = declare_if(true, s, "Melt", "1", role::derived);
  const auto gradient = declare_vector_if<2>(true, s, "Gradient", "1/m", role::derived);
  array& content = declare_if(true, s, "Enthalpy", "J/kg", role::integrated);
  BOOST_TEST(gradient.data()[1] == extra(s, "Gradient_1").data());
  for (auto* a : {&melt, &gradient[0], &gradient[1], &content}) {
    BOOST_TEST(a->size() == 11U);
    std::fill(a->begin(), a->end(), 7.0);
  }
  s.p[2] = 5.0;
  clear_derived(s);
  BOOST_TEST((melt == array(11, 0.0) && gradient[1] == array(11, 0.0)));
  BOOST_TEST((content[3] == 7.0 && s.p[2] == 5.0));  // what travels, and what all particles have
  allocate(s, 6, 0, 3, 0);
  BOOST_TEST(content.size() == 10U);
  BOOST_TEST(content[s.null()] == 0.0);
}

BOOST_AUTO_TEST_CASE(wrong_names_are_told) {
  particles<3> s;
  declare(s, "Melt", "1", role::derived);
  const auto says = [](const char* text) {
    return [text](const std::logic_error& e) { return std::string(e.what()) == text; };
  };
  BOOST_CHECK_EXCEPTION(declare(s, "Melt", "1", role::memory), std::logic_error, says("field Melt is declared twice"));
  BOOST_CHECK_EXCEPTION(extra(s, "Enthalpy"), std::logic_error, says("field Enthalpy is not declared"));
}
