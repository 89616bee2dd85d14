#include "manycontact/algorithm/rnea.hpp"
#include "manycontact/simulation/gains.hpp"
#include "manycontact/simulation/step.hpp"

namespace manycontact {

SceneAtRest::SceneAtRest(const Scene& of) : scene(of), zero(Eigen::VectorXd::Zero(of.nv)) {
  scene.gravity.setZero();
  for (const Robot& robot : of.robots) kin.emplace_back(*robot.model);
}

void SceneAtRest::follow(const Scene& of, Integrator integrator, double h) {
  scene.damping = of.damping;
  for (std::size_t r = 0; r < of.robots.size(); ++r) scene.robots[r].base = of.robots[r].base;
  for (std::size_t c = 0; c < of.contacts.size(); ++c) {
    const Contact& from = of.contacts[c];
    Contact& to = scene.contacts[c];
    to.B.placement = from.B.placement;
    to.reference_frame = from.reference_frame;
    to.alpha = h > 0 ? (1 - error_growth(integrator, {from.alpha, from.beta}, h)) / h : 0;
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

}  // namespace manycontact
