#include <Eigen/LU>
#include <cassert>

#include "../integrators/euler_steps.hpp"
#include "coordinates.hpp"
#include "manycontact/action/contact_fwddyn.hpp"
#include "manycontact/detail/control/couplings.hpp"
#include "manycontact/dynamics/jvp.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// The equations of the couplings, rows [dx; du] + by_w w = 0, with dx, du of the whole node and with the wrenches w.
struct CouplingSystem {
  MatrixXd rows, by_w;
};

CouplingSystem system_of(const Couplings& couplings, const std::vector<ActionPart>& parts, const CouplingData& d,
                         Index ndx, Index nu) {
  const Index size = 6 * static_cast<Index>(couplings.couplings().size());
  CouplingSystem out{MatrixXd::Zero(size, ndx + nu), MatrixXd::Zero(size, size)};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ActionPart& part = parts[i];
    const std::vector<int>& of_part = couplings.couplings_of_parts()[i];
    const Index own = static_cast<Index>(part.u.size());
    for (std::size_t a = 0; a < of_part.size(); ++a) {
      const auto C = d.C[i].middleRows<6>(static_cast<Index>(6 * a)),
                 D = d.D[i].middleRows<6>(static_cast<Index>(6 * a));
      auto rows = out.rows.middleRows<6>(6 * of_part[a]);
      for (std::size_t j = 0; j < part.dx.size(); ++j) rows.col(part.dx[j]) += C.col(static_cast<Index>(j));
      for (std::size_t j = 0; j < part.u.size(); ++j) rows.col(ndx + part.u[j]) += D.col(static_cast<Index>(j));
      for (std::size_t b = 0; b < of_part.size(); ++b)
        out.by_w.block<6, 6>(6 * of_part[a], 6 * of_part[b]) += D.middleCols<6>(own + static_cast<Index>(6 * b));
    }
  }
  return out;
}

// Returns an orthonormal basis, as rows, of the complement of W's rows. W's rows are the translations and rotations
// that a contact constrains; the complement contains those that it leaves free.
Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6> complement_of(
    const Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>& W) {
  const Index m = W.rows();
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6> N =
      Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>::Zero(6 - m, 6);
  if (m == 6) return N;
  if (m == 5) {  // a hinge leaves the rotation about its axis free
    N.row(0).tail<3>() = Vec3<double>(W.row(3).tail<3>()).cross(Vec3<double>(W.row(4).tail<3>()));
  } else {
    N.bottomRightCorner<3, 3>().setIdentity();
    const Vec3<double> a = W.row(0).head<3>();
    if (m == 1) {
      const Vec3<double> b = a.unitOrthogonal();
      N.row(0).head<3>() = b;
      N.row(1).head<3>() = a.cross(b);
    } else if (m == 2) {
      N.row(0).head<3>() = a.cross(Vec3<double>(W.row(1).head<3>()));
    }
  }
  assert((W * N.transpose()).isZero(1e-12) && (N * N.transpose()).isIdentity(1e-12));
  return N;
}

// Adds the terms of the subproblem of A to the rows C dx + D du of a coupling. W are its contact's m constrained
// directions. The first m rows get the rotation of the axes in which the acceleration residual r2 is expressed, and
// delta W F, with the damping delta. The others require that the force F has no components in free directions. With F
// in A's axes, d(W F) = W (X^T dw - s x* F + th x F), where s = J_A dq_A, and th rotates a world-aligned frame.
void add_force_rows(const CouplingData::OfCoupling& coupling, double delta, Index first, Index w, MatrixRef C,
                    MatrixRef D) {
  const ContactDerivatives& dr = coupling.derivatives;
  const auto& W = coupling.rows.W;
  const Index m = W.rows();
  const auto N = complement_of(W);
  for (std::size_t k = 0; k < coupling.support.a.size(); ++k) {
    const Index column = static_cast<Index>(k), to = first + coupling.support.a[k];
    Vec6<double> dF = -cross_force(Vec6<double>(coupling.rows.Jl.col(column)), dr.F);
    if (dr.turns) {
      dF += turned<double>(dr.turn.col(column), dr.F);
      C.col(to).head(m).noalias() += W * turned<double>(dr.turn.col(column), dr.x);
    }
    C.col(to).head(m).noalias() += delta * (W * dF);
    C.col(to).tail(6 - m).noalias() += N * dF;
  }
  const Mat3<double> Rt = coupling.rows.aMA.R.transpose();
  for (const Index half : {Index(0), Index(3)}) {
    D.block(0, w + half, m, 3).noalias() += delta * (W.middleCols<3>(half) * Rt);
    D.block(m, w + half, 6 - m, 3).noalias() += N.middleCols<3>(half) * Rt;
  }
}

