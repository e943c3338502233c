// The non-dimensional numbers of thermal convection, the speeds it may reach, and how far sound and inertia may be
// slowed without changing the flow:
//   RSST, the reduced speed of sound:  zeta^2 D rho/Dt = -rho div v, so c = c_0/zeta, c_0 = sqrt(K_0/rho_0);
//   VIM, the variable inertia method:  xi^2 Dv/Dt = …,               so Pr_eff = Pr/xi^2;
//   both:                              c_eff = c_0/(zeta xi)
// Each rule bounds zeta, xi or zeta xi from above; the notes [S1], [S1b], and what "much less than" is:
// docs/theory/relaxation.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tetsuame::relaxation {

struct fluid_layer {
  double L;      // m, height
  double dT;     // K, bottom less top
  double rho;    // kg/m3
  double kappa;  // m2/s, thermal diffusivity
  double nu;     // m2/s, kinematic viscosity
  double g;      // m/s2
  double alpha;  // 1/K
  double K;      // Pa, bulk modulus
};

double sound_speed(const fluid_layer& f);     // m/s
double rayleigh(const fluid_layer& f);        // (19)
double prandtl(const fluid_layer& f);         // (20)
double thermal_mach(const fluid_layer& f);    // (21)
double thermal_strain(const fluid_layer& f);  // epsilon = alpha DeltaT, (22)

// Speeds (m/s) at which buoyancy is balanced by viscosity (Stokes) or by inertia (free fall); with
// thermal boundary layers buoyancy acts on the layer's width sqrt(kappa L/V) only.
double stokes_speed(const fluid_layer& f, bool boundary_layers);     // Ra M_th c_0, Ra^(2/3) M_th c_0: (23), (25)
double free_fall_speed(const fluid_layer& f, bool boundary_layers);  // (Ra Pr)^(1/2), (Ra Pr)^(2/5): (24), (26)

enum class balance { viscous, inertial };
// The slower of the two is what the flow reaches [S1, appendix].
balance reached_balance(const fluid_layer& f, bool boundary_layers);
double reached_speed(const fluid_layer& f, bool boundary_layers);  // m/s

struct rule {
  std::string limits;   // "zeta", "xi", "zeta xi"
  std::string formula;  // the right-hand side of "<<"
  std::string source;   // equation
  std::string says;     // for whom, and why
  double bound;
};

// Every rule of the note and the later one, in the note's order. phi_xi as in choice.
std::vector<rule> all_rules(const fluid_layer& f, double phi_xi);

struct choice {
  std::string method = "auto";        // rsst_vim where the Stokes speed is the slower one, else rsst; or one of these
  std::string rule = "slower_speed";  // of [S1]; "later": of [S1b]
  bool boundary_layers = true;        // the wider bounds
  double mach = 0.1, phi_xi = 0.5;    // V/c_eff, the factor below the bound; xi below its bound
  std::optional<double> zeta = std::nullopt, xi = std::nullopt;  // >= 1; given: taken as they are
};

struct recommendation {
  std::string how;  // none, rsst, vim, rsst_vim
  double zeta, xi;
  std::string zeta_rule, xi_rule;  // source of the rule that set it, or "given", "not slowed", "at least 1"
  bool layers;                     // boundary layers were counted on
  double c_eff;                    // m/s
  double Pr_eff;                   // Pr/xi^2
  double speed;                    // m/s, the one the flow reaches
  double mach;                     // speed/c_eff
  double reynolds;                 // xi^2 V L/nu
  // Of nu/xi^2 and of c_eff, what binds a step where a program makes other waves of them.
  double viscous_share = 1.0, wave_share = 1.0;
};

// zeta and xi are never below 1: slowed is what they are for.
recommendation recommend(const fluid_layer& f, const choice& wanted);

}  // namespace tetsuame::relaxation
