#include <algorithm>
#include <cmath>
#include <relaxation/rules.hpp>

namespace tetsuame::relaxation {

double sound_speed(const fluid_layer& f) { return std::sqrt(f.K / f.rho); }
double rayleigh(const fluid_layer& f) { return f.alpha * f.g * f.dT * f.L * f.L * f.L / (f.kappa * f.nu); }
double prandtl(const fluid_layer& f) { return f.nu / f.kappa; }
double thermal_mach(const fluid_layer& f) { return f.kappa / (f.L * sound_speed(f)); }
double thermal_strain(const fluid_layer& f) { return f.alpha * f.dT; }

double stokes_speed(const fluid_layer& f, bool boundary_layers) {
  return std::pow(rayleigh(f), boundary_layers ? 2.0 / 3.0 : 1.0) * f.kappa / f.L;
}

double free_fall_speed(const fluid_layer& f, bool boundary_layers) {
  return std::pow(rayleigh(f) * prandtl(f), boundary_layers ? 0.4 : 0.5) * f.kappa / f.L;
}

balance reached_balance(const fluid_layer& f, bool boundary_layers) {
  return stokes_speed(f, boundary_layers) <= free_fall_speed(f, boundary_layers) ? balance::viscous : balance::inertial;
}

double reached_speed(const fluid_layer& f, bool boundary_layers) {
  return reached_balance(f, boundary_layers) == balance::viscous ? stokes_speed(f, boundary_layers)
                                                                 : free_fall_speed(f, boundary_layers);
}

namespace {

struct powers {
  double Ra, Pr, M;
  explicit powers(const fluid_layer& f) : Ra(rayleigh(f)), Pr(prandtl(f)), M(thermal_mach(f)) {}

