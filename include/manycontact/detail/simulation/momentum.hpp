#pragma once
// Momentum of bodies without connection to the world.
//
// In a robot's own coordinates, semi-implicit Euler loses momentum by an error of first order: inertias change within a
// step, while bias forces are those of its start. The exact rate of momentum is known, however. Bodies connected to
// each other by joints and contacts, but not to the world, form a group. Let m be its mass, P its momentum, C its
// centre of mass and L its angular momentum about C. In a step
//
//     P+ = P + h F        C+ = C + h P+ / m        L+ = L + h T
//
// where F, T are gravity and the torques of joints between the group and the world, such as planar ones. Therefore a
// step ends by moving each group as one rigid body, which changes no joint and no contact within the group:
//
//     C := C+                              a displacement
//     [ m 1   0  ] [ dv ]   [ P+ - P ]
//     [  0   I_C ] [ dw ] = [ L+ - L ]     a velocity, with I_C the group's inertia about C
//
// This is a projection onto the conserved quantities (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed.,
// section IV.4), along the corresponding symmetry. Linear and angular momentum are conserved up to rounding errors for
// any h, and a centre of mass moves as a particle does under semi-implicit Euler.
//
// With a planar joint at the world, or a 1D contact with it in world axes, a group can move in a plane. The projection
// is then limited to that plane. Any other connection to the world leaves the group unchanged.

#include <vector>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// A group of bodies and its momentum.
struct FreeGroup {
  bool tied = true;  // whether the group is connected to the world, or has no bodies; the other members are unset then
  bool in_plane = false;  // only motions in the plane across `normal` are free
  Vec3<double> normal;    // unit, in the world

  Vec3<double> reference;       // a point of the world near the bodies; other members refer to it, in world axes
  Inertia<double> Y;            // inertia of all bodies together
  Vec6<double> momentum;        // linear [N s], angular [N m s]
  Vec3<double> C_next;          // C+ [m]
  Vec3<double> P_next, L_next;  // P+ [N s], L+ [N m s]
  Vec3<double> d;               // the displacement [m]
  Vec3<double> dv, dw;          // the velocity: that of C [m/s], angular [rad/s]
};

/// The groups of a scene, and the workspace. Bodies are numbered through the scene, robot by robot.
struct FreeGroups {
  /// Finds the joints of the scene below which a group may begin.
  explicit FreeGroups(const Scene& scene);

  struct FreeJoint {                 // a joint below which a group may begin: floating, or planar at the world
    int robot, joint, node, parent;  // node: the bodies below it; parent: the bodies above; 0: fixed to the world, or
                                     // attached to it by ordinary joints
  };
  std::vector<FreeJoint> joints;  // sorted in the scene's order
  std::vector<int> first_body;    // one entry per robot: the number of its first body
  std::vector<int> node;          // one entry per body: the node that it belongs to, rigidly or by ordinary joints
  std::vector<int> group;         // one entry per node: the number of its group
  std::vector<FreeGroup> groups;  // one entry per node
  bool any = false;               // whether a group is free
  bool nested = false;            // whether a free joint is attached to a body that moves
};

/// Finds the groups before a step of size h from q, v, with the contacts flagged `active`, and computes their momentum
/// after the step. `tau` (nv) has the torques of motors, external wrenches and springs on every velocity coordinate.
/// `kin` has the kinematics of each robot at q and v. Allocates nothing.
void begin_free_motion(const Scene& scene, const std::vector<char>& active, const ConstVectorRef& tau, double h,
                       const std::vector<Kinematics<double>>& kin, FreeGroups& groups);

/// Moves the groups of q (nq), v (nv), the state after the step, to that momentum. kin: per robot, workspace. Allocates
/// nothing.
void end_free_motion(const Scene& scene, Eigen::VectorXd& q, Eigen::VectorXd& v, std::vector<Kinematics<double>>& kin,
                     FreeGroups& groups);

}  // namespace manycontact
