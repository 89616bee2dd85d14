#pragma once
#include <optional>
#include <string>

namespace manycontact {

/// Time steps of size h of dq/dt = v (in each joint's own frame), dv/dt = a(q, v, u), u constant.
enum class Integrator {
  kSemiImplicitEuler,  // v+ from v + h a_free by an impulse of the contacts, q+ = q (+) h v+; one solve, order 1
  kRk4,                // Runge-Kutta-Munthe-Kaas; four solves, order 4
};
inline constexpr Integrator kIntegrators[] = {Integrator::kSemiImplicitEuler, Integrator::kRk4};

/// "semi-implicit-euler", "rk4".
std::string to_string(Integrator integrator);
/// The integrator called `name`, as to_string writes it.
std::optional<Integrator> integrator_from_string(const std::string& name);

}  // namespace manycontact
