#include "manycontact/contact/body_rows.hpp"

namespace manycontact {

namespace {

// The placement of an attachment's frame, in three parts whose origins add up.
struct Placed {
  SE3<double> frame;        // the frame relative to its body's origin, in the world's axes
  Vec3<double> body;        // the body's origin in the tree frame
  WorldPoint<double> tree;  // the tree frame's origin in the world; for immovable frames, their own or their base's
};
Placed placed(const Scene& scene, const Attachment& at, const BodyKinematics<double>* kin) {
  const Vec3<double> none = Vec3<double>::Zero();
  if (at.robot < 0) return {{at.placement.R, none}, none, {at.placement.p}};
  const Mat3<double>& R = kin ? kin->R[at.joint] : scene.robots[at.robot].base.R;
  const SE3<double> frame{R * at.placement.R, R * at.placement.p};
  if (!kin) return {frame, none, {scene.robots[at.robot].base.p}};
  return {frame, kin->p[at.joint], kin->origins[kin->tree_of[at.joint]]};
}

}  // namespace

void body_rows(const Scene& scene, const Contact& c, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& d) {
  Vec6<double> rest = Vec6<double>::Zero();  // acceleration minus gravity of immovable bodies
  rest.head<3>() = -scene.gravity;
  const Placed A = placed(scene, c.A, kinA), B = placed(scene, c.B, kinB);
  d.aMA = d.bMA = A.frame;
  d.bMA.p += A.body - B.body;
  d.bMA.p += A.tree.seen_from(B.tree);
  d.G = B.frame.inverse() * d.bMA;
  const Vec6<double> zero = Vec6<double>::Zero();
  d.vA = kinA ? d.aMA.act_inverse(kinA->v[c.A.joint]) : zero;
  d.aA = d.aMA.act_inverse(kinA ? aA : rest);
  d.vB = kinB ? d.bMA.act_inverse(kinB->v[c.B.joint]) : zero;
  d.aB = d.bMA.act_inverse(kinB ? aB : rest);
  take_places<double>(c, d);
  contact_motion<double>(c, d);
}

}  // namespace manycontact
