#include <algorithm>

#include "../../derivatives/jacobian_rate.hpp"
#include "../../internal.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"

// If rows depend, the least-norm force f is in J's range: P f = 0, P = I - J J^+. Its derivative at constant rank is
// P df = P D dq, with D = d(J(q) y)/dq at constant y = J^+ f.
//
// Inconsistent contacts: rho = J a + a0 of the least-squares acceleration satisfies J^T rho = 0, with the derivative
// J^T (J da + dr2) + G dq = 0; dr2 = drho at constant a, G = d(J^T rho)/dq at constant rho. So J da = -dr2 - (J^T)^+ G
// dq in J's range. As J^T rho = 0 at all q, G dq is in the range of J^T: K^+ [G dq; 0] = [0; (J^T)^+ G dq].

namespace manycontact::internal {

namespace {

// Returns the JacobianRate of contact c of an island, in the island's velocity coordinates.
JacobianRate<double> jacobian_rate(const Scene& scene, const Workspace& work, const IslandWork& d, std::size_t c) {
  const int number = d.island.contacts[c];
  const Contact& contact = scene.contacts[number];
  const auto& joints = [&](int robot) -> const std::vector<int>& { return scene.robots[robot].model->dof_joint; };
  const int a = contact.A.robot, b = contact.B.robot < 0 ? a : contact.B.robot;
  return {contact,
          work.linearisation->contacts[number],
          {work.supports[number].a, joints(a)},
          {work.supports[number].b, joints(b)},
          d.shape->support().columns[c],
          work.linearisation->derivatives[number].chain_a,
          first_dof(d.island, contact.A),
          work.robots[a].kin};
}

DependentDerivatives& work_of(MatrixSystem& m) {
  if (!m.rows) m.rows = std::make_unique<DependentDerivatives>();
  return *m.rows;
}

// Returns a y with J y = f for the contact forces f, computed once per solution. P D is the same for every such y,
// as P d(J n) = 0 where J n = 0.
const Eigen::VectorXd& any_motion(const Scene& scene, const SceneData& data, MatrixSystem& m, KktVectors& v) {
  DependentDerivatives& w = work_of(m);
  if (w.known) return w.y;
  const int* iperm = m.K.pattern->iperm.data();
  const Island& island = m.owner.island;
  v.resize(island.size());
  std::fill(v.b.begin(), v.b.end(), 0.0);
  each_force_block(scene, data.f_offset, island, [&](int from, int to, int n) {
    for (int i = 0; i < n; ++i) v.b[iperm[island.nv + to + i]] = data.f[from + i] / unit_of(m, to + i);
  });
  if (m.factor->own_refinements() > 0) {
    v.x = v.b;
    m.factor->particular_solution(v.x.data());
  } else {
    m.factor->solve_refined(m.K, v, tolerance::kRefinementSteps);
  }
  remake(w.y, island.nv);
  for (int k = 0; k < island.nv; ++k) w.y[k] = v.x[iperm[k]];
  w.known = true;
  return w.y;
}

// Calls use(number of the contact in the island, the contact's part of x). x: one entry per contact row.
template <class X, class Use>
void each_contact(const Scene& scene, const Island& island, X& x, Use&& use) {
  for (std::size_t c = 0; c < island.contacts.size(); ++c)
    use(c, x.segment(island.row_offset[c], scene.contacts[island.contacts[c]].rows()));
}

void take_motion(const Scene& scene, const Island& island, const ConstVector& dq, Eigen::VectorXd& dofs) {
  remake(dofs, island.nv);
  each_velocity_block(scene, island, [&](int from, int to, int n) { dofs.segment(to, n) = dq.segment(from, n); });
}

// Sets rho to S times the inconsistency of the scaled rows S J, so that J^T rho is differentiated with the unscaled J.
void take_contradiction(MatrixSystem& m, Eigen::VectorXd& rho) {
  remake(rho, m.owner.island.nc);
  for (int k = 0; k < rho.size(); ++k)
    rho[k] = -unit_of(m, k) * m.v.null_component[m.K.pattern->iperm[m.owner.island.nv + k]];
}

// Overwrites x, one entry per contact row, with S P S x. S: row weights; P projects onto the null space of (S J)^T.
void project(MatrixSystem& m, KktVectors& v, Eigen::VectorXd& x) {
  const int* iperm = m.K.pattern->iperm.data() + m.owner.island.nv;
  v.resize(m.owner.island.size());
  std::fill(v.b.begin(), v.b.end(), 0.0);
  std::fill(v.null_component.begin(), v.null_component.end(), 0.0);
  for (int k = 0; k < x.size(); ++k) v.b[iperm[k]] = unit_of(m, k) * x[k];
  m.factor->project_out(v.b.data(), v.null_component.data());
  for (int k = 0; k < x.size(); ++k) x[k] = unit_of(m, k) * v.null_component[iperm[k]];
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Finds contacts with dependent rows and the coordinates of their J; returns a zero panel, one column per coordinate.
Eigen::Map<RowMajor> take_columns(const Scene& scene, const SceneData& data, MatrixSystem& m) {
  DependentDerivatives& w = work_of(m);
  const Island& island = m.owner.island;
  w.in_null_space.resize(island.nc);
  m.factor->null_space_rows(w.in_null_space);
  w.contacts.clear(), w.contacts.reserve(island.contacts.size());
  w.columns.clear(), w.columns.reserve(island.nv);
  w.place.assign(island.nv, -1);
  for (std::size_t c = 0; c < island.contacts.size(); ++c) {
    const auto rate = jacobian_rate(scene, *data.workspace, m.owner, c);
    const char* rows = w.in_null_space.data() + island.row_offset[c];
    if (std::none_of(rows, rows + rate.W().rows(), [](char in) { return in; })) continue;
    w.contacts.push_back(static_cast<int>(c));
    rate.each_column([&](int k) {
      if (w.place[k] >= 0) return;
      w.place[k] = static_cast<int>(w.columns.size());
      w.columns.push_back(k);
    });
  }
  const int ld = sparse::padded(static_cast<std::ptrdiff_t>(w.columns.size()));
  w.panel.reserve(static_cast<std::size_t>(island.size()) * sparse::padded(island.nv));  // the largest possible size
  w.panel.assign(static_cast<std::size_t>(island.size()) * ld, 0.0);
  return {w.panel.data(), island.size(), ld};
}

}  // namespace

bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& m, IslandDerivatives& out, PanelWork& work) {
  auto G = take_columns(scene, data, m);
  DependentDerivatives& w = *m.rows;
  const Island& island = m.owner.island;
  take_contradiction(m, w.rows);
  remake(w.dofs, island.nv);
  w.dofs.setZero();
  for (int c : w.contacts) {
    const auto rate = jacobian_rate(scene, *data.workspace, m.owner, c);
    const Vec6<double> F = rate.W().transpose() * w.rows.segment(island.row_offset[c], rate.W().rows());
    for (int i : m.owner.shape->support().columns[c]) {
      w.dofs[i] = 1;
      rate.of_motion(w.dofs, [&](int k, const Vec6<double>& ds) { G(i, w.place[k]) += dot(ds, F); });
      w.dofs[i] = 0;
    }
  }
  const int ld = static_cast<int>(G.cols());
  const bool believed = ld == 0 || solve_columns(m, w.panel.data(), ld, work);
  for (std::size_t k = 0; k < w.columns.size(); ++k)
    out.X.col(out.q_first + w.columns[k]).tail(out.nc) -= G.col(k).tail(out.nc);
  return believed;
}

void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& m, KktVectors& v, IslandDerivatives& out) {
  auto D = take_columns(scene, data, m);  // D has zeros in dynamics rows
  DependentDerivatives& w = *m.rows;
  const Island& island = m.owner.island;
  const Eigen::VectorXd& y = any_motion(scene, data, m, v);
  for (int c : w.contacts) {
    const auto rate = jacobian_rate(scene, *data.workspace, m.owner, c);
    auto rows = D.middleRows(island.nv + island.row_offset[c], rate.W().rows());
    rate.of_motion(y, [&](int k, const Vec6<double>& dnu) { rows.col(w.place[k]).noalias() += rate.W() * dnu; });
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      rows.row(i) *= unit_of(m, island.row_offset[c] + static_cast<int>(i));
  }
  // dforces_dq += P D = D - (D - P D)
  const auto add = [&](double sign) {
    for (int c : w.contacts)
      for (int row = island.nv + island.row_offset[c], k = 0; k < scene.contacts[island.contacts[c]].rows(); ++k, ++row)
        for (std::size_t j = 0; j < w.columns.size(); ++j)
          out.X(row, out.q_first + w.columns[j]) += sign * D(row, static_cast<Eigen::Index>(j));
  };
  add(1);
  if (const int ld = static_cast<int>(D.cols()); ld > 0) m.factor->project_out_panel(w.panel.data(), ld, ld);
  add(-1);
}

bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& m, const ConstVector& dq, KktVectors& v,
                       ProductWork& work) {
  DependentDerivatives& w = work_of(m);
  const Island& island = m.owner.island;
  const int* iperm = m.K.pattern->iperm.data();
  take_contradiction(m, w.rows);
  take_motion(scene, island, dq, w.dofs);
  v.resize(island.size());
  std::fill(v.b.begin(), v.b.end(), 0.0);
  each_contact(scene, island, w.rows, [&](std::size_t c, const auto& rho) {
    if (rho.isZero(0)) return;
    const auto rate = jacobian_rate(scene, *data.workspace, m.owner, c);
    rate.of_force(rate.W().transpose() * rho, w.dofs, [&](int i, double entry) { v.b[iperm[i]] += entry; });
  });
  const bool believed = solve_vector(m, v);
  each_force_block(scene, data.f_offset, island, [&](int to, int from, int n) {
    for (int i = 0; i < n; ++i) work.y[to + i] -= v.x[iperm[island.nv + from + i]] / unit_of(m, from + i);
  });
  return believed;
}

void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& m, const ConstVector& dq, KktVectors& v,
                       ProductWork& work) {
  DependentDerivatives& w = work_of(m);
  const Island& island = m.owner.island;
  const Eigen::VectorXd& y = any_motion(scene, data, m, v);
  take_motion(scene, island, dq, w.dofs);
  remake(w.rows, island.nc);
  each_contact(scene, island, w.rows, [&](std::size_t c, auto of_contact) {
    const auto rate = jacobian_rate(scene, *data.workspace, m.owner, c);
    Vec6<double> dnu = Vec6<double>::Zero();
    rate.of_motion(y, [&](int k, const Vec6<double>& column) { dnu += column * w.dofs[k]; });
    of_contact.noalias() = rate.W() * dnu;
  });
  project(m, v, w.rows);
  each_force_block(scene, data.f_offset, island,
                   [&](int to, int from, int n) { work.y.segment(to, n) -= w.rows.segment(from, n); });
}

