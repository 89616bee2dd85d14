#include "manycontact/detail/contact/reference.hpp"

#include "manycontact/model/expect_state.hpp"

namespace manycontact {

ReferenceResolver::ReferenceResolver(const Scene& scene, const Eigen::VectorXd& q) : scene_(scene), q_(q) {
  expect_configuration("resolve_references", "q", q, scene);
}

SE3<double> ReferenceResolver::placement(const Attachment& at, const SE3<double>& offset) {
  const Robot& robot = scene_.robots[at.robot];
  if (at.joint < 0) return robot.base * offset;
  if (known_[0].robot != at.robot) std::swap(known_[0], known_[1]);
  Places& places = known_[0];
  if (places.robot != at.robot) {
    places.robot = -1;
    places.kin = std::make_unique<Kinematics<double>>(*robot.model);
    forward_kinematics<double>(*robot.model, robot.base, q_.segment(robot.idx_q, robot.model->nq), *places.kin);
    places.robot = at.robot;
  }
  SE3<double> M = places.kin->oMi[at.joint] * offset;
  M.p += places.kin->origin(at.joint);
  return M;
}

void ReferenceResolver::resolve(bool position, bool orientation, Contact& contact) {
  const SE3<double> oMA = placement(contact.A, contact.A.placement);
  SE3<double> body;  // placement in the world of the body to which B' is fixed; the identity for the world
  if (contact.B.robot >= 0) body = placement(contact.B, {});
  const SE3<double> target = body.inverse() * oMA;
  if (position) contact.B.placement.p = target.p;
  if (orientation) contact.B.placement.R = target.R;
}

void resolve_reference(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, bool position, bool orientation,
                       Contact& contact) {
  const Eigen::VectorXd at = q;
  ReferenceResolver(scene, at).resolve(position, orientation, contact);
}

void resolve_references(Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q) {
  const Eigen::VectorXd at = q;
  ReferenceResolver resolver(scene, at);
  for (Contact& contact : scene.contacts) resolver.resolve(true, true, contact);
}

}  // namespace manycontact
