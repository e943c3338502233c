// What the input says of a scheme for liquids, groups &volume, &viscosity, &energy, &smoothing and &hosono; and what
// Hosono's iteration tells when it fails.
#pragma once

#include <cstdint>
#include <foundation/error.hpp>
#include <namelist/schema.hpp>
#include <string>

namespace tetsuame::volume {

// Smoothing divided by the kernel sum; see smoothed.hpp for which sum.
struct smoothing_options {
  bool normalise = false;
};

struct hosono_options {
  std::string solver = "plain";  // plain, under_relaxed, anderson, newton
  double tolerance = 1e-12;      // of max |ln(Y_new/Y)|
  std::int64_t max_iterations = 1000;
  double relaxation = 0.0;  // exponent ω; 0: the least p/K_T of all particles
  std::int64_t anderson_depth = 5;
};

// How a density, or Y, that is integrated is kept with the particles' places (docs/theory/consistency.md).
struct consistency_options {
  std::string name = "none";  // none, tied
  double rate = 0.005;        // of tied: 1/τ over c/Δx
  bool ties() const { return name == "tied"; }
};

// Which of temperature and internal energy is integrated (docs/theory/energy_variable.md).
struct energy_options {
  std::string variable = "temperature";  // temperature, internal_energy
  bool internal() const { return variable == "internal_energy"; }
};

struct options {
  std::string stress = "auto";  // viscous: laplacian, symmetric; of a run one of these
  consistency_options consistency;
  energy_options energy;
  smoothing_options smoothing;
  hosono_options hosono;
};

void declare(namelist::schema& schema, options& o);
// Refuses a rate that nothing has. contrast: viscosities differ.
void resolve(const namelist::schema& schema, options& o, bool contrast);

struct residual_record {
  std::int64_t evaluation;  // of the right-hand side, from 1
  std::int64_t iteration;   // within it, from 1
  double residual;          // max |ln(Y_new/Y)|; not finite: p^ <= 0 somewhere
};

// The iteration had no end: an outcome of the method, told with its reason.
class divergence : public foundation::error {
 public:
  divergence(std::int64_t iteration, const std::string& message)
      : foundation::error(foundation::exit_status::calculation_failed, message), iteration_(iteration) {}
  std::int64_t iteration() const { return iteration_; }

 private:
  std::int64_t iteration_;
};

}  // namespace tetsuame::volume
