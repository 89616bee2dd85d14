#pragma once
// a(r): what a residual costs. Names and interface of Crocoddyl; all Hessians are diagonal.

#include <memory>

#include "manycontact/action/fwd.hpp"

namespace manycontact {

struct ActivationDataAbstract {  // a(r), its gradient and Hessian
  explicit ActivationDataAbstract(std::size_t nr)
      : Ar(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nr))), Arr(static_cast<Eigen::Index>(nr)) {
    Arr.setZero();
  }
  virtual ~ActivationDataAbstract() = default;
  double a_value = 0;                                 // by calc
  Eigen::VectorXd Ar;                                 // nr: by calcDiff
  Eigen::DiagonalMatrix<double, Eigen::Dynamic> Arr;  // nr: by calcDiff
};

class ActivationModelAbstract {  // a(r): a cost's function of its residual
 public:
  explicit ActivationModelAbstract(std::size_t nr) : nr_(nr) {}
  virtual ~ActivationModelAbstract() = default;
  virtual void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) = 0;
  virtual void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) = 0;
  virtual std::shared_ptr<ActivationDataAbstract> createData() { return std::make_shared<ActivationDataAbstract>(nr_); }
  std::size_t get_nr() const { return nr_; }
  virtual void print(std::ostream& os) const;

 protected:
  std::size_t nr_;
};
std::ostream& operator<<(std::ostream& os, const ActivationModelAbstract& model);

/// 1/2 |r|^2
class ActivationModelQuad : public ActivationModelAbstract {
 public:
  explicit ActivationModelQuad(std::size_t nr) : ActivationModelAbstract(nr) {}
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void print(std::ostream& os) const override;
};

/// 1/2 sum w_i r_i^2
class ActivationModelWeightedQuad : public ActivationModelAbstract {
 public:
  explicit ActivationModelWeightedQuad(const Eigen::VectorXd& weights);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  const Eigen::VectorXd& get_weights() const { return weights_; }
  void set_weights(const Eigen::VectorXd& weights);
  void print(std::ostream& os) const override;

 private:
  Eigen::VectorXd weights_;
};

/// lb <= r <= ub, each finite pair drawn in to the middle by the factor beta in [0, 1].
struct ActivationBounds {
  ActivationBounds(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double beta = 1);
  Eigen::VectorXd lb, ub;
  double beta;
};

/// 1/2 |min(r - lb, 0)|^2 + 1/2 |max(r - ub, 0)|^2
class ActivationModelQuadraticBarrier : public ActivationModelAbstract {
 public:
  explicit ActivationModelQuadraticBarrier(const ActivationBounds& bounds)
      : ActivationModelAbstract(static_cast<std::size_t>(bounds.lb.size())), bounds_(bounds) {}
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  const ActivationBounds& get_bounds() const { return bounds_; }
  void set_bounds(const ActivationBounds& bounds);
  void print(std::ostream& os) const override;

 protected:
  ActivationBounds bounds_;
};

/// The same of w_i r_i outside its bounds: 1/2 |w min(r - lb, 0)|^2 + 1/2 |w max(r - ub, 0)|^2. (Its Hessian is w^2; in
/// Crocoddyl 3.0 it is w.)
class ActivationModelWeightedQuadraticBarrier : public ActivationModelQuadraticBarrier {
 public:
  ActivationModelWeightedQuadraticBarrier(const ActivationBounds& bounds, const Eigen::VectorXd& weights);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  const Eigen::VectorXd& get_weights() const { return weights_; }
  void set_weights(const Eigen::VectorXd& weights);
  void print(std::ostream& os) const override;

 private:
  Eigen::VectorXd weights_;
};

/// sum sqrt(eps + r_i^2), eps > 0. (Its Hessian is eps / sqrt(eps + r^2)^3; in Crocoddyl 3.0 eps is missing there.)
class ActivationModelSmooth1Norm : public ActivationModelAbstract {
 public:
  explicit ActivationModelSmooth1Norm(std::size_t nr, double eps = 1);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void print(std::ostream& os) const override;

 private:
  double eps_;
};
using ActivationModelSmoothNorm1 = ActivationModelSmooth1Norm;
using ActivationModelSmoothAbs = ActivationModelSmooth1Norm;

/// sqrt(eps + |r|^2), eps > 0. Its Hessian's diagonal is the Hessian's smallest eigenvalue, eps / sqrt(eps + |r|^2)^3.
/// (In Crocoddyl 3.0 eps is missing there.)
class ActivationModelSmooth2Norm : public ActivationModelAbstract {
 public:
  explicit ActivationModelSmooth2Norm(std::size_t nr, double eps = 1);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void print(std::ostream& os) const override;

 private:
  double eps_;
};

/// 1/2 (|r| - alpha)^2 where |r| < alpha, else zero; alpha >= 0. Hessian: the diagonal of the true one, or that of
/// Gauss-Newton, r_i^2 / |r|^2. Where r = 0 it has a kink, and both derivatives are taken as zero (Crocoddyl: NaN).
class ActivationModel2NormBarrier : public ActivationModelAbstract {
 public:
  explicit ActivationModel2NormBarrier(std::size_t nr, double alpha = 0.1, bool true_hessian = false);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  double get_alpha() const { return alpha_; }
  void set_alpha(double alpha);
  void print(std::ostream& os) const override;

 private:
  double alpha_;
  bool true_hessian_;
};

/// 1 - exp(-|r|^2 / alpha), alpha > 0. Hessian: the diagonal of the true one.
class ActivationModelQuadFlatExp : public ActivationModelAbstract {
 public:
  explicit ActivationModelQuadFlatExp(std::size_t nr, double alpha = 1);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  double get_alpha() const { return alpha_; }
  void set_alpha(double alpha);
  void print(std::ostream& os) const override;

 private:
  double alpha_;
};

/// log(1 + |r|^2 / alpha), alpha > 0. Hessian: the diagonal of the true one.
class ActivationModelQuadFlatLog : public ActivationModelAbstract {
 public:
  explicit ActivationModelQuadFlatLog(std::size_t nr, double alpha = 1);
  void calc(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  void calcDiff(const std::shared_ptr<ActivationDataAbstract>& data, const ConstVectorRef& r) override;
  double get_alpha() const { return alpha_; }
  void set_alpha(double alpha);
  void print(std::ostream& os) const override;

 private:
  double alpha_;
};

}  // namespace manycontact
