#pragma once
// The constraint rows of one contact. A and B' are the contact's frames, G = B'MA, and X is the action of AMB', all in
// A's axes:
//
// clang-format off
//     nu    = v_A - X v_B'                        J_l = J_A - X J_B'   (6 x its columns)
//     nudot = a_A - X a_B' - v_A x nu
//     6D:         x = nudot + alpha log6(G) + beta nu
//     1D, 2D, 3D: x = nudot_lin + nu_ang x nu_lin + alpha R_A^T (p_A - p_B') + beta nu_lin
//     5D:         x_lin as 3D,  x_ang = nudot_ang + alpha m x n + beta nu_ang
// clang-format on
//
// The axis in A is n, and the axis in B', expressed in A, is m = R_AB' n. If the two are aligned, m x n vanishes for
// any rotation of A about them; its rate is then nu_ang across n. (log6(G) is not suitable: half a revolution away from
// B', its rows across n respond to a deviation at a right angle to it.)
//
// a0 = W x and J = W J_l, where W selects the rows. In local axes the rows are those of A's axes. In world axes, W also
// rotates them by oR_A. The rows of a 5D contact are in A's axes, the angular ones along two unit vectors across n.
// Columns of joints above the common ancestor of A and B' are exactly zero and are left out.

#include <cmath>
#include <optional>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Two unit vectors across a unit axis, as rows. The three are right-handed; for the axis z they are x and y.
Eigen::Matrix<double, 2, 3> across(const Vec3<double>& axis);

/// Whether the axes of a contact's rows rotate relative to A, because they are the world's.
inline bool rows_turn(const Contact& contact) {
  return contact.reference_frame != ReferenceFrame::kLocal && contact.type != ContactType::k5D;
}

/// The velocity coordinates that move a joint's body, ascending; empty for joint -1.
std::vector<int> dof_chain(const Model& model, int joint);

/// The velocity coordinates that a contact acts on, numbered within their robots, ascending. a: those above A only
/// (sign +); b: those above B' only (sign -).
struct ContactSupport {
  std::vector<int> a, b;
  int cols() const { return static_cast<int>(a.size() + b.size()); }  // columns of J
};
ContactSupport contact_support(const Scene& scene, const Contact& contact);  // the coordinates of one contact

/// The numbers of contacts between the same two bodies whose rows are reduced to independent ones by B = Q R. Here B
/// are the rows of all these contacts on the relative motion of the bodies in the pair's frame A, and Q has orthonormal
/// columns.
template <class S>
struct PairNumbers {
  // They are on the heap, since kernels with other alignment read them.
  MatX<S> Q;              // rows of all contacts x rank
  MatX<S> R;              // rank x 6
  MatX<S> R_right;        // 6 x rank: R R_right = 1
  MatX<S> terms;          // rank x 2: magnitudes of the terms of R, for displacements and for rotations
  std::vector<SE3<S>> A;  // one entry per contact: its A in the pair's A
};

/// The constraint rows of one contact and the quantities that they are computed from. Allocated once. Everything
/// 6-dimensional is in A's frame.
template <class S>
struct ContactData {
  ContactData(const Contact& contact, const ContactSupport& support);  // allocates the workspace

  // Computed by contact_rows.
  SE3<S> aMA, bMA;  // A in the tree frame of its own body, and in that of B (B in the world: A's axes, relative to B')
  SE3<S> G;         // B'MA
  Vec3<S> on_A, on_B;      // origins of A and B on their bodies; zero for B in the world [m]
  Vec6<S> vA, vB, aA, aB;  // velocities and accelerations (without qdd, minus gravity) of A and X B'
  Vec6<S> nu, nudot, x;    // explained above; for points x's angular part is zero
  Mat6X<S> Jl;             // 6 x cols: J_l, first the columns of support.a, then of support.b
  Eigen::Matrix<S, Eigen::Dynamic, 6, 0, 6, 6> W;   // rows x 6
  MatX<S> J;                                        // rows x cols
  Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1> a0;  // rows
  S joint_lever = S(0);  // largest distance of the joints that rotate the contact from the origin of their tree [m]
  std::optional<PairNumbers<S>> pair;  // set by take_places; only for a contact that represents several contacts
  std::vector<SE3<S>> pair_B;          // one entry per contact of the pair: its B' in the pair's B'
  /// Pairs only: the part of each contact's own a0 that the reduced rows do not contain, one number per row, in order.
  /// Then the largest terms that these are computed from. Then the deviations of the bodies from a common motion and
  /// from their reference placement, relative to the velocities and lengths.
  VecX<S> left;
};

/// Computes the numbers of a pair, for a contact that represents several contacts.
template <class S>
void take_pair(const Contact& contact, ContactData<S>& data);

