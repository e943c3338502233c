// What may change at a restart.
#include <boost/test/unit_test.hpp>
#include <run/restart.hpp>

using namespace tetsuame;

namespace {

auto says(const std::string& text) {
  return [=](const foundation::error& e) {
    return e.status() == foundation::exit_status::bad_input && std::string(e.what()).find(text) != std::string::npos;
  };
}

const std::string program = "convection";
const std::string was =
    "! convection, every key as run\n&domain\n  particles_x = 20\n  ranks_x = 0\n/\n\n&time\n  dt = 1\n  steps = 20\n"
    "  t_end = ! 20\n/\n\n&convection\n  target = 'steady'\n  fast = ! 3\n/\n\n&expert\n  skin = 0.2\n/\n";

std::string changed(const std::string& from, const std::string& to) {
  auto is = was;
  return is.replace(is.find(from), from.size(), to);
}

std::map<std::string, namelist::key_at_restart> keys() {
  std::map<std::string, namelist::key_at_restart> all;
  for (const char* key : {"&domain ranks_x", "&time dt", "&time steps", "&time t_end"}) all[key] = {true, "--set"};
  for (const char* key : {"&domain particles_x", "&convection target", "&convection fast", "&expert skin"})
    all[key] = {false, "case.nml:7"};
  return all;
}

void check(const std::string& is, const std::string& of = program) {
  const auto all = keys();
  run::check_restart({program, was}, {of, is, all});
}

}  // namespace

BOOST_AUTO_TEST_CASE(keys_change_that_are_declared_so) {
  BOOST_CHECK_NO_THROW(check(was));
  BOOST_CHECK_NO_THROW(check(changed("dt = 1", "dt = 2")));
  BOOST_CHECK_NO_THROW(check(changed("ranks_x = 0", "ranks_x = 3")));
  BOOST_CHECK_NO_THROW(check(changed("fast = ! 3", "fast = 3")));  // the value that it came to before
}

BOOST_AUTO_TEST_CASE(others_are_refused_by_name_and_place) {
  const auto refused = [](const std::string& from, const std::string& to, const std::string& text) {
    BOOST_CHECK_EXCEPTION(check(changed(from, to)), foundation::error, says(text));
  };
  refused("particles_x = 20", "particles_x = 21",
          "case.nml:7: &domain particles_x = 21, and 20 in the checkpoint's run");
  refused("particles_x = 20", "particles_x = 21", "only &domain ranks_x; &time dt, steps, t_end;");
  refused("skin = 0.2", "skin = 0.3", "&expert skin = 0.3");
  refused("'steady'", "'transient'", "&convection target = 'transient'");
  refused("fast = ! 3", "fast = ! 4", "&convection fast = 4, and 3");
  refused("  skin = 0.2\n", "", "&expert skin = (no such key), and 0.2");
  refused("  skin = 0.2\n", "  skin = 0.2\n  deep = 1\n", "&expert deep = 1, and (no such key)");
  BOOST_CHECK_EXCEPTION(check(was, "rti"), foundation::error, says("of program convection, not of rti"));
}

BOOST_AUTO_TEST_CASE(an_end_before_the_checkpoint_is_refused) {
  const auto all = keys();
  const auto check_end = [&](const std::string& is, std::int64_t step, double time) {
    run::check_end({program, was, step, time}, {program, is, all});
  };
  BOOST_CHECK_NO_THROW(check_end(was, 20, 20.0));
  BOOST_CHECK_EXCEPTION(check_end(was, 21, 20.0), foundation::error,
                        says("--set: &time steps: expected no less than 21, where the checkpoint stands, found 20"));
  BOOST_CHECK_EXCEPTION(check_end(changed("t_end = ! 20", "t_end = 7"), 9, 9.0), foundation::error,
                        says("--set: &time t_end: expected no less than 9 s, where the checkpoint stands, found 7 s"));
  // Without t_end it is steps * dt, and of steps that are shorter there may be more.
  const auto open = changed("t_end = ! 20", "t_end = ! ");
  BOOST_CHECK_NO_THROW(check_end(open, 30, 20.0));
  BOOST_CHECK_EXCEPTION(check_end(open, 30, 21.0), foundation::error, says("found 20 s, which is steps * dt"));
}
