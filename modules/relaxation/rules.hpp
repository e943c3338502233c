// How far sound and inertia may be slowed without changing the flow:
//   RSST, the reduced speed of sound:  zeta^2 D rho/Dt = -rho div v, so c = c_0/zeta;
//   VIM, the variable inertia method:  xi^2 Dv/Dt = …,               so Pr_eff = Pr/xi^2;
//   both:                              c_eff = c_0/(zeta xi)
// [S1 (1)-(5), (48); VIM: Takeyama, Saitoh & Makino, New Astron. 50, 82 (2017)]. Each rule bounds zeta, xi or zeta xi
// from above; the note writes "much less than", and takes a tenth: the Mach number is then 0.1. [S1b]: the same author,
// June 2023.
#pragma once

#include <optional>
#include <relaxation/numbers.hpp>
#include <string>
#include <vector>

namespace tetsuame::relaxation {

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
  std::optional<double> zeta = std::nullopt, xi = std::nullopt;  // given: taken as they are
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

// zeta and xi are never below 1: slowed is what they are for. fail_input if one given is below 1.
recommendation recommend(const fluid_layer& f, const choice& wanted);

}  // namespace tetsuame::relaxation
