#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <namelist/schema.hpp>
#include <random>
#include <sstream>
#include <stdexcept>

#include "message.hpp"

using namespace tetsuame;
using boost::test_tools::per_element;

namespace {

struct options {
  double length = 1.0 / 3.0, gravity = std::numeric_limits<double>::quiet_NaN();
  std::int64_t steps = 10;
  std::int64_t seed = 9007199254740993;  // no double holds it
  bool periodic = true;
  std::string method = "euler", title = "it's a 'test'";
  std::optional<double> t_end, interval = 5.0;
  std::vector<double> times{0.1, 1e-300};
  std::vector<std::int64_t> counts;
  std::vector<std::string> names{"a", "", " b"};

  bool operator==(const options& o) const {
    const bool same_gravity = gravity == o.gravity || (std::isnan(gravity) && std::isnan(o.gravity));
    return same_gravity && length == o.length && steps == o.steps && seed == o.seed && periodic == o.periodic &&
           method == o.method && title == o.title && t_end == o.t_end && interval == o.interval && times == o.times &&
           counts == o.counts && names == o.names;
  }
};

namelist::schema schema_of(options& to) {
  namelist::schema result;
  result.group("Domain", "the box\nand its contents");
  result.add("domain", "Length", to.length,
             {.unit = "m", .minimum = 0.0, .exclusive_minimum = true, .meaning = "width"});
  result.add("domain", "gravity", to.gravity, {.unit = "m/s2"});
  result.add("domain", "periodic", to.periodic);
  result.group("time", "");
  result.add("time", "method", to.method, {.choices = {"euler", "adaptive", "RKC2"}});
  result.add("time", "title", to.title);
  result.add("time", "steps", to.steps, {.minimum = 0, .maximum = 99});
  result.add("time", "seed", to.seed);
  result.add("time", "t_end", to.t_end, {.unit = "s", .minimum = 0.0});
  result.add("time", "interval", to.interval, {.minimum = 1});
  result.group("lists", "");
  result.add("lists", "times", to.times, {.unit = "s", .maximum_size = 5});
  result.add("lists", "counts", to.counts, {.minimum = 0, .maximum_size = 3});
  result.add("lists", "names", to.names);
  return result;
}

options read(const std::string& text, const std::vector<std::string>& overrides = {}) {
  options result;
  auto input = text.empty() ? namelist::document("f") : namelist::parse_text(text, "f");
  for (const std::string& o : overrides) input.set(o);
  schema_of(result).read(input);
  return result;
}

std::string resolved(options values) {
  std::ostringstream out;
  schema_of(values).write_resolved(out);
  return out.str();
}

}  // namespace

BOOST_AUTO_TEST_CASE(nothing_given_keeps_the_defaults) {
  BOOST_TEST((read("") == options{}));
  BOOST_TEST((read("&domain / &time method= , steps= / &lists times=,, counts= /") == options{}));
}

BOOST_AUTO_TEST_CASE(every_kind_of_target) {
  const options o = read(
      "&DOMAIN length = 2 Gravity=9.8 periodic=F / &time method='rkc2 ' title=\"x\" steps=7 seed=-1 t_end=1d3 "
      "interval=2 /"
      "&lists times(2)=5,6 counts=2*4 names='q' /");
  BOOST_TEST(o.length == 2.0);
  BOOST_TEST(o.gravity == 9.8);
  BOOST_TEST(!o.periodic);
  BOOST_TEST(o.method == "RKC2");
  BOOST_TEST(o.title == "x");
  BOOST_TEST(o.steps == 7);
  BOOST_TEST(o.seed == -1);
  BOOST_TEST(o.t_end.value() == 1000.0);
  BOOST_TEST(o.interval.value() == 2.0);
  BOOST_TEST(o.times == (std::vector<double>{0.1, 5.0, 6.0}), per_element());
  BOOST_TEST(o.counts == (std::vector<std::int64_t>{4, 4}), per_element());
  BOOST_TEST(o.names == (std::vector<std::string>{"q", "", " b"}), per_element());
}

BOOST_AUTO_TEST_CASE(a_list_may_be_filled_in_any_order) {
  BOOST_TEST(read("&lists counts(3)=3 counts(1:2)=1,2 /").counts == (std::vector<std::int64_t>{1, 2, 3}),
             per_element());
  BOOST_TEST(read("&lists counts(3:1:-2)=3,1 counts(2)=2 /").counts == (std::vector<std::int64_t>{1, 2, 3}),
             per_element());
}

