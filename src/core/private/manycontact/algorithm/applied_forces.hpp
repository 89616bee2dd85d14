#pragma once
// Forces on robots other than those of motors, gravity and contacts: external wrenches and springs (model/scene.hpp),
// as torques
//
//     tau(q, v, w) = J_F(q)^T w + tau_s(q, v)
//
// on the velocity coordinates, and products with their derivatives without any matrix. Each force on a body is a wrench
// F in the tree frame (detail/algorithm/kinematics.hpp), f_i the sum over the subtree of body i, and tau_i = S_i^T f_i.
// Along (dq, dv) body i moves by xi_i = sum of S_j dq_j on its path, and its velocity changes by dv_i, both as seen
// from the tree frame, which is at rest; then
//
//     dtau_i = S_i^T df_i + (xi_i x S_i)^T f_i.

#include <span>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// The forces at one state, and the memory for them. Allocated once for a scene.
template <class S>
struct AppliedForces {
  explicit AppliedForces(const Scene& scene);

  struct OfRobot {                                    // a robot with an external wrench, a spring or a spring in a
                                                      // joint
    int robot = -1;                                   // number in the scene
    std::vector<int> wrenches, springs, joint_springs;  // forces on it; springs: with end A on it
    std::vector<int> joints;  // ascending: of the bodies that forces act on, and of those before them in the tree
    Kinematics<S> kin;        // velocities too; not of a robot with joints' springs alone
    std::vector<Vec6<S>> f;   // njoints, of `joints`: on the body; after add_applied_forces on its subtree
  };
  struct OfSpring {
    Vec3<S> d, n;   // vector from B to A in the world, and its direction
    Vec3<S> rate;   // time derivative of d
    S length, t;    // |d|; t = damping d|d|/dt - stiffness (length at rest): the force on A is -stiffness d - t n
    bool directed;  // n has a meaning, or none is needed
  };

  std::vector<OfRobot> robots;    // ascending by robot number
  std::vector<int> number;        // one entry per robot of the scene: its place in `robots`, -1: nothing acts on it
  std::vector<Vec6<S>> wrenches;  // one entry per external wrench: on its body, in the tree frame
  std::vector<OfSpring> springs;  // one entry per spring
};

/// Computes the wrenches on bodies at q (nq), v (nv); `w` has the external wrenches. They are in each robot's `f`, for
/// the bodies in `joints`, in the tree frame. NaN on bodies of a spring whose ends coincide.
template <class S>
void find_applied_wrenches(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                           AppliedForces<S>& forces);

/// tau += tau(q, v, w). Sizes: q nq, v and tau nv; `w` has the external wrenches. NaN on robots with a spring whose
/// ends coincide.
template <class S>
void add_applied_forces(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                        AppliedForces<S>& forces, S* tau);

/// Bodies' variations, one thread's. Allocated once.
struct AppliedScratch {
  explicit AppliedScratch(const AppliedForces<double>& forces);
  std::vector<std::vector<Vec6<double>>> u, x, v;  // one entry per robot of `forces`: njoints
};

// The following functions need add_applied_forces at q, v, and consider only these robots of the scene. Vectors are
// those of the scene: nv, and 6 per external wrench.

/// dtau += dtau/dq dq + dtau/dv dv + dtau/dw dw. dw: nullptr for zero.
void add_applied_tangent(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* dq, const double* dv, const double* dw,
                         AppliedScratch& scratch, double* dtau);

/// wq += (dtau/dq)^T l, wv += (dtau/dv)^T l; ww = (dtau/dw)^T l of the external wrenches on these robots, if ww is not
/// nullptr.
void add_applied_adjoint(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* l, AppliedScratch& scratch, double* wq, double* wv,
                         double* ww);

/// The sizes of what rounding of tau and of its derivatives comes from, per velocity coordinate of the scene.
struct AppliedSizes {
  std::vector<double> tau;      // the sum of the terms that it was computed from
  std::vector<double> q, v, w;  // the same of the largest entry in each row of dtau/dq, dtau/dv, dtau/dw
};
/// After add_applied_forces at q (nq), v (nv); of these robots alone, zero for all others.
AppliedSizes applied_sizes(const Scene& scene, const double* q, const double* v, const AppliedForces<double>& forces,
                           std::span<const int> robots);

/// The power of external wrenches and dampers at the state of the last add_applied_forces [W]; that of dampers is
/// negative.
struct AppliedPower {
  double wrenches = 0, dampers = 0;
};
AppliedPower power_of(const Scene& scene, const AppliedForces<double>& forces);

/// The distance between a spring's ends at q (nq), which need not be the scene's. Throws std::invalid_argument unless q
/// has scene.nq numbers.
double spring_length(const Scene& scene, const ConstVectorRef& q, const Spring& spring);

/// The energy of the springs at q [J]. `kin` has the placed kinematics of each robot of the scene.
double energy_of_springs(const Scene& scene, const ConstVectorRef& q, const std::vector<Kinematics<double>>& kin);

}  // namespace manycontact
