// Bounds the errors of derivatives Y = [da; -df], the solution of K Y = R, per column in the maximum norm:
//
//     |Y - Y_true| <= |K^-1| (|R - K Y| + c eps T + c eps |K| |Y| + T_x),
//
// T are magnitudes of the terms of R, which may cancel; |K| includes magnitudes of the terms of K's entries. c eps is a
// relative rounding error. T_x is the effect of errors of a and f on R, for derivatives with respect to q alone; terms
// of external wrenches and springs do not depend on a and f. If rows are dependent, with inconsistency rho and
// projection P R of R on the null space, rounding errors dJ of J add
//
//     + |K^+ K^+| (|dJ^T P R| + |d(J^T drho)/dq|),
//
// as in bounds.cpp. drho is the uncertainty of rho: the rounding error of rho, and rho itself if derivatives omit it.

#include "../../applied_forces.hpp"
#include "../../internal.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "matrix.hpp"
#include "row_terms.hpp"

namespace manycontact::internal {

namespace {

// Returns per dynamics row the largest entry of G = d(J^T rho)/dq (least_norm_forces.cpp). rho: one per contact row.
std::vector<double> sizes_of_G(const Scene& scene, const Workspace& work, const MatrixSystem& m,
                               const std::vector<double>& rho) {
  std::vector<double> out(m.owner.island.nv, 0.0);
  const auto size = [](const auto& x) { return x.cwiseAbs().maxCoeff(); };
  for (std::size_t k = 0; k < m.owner.island.contacts.size(); ++k) {
    const int c = m.owner.island.contacts[k];
    const ContactData<double>& data = work.linearisation->contacts[c];
    const Eigen::Map<const Eigen::VectorXd> of_rows(rho.data() + m.owner.island.row_offset[k],
                                                    scene.contacts[c].rows());
    const Vec6<double> F = data.W.cwiseAbs().transpose() * of_rows.cwiseAbs();
    const double force = size(F.head<3>()), moment = size(F.tail<3>());
    const auto [moved, turning] = largest_of_motions(data.Jl);
    const double turned = rows_turn(scene.contacts[c]) ? std::max(turning, 1.0) : turning;
    const std::vector<int>& columns = m.owner.shape->support().columns[k];
    for (std::size_t j = 0; j < columns.size(); ++j) {
      const auto s = data.Jl.col(static_cast<Eigen::Index>(j));
      out[columns[j]] += (force * turned) * size(s.head<3>()) + (force * moved + moment * turned) * size(s.tail<3>());
    }
  }
  return out;
}

// Returns the largest linear and angular motions of a robot's coordinates, except linear motions of a floating base.
RowTerms<double> largest_motions(const Model& model, const Kinematics<double>& kin) {
  RowTerms<double> out;
  for (int k = 0; k < model.nv; ++k) {
    if (model.joints[model.dof_joint[k]].nv() < 6)
      out.linear = std::max(out.linear, kin.J.col(k).head<3>().cwiseAbs().maxCoeff());
    out.angular = std::max(out.angular, kin.J.col(k).tail<3>().cwiseAbs().maxCoeff());
  }
  return out;
}

// Adds the largest |d(S^T f)/dq| over q to `terms`. S: a coordinate's motion; f: sum of |fext| of the bodies it moves.
void add_turned_forces(const Model& model, const Kinematics<double>& kin, const RowTerms<double>& motions,
                       const std::vector<Vec6<double>>& fext, double* terms) {
  std::vector<RowTerms<double>> F(model.njoints());
  for (int i = model.njoints() - 1; i >= 0; --i) {
    F[i].linear += fext[i].head<3>().cwiseAbs().maxCoeff();
    F[i].angular += fext[i].tail<3>().cwiseAbs().maxCoeff();
    const Joint& joint = model.joints[i];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k)
      terms[k] += F[i].linear * motions.angular * kin.J.col(k).head<3>().cwiseAbs().maxCoeff() +
                  (F[i].linear * motions.linear + F[i].angular * motions.angular) *
                      kin.J.col(k).tail<3>().cwiseAbs().maxCoeff();
    if (joint.parent < 0) continue;
    F[joint.parent].linear += F[i].linear;
    F[joint.parent].angular += F[i].angular;
  }
}

// Magnitudes of terms of derivatives with respect to q and v, one entry per row of K in the island's order. A term that
// rotates with q has a derivative of the term's size; a product of two velocities has one of twice the term's size.
struct TermsOfDerivatives {
  std::vector<double> q, v;
  std::vector<double> M;  // one entry per row of dynamics: terms of the largest entry of this row of M
};
TermsOfDerivatives terms_of_derivatives(const Scene& scene, const SceneData& data, const MatrixSystem& m) {
  const Workspace& work = *data.workspace;
  const Island& island = m.owner.island;
  TermsOfDerivatives out{std::vector<double>(island.size(), 0.0), std::vector<double>(island.size(), 0.0),
                         std::vector<double>(island.nv, 0.0)};
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Robot& robot = scene.robots[island.robots[k]];
    const RobotData& r = work.robots[island.robots[k]];
    const int first = island.dof_offset[k], nv = robot.model->nv;
    if (nv == 0) continue;
    torque_terms(*robot.model, r, data.a.data() + robot.idx_v, out.q.data() + first, out.M.data() + first);
    double w = 0;
    for (const Vec6<double>& velocity : r.kin.v) w = std::max(w, velocity.tail<3>().cwiseAbs().maxCoeff());
    const RowTerms<double> motions = largest_motions(*robot.model, r.kin);
    for (int i = first; i < first + nv; ++i) {
      out.q[i] *= motions.angular;
      out.v[i] = 2 * w * out.M[i];
    }
    add_turned_forces(*robot.model, r.kin, motions, work.linearisation->of(island.robots[k]).fext,
                      out.q.data() + first);
  }
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const ContactData<double>& rows = work.linearisation->contacts[island.contacts[k]];
    const RowTerms<double> terms = with_robots_of(
        scene, work, contact, [&](const auto&... robots) { return row_terms<double>(contact, rows, robots...); });
    const auto [moved, turned] = largest_of_motions(rows.Jl);
    const auto velocity = [&](int at) {
      return std::max(rows.vA.segment<3>(at).cwiseAbs().maxCoeff(), rows.vB.segment<3>(at).cwiseAbs().maxCoeff());
    };
    const double beta = std::abs(contact.beta), v = velocity(0), w = velocity(3);
    for (int i = 0, row = island.nv + island.row_offset[k]; i < contact.rows(); ++i, ++row) {
      const double unit = unit_of(m, row - island.nv);
      const auto [linear, angular] = row_weights(rows, i);
      out.q[row] = unit * (turned * terms.of_row(i) + linear * moved * terms.angular);
      out.v[row] = unit * (linear * ((2 * w + beta) * moved + 2 * v * turned) + angular * (2 * w + beta) * turned);
    }
  }
  return out;
}

