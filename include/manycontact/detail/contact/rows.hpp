#pragma once
// The constraint rows of one contact with frames A and B'. G = B'MA is A's placement in B', X the action of AMB'. v_A,
// a_A, J_A (v_B' ...) are spatial velocity, acceleration and Jacobian of A (B'). All are in A's axes:
//
// clang-format off
//     nu    = v_A - X v_B'                        J_l = J_A - X J_B'   (6 x its columns)
//     nudot = a_A - X a_B' - v_A x nu
//     6D:         x = nudot + alpha log6(G) + beta nu
//     1D, 2D, 3D: x = nudot_lin + nu_ang x nu_lin + alpha R_A^T (p_A - p_B') + beta nu_lin
//     5D:         x_lin as 3D,  x_ang = nudot_ang + alpha m x n + beta nu_ang
// clang-format on
//
// The axis in A is n, and the axis in B', expressed in A, is m = R_AB' n. If n and m are parallel, m x n vanishes for
// any rotation of A about n, and its rate is then the part of nu_ang across n. The rows across n do not use log6(G):
// near half a revolution from B', they would respond to a deviation at a right angle to the actual one.
//
// a0 = W x and J = W J_l, where W selects the rows. In local axes the rows are in A's axes. In world axes, W also
// rotates them by oR_A. Rows of a 5D contact are in A's axes, the angular ones along two unit vectors across n. Columns
// of joints above the common ancestor of A and B' are exactly zero and are left out.

#include <cmath>
#include <optional>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Returns two unit vectors orthogonal to a unit axis, as rows. With the axis they form a right-handed basis; for the
/// axis z they are x and y.
Eigen::Matrix<double, 2, 3> across(const Vec3<double>& axis);

/// Returns whether the axes of a contact's rows are the world's, so that they rotate relative to A.
inline bool rows_turn(const Contact& contact) {
  return contact.reference_frame != ReferenceFrame::kLocal && contact.type != ContactType::k5D;
}

/// Returns the velocity coordinates that move a joint's body, ascending; empty for joint -1.
std::vector<int> dof_chain(const Model& model, int joint);

/// The velocity coordinates that a contact acts on, numbered within their robots, ascending. a: coordinates that move A
/// and not B' (sign +); b: coordinates that move B' and not A (sign -).
struct ContactSupport {
  std::vector<int> a, b;
  int cols() const { return static_cast<int>(a.size() + b.size()); }  // columns of J
};
ContactSupport contact_support(const Scene& scene, const Contact& contact);  // the coordinates of `contact`

/// A pair: all contacts between the same two bodies, with rows reduced to independent ones by B = Q R. B maps the
/// bodies' relative motion, in the pair's frame A, to the rows of these contacts; Q has orthonormal columns.
template <class S>
struct PairNumbers {
  // These matrices are on the heap, because kernels for other SIMD levels, with another alignment, read them.
  MatX<S> Q;              // (rows of all contacts) x rank, orthonormal columns
  MatX<S> R;              // rank x 6: Q^T B
  MatX<S> R_right;        // 6 x rank, right inverse: R R_right = 1
  MatX<S> terms;          // rank x 2: magnitudes of the terms of R's rows, of displacements and of rotations
  std::vector<SE3<S>> A;  // one entry per contact: placement of its A in the pair's A
};

/// The constraint rows of one contact and the quantities that they are computed from. Allocated once. Six-dimensional
/// members are in A's frame.
template <class S>
struct ContactData {
  ContactData(const Contact& contact, const ContactSupport& support);  // allocates the workspace

  // Computed by contact_rows.
  SE3<S> aMA, bMA;         // A in the tree frame of A's body, and of B's (B in the world: relative to B', in A's axes)
  SE3<S> G;                // B'MA, placement of A in B'
  Vec3<S> on_A, on_B;      // origins of A and B in their bodies' frames [m]; zero for B in the world
  Vec6<S> vA, vB, aA, aB;  // velocities, accelerations (qdd = 0, minus gravity) of A, and of B' times X
  Vec6<S> nu, nudot, x;    // motions of A relative to B' (file header); for points x's angular part is zero
  Mat6X<S> Jl;             // 6 x cols: J_l, first the columns of support.a, then of support.b
  Eigen::Matrix<S, Eigen::Dynamic, 6, 0, 6, 6> W;   // rows x 6: selects the constraint rows
  MatX<S> J;                                        // rows x cols: Jacobian of the rows
  Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1> a0;  // rows: bias of the rows
  S joint_lever = S(0);  // largest distance of the joints that rotate the contact from the origin of their tree [m]
  std::optional<PairNumbers<S>> pair;  // set by take_places, if it represents several contacts
  std::vector<SE3<S>> pair_B;          // one entry per contact of the pair: placement of its B' in the pair's B'
  /// Pairs only, in three parts. First the part of each contact's own a0 that the reduced rows do not contain, one
  /// number per row, in order. Then one number, the largest term of the a0 of all rows. Then one number, the larger of
  /// the bodies' deviations from a common motion and from their reference placement, relative to velocities or lengths.
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

/// Returns the placement error of a contact, from G = B'MA, in A's axes [m, rad], times a gain: log6(G) for 6D, G_R^T
/// G_p for points. For hinges m x n is added, the rotation between their axes n and m = G_R^T n. W selects its rows.
template <class S>
Vec6<S> contact_error(const Contact& contact, const SE3<S>& G, const S& gain = S(1));

/// Computes nu, nudot, x, W and a0 from aMA, bMA, G, vA, vB, aA and aB.
template <class S>
void contact_motion(const Contact& contact, ContactData<S>& data);

/// Computes the part of ContactData::joint_lever that is due to the joints above A (support: ContactSupport::a) or
/// above B' (ContactSupport::b).
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

/// Computes the constraint rows of a contact and the other members of `data`. kinA, kinB: kinematics of the robots of A
/// and B after forward_accelerations; kinB is nullptr if B is in the world.
template <class S>
void contact_rows(const Scene& scene, const Contact& contact, const ContactSupport& support, const Kinematics<S>& kinA,
                  const Kinematics<S>* kinB, ContactData<S>& data);

/// Computes `data` except joint_lever, from given placements aMA, bMB of A and B in the tree frames of their bodies.
/// from_b: origin of A's tree frame relative to B's tree frame. The contact's own placements are not read, and the
/// caller sets on_A and on_B.
template <class S>
void contact_rows_between(const Vec3<double>& gravity, const Contact& contact, const ContactSupport& support,
                          const Kinematics<S>& kinA, const SE3<S>& aMA, const Kinematics<S>* kinB, const SE3<S>& bMB,
                          const Vec3<S>& from_b, ContactData<S>& data);

/// Reference magnitudes for a contact's rows, from the largest entries of the relative motion J_l. `moved` is for
/// displacements, `turning` for rotations, `of_point` for a point's displacement.
///
/// `of_point` includes a hundredth of the rotations times the moment arms they were computed with, because all joints
/// may rotate about the point. Both bodies' motions are taken at A's frame, so that the arm of B's frame does not
/// count.
template <class S>
struct MotionSizes {
  S moved, turning, of_point;
};
/// Computes MotionSizes of a contact, after contact_rows.
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

/// Returns the reference magnitude of a contact's rows: the largest entry of J_l for the contact's point or frame. A
/// row that is tiny relative to this magnitude may consist of rounding errors. Call it after contact_rows.
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
