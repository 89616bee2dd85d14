#include <algorithm>
#include <limits>

#include "contact_columns.hpp"
#include "fwddyn_steps.hpp"

namespace manycontact::internal {

namespace {

// Returns the first columns of A's robot and of B's robot in the data of a contact, where A's columns come first.
EndColumns columns_of(const Scene& scene, const Contact& contact) {
  const bool two = contact.B.robot >= 0 && contact.B.robot != contact.A.robot;
  return {0, two ? scene.robots[contact.A.robot].model->nv : 0};
}

}  // namespace

void set_drift_derivatives(const EndColumns& first, const ContactSupport& support, const ContactData<double>& rows,
                           const ContactDerivatives& d, Eigen::MatrixXd& out) {
  const Eigen::Index n = out.cols() / 2;
  out.setZero();
  each_column(first, support, [&](int to, int k) {
    out.col(to).noalias() = rows.W * d.dx_dq.col(k);
    out.col(n + to).noalias() = rows.W * d.dx_dv.col(k);
  });
  for (Eigen::Index i = 0; d.turns && i < d.turn.cols(); ++i) {
    const Vec6<double> dx = turned<double>(d.turn.col(i), d.x);
    out.col(first.a + d.chain_a[i]).noalias() += rows.W * dx;
  }
}

void fill_contacts(DataCollector& m) {
  for (auto& [name, data] : m.contacts->contacts) {
    if (!data->active) continue;
    const Contact& contact = m.scene.contacts[data->index];
    const ContactData<double>& rows = contact_data(m.scene, m.solution, data->index);
    each_column(columns_of(m.scene, contact), contact_support(m.scene, m.solution, data->index),
                [&](int to, int k) { data->Jc.col(to) = rows.J.col(k); });
    data->a0 = rows.a0;
    data->f = m.solution.f.segment(m.solution.f_offset[data->index], contact.rows());
  }
}

void fill_contact_derivatives(bool forces, DataCollector& m) {
  for (auto& [name, data] : m.contacts->contacts) {
    if (!data->active) continue;
    const Contact& contact = m.scene.contacts[data->index];
    const int i = island_with_robot(m.solution, robot_of(contact));
    if (m.solution.report.islands[i].status == Status::kFailed) {
      data->da0_dx.setConstant(std::numeric_limits<double>::quiet_NaN());
    } else {
      const ContactData<double>& rows = contact_at_solution(m.solution, data->index);
      const ContactDerivatives& d = contact_derivatives(m.solution, data->index);
      set_drift_derivatives(columns_of(m.scene, contact), contact_support(m.scene, m.solution, data->index), rows, d,
                            data->da0_dx);
    }
    if (!forces) continue;
    const Island& island = solved_island(m.solution, i);
    const std::size_t c =
        std::lower_bound(island.contacts.begin(), island.contacts.end(), data->index) - island.contacts.begin();
    const PanelView P = m.panel(i);
    const double* first = P.data() + (island.nv + island.row_offset[c]) * P.outerStride();
    const Eigen::Index nx = m.islands[i].x.size(), nu = m.islands[i].u.size();
    new (&data->df_dx) PanelView(first, contact.rows(), nx, Eigen::OuterStride<>(P.outerStride()));
    new (&data->df_du) PanelView(first + nx, contact.rows(), nu, Eigen::OuterStride<>(P.outerStride()));
  }
}

void fill_dynamics(DifferentialActionDataContactFwdDynamics& data) {
  const DataCollector& m = *data.multibody;
  if (data.storage == MatrixStorage::kPanel) {
    const PanelView P = m.panel(0);
    new (&data.panel) PanelView(P.data(), data.xout.size(), P.cols(), Eigen::OuterStride<>(P.outerStride()));
    return;
  }
  data.Fx_blocks.set_zero();
  data.Fu_blocks.set_zero();
  for (std::size_t i = 0; i < m.islands.size(); ++i) {
    const IslandColumns& columns = m.islands[i];
    const Eigen::Index nv = columns.v.size(), nx = columns.x.size(), nu = columns.u.size();
    const PanelView P = m.panel(i);
    const auto da_dx = P.topLeftCorner(nv, nx), da_du = P.block(0, nx, nv, nu);
    if (has_dense(data.storage)) {
      if (m.islands.size() == 1) {
        data.Fx = da_dx;
        data.Fu = da_du;
      } else {
        for (Eigen::Index j = 0; j < nx; ++j)
          for (Eigen::Index k = 0; k < nv; ++k) data.Fx(columns.v[k], columns.x[j]) = da_dx(k, j);
        for (Eigen::Index j = 0; j < nu; ++j)
          for (Eigen::Index k = 0; k < nv; ++k) data.Fu(columns.v[k], columns.u[j]) = da_du(k, j);
      }
    }
    if (has_blocks(data.storage)) {
      data.Fx_blocks.add(i, 1, da_dx);
      data.Fu_blocks.add(i, 1, da_du);
    }
  }
}

void apply_actuation(const ActuationModelAbstract& actuation, DataCollector& m) {
  if (m.custom.empty()) return;
  const Eigen::Index nv = m.scene.nv, nu = actuation.get_nu();
  for (std::size_t i = 0; i < m.islands.size(); ++i) {
    const IslandDerivatives& d = derivatives(m.solution).islands[i];
    const std::vector<int>& v = m.islands[i].v;
    RowMajorMatrix& out = m.custom[i];
    out.setZero(d.X.rows(), 2 * nv + nu);
    const auto by_tau = d.X.block(0, d.u_first, d.X.rows(), d.nu);
    for (std::size_t k = 0; k < v.size(); ++k) {
      out.col(v[k]) += d.X.col(d.q_first + k);
      out.col(nv + v[k]) += d.X.col(d.v_first + k);
    }
    const auto add = [&](const Eigen::SparseMatrix<double>& B, Eigen::Index first) {
      for (Eigen::Index j = 0; j < B.outerSize(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator it(B, j); it; ++it) {
          const auto row = std::lower_bound(v.begin(), v.end(), static_cast<int>(it.row()));  // v is sorted
          if (row != v.end() && *row == it.row()) out.col(first + j) += it.value() * by_tau.col(row - v.begin());
        }
    };
    add(m.actuation->dtau_dx, 0);
    add(m.actuation->dtau_du, 2 * nv);
  }
}

}  // namespace manycontact::internal
