#pragma once
// Activations a(r): the cost of a residual. Names and interface are Crocoddyl's; all Hessians are diagonal.

#include <memory>

#include "manycontact/detail/action/fwd.hpp"

namespace manycontact {

struct ActivationDataAbstract {  // The value a(r), its gradient and its Hessian.
  /// Allocates the data for nr rows.
  explicit ActivationDataAbstract(std::size_t nr)
      : Ar(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nr))), Arr(static_cast<Eigen::Index>(nr)) {
    Arr.setZero();
  }
  virtual ~ActivationDataAbstract() = default;
  double a_value = 0;                                 // set by calc
  Eigen::VectorXd Ar;                                 // nr: set by calcDiff
  Eigen::DiagonalMatrix<double, Eigen::Dynamic> Arr;  // nr: set by calcDiff
};

class ActivationModelAbstract : public Printable {  // A cost as a function a(r) of the residual.
 public:
  using DataPtr = std::shared_ptr<ActivationDataAbstract>;

  explicit ActivationModelAbstract(std::size_t nr) : nr_(nr) {}  // nr: number of rows
  /// Computes data->a_value from the residual r (nr).
  virtual void calc(const DataPtr& data, const ConstVectorRef& r) = 0;
  /// Computes data->Ar and data->Arr at the last calc.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& r) = 0;
  /// Creates data of this model; one per thread.
  virtual std::shared_ptr<ActivationDataAbstract> createData() { return std::make_shared<ActivationDataAbstract>(nr_); }
  std::size_t get_nr() const { return nr_; }  // number of rows of the residual
  void print(std::ostream& os) const override { os << "ActivationModel {nr=" << nr_ << "}"; }

 protected:
  std::size_t nr_;
};

/// The common base of the activations of this library, with a name, and checks of the size of r.
class NamedActivation : public ActivationModelAbstract {
 public:
  void calc(const DataPtr& data, const ConstVectorRef& r) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& r) override;
  void print(std::ostream& os) const override;  // prints name, size and parameters

 protected:
  NamedActivation(const char* name, std::size_t nr) : ActivationModelAbstract(nr), name_(name) {}  // nr: number of rows
  const char* name_;

 private:
  virtual double value(const ConstVectorRef& r) const = 0;                                      // a(r)
  virtual void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const = 0;  // sets Ar and Arr
  virtual void print_parameters(std::ostream&) const {}                                         // for example ", eps=1"
  void check(const char* function, const ConstVectorRef& r) const;
};

/// The activation 1/2 |r|^2.
class ActivationModelQuad : public NamedActivation {
 public:
  explicit ActivationModelQuad(std::size_t nr) : NamedActivation("ActivationModelQuad", nr) {}  // nr: number of rows

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
};

/// The activation 1/2 sum w_i r_i^2.
class ActivationModelWeightedQuad : public NamedActivation {
 public:
  /// weights: one per row.
  explicit ActivationModelWeightedQuad(const Eigen::VectorXd& weights)
      : NamedActivation("ActivationModelWeightedQuad", static_cast<std::size_t>(weights.size())), weights_(weights) {}
  const Eigen::VectorXd& get_weights() const { return weights_; }  // one weight per row
  void set_weights(const Eigen::VectorXd& weights);                // throws std::invalid_argument for a wrong size

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
  Eigen::VectorXd weights_;
};

/// Bounds lb <= r <= ub. Each finite pair is contracted towards its middle by the factor beta in [0, 1].
struct ActivationBounds {
  /// Throws std::invalid_argument for numbers out of range.
  ActivationBounds(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double beta = 1);
  Eigen::VectorXd lb, ub;
  double beta;
};

/// The activation 1/2 |min(r - lb, 0)|^2 + 1/2 |max(r - ub, 0)|^2.
class ActivationModelQuadraticBarrier : public NamedActivation {
 public:
  /// bounds: one pair per row.
  explicit ActivationModelQuadraticBarrier(const ActivationBounds& bounds)
      : ActivationModelQuadraticBarrier("ActivationModelQuadraticBarrier", bounds) {}
  const ActivationBounds& get_bounds() const { return bounds_; }  // the bounds
  void set_bounds(const ActivationBounds& bounds);                // throws std::invalid_argument for a wrong size

 protected:
  /// name: name of the derived class.
  ActivationModelQuadraticBarrier(const char* name, const ActivationBounds& bounds)
      : NamedActivation(name, static_cast<std::size_t>(bounds.lb.size())), bounds_(bounds) {}
  ActivationBounds bounds_;
  Eigen::VectorXd weights_;  // one weight per row; empty: all weights are 1

