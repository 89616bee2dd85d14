#pragma once
// The rows of one contact. With A, B' the contact's frames, G = B'MA and X the action of AMB', all in A's axes:
//
// clang-format off
//   nu    = v_A - X v_B'                        J_l = J_A - X J_B'   (6 x its columns)
//   nudot = a_A - X a_B' - v_A x nu
//   6D:         x = nudot + alpha log6(G) + beta nu
//   1D, 2D, 3D: x = nudot_lin + nu_ang x nu_lin + alpha R_A^T (p_A - p_B') + beta nu_lin
//   5D:         x_lin as 3D,  x_ang = nudot_ang + alpha m x n + beta nu_ang
// clang-format on
//
// with n the axis in A and m = R_AB' n the one in B', seen from A: m x n vanishes when they are in line however far A
// has turned about them, and changes by nu_ang across n then. (log6(G) would not do: half a turn away from B' its rows
// across n answer a deviation at a right angle to it.)
//
// a0 = W x and J = W J_l with W selecting the rows: of A's axes (local), or of the world's (W turns them by oR_A). The
// rows of a 5D contact are those of A's axes, the angular ones along two unit vectors across n.
// Columns of joints above the common ancestor of A and B' are zero exactly and left out.

#include <cmath>
#include <optional>

#include "manycontact/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Two unit vectors across a unit axis, as rows; right-handed with it, x and y where it is z.
Eigen::Matrix<double, 2, 3> across(const Vec3<double>& axis);

/// Whether a contact's rows turn with A against A's axes, being the world's.
inline bool rows_turn(const Contact& contact) {
  return contact.reference_frame != ReferenceFrame::kLocal && contact.type != ContactType::k5D;
}

/// The velocity coordinates that move a joint's body, ascending; none for joint -1.
std::vector<int> dof_chain(const Model& model, int joint);

/// The velocity coordinates a contact acts on, numbered within their robots, ascending: those only above A (sign +),
/// those only above B' (sign -).
struct ContactSupport {
  std::vector<int> a, b;
  int cols() const { return static_cast<int>(a.size() + b.size()); }  // of J
};
ContactSupport contact_support(const Scene& scene, const Contact& contact);  // of one contact

/// Numbers of contacts between the same two bodies whose rows are reduced (contact/pair_rows.hpp): B = Q R, B the rows of
/// all on the relative motion of the bodies in the pair's frame A, Q with orthonormal columns.
template <class S>
struct PairNumbers {
  struct Member {  // one of the contacts
    SE3<S> A, B;   // its A in the pair's A, its B' in the pair's B'
    MatX<S> Q;     // its rows of Q: rows x rank
  };
  // on the heap, since kernels of other alignment read them
  MatX<S> R;        // rank x 6
  MatX<S> R_right;  // 6 x rank: R R_right = 1
  MatX<S> terms;    // rank x 2: what entries of R by displacements, and by turns, are summed from
  std::vector<Member> members;
};

/// Numbers of one contact. Allocated once; everything 6-dimensional is in A's frame.
template <class S>
struct ContactData {
  ContactData(const Contact& contact, const ContactSupport& support);  // room for it

  // by contact_rows
  SE3<S> aMA, bMA;         // A in the tree frame of its own body, and of B's (of the world: its axes, about B')
  SE3<S> G;                // B'MA
  Vec3<S> on_A, on_B;      // A's and B's frames on their bodies; B's in the world is zero [m]
  Vec6<S> vA, vB, aA, aB;  // velocities, accelerations (without qdd, minus gravity) of A and X B'
  Vec6<S> nu, nudot, x;    // as above; for points x's angular part is zero
  Mat6X<S> Jl;             // 6 x cols: J_l, first the columns of support.a, then of support.b
  Eigen::Matrix<S, Eigen::Dynamic, 6, 0, 6, 6> W;   // rows x 6
  MatX<S> J;                                        // rows x cols
  Eigen::Matrix<S, Eigen::Dynamic, 1, 0, 6, 1> a0;  // rows
  S joint_lever = S(0);  // how far joints that turn it are from their tree's origin, at most [m]
  std::optional<PairNumbers<S>> pair;  // of a contact that stands for several: by take_places
  /// Of these: what of their own a0 the reduced rows do not have, one number per row of each, in order; then the largest
  /// terms that these are computed from, and how far the bodies are from moving as one and from where they are to be,
  /// relative to the velocities and levers.
  VecX<S> left;
};

/// The pair's numbers, of a contact that stands for several.
template <class S>
void take_pair(const Contact& contact, ContactData<S>& data);

/// on_A and on_B, of the contact's own placements, and the pair's numbers.
template <class S>
void take_places(const Contact& contact, ContactData<S>& data) {
  data.on_A = contact.A.placement.p.template cast<S>();
  data.on_B.setZero();
  if (contact.B.robot >= 0) data.on_B = contact.B.placement.p.template cast<S>();
  if (contact.pair) take_pair<S>(contact, data);
}

/// How far A is from B', G = B'MA, in A's axes [m, rad]: log6(G) of 6D; else of the points G_R^T G_p, and of hinges the
/// turn between their axes m = G_R^T n, m x n; times a gain. W picks the rows of it.
template <class S>
Vec6<S> contact_error(const Contact& contact, const SE3<S>& G, const S& gain = S(1));

/// nu, nudot, x, W and a0, from aMA, bMA, G, vA, vB, aA and aB.
template <class S>
void contact_motion(const Contact& contact, ContactData<S>& data);

/// joint_lever of the joints above one end, `support` of the contact's.
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

/// Fills `data`. kinA, kinB: of the robots of A and B after forward_accelerations; kinB is nullptr when B is the world.
template <class S>
void contact_rows(const Scene& scene, const Contact& contact, const ContactSupport& support, const Kinematics<S>& kinA,
                  const Kinematics<S>* kinB, ContactData<S>& data);

/// The same, but for joint_lever, with the frames' placements given, A's and B's in the tree frames of their bodies,
/// and from_b: A's tree frame's origin as seen from B's. The contact's own placements are not read: on_A and on_B are
/// the caller's.
template <class S>
void contact_rows_between(const Vec3<double>& gravity, const Contact& contact, const ContactSupport& support,
                          const Kinematics<S>& kinA, const SE3<S>& aMA, const Kinematics<S>* kinB, const SE3<S>& bMB,
                          const Vec3<S>& from_b, ContactData<S>& data);

/// The same of a contact with the world: A in its body's tree frame, that frame's origin, and B' in the world.
template <class S>
void contact_rows_with_world(const Vec3<double>& gravity, const Contact& contact, const ContactSupport& support,
                             const Kinematics<S>& kinA, const SE3<S>& aMA, const WorldPoint<S>& origin,
                             const SE3<S>& oMB, ContactData<S>& data);

/// The largest entries of the motions that a contact's rows are picked from [J's units]: of displacements, of turns, and
/// of a point's displacement. The last counts the turns times a hundredth of the levers they were computed with, since
/// all joints may turn about the point: both bodies' motions are taken at A's frame, so the place of B's frame on its
/// body is not one of these levers.
template <class S>
struct MotionSizes {
  S moved, turning, of_point;
};
/// After contact_rows.
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

/// The largest entry of what a contact's rows are picked from, the point's or the frame's motion: a row much smaller is
/// rounding. After contact_rows.
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
