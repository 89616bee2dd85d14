#pragma once
// Opens and closes contacts between steps. A closing contact stops its frames' relative velocity at once:
//
//     [ M  J^T     ] [ v+      ]   [ M v ]
//     [ J  -delta I] [ -Lambda ] = [  0  ]
//
// M is the joint-space inertia, J the contact rows, delta the damping, and Lambda the impulse, without rebound. The
// velocity v+ is the one allowed by the contacts that is nearest to v in the norm of M. Opening a contact changes no
// velocity.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct VelocityJump {           // The result of an impact.
  Status status = Status::kOk;  // status of the impact's solve; kFailed: only the set of contacts was changed
  double energy_lost = 0;       // kinetic energy lost [J]
  Eigen::VectorXd impulse;      // impulse on A, rows of the active contacts as in Solution::f [N s, N m s]
};

/// Sets data.dynamics.active to `active`. If a contact closes, replaces data.v by v+, by one solve. Allocates. Throws
/// std::invalid_argument unless `active` has one flag per contact. Thread-safe for distinct data.
VelocityJump switch_contacts(const Scene& scene, const std::vector<char>& active, SimulationData& data);

}  // namespace manycontact
