#pragma once
// Quantities that exact motion conserves. Constraint errors that are zero remain zero. Energy is conserved without
// torques, external wrenches, dampers and gains; momentum without gravity and contacts with the world.

#include <vector>

#include "manycontact/detail/contact/rows.hpp"

namespace manycontact {

struct Invariants {           // The quantities of a scene at one state.
  double violation_position = 0;  // max |W e| of active contacts, e = log6(G) or R_A^T (p_A - p_B') [m, rad]
  double violation_velocity = 0;  // max |J v| of active contacts [m/s, rad/s]
  double kinetic = 0;         // J, rotors (armature) included
  double potential = 0;       // J, due to gravity (zero at the world's origin) and springs
  Vec6<double> momentum = Vec6<double>::Zero();  // momentum of the bodies, about the world's origin: linear
                                                 // [N s], angular [N m s]

  double energy() const { return kinetic + potential; }  // total energy [J]
};

/// The workspace of `invariants`.
struct InvariantsData {
  explicit InvariantsData(const Scene& scene);  // makes the workspace for this scene
  std::vector<Kinematics<double>> kin;          // one entry per robot
  std::vector<ContactSupport> supports;         // one entry per contact
  std::vector<ContactData<double>> contacts;    // one entry per contact
};

/// Computes the quantities at q (nq), v (nv), with the contacts flagged `active`. For W and e see
/// detail/contact/rows.hpp. The position error of a 1D or 2D contact whose axes rotate also grows in exact motion, as
/// the contact constrains a direction and no position. Allocates nothing. Thread-safe for distinct data.
Invariants invariants(const Scene& scene, const std::vector<char>& active, const ConstVectorRef& q,
                      const ConstVectorRef& v, InvariantsData& data);

}  // namespace manycontact