// Gradients Lx + Gx^T y_g + Hx^T y_h, Lu + Gu^T y_g + Hu^T y_h of a subproblem, with the multipliers y_g, y_h of its
// constraints. rows: indices of [y_g; y_h] in the multipliers y of the whole node.
struct PartGradient {
  VectorXd x, u;
  PartGradient(const ActionDataAbstract& d, const VectorXd& y, const std::vector<int>& rows, bool terminal)
      : x(d.Lx), u(terminal ? VectorXd() : VectorXd(d.Lu)) {
    if (y.size() == 0 || rows.empty()) return;
    const VectorXd own = y(rows), of_g = own.head(d.g.size()), of_h = own.tail(d.h.size());
    x += d.Gx.transpose() * of_g + d.Hx.transpose() * of_h;
    if (!terminal) u += d.Gu.transpose() * of_g + d.Hu.transpose() * of_h;
  }
};

// Computes Lx + A^T next and Lu + B^T next of all subproblems at constant wrenches w, and the gradient by_w w.r.t. w.
void gradient_of_parts(const ActionModelParts& model, const ActionDataParts& d, const VectorXd& next, const VectorXd& y,
                       VectorXd& gx, VectorXd& gu, VectorXd& by_w) {
  const auto rows = internal::constraint_rows(model.get_parts(), false);
  gx.resize(model.get_state()->get_ndx());
  gu.resize(model.get_nu());
  by_w.setZero(6 * static_cast<Index>(model.get_couplings()->couplings().size()));
  for (std::size_t i = 0; i < d.parts.size(); ++i) {
    const ActionPart& part = model.get_parts()[i];
    const ActionDataAbstract& from = *d.parts[i];
    const PartGradient own(from, y, rows[i], false);
    const VectorXd of_next = next(part.dx);
    const VectorXd all = own.u + from.Fu.transpose() * of_next;
    gx(part.dx) = own.x + from.Fx.transpose() * of_next;
    gu(part.u) = all.head(part.u.size());
    for (std::size_t b = 0; b < model.get_couplings()->couplings_of_parts()[i].size(); ++b)
      by_w.segment<6>(6 * model.get_couplings()->couplings_of_parts()[i][b]) +=
          all.segment<6>(static_cast<Index>(part.u.size() + 6 * b));
  }
}

void terminal_gradient(const ActionModelParts& model, const ActionDataParts& d, const VectorXd& y, VectorXd& gx) {
  const auto rows = internal::constraint_rows(model.get_parts(), true);
  gx.resize(model.get_state()->get_ndx());
  for (std::size_t i = 0; i < d.parts.size(); ++i)
    gx(model.get_parts()[i].dx) = PartGradient(*d.parts[i], y, rows[i], true).x;
}

}  // namespace

// Sets the coefficients C of dx and D of du in the equations of coupling b, for the subproblem of A if of_a, otherwise
// for that of B.
void Couplings::share_of_end(const std::vector<ActionPart>& parts, ActionDataParts& d, std::size_t b, bool of_a) const {
  CouplingData& own = *d.couplings;
  const Contact& contact = scene_.contacts[couplings_[b].contact];
  const CouplingData::OfCoupling& coupling = own.couplings[b];
  const auto part = static_cast<std::size_t>(of_a ? couplings_[b].part_a : couplings_[b].part_b);
  const int r = (of_a ? contact.A : contact.B).robot;
  const std::vector<int>& of_part = couplings_of_[part];
  const Index at = std::find(of_part.begin(), of_part.end(), static_cast<int>(b)) - of_part.begin();
  const auto& state = static_cast<const StateMultibody&>(*parts[part].model->get_state());
  const Index nv = static_cast<Index>(state.get_nv()), m = contact.rows();
  const Index first = state.get_model()->scene().robots[local_robot_[r]].idx_v;
  const std::vector<int>& chain = of_a ? coupling.support.a : coupling.support.b;
  const Index column = of_a ? 0 : static_cast<Index>(coupling.support.a.size());
  const ContactDerivatives& dr = coupling.derivatives;
  const auto& W = coupling.rows.W;

  const DifferentialActionDataAbstract& a = *internal::euler_of(*d.parts[part]).differential;
  auto C = own.C[part].middleRows<6>(6 * at), D = own.D[part].middleRows<6>(6 * at);
  C.setZero();
  D.setZero();
  auto C_held = C.topRows(m), D_held = D.topRows(m);  // rows of constrained directions, which contain derivatives of r2
  for (std::size_t k = 0; k < chain.size(); ++k) {
    const Index from = column + static_cast<Index>(k), to = first + chain[k];
    C_held.noalias() += coupling.rows.J.col(from) * a.Fx.row(to);
    D_held.noalias() += coupling.rows.J.col(from) * a.Fu.row(to);
    C_held.col(to).noalias() += W * dr.dx_dq.col(from);
    C_held.col(nv + to).noalias() += W * dr.dx_dv.col(from);
  }
  if (of_a) add_force_rows(coupling, scene_.damping, first, static_cast<Index>(parts[part].u.size()) + 6 * at, C, D);
}

