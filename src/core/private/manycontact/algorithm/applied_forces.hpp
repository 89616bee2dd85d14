#pragma once
// External wrenches and springs (model/scene.hpp) as torques
//
//     tau(q, v, w) = J_F(q)^T w + tau_s(q, v)
//
// on the velocity coordinates, and products with their derivatives without matrices. Each force on a body is a wrench F
// in the tree frame (detail/algorithm/kinematics.hpp), f_i the sum over the subtree of body i, and tau_i = S_i^T f_i.
// Along (dq, dv), body i moves by xi_i = sum of S_j dq_j on its path and its velocity changes by dv_i; then
//
//     dtau_i = S_i^T df_i + (xi_i x S_i)^T f_i.

#include <span>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// The forces at one state; allocate once per scene.
template <class S>
struct AppliedForces {
  explicit AppliedForces(const Scene& scene);

  struct OfRobot {                                    // a robot with wrenches, springs or joint springs
    int robot = -1;                                   // number in the scene
    std::vector<int> wrenches, springs, joint_springs;  // forces on it; springs: with end A on it
    std::vector<int> joints;                            // ascending: bodies with forces, and their ancestors
    Kinematics<S> kin;                                  // velocities too; unused for robots with only joint springs
    std::vector<Vec6<S>> f;  // njoints, set for `joints`: force on the body; after add_applied_forces on its subtree
  };
  struct OfSpring {
    Vec3<S> d, n;   // vector from B to A in the world, and its direction
    Vec3<S> rate;   // time derivative of d
    S length, t;    // |d|; t = damping d|d|/dt - stiffness (rest length): the force on A is -stiffness d - t n
    bool directed;  // false: n is needed but undefined, as the ends coincide
  };

  std::vector<OfRobot> robots;    // ascending by robot number
  std::vector<int> number;        // one entry per robot of the scene: index in `robots`; -1: no force
  std::vector<Vec6<S>> wrenches;  // one entry per external wrench: on its body, in the tree frame
  std::vector<OfSpring> springs;  // one entry per spring
};

/// Computes each robot's `f`, wrenches in the tree frame, at q (nq), v (nv). NaN on springs whose ends coincide.
template <class S>
void find_applied_wrenches(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                           AppliedForces<S>& forces);

/// Adds tau(q, v, w) to tau. Sizes: q nq; v, tau nv. NaN on robots with a spring whose ends coincide.
template <class S>
void add_applied_forces(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                        AppliedForces<S>& forces, S* tau);

/// Variations of bodies, for one thread; allocate once.
struct AppliedScratch {
  explicit AppliedScratch(const AppliedForces<double>& forces);
  std::vector<std::vector<Vec6<double>>> u, x, v;  // one entry per robot of `forces`: njoints
};

// Call the functions below after add_applied_forces at q, v. They consider `robots` only, with vectors of the scene.

/// Adds dtau/dq dq + dtau/dv dv + dtau/dw dw to dtau. dw: nullptr for zero.
void add_applied_tangent(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* dq, const double* dv, const double* dw,
                         AppliedScratch& scratch, double* dtau);

/// Adds (dtau/dq)^T l to wq, (dtau/dv)^T l to wv; sets ww = (dtau/dw)^T l for these robots unless it is nullptr.
void add_applied_adjoint(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* l, AppliedScratch& scratch, double* wq, double* wv,
                         double* ww);

/// Magnitudes that rounding errors of tau and its derivatives are relative to, per velocity coordinate of the scene.
struct AppliedSizes {
  std::vector<double> tau;      // sum of the magnitudes of tau's terms
  std::vector<double> q, v, w;  // the same for the largest entry of each row of dtau/dq, dtau/dv, dtau/dw
};
/// Call it after add_applied_forces at q (nq), v (nv). Zero for robots not in `robots`.
AppliedSizes applied_sizes(const Scene& scene, const double* q, const double* v, const AppliedForces<double>& forces,
                           std::span<const int> robots);

/// Power of external wrenches and of dampers (negative) at the state of the last add_applied_forces [W].
struct AppliedPower {
  double wrenches = 0, dampers = 0;
};
AppliedPower power_of(const Scene& scene, const AppliedForces<double>& forces);

/// Returns the distance between the ends of `spring` at q (nq). Throws std::invalid_argument for a wrong size.
double spring_length(const Scene& scene, const ConstVectorRef& q, const Spring& spring);

/// Returns the energy of the springs at q [J]. `kin`: placed kinematics of each robot of the scene.
double energy_of_springs(const Scene& scene, const ConstVectorRef& q, const std::vector<Kinematics<double>>& kin);

}  // namespace manycontact
