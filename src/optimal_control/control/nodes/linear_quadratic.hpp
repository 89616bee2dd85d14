#pragma once
// Cost and constraints that ActionModelLQR and DifferentialActionModelLQR share; m is either model, and d is its data.

#include <Eigen/Eigenvalues>
#include <random>

#include "manycontact/action/fwd.hpp"
#include "manycontact/control/state_vector.hpp"

namespace manycontact::internal {

// 1/2 x^T Q x + q^T x, G [x; 0] + g, H [x; 0] + h
template <class Model, class Data>
void linear_quadratic_values(const Model& m, const ConstVectorRef& x, Data& d) {
  d.Lx = m.get_q();  // q + Q x / 2
  d.Lx.noalias() += 0.5 * (m.get_Q() * x);
  d.cost = d.Lx.dot(x);
  d.g = m.get_g();
  d.g.noalias() += m.get_G().leftCols(x.size()) * x;
  d.h = m.get_h();
  d.h.noalias() += m.get_H().leftCols(x.size()) * x;
}

// the rest, with u
template <class Model, class Data>
void add_linear_quadratic_values(const Model& m, const ConstVectorRef& x, const ConstVectorRef& u, Data& d) {
  d.Lu = m.get_r();  // r + N^T x + R u / 2
  d.Lu.noalias() += m.get_N().transpose() * x;
  d.Lu.noalias() += 0.5 * (m.get_R() * u);
  d.cost += d.Lu.dot(u);
  d.g.noalias() += m.get_G().rightCols(u.size()) * u;
  d.h.noalias() += m.get_H().rightCols(u.size()) * u;
}

template <class Model, class Data>
void linear_quadratic_derivatives(const Model& m, const ConstVectorRef& x, Data& d) {
  d.Lx = m.get_q();
  d.Lx.noalias() += m.get_Q() * x;
  d.Lxx = m.get_Q();
  d.Gx = m.get_G().leftCols(x.size());
  d.Hx = m.get_H().leftCols(x.size());
}

template <class Model, class Data>
void add_linear_quadratic_derivatives(const Model& m, const ConstVectorRef& x, const ConstVectorRef& u, Data& d) {
  d.Lx.noalias() += m.get_N() * u;
  d.Lu = m.get_r();
  d.Lu.noalias() += m.get_N().transpose() * x;
  d.Lu.noalias() += m.get_R() * u;
  d.Lxu = m.get_N();
  d.Luu = m.get_R();
  d.Gu = m.get_G().rightCols(u.size());
  d.Hu = m.get_H().rightCols(u.size());
}

template <class Matrix>
void check_shape(const char* who, const char* what, const Matrix& matrix, Eigen::Index rows, Eigen::Index cols) {
  require(matrix.rows() == rows && matrix.cols() == cols, who,
          std::string(what) + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ", " +
              std::to_string(rows) + " x " + std::to_string(cols) + " is expected");
}

/// [Q N; N^T R] has no eigenvalue below -1e-12 of its largest: what rounding makes of a zero.
inline void check_convex(const char* who, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
                         const Eigen::MatrixXd& N) {
  Eigen::MatrixXd L(Q.rows() + R.rows(), Q.cols() + R.cols());
  L << Q, N, N.transpose(), R;
  const Eigen::VectorXd values =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(L, Eigen::EigenvaluesOnly).eigenvalues();
  require(values.size() == 0 || values.minCoeff() >= -1e-12 * values.cwiseAbs().maxCoeff(), who,
          "[Q N; N^T R] has a negative eigenvalue, a convex cost is expected");
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
