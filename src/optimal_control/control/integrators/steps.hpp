#pragma once
// Common parts of the integrators: results of the differential model's data that they pass on.

#include "manycontact/control/integrated_action.hpp"

namespace manycontact::internal {

/// Throws std::invalid_argument when the differential model leaves its dense matrices out.
inline void check_dense(const char* where, const DifferentialActionDataAbstract& from) {
  require(has_dense(from.storage), where, "the differential model's storage is not dense, kDense or kBoth is expected");
}

/// g, h and, if asked for, r.
inline void copy_values(const DifferentialActionDataAbstract& from, bool with_residual, ActionDataAbstract& to) {
  to.g = from.g;
  to.h = from.h;
  if (with_residual) to.r = from.r;
}

/// A terminal node: xnext = x. `d` is the data of the integrator, and `dx` its step.
template <class Data>
void calc_terminal(const ConstVectorRef& x, const DifferentialActionDataAbstract& from, bool with_residual, Data& d) {
  d.dx.setZero();
  d.xnext = x;
  d.cost = from.cost;
  copy_values(from, with_residual, d);
}

/// x' = x (+) [h v + h^2 a; h a], and h times the cost.
template <class Data>
void calc_semi_implicit(const StateAbstract& state, const ConstVectorRef& x, double h, const Eigen::VectorXd& a,
                        const DifferentialActionDataAbstract& from, bool with_residual, Data& d) {
  const Eigen::Index nv = state.get_nv();
  d.dx.head(nv) = h * x.tail(nv) + h * h * a;
  d.dx.tail(nv) = h * a;
  state.integrate(x, d.dx, d.xnext);
  d.cost = h * from.cost;
  copy_values(from, with_residual, d);
}

/// u of the differential model's quasi-static torques, at the interval's beginning.
inline void quasi_static(DifferentialActionModelAbstract& model,
                         const std::shared_ptr<DifferentialActionDataAbstract>& data,
                         ControlParametrizationModelAbstract& control,
                         const std::shared_ptr<ControlParametrizationDataAbstract>& w, VectorRef u,
                         const ConstVectorRef& x, std::size_t maxiter, double tol) {
  model.quasiStatic(data, w->w, x, maxiter, tol);
  control.params(w, 0, w->w);
  u = w->u;
}

inline void copy_constraint_derivatives(const ControlParametrizationModelAbstract& control,
                                        const std::shared_ptr<ControlParametrizationDataAbstract>& w,
                                        const DifferentialActionDataAbstract& from, ActionDataAbstract& to) {
  to.Gx = from.Gx;
  to.Hx = from.Hx;
  to.Gu.resize(from.Gu.rows(), to.Gu.cols());
  to.Hu.resize(from.Hu.rows(), to.Hu.cols());
  if (to.Gu.size()) control.multiplyByJacobian(w, from.Gu, to.Gu);
  if (to.Hu.size()) control.multiplyByJacobian(w, from.Hu, to.Hu);
}

/// h times the cost's derivatives, by x and u. Lwu: nw x nu, workspace.
inline void integrate_cost_derivatives(double h, const ControlParametrizationModelAbstract& control,
                                       const std::shared_ptr<ControlParametrizationDataAbstract>& w,
                                       const DifferentialActionDataAbstract& from, Eigen::MatrixXd& Lwu,
                                       ActionDataAbstract& to) {
  to.Lx = h * from.Lx;
  to.Lxx = h * from.Lxx;
  control.multiplyJacobianTransposeBy(w, from.Lu, to.Lu);
  control.multiplyByJacobian(w, from.Lxu, to.Lxu);
  control.multiplyByJacobian(w, from.Luu, Lwu);
  control.multiplyJacobianTransposeBy(w, Lwu, to.Luu);
  to.Lu *= h, to.Lxu *= h, to.Luu *= h;
}

/// The derivatives of a terminal node: xnext = x.
inline void copy_terminal_derivatives(const DifferentialActionDataAbstract& from, ActionDataAbstract& to) {
  check_dense("IntegratedActionModel::calcDiff", from);
  to.Fx.setIdentity();
  to.Lx = from.Lx;
  to.Lxx = from.Lxx;
  to.Gx = from.Gx;
  to.Hx = from.Hx;
}

}  // namespace manycontact::internal
