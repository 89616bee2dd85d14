#include <Eigen/QR>

#include "fwddyn_steps.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact::internal {

namespace {

// The u part of the minimum-norm least-squares solution of [dtau/du  J^T] [u; f] = h(q, 0) of the whole scene, dtau/du
// at u = 0, for an actuation that is not a selection.
void custom_quasi_static(ActuationModelAbstract& actuation, const ConstVectorRef& x, DataCollector& m, VectorRef u) {
  u.setZero();
  actuation.calc(m.actuation, x, u);
  actuation.calcDiff(m.actuation, x, u);
  quasi_static_tau(m.scene, x.head(m.scene.nq), m.solution);  // evaluates h and J
  const Eigen::Index nu = u.size();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(m.scene.nv, nu + m.solution.f.size());
  A.leftCols(nu) = m.actuation->dtau_du;
  Eigen::VectorXd h = -m.actuation->tau;
  for (int r = 0; r < m.scene.nrobots(); ++r)
    h.segment(m.scene.robots[r].idx_v, m.solution.robots[r].h.size()) += m.solution.robots[r].h;
  for (std::size_t c = 0; c < m.scene.contacts.size(); ++c) {
    if (m.solution.f_offset[c] < 0) continue;
    const Contact& contact = m.scene.contacts[c];
    const Eigen::MatrixXd& J = m.solution.contacts[c].J;
    int k = 0;
    const auto column = [&](int robot, int i) {
      A.row(m.scene.robots[robot].idx_v + i).segment(nu + m.solution.f_offset[c], J.rows()) = J.col(k++).transpose();
    };
    for (int i : m.solution.supports[c].a) column(contact.A.robot, i);
    for (int i : m.solution.supports[c].b) column(contact.B.robot, i);
  }
  u = A.completeOrthogonalDecomposition().solve(h).head(nu);
}

}  // namespace

void quasi_static(ActuationModelAbstract& actuation, const ConstVectorRef& x, DataCollector& m, VectorRef u) {
  const auto q = x.head(m.scene.nq);
  switch (kind(actuation, m.scene)) {
    case Actuation::kActuated:
      u = manycontact::quasi_static(m.scene, q, m.solution);
      break;
    case Actuation::kAll:
      u = quasi_static_tau(m.scene, q, m.solution);
      break;
    case Actuation::kCustom:
      custom_quasi_static(actuation, x, m, u);
  }
}

}  // namespace manycontact::internal
