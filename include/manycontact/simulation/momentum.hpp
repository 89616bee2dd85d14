#pragma once
// Momentum of what nothing ties to the world.
//
// Semi-implicit Euler in a robot's own coordinates loses it: the velocity of a floating base is written in axes that
// turn with the base, so v - h w x v is longer than v by (h w)^2 / 2 in every step (at 10 rad/s and 1 ms, 5 % a
// second). What exact motion does to momentum is known, however. Bodies joined to each other by joints and contacts,
// but not to the world, are a group, of mass m, momentum P, centre of mass C and angular momentum L about it. In a step
//
//     P+ = P + h F        C+ = C + h P+ / m        L+ = L + h T
//
// with F, T the gravity on the group and the torques of its joints at the world (planar ones have some). So a step is
// ended by moving each group as one rigid body, which no joint and no contact within it can notice:
//
//     C := C+                              a displacement
//     [ m 1   0  ] [ dv ]   [ P+ - P ]
//     [  0   I_C ] [ dw ] = [ L+ - L ]     a velocity, with I_C the group's inertia about C
//
// This is a projection onto what the motion keeps (Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed.,
// section IV.4), along the symmetry that keeps it. Linear and angular momentum are then kept to rounding whatever h is,
// and a centre of mass flies as a particle does under semi-implicit Euler.
//
// A planar joint at the world, or a 1D contact with it in world axes, leaves a group the motions of a plane: then the
// same is done in that plane alone. Whatever else touches the world ties the group to it, and nothing is done.

#include <vector>

#include "manycontact/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Bodies that move together, and their momentum.
struct FreeGroup {
  bool tied = true;       // to the world, or a number without a group: what follows is not kept
  bool in_plane = false;  // only motions in the plane across `normal` are free
  Vec3<double> normal;    // unit, in the world

  Vec3<double> reference;       // a point of the world near the bodies; the rest is about it, in world axes
  Inertia<double> Y;            // of all bodies together
  Vec6<double> momentum;        // linear [N s], angular [N m s]
  Vec3<double> C_next;          // C+ [m]
  Vec3<double> P_next, L_next;  // P+ [N s], L+ [N m s]
  Vec3<double> d;               // the displacement [m]
  Vec3<double> dv, dw;          // the velocity: of C [m/s], angular [rad/s]
};

/// The groups of a scene, and room for them. Bodies are numbered through the scene, robot by robot.
struct FreeGroups {
  /// For this scene; finds its joints below which a group may begin.
  explicit FreeGroups(const Scene& scene);

  struct FreeJoint {                 // a joint below which a group may begin: floating, or planar at the world
    int robot, joint, node, parent;  // node: of the bodies below it; parent: of those above. 0: what stands in the
                                     // world, or hangs on it by ordinary joints
  };
  std::vector<FreeJoint> joints;  // in the scene's order
  std::vector<int> first_body;    // per robot
  std::vector<int> node;          // per body: what it is rigidly or by ordinary joints a part of
  std::vector<int> group;         // per node: the number of its group
  std::vector<FreeGroup> groups;  // as many as nodes
  bool any = false;               // a group is free
  bool nested = false;            // a free joint hangs on a body that moves
};

/// Before a step from q, v with the torques tau (nv: on every velocity coordinate) of motors, pushes and springs: finds
/// the groups with the contacts flagged `active`, and what their momentum will be after a step of h. kin: per robot, at
/// q and v. Allocates nothing.
void begin_free_motion(const Scene& scene, const std::vector<char>& active,
                       const Eigen::Ref<const Eigen::VectorXd>& tau, double h,
                       const std::vector<Kinematics<double>>& kin, FreeGroups& groups);

/// After it: moves the groups of q, v (nq, nv), the state that the step came to, to that momentum. kin: per robot,
/// scratch. Allocates nothing.
void end_free_motion(const Scene& scene, Eigen::VectorXd& q, Eigen::VectorXd& v, std::vector<Kinematics<double>>& kin,
                     FreeGroups& groups);

}  // namespace manycontact
