#pragma once
// The torques of external wrenches w and of springs (model/scene.hpp) on the velocity coordinates,
//
//     tau(q, v, w) = J_F(q)^T w + tau_s(q, v),
//
// and products with the derivatives of tau, without matrices. Each force on a body is a wrench F in the tree frame
// (detail/algorithm/kinematics.hpp). With the sum f_i of wrenches over the subtree of body i, tau_i = S_i^T f_i. Along
// (dq, dv), body i moves by xi_i, the sum of S_j dq_j over the joints j above it, so that
//
//     dtau_i = S_i^T df_i + (xi_i x S_i)^T f_i.

#include <span>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

template <class S>
struct AppliedForces {  // a scene's external wrenches and springs at one state; allocate once per scene
  explicit AppliedForces(const Scene& scene);

  struct OfRobot {                                    // a robot on which any of these forces acts
    int robot = -1;                                   // number in the scene
    std::vector<int> wrenches, springs, joint_springs;  // numbers of its forces; of springs, those with end A on it
    std::vector<int> joints;                            // ascending: joints with forces on their bodies, and ancestors
    Kinematics<S> kin;                                  // velocities included; unused if there are only joint springs
    std::vector<Vec6<S>> f;  // njoints, set for `joints`: force on the body; add_applied_forces sums it over subtrees
  };
  struct OfSpring {
    Vec3<S> d, n;   // vector from B to A in the world, and its unit vector
    Vec3<S> rate;   // time derivative of d
    S length, t;    // |d|; t = damping d|d|/dt - stiffness (rest length): A's force is -stiffness d - t n
    bool directed;  // whether n is defined or not needed; false if A and B coincide and the force depends on n
  };

  std::vector<OfRobot> robots;    // ascending by robot number
  std::vector<int> number;        // one entry per robot of the scene: index in `robots`, or -1 without forces
  std::vector<Vec6<S>> wrenches;  // one entry per external wrench: F on its body
  std::vector<OfSpring> springs;  // one entry per spring
};

/// Computes OfRobot::f, the forces on bodies, at q (nq), v (nv). They are NaN for springs that are not `directed`.
template <class S>
void find_applied_wrenches(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                           AppliedForces<S>& forces);

/// Adds tau(q, v, w) to tau. Sizes: q nq; v, tau nv. tau is NaN for robots with a spring that is not `directed`.
template <class S>
void add_applied_forces(const Scene& scene, const S* q, const S* v, std::span<const Vec6<S>> w,
                        AppliedForces<S>& forces, S* tau);

struct AppliedScratch {  // one thread's scratch; allocate it once
  explicit AppliedScratch(const AppliedForces<double>& forces);
  std::vector<std::vector<Vec6<double>>> u, x, v;  // changes or gradients of njoints bodies, per robot of `forces`
};

// Call the functions below that have an argument `robots` after add_applied_forces at q, v. They consider only these
// robots. Vectors have the sizes and the order of the scene.

/// Adds dtau/dq dq + dtau/dv dv + dtau/dw dw to dtau. dw: nullptr for zero.
void add_applied_tangent(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* dq, const double* dv, const double* dw,
                         AppliedScratch& scratch, double* dtau);

/// Adds (dtau/dq)^T l to wq, (dtau/dv)^T l to wv. Sets ww = (dtau/dw)^T l for these robots' wrenches if given.
void add_applied_adjoint(const Scene& scene, const double* v, const AppliedForces<double>& forces,
                         std::span<const int> robots, const double* l, AppliedScratch& scratch, double* wq, double* wv,
                         double* ww);

/// Magnitudes of terms of tau and its derivatives, relative to which rounding is judged: one per velocity coordinate.
struct AppliedSizes {
  std::vector<double> tau;      // sum of the magnitudes of the terms of tau
  std::vector<double> q, v, w;  // bounds of these sums for any entry in a row of dtau/dq, dtau/dv, dtau/dw
};
/// Computes the magnitudes, after add_applied_forces at q (nq), v (nv). They are zero for robots not in `robots`.
AppliedSizes applied_sizes(const Scene& scene, const double* q, const double* v, const AppliedForces<double>& forces,
                           std::span<const int> robots);

/// Power [W] of external wrenches, and of the springs' dampers (negative), in the state of the last add_applied_forces.
struct AppliedPower {
  double wrenches = 0, dampers = 0;
};
AppliedPower power_of(const Scene& scene, const AppliedForces<double>& forces);

/// Returns the distance between the ends of `spring` at q (nq) [m]. Throws std::invalid_argument for a wrong size.
double spring_length(const Scene& scene, const ConstVectorRef& q, const Spring& spring);

/// Returns the energy of all springs at q [J]. `kin`: kinematics of each robot of the scene, placed at q.
double energy_of_springs(const Scene& scene, const ConstVectorRef& q, const std::vector<Kinematics<double>>& kin);

}  // namespace manycontact
