#include "manycontact/dynamics/static_torque.hpp"

#include "derivatives/columns.hpp"
#include "internal.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"

namespace manycontact {

StaticTorque::StaticTorque(const Scene& scene) : applied(scene), scratch(applied) {
  for (Eigen::VectorXd* x : {&tau, &tau_s, &l, &wq, &wv}) x->setZero(scene.nv);
  for (const Robot& robot : scene.robots) {
    kin.emplace_back(*robot.model);
    terms.emplace_back(*robot.model);
    fext.emplace_back(robot.model->njoints(), Vec6<double>::Zero());
    f.emplace_back(robot.model->njoints());
  }
}

void static_torque(const Scene& scene, const SceneData& data, const double* q, bool contacts, StaticTorque& s) {
  const Workspace& w = *data.workspace;
  for (std::size_t c = 0; contacts && c < scene.contacts.size(); ++c)
    if (data.f_offset[c] >= 0) (void)contact_data(scene, data, static_cast<int>(c));  // evaluates the rows
  if (contacts)
    for (const auto& d : w.islands)
      internal::contact_forces(scene, d->island, w.contacts, data.f_offset, data.f,
                               [&s](int r) -> std::vector<Vec6<double>>& { return s.fext[r]; });
  s.tau.setZero();  // serves as zero velocities below
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Robot& robot = scene.robots[r];
    s.kin[r] = robot_kinematics(scene, data, r);
    auto tau = s.tau.segment(robot.idx_v, robot.model->nv);
    forward_accelerations<double>(*robot.model, tau, nullptr, scene.gravity, s.kin[r]);
    if (!contacts) std::fill(s.fext[r].begin(), s.fext[r].end(), Vec6<double>(Vec6<double>::Zero()));
    inverse_dynamics<double>(*robot.model, s.kin[r], nullptr, s.fext[r], s.f[r], tau);
  }
  if (!has_applied_forces(scene)) return;
  s.tau_s.setZero();
  add_applied_forces<double>(scene, q, s.l.data(), data.wrenches, s.applied, s.tau_s.data());  // s.l: zero velocities
  s.tau -= s.tau_s;
}

namespace {

// Subtracts dtau_s/dq from `out`, row by row, where tau_s are the torques of wrenches and springs.
void subtract_applied(const Scene& scene, const Island& island, StaticTorque& s,
                      Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> out) {
  if (!has_applied_forces(scene)) return;
  const Eigen::VectorXd& rest = s.tau_s.setZero();
  each_velocity_block(scene, island, [&](int at, int row, int n) {
    for (int i = 0; i < n; ++i) {
      s.wq.setZero(), s.wv.setZero();
      s.l[at + i] = 1;
      add_applied_adjoint(scene, rest.data(), s.applied, island.robots, s.l.data(), s.scratch, s.wq.data(), s.wv.data(),
                          nullptr);
      s.l[at + i] = 0;
      each_velocity_block(scene, island, [&](int from, int column, int count) {
        out.row(row + i).segment(column, count) -= s.wq.segment(from, count).transpose();
      });
    }
  });
}

}  // namespace

void static_torque_derivative(const Scene& scene, const SceneData& data, std::size_t i, bool contacts, StaticTorque& s,
                              Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> out) {
  const Workspace& w = *data.workspace;
  const Island& island = w.islands[i]->island;
  out.setZero();
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const int r = island.robots[k], o = island.dof_offset[k];
    const Model& model = *scene.robots[r].model;
    rnea_derivatives(model, s.kin[r], w.robots[r].Yc, s.fext[r], s.terms[r]);
    // `out` is row-major; its transpose is column-major, with the triangles exchanged
    unpack_tree(model, s.terms[r].dq_upper, s.terms[r].dq_lower, out.block(o, o, model.nv, model.nv).transpose());
  }
  subtract_applied(scene, island, s, out);
  if (!contacts) return;
  out *= -1;  // sign of -dr1/dq, which force_columns corrects
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const int c = island.contacts[k];
    const Contact& contact = scene.contacts[c];
    const int oA = first_dof(island, contact.A), oB = first_dof(island, contact.B);
    internal::force_columns(contact_at_solution(data, c), contact_derivatives(data, c),
                            w.islands[i]->shape->support().columns[k], oA, oB, out);
  }
  out *= -1;
}

}  // namespace manycontact