// Returns T_x of the file header per row of K, in the island's order, for errors a of accelerations and f of forces.
std::vector<double> terms_of_errors(const Scene& scene, const SceneData& data, const MatrixSystem& m,
                                    const std::vector<double>& terms_of_M, double a, double f) {
  const Workspace& work = *data.workspace;
  const Island& island = m.owner.island;
  std::vector<double> out(island.size(), 0.0);
  std::vector<std::vector<Vec6<double>>> fext;  // one list per robot: magnitudes of contact forces on its bodies
  for (int r : island.robots) fext.emplace_back(scene.robots[r].model->njoints(), Vec6<double>(Vec6<double>::Zero()));
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const ContactData<double>& rows = work.linearisation->contacts[island.contacts[k]];
    const Vec6<double> F = f * rows.W.cwiseAbs().colwise().sum().transpose();
    each_body_force(contact, rows, F, [&](const Attachment& at, const Vec6<double>& force) {
      fext[local_robot(island, at.robot)][at.joint] += force.cwiseAbs();
    });
    const RowTerms<double> J = motion_terms(contact, rows);
    const auto [moved, turned] = largest_of_motions(rows.Jl);
    const double accelerated = a * static_cast<double>(rows.Jl.cols());
    for (int i = 0, row = island.nv + island.row_offset[k]; i < contact.rows(); ++i, ++row)
      out[row] = unit_of(m, row - island.nv) * accelerated *
                 (turned * J.of_row(i) + row_weights(rows, i).linear * moved * J.angular);
  }
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const Model& model = *scene.robots[island.robots[k]].model;
    const Kinematics<double>& kin = work.robots[island.robots[k]].kin;
    const int first = island.dof_offset[k];
    if (model.nv == 0) continue;
    const RowTerms<double> motions = largest_motions(model, kin);
    for (int i = first; i < first + model.nv; ++i) out[i] = motions.angular * terms_of_M[i] * model.nv * a;
    add_turned_forces(model, kin, motions, fext[k], out.data() + first);
  }
  return out;
}

