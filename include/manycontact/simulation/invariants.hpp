#pragma once
// What exact motion keeps: the errors of contacts (zero if they start so), energy without torques,
// pushes, dampers and gains, momentum without gravity and contacts with the world.

#include <vector>

#include "manycontact/contact/rows.hpp"

namespace manycontact {

struct Invariants {           // Of a scene at one state.
  double position_drift = 0;  // max |W e| over the active contacts, with e = log6(G) or R_A^T (p_A - p_B') [m, rad]
  double velocity_drift = 0;  // max |J v| [m/s, rad/s]
  double kinetic = 0;         // J, rotors (armature) included
  double potential = 0;       // J, of gravity, zero at the world's origin, and of springs
  Vec6<double> momentum = Vec6<double>::Zero();  // of the bodies, about the world's origin: linear [N s], angular

  double energy() const { return kinetic + potential; }  // J
};

/// Room for `invariants`.
struct InvariantsData {
  explicit InvariantsData(const Scene& scene);  // for this scene
  std::vector<Kinematics<double>> kin;          // per robot
  std::vector<ContactSupport> supports;         // per contact
  std::vector<ContactData<double>> contacts;    // per contact
};

/// At q (nq), v (nv), with the contacts flagged `active`. W and e are those of contact/rows.hpp. A 1D or 2D contact
/// whose axes turn holds a direction, not a place: its position drift grows in exact motion too. Allocates nothing.
Invariants invariants(const Scene& scene, const std::vector<char>& active, const Eigen::Ref<const Eigen::VectorXd>& q,
                      const Eigen::Ref<const Eigen::VectorXd>& v, InvariantsData& data);

}  // namespace manycontact
