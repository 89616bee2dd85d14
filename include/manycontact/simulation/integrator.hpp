#pragma once
#include <optional>
#include <string>

namespace manycontact {

/// Time stepping schemes with step h for dq/dt = v (in joint frames), dv/dt = a(q, v, u); u is constant in a step.
enum class Integrator {
  kSemiImplicitEuler,  // v+ = v + h (a without contacts) + impulse of contacts, q+ = q (+) h v+; one solve, order 1
  kRk4,                // Runge-Kutta-Munthe-Kaas; four solves, order 4
};
inline constexpr Integrator kIntegrators[] = {Integrator::kSemiImplicitEuler, Integrator::kRk4};

/// Returns the name: "semi-implicit-euler", "rk4".
std::string to_string(Integrator integrator);
/// Returns the integrator with the given name, as to_string writes it; none if there is no such integrator.
std::optional<Integrator> integrator_from_string(const std::string& name);

}  // namespace manycontact
