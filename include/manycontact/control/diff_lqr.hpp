#pragma once
// Linear dynamics qdd = Aq q + Av v + B w + f on x = [q; v] of a vector space, with the cost and constraints of
// ActionModelLQR (lqr.hpp) in x and w. Crocoddyl's DifferentialActionModelLQR.

#include "manycontact/action/diff_action.hpp"

namespace manycontact {

/// Linear dynamics in continuous time with a quadratic cost.
class DifferentialActionModelLQR : public DifferentialActionModelAbstract {
 public:
  using MatrixXs = Eigen::MatrixXd;
  using VectorXs = Eigen::VectorXd;

  /// They throw std::invalid_argument for wrong sizes, and if [Q N; N^T R] has an eigenvalue below -1e-12.
  DifferentialActionModelLQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q,
                             const MatrixXs& R, const MatrixXs& N);
  DifferentialActionModelLQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q,
                             const MatrixXs& R, const MatrixXs& N, const VectorXs& f, const VectorXs& q,
                             const VectorXs& r);
  DifferentialActionModelLQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q,
                             const MatrixXs& R, const MatrixXs& N, const MatrixXs& G, const MatrixXs& H,
                             const VectorXs& f, const VectorXs& q, const VectorXs& r, const VectorXs& g,
                             const VectorXs& h);
  /// Uses identity matrices, with q and r of ones. f is zero if drift_free, otherwise ones.
  DifferentialActionModelLQR(std::size_t nq, std::size_t nu, bool drift_free = true);
  /// Makes a random model with entries within +-1 and a convex cost; the same sequence in every run.
  static DifferentialActionModelLQR Random(std::size_t nq, std::size_t nu, std::size_t ng = 0, std::size_t nh = 0);

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const DataPtr& data, const ConstVectorRef& x) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override;
  void print(std::ostream& os) const override;

  const MatrixXs& get_Aq() const { return Aq_; }  // matrix of q
  const MatrixXs& get_Av() const { return Av_; }  // matrix of v
  const MatrixXs& get_B() const { return B_; }    // matrix of the controls
  const VectorXs& get_f() const { return f_; }    // constant term of the dynamics
  const MatrixXs& get_Q() const { return Q_; }    // Hessian of the cost with respect to x
  const MatrixXs& get_R() const { return R_; }    // Hessian of the cost with respect to u
  const MatrixXs& get_N() const { return N_; }    // mixed Hessian of the cost
  const MatrixXs& get_G() const { return G_; }    // matrix of the inequality constraints
  const MatrixXs& get_H() const { return H_; }    // matrix of the equality constraints
  const VectorXs& get_q() const { return q_; }    // gradient of the cost with respect to x
  const VectorXs& get_r() const { return r_; }    // gradient of the cost with respect to u
  const VectorXs& get_g() const { return g_; }    // constant term of the inequality constraints
  const VectorXs& get_h() const { return h_; }    // constant term of the equality constraints
  /// Replaces all matrices and vectors. Throws std::invalid_argument for wrong sizes.
  void set_LQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R,
               const MatrixXs& N, const MatrixXs& G, const MatrixXs& H, const VectorXs& f, const VectorXs& q,
               const VectorXs& r, const VectorXs& g, const VectorXs& h);

 private:
  MatrixXs Aq_, Av_, B_, Q_, R_, N_, G_, H_;
  VectorXs f_, q_, r_, g_, h_;
};

}  // namespace manycontact
