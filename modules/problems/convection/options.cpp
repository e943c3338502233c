#include <convection/options.hpp>
#include <eos/keys.hpp>

namespace tetsuame::convection {

namespace {

using namelist::between, namelist::for_expert, namelist::positive, namelist::up_to;

constexpr const char* g = "convection";

void declare_numbers(namelist::schema& schema, convection_options& o) {
  schema.add(g, "rayleigh", o.rayleigh,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "alpha g DeltaT length_y^3/(kappa nu), DeltaT that of bottom and top or, where these are "
                         "adiabatic and left and right fixed, of left and right; "
                         "overrides the expansivity and keeps the Prandtl number; the viscosity where the expansivity "
                         "is not free: heat of friction or of compression, an equation of state, viscosity_law "
                         "'table' or 'melt'"});
  schema.add(g, "prandtl", o.prandtl,
             {.minimum = 0.0,
              .exclusive_minimum = true,
              .meaning = "overrides the viscosity and keeps the Rayleigh number, by the expansivity"});
  schema.add(g, "viscous_heating", o.viscous_heating, {.meaning = "heat from friction, 2 nu e:e"});
  schema.add(g, "adiabatic_heating", o.adiabatic_heating,
             {.meaning = "cooling of what rises, alpha g v_y T; temperatures are absolute then"});
  schema.add(g, "heating", o.heating, {.unit = "W/kg", .meaning = "from inside, uniform"});
}

void declare_aim(namelist::schema& schema, convection_options& o) {
  schema.add(g, "target", o.target,
             {.choices = {"auto", "steady", "transient"},
              .meaning = "steady: inertia acts on the rate of velocity at a place, and vanishes in a steady flow, "
                         "whatever xi; transient: on D v/D t; auto: steady where viscosity balances buoyancy"});
  schema.add(
      g, "steady_tolerance", o.steady_tolerance,
      between(
          0.0, 1.0,
          "the run ends when Nusselt number and rms velocity change by less over six turnovers, or, with "
          "one viscosity and the steady state as the aim, are known to it beside a swing that dies; 0: at t_end only"));
  schema.add(
      g, "levels", o.levels,
      for_expert(between(-1, 10,
                         "the run starts with twice the particle spacing, so many times twice, and goes on with half "
                         "of it whenever the flow is steady to ten times steady_tolerance, which it needs. -1: as many "
                         "as resolve the flow where only the steady state is the aim and the viscosity is constant, "
                         "else none")));
  schema.add(g, "steady_mach", o.steady_mach,
             for_expert(up_to(10.0,
                              "target steady: Ra^(2/3) kappa/L over slowed sound; the flow itself is about six times "
                              "slower: at 1.5, Mach 0.25. Not given: 1.5, where the viscosity varies 1")));
}

void declare_gravity(namelist::schema& schema, convection_options& o) {
  schema.add(g, "gravity_density", o.gravity_density,
             {.choices = {"boussinesq", "separated", "conventional", "equation_of_state"},
              .meaning = "gravity feels -alpha T', with p'/K_0 (GDS), or with the slowed fluid's zeta^2 p'/K_0; or the "
                         "density of an equation of state at the pressure of a column at rest, and p'/K"});
  std::vector<std::string> materials(eos::names().begin(), eos::names().end());
  schema.add(g, "eos", o.eos,
             {.choices = materials,
              .meaning = "whose density gravity feels, temperatures are absolute then; linear: of &material"});
  schema.add(g, "eos_table", o.eos_table, for_expert(eos::key_of_table()));
  schema.add(
      g, "p_top", o.p_top,
      {.unit = "Pa", .meaning = "pressure on top of the column at rest, for eos and viscosity by melt fraction"});
  schema.add(g, "eos_dynamic_pressure", o.eos_dynamic_pressure,
             {.expert = true,
              .meaning = "with eos: gravity feels p'/K too; the heat of that compression is not in the balance"});
}

void declare_viscosity(namelist::schema& schema, convection_options& o) {
  schema.add(
      g, "viscosity_law", o.viscosity_law,
      {.choices = {"constant", "blankenbach_2a", "blankenbach_2b", "exponential", "table", "melt"},
       .meaning = "nu = nu_0 exp(-b (T - T_top)/DeltaT + c depth/L); 2a: b = ln 1000, 2b: b = ln 16384, c = ln 64; "
                  "exponential: exponents of &expert; of "
                  "viscosity_file; or by melt fraction between the mantle's solidus and liquidus at the pressure of a "
                  "column at rest (temperatures are absolute then); a Rayleigh number given scales the last two"});
  schema.add(g, "viscosity_file", o.viscosity_file,
             {.file = namelist::file_of::run,
              .meaning = "law 'table': a table of temperature (K), depth (m), viscosity (Pa s), a line for each pair, "
                         "ascending, depth fastest; ln nu is bilinear between"});
  const auto limit = [&](const char* key, double& value, const char* meaning) {
    schema.add(g, key, value, for_expert(positive("Pa s", meaning)));
  };
  schema.add(g, "melt_viscosity", o.melt_viscosity,
             {.choices = {"suspension", "blended"},
              .expert = true,
              .meaning = "law 'melt': of Lebrun et al., or its logarithm from solid to liquid by tanh of the melt "
                         "fraction"});
  limit("viscosity_min", o.viscosity_min, "law 'melt': the viscosity is not below this");
  limit("viscosity_max", o.viscosity_max, "law 'melt': nor above this");
  schema.add(g, "viscosity_ramp", o.viscosity_ramp,
             {.unit = "s",
              .minimum = 0.0,
              .meaning = "the exponents grow from zero over this time; with one viscosity and the steady state as the "
                         "aim it falls over this time from that at which Ra is 1000. Not given: 0; falling, 0.033 "
                         "L^2/kappa for each power of ten"});
  schema.add(g, "temperature_exponent", o.temperature_exponent,
             {.expert = true, .meaning = "b of the exponential law"});
  schema.add(g, "depth_exponent", o.depth_exponent, {.expert = true, .meaning = "c of the exponential law"});
  schema.add(g, "composition", o.composition,
             {.choices = {"peridotitic", "chondritic"},
              .expert = true,
              .meaning = "law 'melt': of the liquidus above 20 GPa"});
}

void declare_noise(namelist::schema& schema, convection_options& o) {
  schema.add(
      g, "pressure_diffusion", o.pressure_diffusion,
      for_expert(between(0.0, 1.0,
                         "delta of the term that smooths the pressure's noise; not given: target transient 0.4, steady "
                         "0.2, with one viscosity 0.02")));
  schema.add(
      g, "remap_diffusion", o.remap_diffusion,
      for_expert(between(
          0.0, 10.0, "of the noise in temperature and velocity, times the speed with which particles are shifted")));
  schema.add(g, "shifting", o.shifting, for_expert(between(0.0, 10.0, "strength of the particle shifting")));
}

}  // namespace

