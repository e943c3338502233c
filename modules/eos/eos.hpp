// Equations of state by name. Each is a plain struct with
//   double pressure(rho, T)          Pa
//   double density(p, T)             kg/m^3, the inverse; fail_calculation if there is none
//   properties evaluate(rho, T)      p, K_T, alpha, c_V, c; throws nothing, a state out of
//                                    reach gives not-a-number, which the caller reports
//   description about                name, source, whether its parameters are illustrative
// with rho in kg/m^3, T in K, p in Pa. Equations and parameters: docs/theory/eos.md.
#pragma once

#include <eos/isentropic_liquid.hpp>
#include <eos/linear.hpp>
#include <eos/liquid.hpp>
#include <eos/options.hpp>
#include <eos/stiffened_gas.hpp>
#include <eos/tillotson.hpp>
#include <variant>

namespace tetsuame::eos {

using any = std::variant<linear, liquid<vinet>, liquid<birch_murnaghan>, isentropic_liquid, tillotson, stiffened_gas>;

// fail_input as resolve() does.
any make(const material_options& options);

const description& about(const any& material);
double pressure(const any& material, double rho, double T);
double density(const any& material, double p, double T);
properties evaluate(const any& material, double rho, double T);

}  // namespace tetsuame::eos
