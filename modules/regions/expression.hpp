// A value by an expression of an input, such as '1500 + 200*sin(2*pi*x/length_x)': muParser's syntax, with + - * / ^,
// comparisons, && ||, a ? b : c, and the functions sin, cos, tan, their inverses, atan2, sinh, cosh, tanh, exp, ln,
// log10, sqrt, abs, sign, min, max, hypot. A number alone needs no muParser.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tetsuame::regions {

class expression {
 public:
  // variables: their names, in the order in which at() has their values. Fails, with bad_input, where the text is no
  // expression of these and of the constants.
  expression(std::string text, const std::vector<std::string>& variables,
             const std::map<std::string, double>& constants);

  const std::string& text() const { return text_; }
  // Whether its value is that of one of these variables' as well.
  bool uses(const std::vector<std::string>& variables) const;
  // By one thread at a time, as those of copies. May be not finite, as 1/x at 0 is.
  double at(std::span<const double> values) const;

 private:
  struct parser;
  std::string text_;
  double number_ = 0.0;             // of a text that is one
  std::shared_ptr<parser> parser_;  // of another
};

// Whether expressions beside numbers are read.
bool has_expressions();

}  // namespace tetsuame::regions