 private:
  double weight(Eigen::Index i) const { return weights_.size() == 0 ? 1 : weights_[i]; }
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
};

/// The activation 1/2 |w min(r - lb, 0)|^2 + 1/2 |w max(r - ub, 0)|^2. (The Hessian is w^2; Crocoddyl 3.0 has w.)
class ActivationModelWeightedQuadraticBarrier : public ActivationModelQuadraticBarrier {
 public:
  /// Throws std::invalid_argument unless there is one weight per row.
  ActivationModelWeightedQuadraticBarrier(const ActivationBounds& bounds, const Eigen::VectorXd& weights);
  const Eigen::VectorXd& get_weights() const { return weights_; }  // one weight per row
  void set_weights(const Eigen::VectorXd& weights);                // throws std::invalid_argument for a wrong size
};

/// The activation sum sqrt(eps + r_i^2), eps > 0. (Crocoddyl 3.0 lacks eps in its Hessian eps / sqrt(eps + r^2)^3.)
class ActivationModelSmooth1Norm : public NamedActivation {
 public:
  /// Throws std::invalid_argument unless eps is positive.
  explicit ActivationModelSmooth1Norm(std::size_t nr, double eps = 1);

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
  void print_parameters(std::ostream& os) const override { os << ", eps=" << eps_; }
  double eps_;
};
using ActivationModelSmoothNorm1 = ActivationModelSmooth1Norm;
using ActivationModelSmoothAbs = ActivationModelSmooth1Norm;

/// The activation sqrt(eps + |r|^2), eps > 0. Its Hessian is the identity times the smallest eigenvalue of the true
/// Hessian, eps / sqrt(eps + |r|^2)^3. (Crocoddyl 3.0 omits the factor eps.)
class ActivationModelSmooth2Norm : public NamedActivation {
 public:
  /// Throws std::invalid_argument unless eps is positive.
  explicit ActivationModelSmooth2Norm(std::size_t nr, double eps = 1);

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
  void print_parameters(std::ostream& os) const override { os << ", eps=" << eps_; }
  double eps_;
};

/// The common base of activations with a parameter alpha.
class ActivationWithAlpha : public NamedActivation {
 public:
  double get_alpha() const { return alpha_; }  // the parameter alpha
  void set_alpha(double alpha);                // throws std::invalid_argument for values out of range

 protected:
  /// may_be_zero: whether alpha may be zero. Throws std::invalid_argument for values out of range.
  ActivationWithAlpha(const char* name, std::size_t nr, double alpha, bool may_be_zero);
  void print_parameters(std::ostream& os) const override { os << ", alpha=" << alpha_; }
  double alpha_;

 private:
  bool may_be_zero_;
};

/// The activation 1/2 (|r| - alpha)^2 if |r| < alpha, otherwise zero; alpha >= 0. Its Hessian is the diagonal of the
/// true or of the Gauss-Newton Hessian, r_i^2 / |r|^2. At r = 0 gradient and Hessian are zero (Crocoddyl: NaN).
class ActivationModel2NormBarrier : public ActivationWithAlpha {
 public:
  /// Throws std::invalid_argument for a negative alpha.
  explicit ActivationModel2NormBarrier(std::size_t nr, double alpha = 0.1, bool true_hessian = false)
      : ActivationWithAlpha("ActivationModel2NormBarrier", nr, alpha, true), true_hessian_(true_hessian) {}

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
  void print_parameters(std::ostream& os) const override;
  bool true_hessian_;
};

/// The activation 1 - exp(-|r|^2 / alpha), alpha > 0. Its Hessian is the diagonal of the true Hessian.
class ActivationModelQuadFlatExp : public ActivationWithAlpha {
 public:
  /// Throws std::invalid_argument unless alpha is positive.
  explicit ActivationModelQuadFlatExp(std::size_t nr, double alpha = 1)
      : ActivationWithAlpha("ActivationModelQuadFlatExp", nr, alpha, false) {}

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
};

/// The activation log(1 + |r|^2 / alpha), alpha > 0. Its Hessian is the diagonal of the true Hessian.
class ActivationModelQuadFlatLog : public ActivationWithAlpha {
 public:
  /// Throws std::invalid_argument unless alpha is positive.
  explicit ActivationModelQuadFlatLog(std::size_t nr, double alpha = 1)
      : ActivationWithAlpha("ActivationModelQuadFlatLog", nr, alpha, false) {}

 private:
  double value(const ConstVectorRef& r) const override;
  void differentiate(const ConstVectorRef& r, ActivationDataAbstract& data) const override;
};

}  // namespace manycontact
