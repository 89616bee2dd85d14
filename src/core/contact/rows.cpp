#include "manycontact/detail/contact/rows.hpp"

#include <limits>
#include <type_traits>

#include "manycontact/contact/pair_motion.hpp"
#include "manycontact/spatial/double_double.hpp"
#include "spatial/pack_explog.hpp"

namespace manycontact {

template <class S>
ContactData<S>::ContactData(const Contact& contact, const ContactSupport& support)
    : on_A(Vec3<S>::Zero()),
      on_B(Vec3<S>::Zero()),
      vA(Vec6<S>::Zero()),
      vB(Vec6<S>::Zero()),
      aA(Vec6<S>::Zero()),
      aB(Vec6<S>::Zero()),
      nu(Vec6<S>::Zero()),
      nudot(Vec6<S>::Zero()),
      x(Vec6<S>::Zero()),
      Jl(Mat6X<S>::Zero(6, support.cols())),
      W(Eigen::Matrix<S, Eigen::Dynamic, 6, 0, 6, 6>::Zero(contact.rows(), 6)),
      J(MatX<S>::Zero(contact.rows(), support.cols())),
      a0(VecX<S>::Zero(contact.rows())) {
  if (!contact.pair) return;
  pair.emplace();
  pair->Q.setZero(static_cast<Eigen::Index>(contact.pair->unit.size()), contact.rows());
  pair->R.setZero(contact.rows(), 6);
  pair->R_right.setZero(6, contact.rows());
  pair->terms.setZero(contact.rows(), 2);
  pair->A.resize(contact.pair->members.size());
  pair_B.resize(contact.pair->members.size());
  left.setZero(static_cast<Eigen::Index>(contact.pair->unit.size()) + 2);
}

namespace {

// Returns an attachment's placement in its tree frame, or relative to the origin of its fixed base. If S has more
// digits than double, a step of Newton's method makes R orthogonal: R is a product of rotations rounded to double, and
// J^T a0, with R^T in both J and a0, would have errors of eps |a0| with the eps of double.
template <class S>
SE3<S> place(const Scene& scene, const Attachment& at, const Kinematics<S>& kin) {
  SE3<S> M = at.joint >= 0 ? kin.oMi[at.joint]
                           : SE3<S>{scene.robots[at.robot].base.R.template cast<S>(), Vec3<S>::Zero()};
  M = M * at.placement.cast<S>();
  if constexpr (std::is_same_v<S, DoubleDouble> || std::numeric_limits<S>::digits > 53)
    M.R = S(0.5) * M.R * (S(3) * Mat3<S>::Identity() - M.R.transpose() * M.R);
  return M;
}

// Returns the world position of the origin relative to which place() gives the placement. On a fixed base, kin is not
// used, because it may be of an earlier state.
template <class S>
WorldPoint<S> origin(const Scene& scene, const Attachment& at, const Kinematics<S>& kin) {
  if (at.joint >= 0) return kin.origins[kin.tree_of[at.joint]];
  return {scene.robots[at.robot].base.p.template cast<S>()};
}

// Computes d.W, which selects the rows from a motion in A's axes and, for world axes, rotates it by R = oR_A first.
template <class S>
void select_rows(const Contact& c, const Mat3<S>& R, ContactData<S>& d) {
  Mat3<S> axes = Mat3<S>::Identity();
  if (rows_turn(c)) axes = R;
  switch (c.type) {
    case ContactType::k1D:
      d.W.template block<1, 3>(0, 0) = c.axis.cast<S>().transpose() * axes;
      break;
    case ContactType::k2D:
      d.W.template block<1, 3>(0, 0) = axes.row(0);
      d.W.template block<1, 3>(1, 0) = axes.row(2);
      break;
    case ContactType::k3D:
      d.W.template block<3, 3>(0, 0) = axes;
      break;
    case ContactType::k5D:
      d.W.template block<3, 3>(0, 0) = axes;
      d.W.template block<2, 3>(3, 3) = across(c.axis).cast<S>();
      break;
    case ContactType::k6D:
      d.W.template block<3, 3>(0, 0) = axes;
      d.W.template block<3, 3>(3, 3) = axes;
      break;
  }
}

}  // namespace

template <class S>
Vec6<S> contact_error(const Contact& c, const SE3<S>& G, const S& gain) {
  if (c.type == ContactType::k6D) return gain * log6(G);
  Vec6<S> e = Vec6<S>::Zero();
  e.template head<3>() = gain * (G.R.transpose() * G.p);
  if (c.type == ContactType::k5D) {
    const Vec3<S> n = c.axis.cast<S>();
    e.template tail<3>() = gain * Vec3<S>(G.R.transpose() * n).cross(n);
  }
  return e;
}

template <class S>
void contact_motion(const Contact& c, ContactData<S>& d) {
  const S alpha(c.alpha), beta(c.beta);
  d.nu = d.vA - d.vB;
  d.nudot = d.aA - d.aB - cross_motion(d.vA, d.nu);
  if (c.pair) return pair_motion<S>(c, d);
  if (c.type == ContactType::k6D) {
    d.x = d.nudot + beta * d.nu;
  } else {
    const Vec3<S> lin = d.nu.template head<3>(), ang = d.nu.template tail<3>();
    d.x.template head<3>() = d.nudot.template head<3>() + ang.cross(lin) + beta * lin;
    if (c.type == ContactType::k5D) d.x.template tail<3>() = d.nudot.template tail<3>() + beta * ang;
  }
  if (c.alpha != 0) d.x += contact_error<S>(c, d.G, alpha);
  if (c.type == ContactType::k6D && c.reference_frame == ReferenceFrame::kLocal) {
    d.W.setIdentity();
    d.a0 = d.x;
    return;
  }
  select_rows<S>(c, d.aMA.R, d);
  d.a0.noalias() = d.W * d.x;
}

template <class S>
void contact_rows(const Scene& scene, const Contact& c, const ContactSupport& support, const Kinematics<S>& kinA,
                  const Kinematics<S>* kinB, ContactData<S>& d) {
  const WorldPoint<S> from = origin<S>(scene, c.A, kinA);
  const SE3<S> aMA = place<S>(scene, c.A, kinA);
  take_places<S>(c, d);
  d.joint_lever = S(0);
  if (!support.a.empty()) d.joint_lever = joint_lever<S>(*scene.robots[c.A.robot].model, kinA, support.a);
  if (!support.b.empty())
    d.joint_lever = larger(joint_lever<S>(*scene.robots[c.B.robot].model, *kinB, support.b), d.joint_lever);
  const SE3<S> bMB = kinB ? place<S>(scene, c.B, *kinB) : SE3<S>{c.B.placement.R.cast<S>(), Vec3<S>::Zero()};
  const WorldPoint<S> to = kinB ? origin<S>(scene, c.B, *kinB) : WorldPoint<S>{c.B.placement.p.cast<S>()};
  contact_rows_between<S>(scene.gravity, c, support, kinA, aMA, kinB, bMB, from.seen_from(to), d);
}

template <class S>
void contact_rows_between(const Vec3<double>& gravity, const Contact& c, const ContactSupport& support,
                          const Kinematics<S>& kinA, const SE3<S>& aMA, const Kinematics<S>* kinB, const SE3<S>& bMB,
                          const Vec3<S>& from_b, ContactData<S>& d) {
  Vec6<S> rest = Vec6<S>::Zero();  // acceleration minus gravity of immovable bodies
  rest.template head<3>() = -gravity.cast<S>();
  d.aMA = d.bMA = aMA;
  d.bMA.p += from_b;
  d.G = bMB.inverse() * d.bMA;
  const bool a_moves = c.A.joint >= 0, b_moves = kinB && c.B.joint >= 0;
  d.vA = a_moves ? d.aMA.act_inverse(kinA.v[c.A.joint]) : Vec6<S>(Vec6<S>::Zero());
  d.aA = d.aMA.act_inverse(a_moves ? kinA.a[c.A.joint] : rest);
  d.vB = b_moves ? d.bMA.act_inverse(kinB->v[c.B.joint]) : Vec6<S>(Vec6<S>::Zero());
  d.aB = d.bMA.act_inverse(b_moves ? kinB->a[c.B.joint] : rest);
  contact_motion<S>(c, d);
  int k = 0;
  for (int i : support.a) d.Jl.col(k++) = d.aMA.act_inverse(kinA.J.col(i));
  for (int i : support.b) d.Jl.col(k++) = -d.bMA.act_inverse(kinB->J.col(i));
  if (c.type == ContactType::k6D && c.reference_frame == ReferenceFrame::kLocal && !c.pair)
    d.J = d.Jl;
  else
    d.J.noalias() = d.W * d.Jl;
}

using Real = InstantiatedScalar;
template struct ContactData<Real>;
template Vec6<Real> contact_error<Real>(const Contact&, const SE3<Real>&, const Real&);
template void contact_motion<Real>(const Contact&, ContactData<Real>&);
template void contact_rows<Real>(const Scene&, const Contact&, const ContactSupport&, const Kinematics<Real>&,
                                 const Kinematics<Real>*, ContactData<Real>&);
template void contact_rows_between<Real>(const Vec3<double>&, const Contact&, const ContactSupport&,
                                         const Kinematics<Real>&, const SE3<Real>&, const Kinematics<Real>*,
                                         const SE3<Real>&, const Vec3<Real>&, ContactData<Real>&);

}  // namespace manycontact
