#include "manycontact/simulation/integrator.hpp"

namespace manycontact {

std::string to_string(Integrator integrator) { return integrator == Integrator::kRk4 ? "rk4" : "semi-implicit-euler"; }

std::optional<Integrator> integrator_from_string(const std::string& name) {
  for (Integrator integrator : kIntegrators)
    if (to_string(integrator) == name) return integrator;
  return std::nullopt;
}

}  // namespace manycontact