// Adds |dK| times `sizes` to w, in elimination order. dK: errors of K due to cancelling terms, divided by c eps.
void add_terms_of_K(const Scene& scene, const Workspace& work, const MatrixSystem& m, const TermsOfDerivatives& terms,
                    const std::vector<double>& sizes, std::vector<double>& w) {
  const Island& island = m.owner.island;
  const int* iperm = m.K.pattern->iperm.data();
  for (std::size_t k = 0; k < island.robots.size(); ++k) {
    const int first = island.dof_offset[k], end = first + scene.robots[island.robots[k]].model->nv;
    double accelerated = 0;
    for (int i = first; i < end; ++i) accelerated += sizes[iperm[i]];
    for (int i = first; i < end; ++i) w[iperm[i]] += terms.M[i] * accelerated;
  }
  add_terms_of_J(scene, work, m, sizes, w);
}

// Returns the uncertainty drho of the contacts' inconsistency, one entry per contact row.
std::vector<double> unknown_contradiction(const Scene& scene, const Workspace& work, const MatrixSystem& m) {
  const Island& island = m.owner.island;
  std::vector<double> out(island.nc);
  const double c_eps = rounding(scene, m);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const RowTerms<double> terms = row_terms(scene, work, island.contacts[k]);
    for (int i = 0, row = island.row_offset[k]; i < scene.contacts[island.contacts[k]].rows(); ++i, ++row) {
      const double left = std::abs(m.v.null_component[m.K.pattern->iperm[island.nv + row]]) * unit_of(m, row);
      out[row] = left == 0 ? 0 : c_eps * terms.of_row(i) * unit_of(m, row) * unit_of(m, row);
      if (!m.contradiction) out[row] += left;
    }
  }
  return out;
}

struct Panel {  // columns X of derivatives, and their residuals in the scaled units of K
  const AlignedPanel& X;
  AlignedPanel Y, left;  // Y = [da; -df], df divided by the row units S; residual R - K Y
  AlignedPanel missed;   // R's projection P R on the null space; set if rows are dependent

  // X may have memory for more columns than R.
  Panel(const MatrixSystem& m, const AlignedPanel& of, const AlignedPanel& R) : X(of), Y(R), left(R) {
    const int nv = m.owner.island.nv, ld = static_cast<int>(R.cols());
    Y.leftCols(ld) = X.leftCols(ld);
    for (int k = 0; k < m.owner.island.nc; ++k) Y.row(nv + k) *= -1 / unit_of(m, k);
    if (ld == 0) return;
    sparse::residual_panel(m.K.pattern->K, m.K.values.data(), m.K.pattern->perm.data(), Y.data(), left.data(), ld, ld);
    if (!m.deficient()) return;
    missed = left;
    m.factor->project_out_panel(left.data(), ld, ld);
    missed -= left;
  }
};

struct Columns {  // columns of a panel with respect to one kind of variable: q, v, u or wrenches
  const Panel& panel;
  int first, count;
  const AlignedPanel* R = nullptr;             // right-hand sides, without wrenches and springs
  const std::vector<double>* terms = nullptr;  // one entry per row of the island: terms of R
  std::vector<double> applied = {};            // one entry per row of dynamics: terms of wrenches and springs
  bool by_q = false;

  double largest(const AlignedPanel& X, int row, int rows = 1) const {
    return X.block(row, first, rows, count).cwiseAbs().maxCoeff();
  }
};

}  // namespace

