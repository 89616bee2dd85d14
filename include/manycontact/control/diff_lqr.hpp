#pragma once
// Linear dynamics qdd = Aq q + Av v + B w + f for states x = [q; v] in a vector space, with the cost and constraints of
// ActionModelLQR (lqr.hpp) in x and w. The interface is that of Crocoddyl's DifferentialActionModelLQR.

#include "manycontact/control/lqr.hpp"

namespace manycontact {

/// Linear dynamics in continuous time with a quadratic cost.
class DifferentialActionModelLQR
    : public NodeWithData<DifferentialActionModelLQR, DifferentialActionModelAbstract, DifferentialActionDataAbstract>,
      public LinearQuadraticTerms {
 public:
  static constexpr const char* kName = "DifferentialActionModelLQR";  // for messages

  /// Throw std::invalid_argument for wrong sizes, and if [Q N; N^T R] has an eigenvalue below -1e-12 of the largest.
  DifferentialActionModelLQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q,
                             const MatrixXs& R, const MatrixXs& N);
  DifferentialActionModelLQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q,
                             const MatrixXs& R, const MatrixXs& N, const VectorXs& f, const VectorXs& q,
                             const VectorXs& r);  // without constraints
  DifferentialActionModelLQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q,
                             const MatrixXs& R, const MatrixXs& N, const MatrixXs& G, const MatrixXs& H,
                             const VectorXs& f, const VectorXs& q, const VectorXs& r, const VectorXs& g,
                             const VectorXs& h);  // with constraints

  /// Uses identity matrices, with q and r of ones. f is zero if drift_free, otherwise ones.
  DifferentialActionModelLQR(std::size_t nq, std::size_t nu, bool drift_free = true);
  /// Makes a random model with entries within +-1 and a convex cost; the same sequence in every run.
  static DifferentialActionModelLQR Random(std::size_t nq, std::size_t nu, std::size_t ng = 0, std::size_t nh = 0);
  void print(std::ostream& os) const override { os << kName << " {nx=" << state_->get_nx() << ", nu=" << nu_ << "}"; }

  const MatrixXs& get_Aq() const { return Aq_; }  // matrix of q
  const MatrixXs& get_Av() const { return Av_; }  // matrix of v
  /// Replaces all matrices and vectors. Throws std::invalid_argument for wrong sizes.
  void set_LQR(const MatrixXs& Aq, const MatrixXs& Av, const MatrixXs& B, const MatrixXs& Q, const MatrixXs& R,
               const MatrixXs& N, const MatrixXs& G, const MatrixXs& H, const VectorXs& f, const VectorXs& q,
               const VectorXs& r, const VectorXs& g, const VectorXs& h);

 private:
  void evaluate(DifferentialActionDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(DifferentialActionDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  MatrixXs Aq_, Av_;
};

}  // namespace manycontact
