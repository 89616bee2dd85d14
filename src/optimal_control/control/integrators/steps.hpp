#pragma once

#include "manycontact/control/integrated_action.hpp"

namespace manycontact::internal {

/// Throws std::invalid_argument unless the differential model stores dense matrices.
inline void check_dense(const char* where, const DifferentialActionDataAbstract& from) {
  require(has_dense(from.storage), where, "the differential model's storage is not dense, kDense or kBoth is expected");
}

inline void copy_values(const DifferentialActionDataAbstract& from, bool with_residual, ActionDataAbstract& to) {
  to.g = from.g;
  to.h = from.h;
  if (with_residual) to.r = from.r;
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

/// Computes h times the cost's derivatives with respect to x and u. Lwu is workspace (nw x nu).
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

}  // namespace manycontact::internal
