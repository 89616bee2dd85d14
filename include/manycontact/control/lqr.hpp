#pragma once
// Linear dynamics with a quadratic cost:
//
//     x' = A x + B u + f,  l = 1/2 x^T Q x + 1/2 u^T R u + x^T N u + q^T x + r^T u,  g = G [x; u] + g0,  h = H [x; u] +
//     h0
//
// Crocoddyl's ActionModelLQR.

#include "manycontact/control/action_model.hpp"
#include "manycontact/control/state_vector.hpp"

namespace manycontact {

class ActionModelLQR : public ActionModelAbstract {  // Linear dynamics in discrete time with a quadratic cost.
 public:
  using MatrixXs = Eigen::MatrixXd;
  using VectorXs = Eigen::VectorXd;

  /// They throw std::invalid_argument for wrong sizes, and if [Q N; N^T R] has an eigenvalue below -1e-12 of the
  /// largest.
  ActionModelLQR(const MatrixXs& A, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R, const MatrixXs& N);
  ActionModelLQR(const MatrixXs& A, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R, const MatrixXs& N,
                 const VectorXs& f, const VectorXs& q, const VectorXs& r);
  ActionModelLQR(const MatrixXs& A, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R, const MatrixXs& N,
                 const MatrixXs& G, const MatrixXs& H, const VectorXs& f, const VectorXs& q, const VectorXs& r,
                 const VectorXs& g, const VectorXs& h);
  /// Uses identity matrices, with q and r of ones. f is zero if drift_free, otherwise ones.
  ActionModelLQR(std::size_t nx, std::size_t nu, bool drift_free = true);
  /// Makes a random model with entries within +-1 and a convex cost; the same sequence in every run.
  static ActionModelLQR Random(std::size_t nx, std::size_t nu, std::size_t ng = 0, std::size_t nh = 0);

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const DataPtr& data, const ConstVectorRef& x) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override;
  void print(std::ostream& os) const override;

  const MatrixXs& get_A() const { return A_; }  // matrix of the state
  const MatrixXs& get_B() const { return B_; }  // matrix of the controls
  const VectorXs& get_f() const { return f_; }  // constant term of the dynamics
  const MatrixXs& get_Q() const { return Q_; }  // Hessian of the cost with respect to x
  const MatrixXs& get_R() const { return R_; }  // Hessian of the cost with respect to u
  const MatrixXs& get_N() const { return N_; }  // mixed Hessian of the cost
  const MatrixXs& get_G() const { return G_; }  // matrix of the inequality constraints
  const MatrixXs& get_H() const { return H_; }  // matrix of the equality constraints
  const VectorXs& get_q() const { return q_; }  // gradient of the cost with respect to x
  const VectorXs& get_r() const { return r_; }  // gradient of the cost with respect to u
  const VectorXs& get_g() const { return g_; }  // constant term of the inequality constraints
  const VectorXs& get_h() const { return h_; }  // constant term of the equality constraints
  /// Replaces all matrices and vectors. Throws std::invalid_argument for wrong sizes.
  void set_LQR(const MatrixXs& A, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R, const MatrixXs& N,
               const MatrixXs& G, const MatrixXs& H, const VectorXs& f, const VectorXs& q, const VectorXs& r,
               const VectorXs& g, const VectorXs& h);

 private:
  MatrixXs A_, B_, Q_, R_, N_, G_, H_;
  VectorXs f_, q_, r_, g_, h_;
};

}  // namespace manycontact
