#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <foundation/error.hpp>
#include <namelist/text.hpp>
#include <regions/expression.hpp>

#if TETSUAME_MUPARSER
#include <muParser.h>
#endif

namespace tetsuame::regions {

bool has_expressions() { return TETSUAME_MUPARSER; }

#if TETSUAME_MUPARSER

namespace {

double hypot(double a, double b) { return std::hypot(a, b); }

}  // namespace

struct expression::parser {
  mu::Parser of;
  std::vector<double> values;

  parser(const std::string& text, const std::vector<std::string>& variables,
         const std::map<std::string, double>& constants)
      : values(variables.size(), 1.0) {
    try {
      of.DefineFun("hypot", hypot);
      of.DefineConst("pi", M_PI);
      for (const auto& [name, value] : constants) of.DefineConst(name, value);
      for (std::size_t k = 0; k < variables.size(); ++k) of.DefineVar(variables[k], &values[k]);
      of.SetExpr(text);
      of.Eval();
    } catch (const mu::ParserError& e) {
      std::vector<std::string> known = variables;
      known.emplace_back("pi");
      for (const auto& [name, value] : constants) known.push_back(name);
      foundation::fail_input(
          fmt::format("{}: {}; known are {}; operators + - * / ^ (power) < <= > >= == != && (and) || (or)",
                      namelist::quote(namelist::excerpt(text)), e.GetMsg(), fmt::join(known, ", ")));
    }
    if (of.GetNumResults() != 1)
      foundation::fail_input(
          fmt::format("{} has several values: expected one", namelist::quote(namelist::excerpt(text))));
  }
};

#else

struct expression::parser {
  parser(const std::string& text, const std::vector<std::string>&, const std::map<std::string, double>&) {
    foundation::fail_input(namelist::quote(namelist::excerpt(text)) +
                           ": this program was built without muParser, which reads expressions: expected a number");
  }
};

#endif

expression::expression(std::string text, const std::vector<std::string>& variables,
                       const std::map<std::string, double>& constants)
    : text_(std::move(text)) {
  if (const auto number = namelist::to_real(text_))
    number_ = *number;
  else
    parser_ = std::make_shared<parser>(text_, variables, constants);
}

bool expression::uses([[maybe_unused]] const std::vector<std::string>& variables) const {
  if (!parser_) return false;
#if TETSUAME_MUPARSER
  const auto& used = parser_->of.GetUsedVar();
  return std::ranges::any_of(variables, [&](const std::string& name) { return used.count(name) > 0; });
#else
  return false;
#endif
}

double expression::at([[maybe_unused]] std::span<const double> values) const {
  if (!parser_) return number_;
#if TETSUAME_MUPARSER
  std::copy_n(values.begin(), parser_->values.size(), parser_->values.begin());
  return parser_->of.Eval();
#else
  return 0.0;
#endif
}

}  // namespace tetsuame::regions