BOOST_AUTO_TEST_CASE(a_sparse_list_may_have_gaps) {
  std::vector<double> lengths;
  std::vector<std::string> shapes, names;
  namelist::schema s;
  s.group("bodies", "");
  s.add("bodies", "length", lengths, {.sparse = true});
  s.add("bodies", "shape", shapes, {.choices = {"box", "sphere"}, .sparse = true});
  s.add("bodies", "name", names, {.sparse = true});
  s.read(namelist::parse_text("&bodies length(3) = 2 length(1) = 1 shape(2) = 'sphere' name(2) = 'a' /", "f.nml"));
  BOOST_TEST(lengths == (std::vector<double>{1.0, 0.0, 2.0}), per_element());
  BOOST_TEST(shapes == (std::vector<std::string>{"box", "sphere"}), per_element());
  BOOST_TEST(names == (std::vector<std::string>{"", "a"}), per_element());
}

BOOST_AUTO_TEST_CASE(overrides_win) {
  const options o = read("&time method='adaptive' /", {"time.method=Euler", "time.title=a.b", "lists.names(2)=/tmp",
                                                       "domain.length=3", "domain.periodic=f"});
  BOOST_TEST(o.method == "euler");
  BOOST_TEST(o.title == "a.b");
  BOOST_TEST(o.names == (std::vector<std::string>{"a", "/tmp", " b"}), per_element());
  BOOST_TEST(o.length == 3.0);
  BOOST_TEST(!o.periodic);
}

BOOST_AUTO_TEST_CASE(overrides_of_whole_lists_replace_them) {
  const std::string file = "&lists times=1,2,3,4 counts=5,6,7 /";
  BOOST_TEST(read(file, {"lists.counts=8"}).counts == (std::vector<std::int64_t>{8}), per_element());
  BOOST_TEST(read(file, {"lists.counts=8,9", "lists.counts=1"}).counts == (std::vector<std::int64_t>{1}),
             per_element());
  // What has a default has it again, as if the file had said nothing.
  BOOST_TEST(read(file, {"lists.times=9"}).times == (std::vector<double>{9.0, 1e-300}), per_element());
  // Elements by their numbers, and nulls, keep the others.
  BOOST_TEST(read(file, {"lists.counts(2)=8"}).counts == (std::vector<std::int64_t>{5, 8, 7}), per_element());
  BOOST_TEST(read(file, {"lists.counts=,8"}).counts == (std::vector<std::int64_t>{5, 8}), per_element());
  BOOST_TEST(read(file, {"lists.counts=8", "lists.counts(2)=9"}).counts == (std::vector<std::int64_t>{8, 9}),
             per_element());
  BOOST_TEST(message([&] { read("&lists counts=5 /", {"lists.counts=,,7"}); }) ==
             "--set lists.counts=,,7: &lists counts: element 2 has neither a value nor a default");
}

BOOST_AUTO_TEST_CASE(origins) {
  options o;
  auto s = schema_of(o);
  auto input = namelist::parse_text("&time\n steps = 1\n steps =\n 2 title= /\n", "f.nml");
  input.set("time.method=euler");
  s.read(input);
  BOOST_TEST(o.steps == 2);
  BOOST_TEST(s.where("time", "Steps") == "f.nml:4");
  BOOST_TEST(s.where("time", "method") == "--set time.method=euler");
  BOOST_TEST(s.where("time", "title") == "default");
  BOOST_TEST(s.given("time", "steps"));
  BOOST_TEST(!s.given("time", "title"));
  BOOST_TEST(message([&] { s.fail("time", "steps", "too few for this dt"); }) ==
             "f.nml:4: &time steps: too few for this dt");
  BOOST_CHECK_THROW(s.where("time", "absent"), std::logic_error);
}

BOOST_AUTO_TEST_CASE(describe_reads_back_as_the_defaults) {
  options changed;
  auto s = schema_of(changed);
  s.read(namelist::parse_text("&time steps=3 title='other' / &lists times=7 /", "f"));
  std::ostringstream out;
  s.describe(out);
  BOOST_TEST((read(out.str()) == options{}));
  for (const char* line :
       {R"(! the box
! and its contents
&domain
  ! width
  ! real [m], > 0, default 0.3333333333333333
  length = 0.3333333333333333
)",
        "  ! real [m/s2], default none\n  gravity =\n", "  ! integer, in [0, 99], default 10\n  steps = 10\n",
        "  ! text, one of 'euler', 'adaptive', 'RKC2', default 'euler'\n",
        "  ! optional real [s], >= 0, default none\n  t_end =\n", "  title = 'it''s a ''test'''\n",
        "  ! list of reals, at most 5 [s], default 0.1, 1e-300\n", "  periodic = .true.\n"})
    BOOST_TEST(out.str().find(line) != std::string::npos, line << "\nnot in\n" << out.str());
}