void Couplings::differentiate(const std::vector<ActionPart>& parts, ActionDataParts& d) const {
  CouplingData& own = *d.couplings;
  for (std::size_t r = 0; r < own.robots.size(); ++r)
    if (own.robots[r])  // only Psid, Psidd, Sv are used
      rnea_derivatives<double>(*scene_.robots[r].model, own.robots[r]->kin, own.robots[r]->kin.Y, {},
                               own.robots[r]->terms);
  for (std::size_t b = 0; b < couplings_.size(); ++b) {
    const int c = couplings_[b].contact;
    const Contact& contact = scene_.contacts[c];
    const CouplingData::OfRobot& A = *own.robots[contact.A.robot];
    const CouplingData::OfRobot& B = *own.robots[contact.B.robot];
    CouplingData::OfCoupling& coupling = own.couplings[b];
    contact_derivatives<double>(contact, coupling.support, A.kin, &B.kin, A.terms, &B.terms,
                                own.solution.f.segment(own.solution.f_offset[c], contact.rows()), coupling.rows,
                                coupling.derivatives);
    share_of_end(parts, d, b, true);
    share_of_end(parts, d, b, false);
  }
}

// Computes the whole node's matrices. With w = W [dx; du] and (x_i, u_i, w_i) = T [dx; du] of subproblem i,
//     [Fx Fu] = sum [A B] T,    L.. = sum T^T [Lxx Lxu; Lxu^T Luu] T,    [Gx Gu] = [G_i T], [Hx Hu] = [H_i T]
void Couplings::condense(const std::vector<ActionPart>& parts, ActionDataParts& d) const {
  const Index ndx = d.Fu.rows(), nu = d.Fu.cols();
  const CouplingSystem system = system_of(*this, parts, *d.couplings, ndx, nu);
  const MatrixXd W = -system.by_w.partialPivLu().solve(system.rows);
  MatrixXd F = MatrixXd::Zero(ndx, ndx + nu), H = MatrixXd::Zero(ndx + nu, ndx + nu);
  MatrixXd C = MatrixXd::Zero(d.g.size(), ndx + nu), E = MatrixXd::Zero(d.h.size(), ndx + nu);
  VectorXd g = VectorXd::Zero(ndx + nu);
  Index of_g = 0, of_h = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ActionPart& part = parts[i];
    const ActionDataAbstract& from = *d.parts[i];
    const Index nx = static_cast<Index>(part.dx.size()), nv = from.Fu.cols();
    MatrixXd T = MatrixXd::Zero(nx + nv, ndx + nu), AB(nx, nx + nv), L(nx + nv, nx + nv);
    for (Index j = 0; j < nx; ++j) T(j, part.dx[j]) = 1;
    for (std::size_t j = 0; j < part.u.size(); ++j) T(nx + static_cast<Index>(j), ndx + part.u[j]) = 1;
    for (std::size_t b = 0; b < couplings_of_[i].size(); ++b)
      T.middleRows<6>(nx + static_cast<Index>(part.u.size() + 6 * b)) = W.middleRows<6>(6 * couplings_of_[i][b]);
    VectorXd l(nx + nv);
    l << from.Lx, from.Lu;
    AB << from.Fx, from.Fu;
    L << from.Lxx, from.Lxu, from.Lxu.transpose(), from.Luu;
    F(part.dx, Eigen::all) = AB * T;
    H.noalias() += T.transpose() * L * T;
    g.noalias() += T.transpose() * l;
    const auto put_rows = [&](const MatrixXd& by_x, const MatrixXd& by_u, Index& first, MatrixXd& to) {
      MatrixXd own(by_x.rows(), nx + nv);
      own << by_x, by_u;
      to.middleRows(first, own.rows()) = own * T;
      first += own.rows();
    };
    put_rows(from.Gx, from.Gu, of_g, C);
    put_rows(from.Hx, from.Hu, of_h, E);
  }
  d.Fx = F.leftCols(ndx);
  d.Lx = g.head(ndx);
  d.Lxx = H.topLeftCorner(ndx, ndx);
  d.Gx = C.leftCols(ndx);
  d.Hx = E.leftCols(ndx);
  d.Fu = F.rightCols(nu);
  d.Gu = C.rightCols(nu);
  d.Hu = E.rightCols(nu);
  d.Lu = g.tail(nu);
  d.Lxu = H.topRightCorner(ndx, nu);
  d.Luu = H.bottomRightCorner(nu, nu);
}

