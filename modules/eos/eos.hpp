// Equations of state by name. Each is a plain struct with
//   double pressure(rho, T)          Pa
//   double density(p, T)             kg/m^3, the inverse; fail_calculation if there is none
//   properties evaluate(rho, T)      p, K_T, alpha, c_V, c; throws nothing, a state out of
//                                    reach gives not-a-number, which the caller reports
//   description about                name, source, whether its parameters are illustrative
// with rho in kg/m^3, T in K, p in Pa. Equations and parameters: docs/theory/eos.md.
#pragma once

#include <cstddef>
#include <eos/ideal_gas.hpp>
#include <eos/isentropic_liquid.hpp>
#include <eos/linear.hpp>
#include <eos/liquid.hpp>
#include <eos/options.hpp>
#include <eos/stiffened_gas.hpp>
#include <eos/tillotson.hpp>
#include <span>
#include <variant>

namespace tetsuame::eos {

using any = std::variant<linear, liquid<vinet>, liquid<birch_murnaghan>, isentropic_liquid, tillotson, ideal_gas,
                         stiffened_gas>;

// fail_input as resolve() does.
any make(const material_options& options);

const description& about(const any& material);
double pressure(const any& material, double rho, double T);
double density(const any& material, double p, double T);
properties evaluate(const any& material, double rho, double T);

// One value a particle; all of the same length.
struct property_arrays {
  std::span<double> p, K_T, alpha, c_V, sound_speed;
};

// Particles first <= i < last, of rho and T as long as the arrays: the material is looked up
// once, so threads may each take a range. Results do not depend on how the range is cut.
void evaluate(const any& material, std::span<const double> rho, std::span<const double> T, const property_arrays& out,
              std::size_t first, std::size_t last);
void evaluate(const any& material, std::span<const double> rho, std::span<const double> T, const property_arrays& out);

}  // namespace tetsuame::eos
