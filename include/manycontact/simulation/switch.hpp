#pragma once
// Contacts that come and go between steps. A contact that closes stops its frames' relative velocity at once:
//
//     [ M  J^T     ] [ v+      ]   [ M v ]
//     [ J  -delta I] [ -Lambda ] = [  0  ]
//
// an impulse Lambda without restitution. v+ is the nearest velocity to v, in the kinetic metric, that the contacts
// allow; kinetic energy falls by that of v - v+. A contact that opens changes nothing but the set.

#include "manycontact/simulation/step.hpp"

namespace manycontact {

struct VelocityJump {           // What an impact did.
  Status status = Status::kOk;  // of its solve; kFailed: nothing was changed but the set of contacts
  double energy_lost = 0;       // J
  Eigen::VectorXd impulse;      // rows of the active contacts, as Solution::f: on A [N s, N m s]
};

/// Sets data.dynamics.active and, where a contact closes, replaces data.v by v+. Allocates. Throws
/// std::invalid_argument unless `active` has a flag for each contact.
VelocityJump switch_contacts(const Scene& scene, const std::vector<char>& active, SimulationData& data);

}  // namespace manycontact