// Computes gx = Lx + A^T next + C^T mu and gu = Lu + B^T next + D_u^T mu, where the multipliers mu of the couplings'
// equations satisfy by_w^T mu = -(Lw + B_w^T next).
void coupled_gradient(const ActionModelParts& model, const ActionDataParts& d, const VectorXd& next, bool terminal,
                      const VectorXd& y, VectorXd& gx, VectorXd& gu) {
  if (terminal) return terminal_gradient(model, d, y, gx);
  VectorXd by_w;
  gradient_of_parts(model, d, next, y, gx, gu, by_w);
  if (by_w.size() == 0) return;
  const CouplingSystem system =
      system_of(*model.get_couplings(), model.get_parts(), *d.couplings, gx.size(), gu.size());
  const VectorXd mu = -system.by_w.transpose().partialPivLu().solve(by_w);
  const VectorXd add = system.rows.transpose() * mu;
  gx += add.head(gx.size());
  gu += add.tail(gu.size());
}

// Computes the gradients with derivatives of the whole scene's dynamics. A coupling's wrench is w = R F about a fixed
// point, with F = W^T f in A's moving axes. With s = J_A dq_A and the rotation th of a world-aligned frame (A's axes):
//
//     R^T dw = W^T df + s x* F - th x F
//
// The gradient with respect to w thus gives gradients with respect to the contact force f and the placement of A.
void scene_gradient(const ActionModelParts& model, ActionDataParts& d, const VectorXd& next, bool terminal,
                    const VectorXd& y, VectorXd& gx, VectorXd& gu) {
  if (terminal) return terminal_gradient(model, d, y, gx);
  VectorXd by_w;
  gradient_of_parts(model, d, next, y, gx, gu, by_w);
  if (by_w.size() == 0) return;
  CouplingData& own = *d.couplings;
  const Scene& scene = model.get_couplings()->scene();
  VectorXd by_f = VectorXd::Zero(own.solution.f.size());
  for (std::size_t b = 0; b < model.get_couplings()->couplings().size(); ++b) {
    const int c = model.get_couplings()->couplings()[b].contact;
    const Contact& contact = scene.contacts[c];
    const CouplingData::OfCoupling& coupling = own.couplings[b];
    const ContactDerivatives& dr = coupling.derivatives;
    const Mat3<double>& R = coupling.rows.aMA.R;
    Vec6<double> g;
    g << R.transpose() * by_w.segment<3>(static_cast<Index>(6 * b)),
        R.transpose() * by_w.segment<3>(static_cast<Index>(6 * b) + 3);
    by_f.segment(own.solution.f_offset[c], contact.rows()) = coupling.rows.W * g;
    const int first = scene.robots[contact.A.robot].idx_v;
    for (std::size_t k = 0; k < coupling.support.a.size(); ++k) {
      const Index column = static_cast<Index>(k);
      Vec6<double> moved = cross_force(Vec6<double>(coupling.rows.Jl.col(column)), dr.F);
      if (dr.turns) moved -= turned<double>(dr.turn.col(column), dr.F);
      gx[first + coupling.support.a[k]] += g.dot(moved);
    }
  }
  VectorXd wq(scene.nv), wv(scene.nv), wu(scene.nu);
  vjp(scene, own.solution, VectorXd::Zero(scene.nv), by_f, wq, wv, wu);
  gx.head(scene.nv) += wq;
  gx.tail(scene.nv) += wv;
  gu += wu;
}

}  // namespace manycontact