bool bound_derivatives(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& m,
                       const IslandDerivatives& derivatives, DerivativeBounds& out) {
  const Island& island = m.owner.island;
  IslandDerivatives R;
  lay_out(scene, island, derivatives.request, R);
  {
    const AtSolution at(scene, data, island);
    if (!weighed_right_hand_sides(scene, data, m, R, thread.panel)) return false;
  }
  const AlignedPanel alone = R.X;
  add_applied_right_hand_sides(scene, data, island, R);
  const Panel X(m, derivatives.X, R.X), W(m, derivatives.W, R.W);

  const auto [a, f] = known_answer(scene, data, m);
  const double c_eps = rounding(scene, m), e = std::max(a.felt(), f.felt());
  const double projected = m.deficient() ? m.factor->projector_error() + f.felt() : 0;
  const TermsOfDerivatives terms = terms_of_derivatives(scene, data, m);
  const std::vector<double> of_errors = terms_of_errors(scene, data, m, terms.M, a.error, f.error);
  const double of_dropped = m.deficient() ? rounding_of_J(scene, m) : c_eps;
  const AppliedSizes applied = applied_sizes(scene, data, island);
  const std::vector<double> of_contradiction =
      m.deficient() ? sizes_of_G(scene, *data.workspace, m, unknown_contradiction(scene, *data.workspace, m))
                    : std::vector<double>();
  const std::vector<double> none(island.size(), 0.0);
  std::vector<double> sizes(island.size()), rest(island.size()), w(island.size());  // all in order of elimination
  const auto bound_columns = [&](const Columns& of, double& of_a, double& of_f) {
    if (of.count == 0) return;
    const KktPattern& p = *m.K.pattern;
    const double of_K = m.deficient() && m.contradiction ? c_eps + e : c_eps;  // errors of a, f change rho
    for (int k = 0; k < island.size(); ++k) sizes[p.iperm[k]] = of.largest(of.panel.Y, k);
    sparse::residual(p.K, m.K.values.data(), sizes.data(), none.data(), rest.data(), w.data());  // w = |K| sizes
    add_terms_of_K(scene, *data.workspace, m, terms, sizes, w);
    std::vector<double> of_applied(island.size(), 0.0);
    for (int k = 0; k < island.size(); ++k) {
      double& of_row = w[p.iperm[k]];
      of_row =
          of.largest(of.panel.left, k) + of_K * of_row +
          (k < island.nv ? c_eps : of_dropped) * ((of.R ? of.largest(*of.R, k) : 0) + (of.terms ? (*of.terms)[k] : 0)) +
          (of.by_q ? of_errors[k] : 0);
      if (k < island.nv && !of.applied.empty()) of_applied[p.iperm[k]] = of.applied[k];
      of_row += c_eps * of_applied[p.iperm[k]];
    }
    std::vector<double> twice;
    if (m.deficient()) {
      for (int k = 0; k < island.size(); ++k) rest[p.iperm[k]] = k < island.nv ? 0 : of.largest(of.panel.missed, k);
      twice = turned_contradiction(scene, *data.workspace, m, rest);
      for (int k = 0; k < island.nv && of.by_q; ++k) twice[p.iperm[k]] += of_contradiction[k];
    }
    const auto bound = [&](int from, int count) {
      return bound_of_solution(m, w, from, count) + (m.deficient() ? bound_of_two_solutions(m, twice, from, count) : 0);
    };
    of_a = Known{of.largest(of.panel.X, 0, island.nv), bound(0, island.nv)}.relative();
    if (island.nc == 0 || !derivatives.request.forces) return;
    const double df = of.largest(of.panel.X, island.nv, island.nc);
    // terms of wrenches and springs may cancel the other terms
    const double summed = m.deficient() ? bound_of_solution(m, of_applied, island.nv, island.nc) : 0;
    of_f = Known{df, bound(island.nv, island.nc) + projected * (df + summed)}.relative();
  };
  const auto of_island = [&](const std::vector<double>& x) {
    std::vector<double> own(island.nv);
    each_velocity_block(scene, island, [&](int at, int first, int n) { std::copy_n(&x[at], n, &own[first]); });
    return own;
  };
  const DerivativeRequest& request = derivatives.request;
  const int by_w = request.wrenches ? static_cast<int>(6 * derivatives.wrenches.size()) : 0;
  out = {};
  bound_columns({X, derivatives.q_first, request.q ? island.nv : 0, &alone, &terms.q, of_island(applied.q), true},
                out.da_dq, out.dforces_dq);
  bound_columns({X, derivatives.v_first, request.v ? island.nv : 0, &alone, &terms.v, of_island(applied.v)}, out.da_dv,
                out.dforces_dv);
  bound_columns({X, derivatives.u_first, request.u ? derivatives.nu : 0, &alone}, out.da_du, out.dforces_du);
  bound_columns({W, 0, by_w, nullptr, nullptr, of_island(applied.w)}, out.da_dw, out.dforces_dw);
  return true;
}

}  // namespace manycontact::internal
