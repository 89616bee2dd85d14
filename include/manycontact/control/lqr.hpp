#pragma once
// Nodes with linear dynamics, a quadratic cost, and linear constraints g, h:
//
//     x' = A x + B u + f,    l = 1/2 x^T Q x + 1/2 u^T R u + x^T N u + q^T x + r^T u,
//     g = G [x; u] + g0,     h = H [x; u] + h0
//
// The interface is that of Crocoddyl's ActionModelLQR.

#include "manycontact/control/action_model.hpp"
#include "manycontact/detail/control/state_vector.hpp"

namespace manycontact {

/// The matrices and vectors that linear-quadratic nodes have in discrete and in continuous time.
class LinearQuadraticTerms {
 public:
  const Eigen::MatrixXd& get_B() const { return B_; }  // matrix of the controls
  const Eigen::VectorXd& get_f() const { return f_; }  // constant term of the dynamics
  const Eigen::MatrixXd& get_Q() const { return Q_; }  // Hessian of the cost with respect to x
  const Eigen::MatrixXd& get_R() const { return R_; }  // Hessian of the cost with respect to u
  const Eigen::MatrixXd& get_N() const { return N_; }  // mixed Hessian of the cost
  const Eigen::MatrixXd& get_G() const { return G_; }  // matrix of the inequality constraints
  const Eigen::MatrixXd& get_H() const { return H_; }  // matrix of the equality constraints
  const Eigen::VectorXd& get_q() const { return q_; }  // gradient of the cost with respect to x
  const Eigen::VectorXd& get_r() const { return r_; }  // gradient of the cost with respect to u
  const Eigen::VectorXd& get_g() const { return g_; }  // constant term of the inequality constraints
  const Eigen::VectorXd& get_h() const { return h_; }  // constant term of the equality constraints

 protected:
  /// Sets the terms; rows: rows of the dynamics. Throws std::invalid_argument for wrong sizes or a nonconvex cost.
  void set_terms(const NodeAbstract& node, const char* name, Eigen::Index rows, const Eigen::MatrixXd& B,
                 const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R, const Eigen::MatrixXd& N, const Eigen::MatrixXd& G,
                 const Eigen::MatrixXd& H, const Eigen::VectorXd& f, const Eigen::VectorXd& q, const Eigen::VectorXd& r,
                 const Eigen::VectorXd& g, const Eigen::VectorXd& h);
  Eigen::MatrixXd B_, Q_, R_, N_, G_, H_;
  Eigen::VectorXd f_, q_, r_, g_, h_;
};

/// Linear dynamics in discrete time with a quadratic cost.
class ActionModelLQR : public NodeWithData<ActionModelLQR, ActionModelAbstract, ActionDataAbstract>,
                       public LinearQuadraticTerms {
 public:
  static constexpr const char* kName = "ActionModelLQR";

  /// Throw std::invalid_argument for wrong sizes, and if [Q N; N^T R] has an eigenvalue below -1e-12 of the largest.
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
  void print(std::ostream& os) const override {
    os << kName << " {nx=" << state_->get_nx() << ", nu=" << nu_ << ", ng=" << ng_ << ", nh=" << nh_ << "}";
  }

  const MatrixXs& get_A() const { return A_; }  // matrix of the state
  /// Replaces all matrices and vectors. Throws std::invalid_argument for wrong sizes.
  void set_LQR(const MatrixXs& A, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R, const MatrixXs& N,
               const MatrixXs& G, const MatrixXs& H, const VectorXs& f, const VectorXs& q, const VectorXs& r,
               const VectorXs& g, const VectorXs& h);

 private:
  void evaluate(ActionDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(ActionDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  MatrixXs A_;
};

}  // namespace manycontact
