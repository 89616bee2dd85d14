#include "manycontact/contact/body_rows.hpp"

namespace manycontact {

namespace {

// An attachment's frame in its body's frame, and that frame's origin seen from the robot's base.
struct Placed {
  SE3<double> frame;
  Vec3<double> body;
};
Placed placed(const Scene& scene, const Attachment& at, const BodyKinematics<double>& kin) {
  const bool moves = at.joint >= 0;
  const Mat3<double>& R = moves ? kin.R[at.joint] : scene.robots[at.robot].base.R;
  return {{R * at.placement.R, R * at.placement.p}, moves ? kin.p[at.joint] : Vec3<double>(Vec3<double>::Zero())};
}

}  // namespace

void body_rows(const Scene& scene, const Contact& c, const BodyKinematics<double>& kinA,
               const BodyKinematics<double>* kinB, const Vec6<double>& aA, const Vec6<double>& aB,
               ContactData<double>& d) {
  Vec6<double> rest = Vec6<double>::Zero();  // acceleration of what stands still, minus gravity
  rest.head<3>() = -scene.gravity;
  const Placed A = placed(scene, c.A, kinA);
  d.aMA = d.bMA = A.frame;
  d.bMA.p += A.body;
  SE3<double> bMB = c.B.placement;
  if (kinB) {
    const Placed B = placed(scene, c.B, *kinB);
    bMB = B.frame;
    d.bMA.p -= B.body;
    if (kinB != &kinA) d.bMA.p += kinA.origin - kinB->origin;
  } else {
    d.bMA.p += kinA.origin;
  }
  d.G = bMB.inverse() * d.bMA;
  const bool a_moves = c.A.joint >= 0, b_moves = kinB && c.B.joint >= 0;
  const Vec6<double> zero = Vec6<double>::Zero();
  d.vA = a_moves ? d.aMA.act_inverse(kinA.v[c.A.joint]) : zero;
  d.aA = d.aMA.act_inverse(a_moves ? aA : rest);
  d.vB = b_moves ? d.bMA.act_inverse(kinB->v[c.B.joint]) : zero;
  d.aB = d.bMA.act_inverse(b_moves ? aB : rest);
  contact_motion<double>(c, d);
}

}  // namespace manycontact
