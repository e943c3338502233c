// The fields of convection beside x, v and T of the particles, by name.
#pragma once

#include <convection/graded_viscosity.hpp>
#include <convection/options.hpp>
#include <deque>
#include <functional>
#include <operators/consistent.hpp>
#include <particles/named_fields.hpp>

namespace tetsuame::convection {

// Places of the unknowns among the fields of the operators: v, T, p, and z where the viscous response is relaxed.
template <int D>
struct unknown {
  static constexpr std::size_t T = D, p = D + 1, z = D + 2;
  static constexpr int count = D + 2, count_with_z = 2 * D + 2;
};

template <int D>
std::vector<std::string> names_of_unknowns(const parameters& layer) {
  std::vector<std::string> all;
  for (int a = 0; a < D; ++a) all.push_back("Velocity" + std::to_string(a));
  all.insert(all.end(), {"Temperature", "Pressure"});
  for (int a = 0; a < D && layer.relaxed; ++a) all.push_back("RelaxedVelocity" + std::to_string(a));
  return all;
}

// What the operators need of an earlier evaluation.
template <int D>
struct lagged_terms {
  static constexpr std::size_t S = operators::symmetric_terms(D), N = angular_terms;
  template <std::size_t K>
  using vector_field = particles::vector_field<K>;

  // Of each unknown: the plain Laplacian P, for the deferred correction and curvature at walls that do not slip; and G,
  // for the noise.
  std::vector<particles::array*> laplacian;
  std::vector<vector_field<D>> gradient;
  vector_field<S> tensor;  // B of the Laplacian
  // Where the viscosity varies, (∇v + ∇vᵀ - ∇·v)·∇ln ν, 1/(m s), for the pressure at walls; and, in 2-D, ν A, m/s2, and
  // a of the isotropic line forces, graded_viscosity.hpp, and ν, m2/s.
  vector_field<D> stress, force;
  vector_field<N> angles;
  particles::array* viscosity = nullptr;

  std::vector<particles::array*> all, of_neighbours;  // of these; what a particle needs of its neighbours too

  // make(name, unit): the array of a component.
  using maker = std::function<particles::array&(const std::string& name, const std::string& unit)>;
  lagged_terms(const parameters& layer, const maker& make) {
    const auto add = [&](const std::string& name, const std::string& unit) {
      return all.emplace_back(&make(name, unit));
    };
    const auto add_vector = [&]<std::size_t K>(vector_field<K>& field, const std::string& name,
                                               const std::string& unit) {
      std::array<particles::array*, K> components;
      for (std::size_t k = 0; k < K; ++k) components[k] = add(name + "_" + std::to_string(k), unit);
      field = vector_field<K>(components);
    };
    const auto names = names_of_unknowns<D>(layer);
    for (const auto& name : names) laplacian.push_back(add("LaplacianOf" + name, ""));
    for (const auto& name : names) add_vector(gradient.emplace_back(), "GradientOf" + name, "");
    if (layer.law.varies) add_vector(stress, "GradedStress", "1/(m s)");
    if (layer.law.varies && graded_viscosity<D>::isotropic) {
      add_vector(force, "ViscousForce", "m/s^2");
      add_vector(angles, "LineWeight", "1");
      viscosity = add("EarlierViscosity", "m^2/s");
    }
    of_neighbours = all;
    add_vector(tensor, "LaplacianWeight", "1");
  }
};

// What one pass over the neighbours leaves, for the fluid.
template <int D>
struct sums {
  std::deque<particles::array> own;  // of all these
  template <std::size_t K>
  particles::vector_field<K> make() {
    std::array<particles::array*, K> all;
    for (auto& a : all) a = &own.emplace_back();
    return particles::vector_field<K>(all);
  }

  lagged_terms<D> latest;  // what the next evaluations may lag behind
  // L and Q of each unknown.
  particles::vector_field<unknown<D>::count_with_z> laplacian = make<unknown<D>::count_with_z>(),
                                                    noise = make<unknown<D>::count_with_z>();
  particles::vector_field<D> uneven = make<D>();  // 1/m, how unevenly particles stand
  particles::array& W = own.emplace_back();       // Σ W, 1/m^D
  // Where the viscosity varies: its force over ν and that without correction, 1/(m s); ∇ln ν, 1/m; contrast.
  particles::vector_field<D> viscous = make<D>(), plain_viscous = make<D>(), log_slope = make<D>();
  particles::array &viscous_contrast = own.emplace_back(), &sound_contrast = own.emplace_back();

  explicit sums(const parameters& layer)
      : latest(layer, [&](const std::string&, const std::string&) -> particles::array& { return own.emplace_back(); }) {
  }
  sums(const sums&) = delete;

  void resize(std::size_t n) {  // room for n particles
    for (auto& a : own)
      if (a.size() < n) a.resize(n);
  }
};

}  // namespace tetsuame::convection