void declare(namelist::schema& schema, options& o) {
  domain::declare(schema, demands, o.domain);
  relaxation::declare(schema, o.physics);
  schema.group(g, "numbers, aim, gravity and viscosity");
  declare_numbers(schema, o.convection);
  declare_aim(schema, o.convection);
  declare_gravity(schema, o.convection);
  declare_viscosity(schema, o.convection);
  declare_noise(schema, o.convection);
  schema.group("initial", "start: conduction, at rest, with a disturbance");
  schema.add(
      "initial", "perturbation", o.initial.perturbation,
      between(-1.0, 1.0,
              "a of T = T_conductive + a DeltaT cos(half_waves pi x/length_x) sin(pi y/L); x and y change places "
              "where heat goes from left to right"));
  schema.add("initial", "half_waves", o.initial.half_waves,
             between(0, 1000, "along x; along y where heat goes from left to right"));
  schema.add("initial", "temperature_noise", o.initial.temperature_noise,
             between(0.0, 1.0,
                     "b of T + b DeltaT r, r of each particle a random number between -1 and 1, by its ID and the "
                     "seed: the same on any number of processes"));
  schema.add("initial", "noise_seed", o.initial.noise_seed, for_expert(between(0, 1000000, "of those random numbers")));
  auto& sides = o.walls.sides;
  o.walls.slip = "free_slip";
  sides[2].thermal = sides[3].thermal = "fixed";
  sides[2].temperature = 1000.0;
  sides[3].temperature = 0.0;
  walls::declare(schema, {.flux = true}, o.walls);
  o.common.kernel.skin = 0.6;  // a particle moves by a sixth of its spacing and more in one step of slowed sound
  regions::declare(schema, of_regions, o.of_regions);
  sources::declare(schema, {}, o.of_sources);
  run::declare(
      schema, o.common,
      {.single_pairs = true, .keeping = {"ab2"}, .starts_from_file = true, .reads = "places and temperatures"});
}

}  // namespace tetsuame::convection
