#include "manycontact/detail/algorithm/kinematics.hpp"

#include <algorithm>

#include "manycontact/algorithm/model_numbers.hpp"
#include "place_path.hpp"

namespace manycontact {

#ifdef MANYCONTACT_LANES
template <int W>
inline constexpr int kAngles<Pack<W, float>> = W == 1 ? 8 : 4;
#endif

template <class S>
Kinematics<S>::Kinematics(const Model& model)
    : origins(model.trees.size()),
      oMi(model.njoints()),
      J(Mat6X<S>::Zero(6, model.nv)),
      Y(model.njoints()),
      v(model.njoints(), Vec6<S>::Zero()),
      a(model.njoints(), Vec6<S>::Zero()),
      a_base(Vec6<S>::Zero()),
      tree_of(model.tree_of) {}

namespace {

// Sines and cosines of the angles of joints first ... end-1, at most kAngles of them, computed together.
template <class S>
struct Turns {
  S s[kAngles<S>], c[kAngles<S>];

  Turns(const Model& model, const ConstVecRef<S>& q, int first, int end) {
    S angle[kAngles<S>];
    for (int i = first; i < end; ++i) angle[i - first] = angle_of<S>(model.joints[i], q);
    for (int k = end - first; k < kAngles<S>; ++k) angle[k] = S(0);
    sin_cos<kAngles<S>>(angle, s, c);
  }
};

// Sets the columns of J for one joint, i.e. its motion subspace, from the placement M of its child frame.
template <class S>
[[gnu::always_inline]] inline void fill_columns(const Joint& joint, const SE3<S>& M, Mat6X<S>& J) {
  const int iv = joint.idx_v;
  switch (joint.type) {
    case JointType::kRevolute: {
      const Vec3<S> axis = axis_of<S>(joint, M.R);
      J.col(iv).template head<3>() = cross(M.p, axis);
      J.col(iv).template tail<3>() = axis;
      break;
    }
    case JointType::kPrismatic:
      J.col(iv).template head<3>() = axis_of<S>(joint, M.R);
      J.col(iv).template tail<3>().setZero();
      break;
    case JointType::kFloating:
      J.template middleCols<6>(iv) = M.action();
      break;
    case JointType::kPlanar: {
      const Vec3<S> normal = M.R.col(2);
      J.template block<3, 1>(0, iv) = M.R.col(0);
      J.template block<3, 1>(0, iv + 1) = M.R.col(1);
      J.template block<3, 2>(3, iv).setZero();
      J.template block<3, 1>(0, iv + 2) = cross(M.p, normal);
      J.template block<3, 1>(3, iv + 2) = normal;
      break;
    }
  }
}

// Computes the motion subspace and inertia of body i, whose placement is known.
template <class S>
[[gnu::always_inline]] inline void fill_body(const Model& model, int i, Kinematics<S>& kin) {
  fill_columns<S>(model.joints[i], kin.oMi[i], kin.J);
  kin.Y[i] = joint_space_inertia<S>(model, kin.own, i).transformed(kin.oMi[i]);
}

// Computes body i after its parent; s, c: sine and cosine of its angle. Calls fill_body while oMi is in registers.
template <class S>
[[gnu::always_inline]] inline void place_body(const Model& model, const ConstVecRef<S>& q, int i, const S& s,
                                              const S& c, Kinematics<S>& kin) {
  const Joint& joint = model.joints[i];
  SE3<S>& M = kin.oMi[i];
  const SE3<S>& P = kin.oMi[joint.parent];
  const PlacementOf<S> placement(model, kin.own, i);
  M.p = add_times<S>(P.p, P.R, placement.p());
  if (joint.placement_rotates)
    M.R = times<S>(P.R, placement.R());
  else
    M.R = P.R;
  move_frame<S>(joint, q, s, c, M.R, M.p);
  fill_body<S>(model, i, kin);
}

// Computes body i of a tree's path: the joints that place a robot in the world (Tree::path). For the tree's root, it
// first places the whole path. Few bodies are on paths.
template <class S, class B>
[[gnu::noinline]] void body_on_path(const Model& model, const SE3<B>& base, const ConstVecRef<S>& q, int i, const S& s,
                                    const S& c, Kinematics<S>& kin) {
  const int tree = model.tree_of[i];
  if (model.joints[i].parent < 0)
    kin.origins[tree] = place_path<S, B>(model, kin.own, model.trees[tree], base, q, s, c,
                                         [&kin](int j) -> SE3<S>& { return kin.oMi[j]; });
  fill_body<S>(model, i, kin);
}

}  // namespace

template <class S, class B>
void forward_kinematics(const Model& model, const SE3<B>& base, const ConstVecRef<S>& q, Kinematics<S>& kin) {
  const int n = model.njoints();
  for (int first = 0; first < n;) {
    const int end = std::min(first + kAngles<S>, n);
    const Turns<S> turns(model, q, first, end);
    for (int i = first; i < end; ++i)
      if (model.on_path[i])
        body_on_path<S, B>(model, base, q, i, turns.s[i - first], turns.c[i - first], kin);
      else
        place_body<S>(model, q, i, turns.s[i - first], turns.c[i - first], kin);
    first = end;
  }
}

template <class S>
void forward_accelerations(const Model& model, const ConstVecRef<S>& v, const S* qdd, const Vec3<double>& gravity,
                           Kinematics<S>& kin) {
  kin.a_base.template head<3>() = -gravity.cast<S>();
  const Vec6<S> zero = Vec6<S>::Zero();
  const int n = model.njoints();
  for (int i = 0; i < n; ++i) {
    const Joint& joint = model.joints[i];
    const int iv = joint.idx_v;
    const Vec6<S>& vp = joint.parent < 0 ? zero : kin.v[joint.parent];
    const Vec6<S>& ap = joint.parent < 0 ? kin.a_base : kin.a[joint.parent];
    Vec6<S> vJ;  // S_i v, the joint's velocity
    Vec6<S> aJ = ap;
    if (joint.nv() == 1) {
      vJ = kin.J.col(iv) * v[iv];
      if (qdd) aJ += kin.J.col(iv) * qdd[iv];
    } else {
      vJ.setZero();
      for (int k = iv; k < iv + joint.nv(); ++k) {
        vJ += kin.J.col(k) * v[k];
        if (qdd) aJ += kin.J.col(k) * qdd[k];
      }
    }
    kin.v[i] = vp + vJ;
    kin.a[i] = add_cross_motion(aJ, vp, vJ);  // v_i x S v = v_p x S v, since S v x S v = 0
  }
}

using Real = InstantiatedScalar;
template struct Kinematics<Real>;
template void forward_kinematics<Real, double>(const Model&, const SE3<double>&, const ConstVecRef<Real>&,
                                               Kinematics<Real>&);
template void forward_accelerations<Real>(const Model&, const ConstVecRef<Real>&, const Real*, const Vec3<double>&,
                                          Kinematics<Real>&);

}  // namespace manycontact