/// Sets on_A and on_B from the contact's own placements, and the numbers of a pair.
template <class S>
void take_places(const Contact& contact, ContactData<S>& data) {
  data.on_A = contact.A.placement.p.template cast<S>();
  data.on_B.setZero();
  if (contact.B.robot >= 0) data.on_B = contact.B.placement.p.template cast<S>();
  if (contact.pair) take_pair<S>(contact, data);
}

/// The placement error of a contact, G = B'MA, in A's axes [m, rad], times a gain. For 6D it is log6(G). For points it
/// is G_R^T G_p. For hinges the rotation between their axes, m = G_R^T n, is added as m x n. W selects its rows.
template <class S>
Vec6<S> contact_error(const Contact& contact, const SE3<S>& G, const S& gain = S(1));

/// Computes nu, nudot, x, W and a0 from aMA, bMA, G, vA, vB, aA and aB.
template <class S>
void contact_motion(const Contact& contact, ContactData<S>& data);

/// Computes joint_lever for the joints above one end. support: ContactSupport::a or b.
template <class S>
S joint_lever(const Model& model, const Kinematics<S>& kin, const std::vector<int>& support) {
  using std::abs;
  S largest(0);
  for (int k : support) {
    if (model.joints[model.dof_joint[k]].type == JointType::kPrismatic) continue;
    const Vec3<S>& p = kin.oMi[model.dof_joint[k]].p;
    for (int i = 0; i < 3; ++i) largest = larger(S(abs(p[i])), largest);
  }
  return largest;
}

/// Computes `data`. kinA, kinB: kinematics of the robots of A and B after forward_accelerations; kinB is nullptr if B
/// is in the world.
template <class S>
void contact_rows(const Scene& scene, const Contact& contact, const ContactSupport& support, const Kinematics<S>& kinA,
                  const Kinematics<S>* kinB, ContactData<S>& data);

/// Computes `data` except joint_lever, from given placements: A and B in the tree frames of their bodies. from_b is the
/// origin of A's tree frame relative to that of B. The contact's own placements are not read; the caller sets on_A and
/// on_B.
template <class S>
void contact_rows_between(const Vec3<double>& gravity, const Contact& contact, const ContactSupport& support,
                          const Kinematics<S>& kinA, const SE3<S>& aMA, const Kinematics<S>* kinB, const SE3<S>& bMB,
                          const Vec3<S>& from_b, ContactData<S>& data);

/// Reference magnitudes for a contact's rows: the largest entries of the relative motion J_l. `moved` is that of
/// displacements, `turning` that of rotations, `of_point` that of a point's displacement.
///
/// `of_point` includes the rotations times a hundredth of the moment arms they were computed with, because all joints
/// may rotate about the point. Both bodies' motions are taken at A's frame, so the position of B's frame is no such
/// arm.
template <class S>
struct MotionSizes {
  S moved, turning, of_point;
};
/// Computes the magnitudes. Call it after contact_rows.
template <class S>
MotionSizes<S> motion_sizes(const Contact& contact, const ContactData<S>& data) {
  using std::abs;
  S of_row[6] = {S(0), S(0), S(0), S(0), S(0), S(0)};
  for (Eigen::Index j = 0; j < data.Jl.cols(); ++j)
    for (int i = 0; i < 6; ++i) of_row[i] = larger(S(abs(data.Jl(i, j))), of_row[i]);
  const auto largest_of = [&](int i) { return larger(larger(of_row[i], of_row[i + 1]), of_row[i + 2]); };
  const S moved = largest_of(0), turning = largest_of(3);
  const auto reach = [](const Vec3<S>& p) { return larger(larger(S(abs(p[0])), S(abs(p[1]))), S(abs(p[2]))); };
  S lever = reach(data.aMA.p) + reach(data.on_A) + data.joint_lever;
  if (moves(contact.B)) lever += reach(data.bMA.p);
  return {moved, turning, larger(S(turning * lever / S(100)), moved)};
}

/// The reference magnitude of a contact's rows: the largest entry of the point's or the frame's motion. A row that is
/// tiny relative to it may be pure rounding error. Call it after contact_rows.
template <class S>
S motion_scale(const Contact& contact, const ContactData<S>& data) {
  const MotionSizes<S> of = motion_sizes<S>(contact, data);
  if (!contact.pair) return holds_turning(contact.type) ? larger(of.turning, of.moved) : of.of_point;
  S largest(0);
  for (Eigen::Index i = 0; i < data.pair->terms.rows(); ++i)
    largest = larger(S(data.pair->terms(i, 0) * of.of_point + data.pair->terms(i, 1) * of.turning), largest);
  return largest;
}

}  // namespace manycontact