BOOST_AUTO_TEST_CASE(resolved_reads_back_exactly) {
  std::mt19937_64 bits(7);
  const auto real = [&] { return std::ldexp(static_cast<double>(bits()), static_cast<int>(bits() % 600) - 300); };
  for (int k = 0; k < 500; ++k) {
    options o;
    o.length = real();
    o.gravity = -real();
    o.steps = static_cast<std::int64_t>(bits() % 100);
    o.seed = static_cast<std::int64_t>(bits());
    o.periodic = bits() % 2 == 0;
    o.method = "adaptive";
    o.title = std::string(bits() % 9, '\'') + "/ ! \" &end \xc3\xa9";
    if (bits() % 2 == 0) o.t_end = real();
    o.times = {real(), -real(), real()};
    o.counts = {1, 2};
    o.names = {"'", "\"", "a,b"};
    const std::string text = resolved(o);
    const options again = read(text);
    BOOST_REQUIRE((again == o));
    BOOST_REQUIRE_EQUAL(resolved(again), text);
  }
}

BOOST_AUTO_TEST_CASE(groups_of_other_programs_are_passed_over_when_named) {
  options o;
  namelist::schema input = schema_of(o);
  input.pass_over("Output");
  input.read(namelist::parse_text("&output every = 'x', 3 /\n&time steps = 7 /", "f"));
  BOOST_TEST(o.steps == 7);
  BOOST_CHECK_THROW(input.read(namelist::parse_text("&outputs every = 1 /", "f")), foundation::error);
}

BOOST_AUTO_TEST_CASE(wrong_declarations) {
  double x = -1.0;
  std::string s = "euler";
  std::vector<double> list(3, 0.0);
  namelist::schema schema;
  schema.group("a", "");
  schema.add("a", "x", x);
  BOOST_CHECK_THROW(schema.add("a", "X", x), std::logic_error);
  BOOST_CHECK_THROW(schema.add("b", "x", x), std::logic_error);
  BOOST_CHECK_THROW(schema.add("a", "y", x, {.minimum = 0.0}), std::logic_error);
  BOOST_CHECK_THROW(schema.add("a", "s", s, {.choices = {"newton"}}), std::logic_error);
  BOOST_CHECK_THROW(schema.add("a", "list", list, {.maximum_size = 2}), std::logic_error);
  BOOST_CHECK_THROW(schema.add("a", "list", list, {.minimum = 1.0}), std::logic_error);
}

// Keys of experts are declared with their module's, and stand together behind all groups.
BOOST_AUTO_TEST_CASE(keys_of_experts) {
  double g = 10.0, order = 2.0, skin = 0.2;
  namelist::schema s;
  s.group("gravity", "");
  s.add("gravity", "g", g);
  s.add("gravity", "order", order, {.expert = true, .meaning = "of the sum"});
  s.group("kernel", "");
  s.add("kernel", "skin", skin, {.minimum = 0.0, .expert = true, .expert_name = "kernel_skin"});
  std::ostringstream described;
  s.describe(described);
  const std::string shown = described.str();
  BOOST_TEST(shown.find("&gravity") < shown.find("&expert"));
  BOOST_TEST(shown.find("! of &gravity: of the sum") > shown.find("&expert"));
  s.read(namelist::parse_text("&expert order = 3 / &gravity g = 9 /", "f"));
  BOOST_TEST(order == 3.0);
  BOOST_TEST(s.given("gravity", "order"));
  BOOST_TEST(!s.given("kernel", "skin"));
  const auto read = [&](const std::string& text) { return message([&] { s.read(namelist::parse_text(text, "f")); }); };
  BOOST_TEST(message([&] { s.fail("gravity", "order", "no"); }) == "f:1: &expert order: no");
  s.read(namelist::parse_text("&expert kernel_skin = 0.5 /", "f"));
  BOOST_TEST(skin == 0.5);
  s.read(namelist::parse_text("&kernel skin = 0.7 /", "f"));
  BOOST_TEST(skin == 0.7);
  BOOST_TEST(shown.find("\n&kernel") == std::string::npos);
  // As well known in the group that declared it, but not in both.
  s.read(namelist::parse_text("&gravity order = 4 /", "f"));
  BOOST_TEST(order == 4.0);
  BOOST_TEST(read("&expert order = 3 / &gravity order = 3 /") == "f:1: &gravity order: is given in &expert too");
  BOOST_TEST(read("&gravity order = 3 / &expert order = 3 /") == "f:1: &expert order: is given in &gravity too");
  auto twice = namelist::parse_text("&gravity order = 4 /", "f");
  twice.set("gravity.order=5");
  s.read(twice);
  BOOST_TEST(order == 5.0);
  BOOST_TEST(read("&kernel order = 3 /") ==
             "f:1: &kernel: unknown key order; the nearest valid key is skin; &expert has a key of this name");
  s.also_known("gravity", "acceleration", "g");
  s.read(namelist::parse_text("&gravity acceleration = 3 /", "f"));
  BOOST_TEST(g == 3.0);
  BOOST_CHECK_THROW(s.add("kernel", "order", g, {.expert = true}), std::logic_error);
}

