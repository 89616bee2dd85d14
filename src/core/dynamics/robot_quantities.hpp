#pragma once
// Terms of one robot's equations M a + h = tau, in doubles, packs of SIMD batches, and quadruple precision (truth/).

#include <limits>

#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

template <class S>
struct RobotQuantities {  // a robot's terms except M, which the caller stores, packed or in a larger matrix
  explicit RobotQuantities(const Model& model) : kin(model), Yc(model.njoints()), f(model.njoints()), h(model.nv) {}

  Kinematics<S> kin;           // kin.a: bias accelerations, i.e. accelerations for qdd = 0
  std::vector<Inertia<S>> Yc;  // composite inertias
  std::vector<Vec6<S>> f;      // scratch of inverse_dynamics
  VecX<S> h;                   // nv: Coriolis, centrifugal, gravity
};

namespace internal {

/// Computes r.kin, and h = ID(q, v, 0). base: placement of the base, as for forward_kinematics.
template <class S, class B>
void evaluate_bias(const Model& model, const SE3<B>& base, const ConstVecRef<S>& q, const ConstVecRef<S>& v,
                   const Vec3<double>& gravity, RobotQuantities<S>& r) {
  forward_kinematics<S, B>(model, base, q, r.kin);
  forward_accelerations<S>(model, v, nullptr, gravity, r.kin);
  inverse_dynamics<S>(model, r.kin, nullptr, {}, r.f, r.h);
}

/// Returns m, or zero if m is within its rounding error. m: M_ii, from the motion column J and composite inertia Y.
template <class S, class Column>
S without_rounding(const S& m, const Column& J, const Inertia<S>& Y) {
  double eps = std::numeric_limits<double>::epsilon();
  if constexpr (requires { typename S::Element; }) eps = std::numeric_limits<typename S::Element>::epsilon();
  const S rounding(tolerance::kRounding * eps);
  const S terms = J.template head<3>().squaredNorm() * Y.m + J.template tail<3>().squaredNorm() * Y.I.trace();
  return select(absolute(m) <= rounding * terms, S(0), m);
}

/// Computes M. An M_ii within its rounding error becomes zero, e.g. for a point mass on a joint's axis: tests of pivots
/// might accept this M_ii, as no terms cancel in it. slot: index of each entry in M; nullptr: packed (crba.hpp).
template <class S>
void evaluate_inertia(const Model& model, RobotQuantities<S>& r, const int* slot, S* M) {
  if (slot)
    crba<S>(model, r.kin, r.Yc, slot, M);
  else
    crba<S>(model, r.kin, r.Yc, M);
  for (int i = 0; i < model.nv; ++i) {
    S& m = M[slot ? slot[model.M_begin[i]] : model.M_begin[i]];
    m = without_rounding<S>(m, r.kin.J.col(i), r.Yc[model.dof_joint[i]]);
  }
}

}  // namespace internal
}  // namespace manycontact
