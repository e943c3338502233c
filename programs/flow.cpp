// Water with a free surface: waves, drops, dam breaks.
#include <free_surface/make.hpp>
#include <free_surface/memory.hpp>

using namespace tetsuame;

int main(int argc, char** argv) {
  free_surface::options o;
  free_surface::parameters p;
  const run::program_input own{
      .program = "flow",
      .restarts = true,
      .declare = [&](namelist::schema& schema) { free_surface::declare(schema, o); },
      .complete = [&](const namelist::schema& schema) { p = free_surface::resolve(schema, o); },
      .need = [&] { return free_surface::need_of(o, p); }};
  return run::start(argc, argv, own, [&](const run::command_line& line, const std::string& resolved) {
    const auto made = (o.domain.dimension == 3 ? free_surface::make_3d : free_surface::make_2d)(o, p);
    run::carry_out(*made, o.common, line, resolved);
  });
}