// Paths begin at the input's folder, those of --set at the current one; empty ones are no files.
BOOST_AUTO_TEST_CASE(files_that_are_named) {
  std::string one, none;
  std::vector<std::string> list;
  namelist::schema s;
  s.group("a", "");
  s.add("a", "file", one, {.file = namelist::file_of::run});
  s.add("a", "no_file", none, {.file = namelist::file_of::start});
  s.add("a", "files", list, {.sparse = true, .file = namelist::file_of::start});
  auto input = namelist::parse_text("&a file = 'x/y.csv '\n files(2) = '../z', '/abs/w' /\n", "in/case.nml");
  input.set("a.files(4)=v/u");
  s.read(input);
  BOOST_TEST(one == "in/x/y.csv");
  BOOST_TEST((list == std::vector<std::string>{"", "z", "/abs/w", "v/u"}));
  const auto files = s.files();
  BOOST_TEST_REQUIRE(files.size() == 4U);
  BOOST_TEST(files[0].where == "in/case.nml:1: &a file");
  BOOST_TEST(files[0].path == &one);
  BOOST_TEST((files[0].what == namelist::file_of::run && files[1].what == namelist::file_of::start));
}

// An element that is left open is neither 0 nor an error, reads back as written, and is placed at what was given.
BOOST_AUTO_TEST_CASE(lists_with_elements_left_open) {
  std::vector<std::string> names;
  std::vector<double> densities;
  namelist::schema s;
  s.group("material", "");
  s.add("material", "name", names, {.sparse = true});
  s.add("material", "density", densities,
        {.minimum = 0.0, .exclusive_minimum = true, .sparse = true, .may_be_left_open = true});
  s.read(namelist::parse_text("&material name = 'a' /\n&material name = 'b'\n density = 2 /\n&material name = 'c' /\n",
                              "f"));
  BOOST_TEST((names == std::vector<std::string>{"a", "b", "c"}));
  BOOST_TEST_REQUIRE(densities.size() == 2U);
  BOOST_TEST(std::isnan(densities[0]));
  BOOST_TEST(densities[1] == 2.0);
  BOOST_TEST(message([&] { s.fail_at("material", "name", 0, "no"); }) == "f:1: &material name: no");
  BOOST_TEST(message([&] { s.fail_at("material", "density", 1, "no"); }) == "f:3: &material density: no");
  std::ostringstream written;
  s.write_resolved(written);
  BOOST_TEST(written.str().find("density = 1*, 2") != std::string::npos);
  densities.clear();
  names.clear();
  s.read(namelist::parse_text(written.str(), "f"));
  std::ostringstream again;
  s.write_resolved(again);
  BOOST_TEST(again.str() == written.str());
}

// The same name stands once where its group has no lists.
BOOST_AUTO_TEST_CASE(a_group_without_lists_stands_once) {
  double viscosity = 1.0;
  namelist::schema s;
  s.group("material", "");
  s.add("material", "viscosity", viscosity);
  const auto read = [&](const std::string& text) { return message([&] { s.read(namelist::parse_text(text, "f")); }); };
  BOOST_TEST(read("&material viscosity = 2 /\n&material /\n") == "f:2: group &material was given before, in line 1");
  BOOST_TEST(read("&material viscosity = 2 /\n") == "no error");
}
