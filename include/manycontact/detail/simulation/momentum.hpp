#pragma once
// Momentum of groups of bodies that have no connection to the world.
//
// In a robot's own coordinates, semi-implicit Euler loses momentum by an error of first order. The reason is that
// inertias change within a step, but the bias forces are those at the start of the step. The exact rate of momentum is
// known, however. Bodies connected to each other by joints and contacts, but not to the world, form a group. Let m be
// the group's mass, P its momentum, C its centre of mass and L its angular momentum about C. In a step of size h
//
//     P+ = P + h F        C+ = C + h P+ / m        L+ = L + h T
//
// where F is the force and T the torque on the group, by gravity and by joints to the world such as planar ones. Each
// step ends by moving the group as one rigid body, which changes no joint and no contact within the group:
//
//     C := C+                              a displacement
//     [ m 1   0  ] [ dv ]   [ P+ - P ]
//     [  0   I_C ] [ dw ] = [ L+ - L ]     a velocity, with I_C the group's inertia about C
//
// This is a projection onto the conserved quantities (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed.,
// section IV.4), along the corresponding symmetry. Linear and angular momentum are conserved up to rounding errors for
// any h. The centre of mass moves as a particle does under semi-implicit Euler.
//
// A planar joint at the world, or a 1D contact with the world in world axes, lets a group move in a plane only. The
// projection is then limited to that plane. With any other connection to the world, the group is left unchanged.

#include <vector>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// A group of bodies and its momentum; C, P, L, h are those of the file header.
struct FreeGroup {
  bool tied = true;       // whether the group is connected to the world, or is empty; other members are then unset
  bool in_plane = false;  // whether the group can move only in the plane across `normal`
  Vec3<double> normal;    // unit vector in the world

  Vec3<double> reference;       // a point of the world near the bodies, about which Y and momentum are; world axes
  Inertia<double> Y;            // inertia of all bodies of the group together
  Vec6<double> momentum;        // about `reference`: linear [N s], angular [N m s]
  Vec3<double> C_next;          // C+, the centre of mass after the step [m]
  Vec3<double> P_next, L_next;  // P+ [N s] and L+ [N m s], after the step
  Vec3<double> d;               // displacement of the group [m]
  Vec3<double> dv, dw;          // change of velocity: of C [m/s], angular [rad/s]
};

/// The groups of a scene, and their workspace. Bodies are numbered through the scene, robot by robot.
struct FreeGroups {
  /// Finds the joints of the scene below which a group may begin.
  explicit FreeGroups(const Scene& scene);

  struct FreeJoint {                 // joint below which a group may begin: floating, or planar at the world
    int robot, joint, node, parent;  // node: number of the bodies below; parent: of the bodies above, 0: the
                                     // world, and bodies attached to the world by ordinary joints
  };
  std::vector<FreeJoint> joints;  // free joints in the scene's order
  std::vector<int> first_body;    // one entry per robot: the number of its first body
  std::vector<int> node;          // one per body: its node, the bodies connected rigidly or by ordinary joints
  std::vector<int> group;         // one entry per node: the number of its group, an index in `groups`
  std::vector<FreeGroup> groups;  // one entry per node; used if the node's number is that of a group
  bool any = false;               // whether any group is free (not tied)
  bool nested = false;            // whether any free joint is attached to a body that moves
};

/// Before a step of size h from q, v: finds the groups, with the contacts flagged `active`, and computes their momentum
/// after the step. `tau` (nv) has the torques of motors, external wrenches and springs on every velocity coordinate.
/// `kin` has the kinematics of each robot at q and v. Allocates nothing.
void begin_free_motion(const Scene& scene, const std::vector<char>& active, const ConstVectorRef& tau, double h,
                       const std::vector<Kinematics<double>>& kin, FreeGroups& groups);

/// After the step: moves each group in q (nq) and v (nv) so that it has the momentum that begin_free_motion computed.
/// kin: one entry per robot, workspace. Allocates nothing.
void end_free_motion(const Scene& scene, Eigen::VectorXd& q, Eigen::VectorXd& v, std::vector<Kinematics<double>>& kin,
                     FreeGroups& groups);

}  // namespace manycontact
