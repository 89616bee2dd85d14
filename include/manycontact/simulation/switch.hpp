#pragma once
// Contacts that open and close between steps. A contact that closes stops the relative velocity of its frames at once:
//
//     [ M  J^T     ] [ v+      ]   [ M v ]
//     [ J  -delta I] [ -Lambda ] = [  0  ]
//
// Lambda is an impulse without restitution. v+ is the velocity nearest to v, in the mass-weighted norm, that the
// contacts allow; the kinetic energy decreases by that of v - v+. Opening a contact changes no velocity.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct VelocityJump {           // The result of an impact.
  Status status = Status::kOk;  // status of the impact's solve; kFailed: only the set of contacts was changed
  double energy_lost = 0;       // J
  Eigen::VectorXd impulse;      // impulse on A, rows of the active contacts as in Solution::f [N s, N m s]
};

/// Sets data.dynamics.active. If a contact closes, replaces data.v by v+. Allocates; costs one solve. Throws
/// std::invalid_argument unless `active` has one flag per contact. Thread-safe for distinct data.
VelocityJump switch_contacts(const Scene& scene, const std::vector<char>& active, SimulationData& data);

}  // namespace manycontact
