#pragma once
// Articulated-body algorithm, all quantities in the tree frame. Source: Featherstone (2008), table 7.1.

#include <span>

#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact {

template <class S>
struct AbaData {  // Scratch memory of aba; allocate it once per robot.
  explicit AbaData(const Model& model);
  std::vector<Mat6<S>> IA;               // njoints: articulated inertia
  std::vector<Vec6<S>> pA;               // njoints: articulated bias force
  Mat6X<S> U;                            // 6 x nv: IA S
  VecX<S> u;                             // nv: tau - S^T pA
  std::vector<Mat6<S>> Dinv;             // njoints: D^-1 in the leading block, with D = S^T IA S + armature
  std::vector<Vec6<S>> a;                // njoints: accelerations of bodies minus those for qdd = 0
};

/// Computes qdd = M^-1 (tau - h + sum J^T fext), and `kin`, whose a is that of qdd = 0. Sizes: q nq; v, tau, qdd nv;
/// fext njoints forces in child frames, or empty. Returns false if M is singular, with qdd = NaN.
template <class S>
[[nodiscard]] bool aba(const Model& model, const SE3<double>& base, const ConstVecRef<S>& q, const ConstVecRef<S>& v,
                       const ConstVecRef<S>& tau, const Vec3<double>& gravity, std::span<const Vec6<S>> fext,
                       Kinematics<S>& kin, AbaData<S>& data, VecRef<S> qdd);

}  // namespace manycontact