  double stokes(bool layers) const { return 1.0 / (std::pow(Ra, layers ? 2.0 / 3.0 : 1.0) * M); }       // (31), (33)
  double free_fall(bool layers) const { return 1.0 / (std::pow(Ra * Pr, layers ? 0.4 : 0.5) * M); }     // (32), (34)
  double inertia(bool layers) const { return std::sqrt(Pr) / std::pow(Ra, layers ? 1.0 / 3.0 : 0.5); }  // (39), (40)
  double later_rsst() const { return 1.0 / (std::pow(Ra, 3.0 / 7.0) * std::pow(Pr, 2.0 / 7.0) * M); }   // [S1b]
  bool later_viscous() const { return Pr > std::pow(Ra, 5.0 / 6.0); }                                   // [S1b]
};

struct bound {
  double value;
  std::string source;
};

bound rsst_bound(const powers& n, bool layers) {
  const double stokes = n.stokes(layers), fall = n.free_fall(layers);
  if (stokes >= fall) return {stokes, layers ? "S1 (33)" : "S1 (31)"};
  return {fall, layers ? "S1 (34)" : "S1 (32)"};
}

}  // namespace

std::vector<rule> all_rules(const fluid_layer& f, double phi_xi) {
  const powers n(f);
  return {
      {"zeta", "eps^1/2 / ((Ra Pr)^1/2 M_th)", "S1 (18)", "RSST without separate gravity density",
       std::sqrt(thermal_strain(f)) * n.free_fall(false)},
      {"zeta", "1 / (Ra M_th)", "S1 (31)", "RSST, Stokes speed", n.stokes(false)},
      {"zeta", "1 / ((Ra Pr)^1/2 M_th)", "S1 (32)", "RSST, free-fall speed", n.free_fall(false)},
      {"zeta", "1 / (Ra^2/3 M_th)", "S1 (33)", "RSST, Stokes speed, layers", n.stokes(true)},
      {"zeta", "1 / ((Ra Pr)^2/5 M_th)", "S1 (34)", "RSST, free-fall speed, layers", n.free_fall(true)},
      {"zeta", "max of (33), (34)", "S1 (35)", "RSST: the slower speed is reached", rsst_bound(n, true).value},
      {"xi", "Pr^1/2 / Ra^1/2", "S1 (39)", "VIM, Reynolds number", n.inertia(false)},
      {"xi", "Pr^1/2 / Ra^1/3", "S1 (40)", "VIM, Reynolds number, layers", n.inertia(true)},
      {"xi", "1 / (Ra M_th)", "S1 (43)", "VIM, Mach number", n.stokes(false)},
      {"xi", "1 / (Ra^2/3 M_th)", "S1 (44)", "VIM, Mach number, layers", n.stokes(true)},
      {"xi", "min of (40), (44)", "S1 (45)", "VIM", std::min(n.inertia(true), n.stokes(true))},
      {"zeta xi", "1 / (Ra M_th)", "S1 (49)", "RSST-VIM, Mach number", n.stokes(false)},
      {"zeta xi", "1 / (Ra^2/3 M_th)", "S1 (50)", "RSST-VIM, Mach number, layers", n.stokes(true)},
      {"zeta", "1 / (phi_xi (Ra Pr)^1/2 M_th)", "S1 (53)", "RSST-VIM with xi = phi_xi of (39)",
       n.free_fall(false) / phi_xi},
      {"zeta", "1 / (phi_xi Ra^1/3 Pr^1/2 M_th)", "S1 (54)", "RSST-VIM with xi = phi_xi of (40)",
       n.stokes(true) / (phi_xi * n.inertia(true))},
      {"zeta", "1 / (Ra^3/7 Pr^2/7 M_th)", "S1b", "later: RSST, for Pr << Ra^5/6", n.later_rsst()},
  };
}

recommendation recommend(const fluid_layer& f, const choice& wanted) {
  const powers n(f);
  const bool later = wanted.rule == "later", layers = wanted.boundary_layers || later;
  const bool viscous = later ? n.later_viscous() : reached_balance(f, layers) == balance::viscous;
  recommendation r{};
  r.layers = layers;
  r.how = wanted.method != "auto" ? wanted.method : viscous ? "rsst_vim" : "rsst";

  r.xi = 1.0;
  r.xi_rule = "not slowed";
  if (r.how == "rsst_vim" || r.how == "vim") {
    bound xi{wanted.phi_xi * n.inertia(layers), layers ? "S1 (40)" : "S1 (39)"};
    const bound by_sound{wanted.mach * n.stokes(layers), layers ? "S1 (44)" : "S1 (43)"};
    if (r.how == "vim" && by_sound.value < xi.value) xi = by_sound;
    r.xi = std::max(1.0, xi.value);
    r.xi_rule = r.xi > 1.0 ? xi.source : "at least 1";
  }
  if (wanted.xi) {
    r.xi = *wanted.xi;
    r.xi_rule = "given";
  }

  r.zeta = 1.0;
  r.zeta_rule = "not slowed";
  if (r.how == "rsst" || r.how == "rsst_vim") {
    // zeta follows from the bound of zeta xi once xi is set: (53), (54) with any xi.
    bound of_product = r.how == "rsst_vim" ? bound{n.stokes(layers), layers ? "S1 (54)" : "S1 (53)"}
                       : later             ? bound{n.later_rsst(), "S1b"}
                                           : rsst_bound(n, layers);
    r.zeta = std::max(1.0, wanted.mach * of_product.value / r.xi);
    r.zeta_rule = r.zeta > 1.0 ? of_product.source : "at least 1";
  }
  if (wanted.zeta) {
    r.zeta = *wanted.zeta;
    r.zeta_rule = "given";
  }

  r.c_eff = sound_speed(f) / (r.zeta * r.xi);
  r.Pr_eff = prandtl(f) / (r.xi * r.xi);
  r.speed = reached_speed(f, layers);
  r.mach = r.speed / r.c_eff;
  r.reynolds = r.xi * r.xi * r.speed * f.L / f.nu;
  return r;
}

}  // namespace tetsuame::relaxation
