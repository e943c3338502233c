// Viscosity by temperature and depth (m below the top) that no formula of two exponents gives: from a file, or by melt
// fraction. ln ν is bilinear between the values of a rectangular grid; beyond it, and the file:
// docs/theory/convection_viscosity.md, "Laws".
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tetsuame::convection {

class viscosity_table {
 public:
  // `viscosity`: Pa s, of T (K) and depth (m), > 0; at all pairs of the two lists, which ascend and are not empty.
  viscosity_table(std::vector<double> T, std::vector<double> depth,
                  const std::function<double(double T, double depth)>& viscosity);
  // fail_input with file, line and reason where it is no such table.
  static viscosity_table read(const std::string& path);

  double log(double T, double depth) const;  // ln(Pa s)
  bool covers(double T, double depth) const;

  const std::vector<double>& temperatures() const { return T_; }
  const std::vector<double>& depths() const { return depth_; }

 private:
  viscosity_table() = default;
  std::vector<double> T_, depth_;
  std::vector<double> log_;  // depth changes fastest
};

// ν over that of the top: exp(-b (T - T_top)/ΔT + c (1 - y/L)), or by a table.
struct viscosity_law {
  bool varies = false;
  double b = 0.0, c = 0.0;                       // exponents of temperature and depth
  double T_top = 0.0, dT = 1.0, L = 1.0;         // K, K, m
  std::shared_ptr<const viscosity_table> table;  // null: by the exponents
  double log_reference = 0.0;                    // of the table at the top, ln(Pa s)
  double log_middle = 0.0;                       // ln of the viscosity in the middle of the layer over that of the top

  double log(double T, double y) const {  // y: m above the bottom
    return table ? table->log(T, L - y) - log_reference : -b * (T - T_top) / dT + c * (1.0 - y / L);
  }
};

}  // namespace tetsuame::convection