namespace {

// Adds sign * D(y)^T x to gradient, where D(y) = d(J y)/dq. x: one entry per contact row.
void add_transposed(const Scene& scene, const SceneData& data, const MatrixSystem& m, double sign,
                    const Eigen::VectorXd& y, const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  each_contact(scene, m.owner.island, x, [&](std::size_t c, const auto& of_contact) {
    if (of_contact.isZero(0)) return;
    const auto rate = jacobian_rate(scene, *data.workspace, m.owner, c);
    const Vec6<double> F = sign * (rate.W().transpose() * of_contact);
    rate.of_motion(y, [&](int k, const Vec6<double>& dnu) { gradient[k] += dot(dnu, F); });
  });
}

}  // namespace

bool add_dependent_adjoint(const Scene& scene, SceneData& data, MatrixSystem& m, const AdjointProduct& p,
                           KktVectors& v) {
  DependentDerivatives& w = work_of(m);
  const Island& island = m.owner.island;
  const int* iperm = m.K.pattern->iperm.data();
  bool believed = true;
  remake(w.dofs, island.nv);
  remake(w.gradient, island.nv);
  w.gradient.setZero();
  if (m.contradiction) {  // G^T a = D(a)^T rho, where [a; y] = K^+ [0; contact rows of v.x]
    for (int k = 0; k < island.size(); ++k)
      v.b[iperm[k]] = k < island.nv ? 0 : v.x[iperm[k]] / unit_of(m, k - island.nv);  // solve_product scaled v.x by S
    believed = solve_vector(m, v);
    for (int k = 0; k < island.nv; ++k) w.dofs[k] = v.x[iperm[k]];
    take_contradiction(m, w.rows);
    add_transposed(scene, data, m, -1, w.dofs, w.rows, w.gradient);
  }
  const Eigen::VectorXd& y = any_motion(scene, data, m, v);
  remake(w.rows, island.nc);
  each_force_block(scene, data.f_offset, island,
                   [&](int from, int to, int n) { w.rows.segment(to, n) = p.wf.segment(from, n); });
  project(m, v, w.rows);
  add_transposed(scene, data, m, 1, y, w.rows, w.gradient);
  each_velocity_block(scene, island,
                      [&](int to, int from, int n) { p.wq.segment(to, n) += w.gradient.segment(from, n); });
  return believed;
}

}  // namespace manycontact::internal
