#pragma once
// Cost and constraints that ActionModelLQR and DifferentialActionModelLQR share; d is the data of either, and u null in
// a terminal node.

#include <random>

#include "manycontact/control/lqr.hpp"

namespace manycontact::internal {

// 1/2 x^T Q x + q^T x, G [x; 0] + g, H [x; 0] + h, and the rest with u
template <class Data>
void linear_quadratic_values(const LinearQuadraticTerms& m, const ConstVectorRef& x, const ConstVectorRef* u, Data& d) {
  d.Lx = m.get_q();  // q + Q x / 2
  d.Lx.noalias() += 0.5 * (m.get_Q() * x);
  d.cost = d.Lx.dot(x);
  d.g = m.get_g();
  d.g.noalias() += m.get_G().leftCols(x.size()) * x;
  d.h = m.get_h();
  d.h.noalias() += m.get_H().leftCols(x.size()) * x;
  if (!u) return;
  d.Lu = m.get_r();  // r + N^T x + R u / 2
  d.Lu.noalias() += m.get_N().transpose() * x;
  d.Lu.noalias() += 0.5 * (m.get_R() * *u);
  d.cost += d.Lu.dot(*u);
  d.g.noalias() += m.get_G().rightCols(u->size()) * *u;
  d.h.noalias() += m.get_H().rightCols(u->size()) * *u;
}

template <class Data>
void linear_quadratic_derivatives(const LinearQuadraticTerms& m, const ConstVectorRef& x, const ConstVectorRef* u,
                                  Data& d) {
  d.Lx = m.get_q();
  d.Lx.noalias() += m.get_Q() * x;
  d.Lxx = m.get_Q();
  d.Gx = m.get_G().leftCols(x.size());
  d.Hx = m.get_H().leftCols(x.size());
  if (!u) return;
  d.Lx.noalias() += m.get_N() * *u;
  d.Lu = m.get_r();
  d.Lu.noalias() += m.get_N().transpose() * x;
  d.Lu.noalias() += m.get_R() * *u;
  d.Lxu = m.get_N();
  d.Luu = m.get_R();
  d.Gu = m.get_G().rightCols(u->size());
  d.Hu = m.get_H().rightCols(u->size());
}

template <class Matrix>
void check_shape(const char* who, const char* what, const Matrix& matrix, Eigen::Index rows, Eigen::Index cols) {
  require(matrix.rows() == rows && matrix.cols() == cols, who,
          std::string(what) + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ", " +
              std::to_string(rows) + " x " + std::to_string(cols) + " is expected");
}

inline std::shared_ptr<StateVector> vectors(Eigen::Index nx) { return std::make_shared<StateVector>(nx); }
inline Eigen::MatrixXd no_rows(Eigen::Index cols) { return Eigen::MatrixXd::Zero(0, cols); }
inline Eigen::VectorXd zeros(Eigen::Index n) { return Eigen::VectorXd::Zero(n); }

/// Entries within +-1.
inline Eigen::MatrixXd random_matrix(std::size_t rows, std::size_t cols) {
  thread_local std::mt19937 rng(1);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [] { return std::uniform_real_distribution<double>(-1, 1)(rng); });
}

}  // namespace manycontact::internal
