#include "manycontact/simulation/integrator.hpp"

namespace manycontact {

std::string to_string(Integrator integrator) {
  switch (integrator) {
    case Integrator::kSemiImplicitEuler:
      return "semi-implicit-euler";
    case Integrator::kRk4:
      return "rk4";
  }
  return "?";
}

std::optional<Integrator> integrator_from_string(const std::string& name) {
  for (Integrator integrator : kIntegrators)
    if (to_string(integrator) == name) return integrator;
  return std::nullopt;
}

}  // namespace manycontact
