#include "manycontact/contact/reference.hpp"

#include <stdexcept>

#include "manycontact/algorithm/kinematics.hpp"

namespace manycontact {

namespace {

// World placement of an attached frame at q.
SE3<double> world_placement(const Scene& scene, const Attachment& at, const Eigen::Ref<const Eigen::VectorXd>& q,
                            const SE3<double>& offset) {
  const Robot& robot = scene.robots[at.robot];
  if (at.joint < 0) return robot.base * offset;
  Kinematics<double> kin(*robot.model);
  forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), kin);
  SE3<double> M = kin.oMi[at.joint] * offset;
  M.p += kin.origin;
  return M;
}

}  // namespace

void resolve_reference(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, bool position, bool orientation,
                       Contact& contact) {
  if (q.size() != scene.nq)
    throw std::invalid_argument("resolve_reference: q has " + std::to_string(q.size()) +
                                " numbers, the scene expects " + std::to_string(scene.nq));
  const SE3<double> oMA = world_placement(scene, contact.A, q, contact.A.placement);
  SE3<double> body;  // what B' is placed on
  if (contact.B.robot >= 0) body = world_placement(scene, contact.B, q, {});
  const SE3<double> target = body.inverse() * oMA;
  if (position) contact.B.placement.p = target.p;
  if (orientation) contact.B.placement.R = target.R;
}

void resolve_references(Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q) {
  for (Contact& contact : scene.contacts) resolve_reference(scene, q, true, true, contact);
}

}  // namespace manycontact
