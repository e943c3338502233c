#include <bench/programs.hpp>
#include <liquid/passes.hpp>
#include <liquid/scheme_of.hpp>
#include <map>
#include <programs/disph_f.hpp>
#include <programs/disph_n.hpp>

namespace tetsuame::bench {

namespace {

struct measured {
  liquid::program program;
  int passes;
};

const measured& of_case(const std::string& name) {
  static const measured c{liquid::describe<programs::program_c>(), 2};
  static const std::map<std::string, measured> others{
      {"program_f", {liquid::describe<programs::program_f>(), 1}},
      {"number_density", {liquid::describe<programs::program_n>(), 2}},
  };
  const auto found = others.find(name);
  return found == others.end() ? c : found->second;
}

}  // namespace

const liquid::program& program_of(const std::string& name) { return of_case(name).program; }
int passes_of(const std::string& name) { return of_case(name).passes; }

}  // namespace tetsuame::bench
