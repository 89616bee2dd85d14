#include "support/terms.hpp"

#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"
#include "spatial/compare.hpp"
#include "support/dense.hpp"

namespace manycontact::test {

Terms::Terms(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
             const Eigen::VectorXd& u)
    : M(Eigen::MatrixXd::Zero(scene.nv, scene.nv)), tau_b(scene.nv), damping(scene.damping) {
  SceneData data(scene, {Method::kDense, {}});
  data.active = active;
  (void)solve(scene, q, v, u, data);  // evaluates all of them, with or without a solution
  J.setZero(data.f.size(), scene.nv);
  a0.resize(data.f.size());
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Robot& robot = scene.robots[r];
    const int o = robot.idx_v, nv = robot.model->nv;
    unpack_inertia<double>(*robot.model, joint_space_inertia(scene, data, r).data(), M.block(o, o, nv, nv));
    tau_b.segment(o, nv) = -bias_torques(scene, data, r);
    for (int k = 0; k < robot.model->nu(); ++k) tau_b[o + robot.model->actuated[k]] += u[robot.idx_u + k];
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (data.f_offset[c] < 0) continue;
    const Contact& contact = scene.contacts[c];
    const int rows = contact.rows();
    a0.segment(data.f_offset[c], rows) = contact_data(scene, data, c).a0;
    int k = 0;
    for (int i : contact_support(scene, data, c).a)
      J.col(scene.robots[contact.A.robot].idx_v + i).segment(data.f_offset[c], rows) =
          contact_data(scene, data, c).J.col(k++);
    for (int i : contact_support(scene, data, c).b)
      J.col(scene.robots[contact.B.robot].idx_v + i).segment(data.f_offset[c], rows) =
          contact_data(scene, data, c).J.col(k++);
  }
}

double Terms::dynamics_error(const Eigen::VectorXd& a, const Eigen::VectorXd& f) const {
  return size_of(M * a - J.transpose() * f - tau_b) / size_of(tau_b);
}

double Terms::least_squares_error(const Eigen::VectorXd& a) const {
  const double size = size_of(J.cwiseAbs().transpose() * (J.cwiseAbs() * a.cwiseAbs() + a0.cwiseAbs()));
  return size == 0 ? 0 : size_of(J.transpose() * (J * a + a0)) / size;
}

double Terms::least_norm_error(const Eigen::VectorXd& f) const {
  if (f.size() == 0) return 0;
  const double size = size_of(f);
  return size == 0 ? 0 : size_of(f - least_norm(J.transpose(), J.transpose() * f, 1e-9).col(0)) / size;
}

Eigen::VectorXd Terms::solve_by_lu() const {
  const Eigen::Index nv = M.rows(), nc = J.rows();
  Eigen::MatrixXd K(nv + nc, nv + nc);
  K << M, J.transpose(), J, -damping * Eigen::MatrixXd::Identity(nc, nc);
  Eigen::VectorXd b(nv + nc);
  b << tau_b, -a0;
  return solved(K, b);
}

}  // namespace manycontact::test
