#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact {

SceneAtRest::SceneAtRest(const Scene& of) : scene(of), zero(Eigen::VectorXd::Zero(of.nv)) {
  scene.gravity.setZero();
  drop_applied_forces(scene);
  for (const Robot& robot : of.robots) kin.emplace_back(*robot.model);
  for (const Contact& contact : of.contacts) contacts.emplace_back(contact, ContactSupport());
}

void SceneAtRest::follow(const Scene& of, double h) {
  gravity = of.gravity;
  scene.damping = of.damping;
  scene.tolerance = of.tolerance;
  scene.moment_length = of.moment_length;
  for (std::size_t r = 0; r < of.robots.size(); ++r) scene.robots[r].base = of.robots[r].base;
  for (std::size_t c = 0; c < of.contacts.size(); ++c) {
    const Contact& from = of.contacts[c];
    Contact& to = scene.contacts[c];
    to.B.placement = from.B.placement;
    to.reference_frame = from.reference_frame;
    to.alpha = from.alpha * h;
    to.beta = 0;
  }
}

void SceneAtRest::inverse_dynamics_of(const Scene& of, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                      const Eigen::VectorXd& a, const Vec3<double>& gravity, Eigen::VectorXd& tau) {
  for (std::size_t r = 0; r < of.robots.size(); ++r) {
    const Robot& robot = of.robots[r];
    const Model& model = *robot.model;
    const double* qdd = a.data() + robot.idx_v;
    forward_kinematics<double>(model, robot.base, q.segment(robot.idx_q, model.nq), kin[r]);
    forward_accelerations<double>(model, v.segment(robot.idx_v, model.nv), qdd, gravity, kin[r]);
    inverse_dynamics<double>(model, kin[r], qdd, {}, f, tau.segment(robot.idx_v, model.nv));
  }
}

void SceneAtRest::contact_velocities(const std::vector<int>& f_offset, Eigen::VectorXd& c) {
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    if (f_offset[k] < 0) continue;
    const Contact& contact = scene.contacts[k];
    ContactData<double>& d = contacts[k];
    contact_rows<double>(scene, contact, {}, kin[contact.A.robot],
                         contact.B.robot < 0 ? nullptr : &kin[contact.B.robot], d);
    c.segment(f_offset[k], contact.rows()).noalias() = d.W * d.nu;  // J v = W nu; nu: relative velocity of the frames
  }
}

void SceneAtRest::contact_velocities_at(const Eigen::VectorXd& v, const std::vector<int>& f_offset,
                                        Eigen::VectorXd& c) {
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    forward_accelerations<double>(*robot.model, v.segment(robot.idx_v, robot.model->nv), nullptr, scene.gravity,
                                  kin[r]);
  }
  contact_velocities(f_offset, c);
}

}  // namespace manycontact
