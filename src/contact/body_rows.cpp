#include "manycontact/contact/body_rows.hpp"

namespace manycontact {

namespace {

// An attachment's frame in its body's frame, that frame's origin seen from the robot's base, and the base in the world.
struct Placed {
  SE3<double> frame;
  Vec3<double> body, base;
};
Placed placed(const Scene& scene, const Attachment& at, const BodyKinematics<double>* kin) {
  if (at.robot < 0) return {at.placement, Vec3<double>::Zero(), Vec3<double>::Zero()};
  const Mat3<double>& R = kin ? kin->R[at.joint] : scene.robots[at.robot].base.R;
  const SE3<double> frame{R * at.placement.R, R * at.placement.p};
  if (!kin) return {frame, Vec3<double>::Zero(), scene.robots[at.robot].base.p};
  return {frame, kin->p[at.joint], kin->origin};
}

}  // namespace

void body_rows(const Scene& scene, const Contact& c, const BodyKinematics<double>* kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& d) {
  Vec6<double> rest = Vec6<double>::Zero();  // acceleration of what stands still, minus gravity
  rest.head<3>() = -scene.gravity;
  const Placed A = placed(scene, c.A, kinA), B = placed(scene, c.B, kinB);
  d.aMA = d.bMA = A.frame;
  d.bMA.p += A.body - B.body;
  d.bMA.p += A.base - B.base;
  d.G = B.frame.inverse() * d.bMA;
  const Vec6<double> zero = Vec6<double>::Zero();
  d.vA = kinA ? d.aMA.act_inverse(kinA->v[c.A.joint]) : zero;
  d.aA = d.aMA.act_inverse(kinA ? aA : rest);
  d.vB = kinB ? d.bMA.act_inverse(kinB->v[c.B.joint]) : zero;
  d.aB = d.bMA.act_inverse(kinB ? aB : rest);
  contact_motion<double>(c, d);
}

}  // namespace manycontact
