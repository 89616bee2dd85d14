#pragma once
// Controls w(t) within one integration step, t in [0, 1]: polynomials whose parameters are the control u of the node:
//
//     w = sum_k c_k(t) u_k,    u = [u_0; u_1; ...], each of nw numbers.
//
// The classes are Crocoddyl's ControlParametrizationModelPolyZero, PolyOne and PolyTwoRK.

#include <array>

#include "manycontact/action/num_diff.hpp"

namespace manycontact {

/// The number of stages of a Runge-Kutta method.
enum RKType { two = 2, three = 3, four = 4 };

class ControlParametrizationModelAbstract;

/// The controls w at one time t, and their derivative with respect to the parameters u.
struct ControlParametrizationDataAbstract {
  /// Allocates the data of the model.
  explicit ControlParametrizationDataAbstract(const ControlParametrizationModelAbstract* model);
  virtual ~ControlParametrizationDataAbstract() = default;

  Eigen::VectorXd w;      // nw: set by calc
  Eigen::VectorXd u;      // nu: set by params
  Eigen::MatrixXd dw_du;  // nw x nu: set by calcDiff
};

/// Controls within a step as a function of parameters.
class ControlParametrizationModelAbstract {
 public:
  using Data = std::shared_ptr<ControlParametrizationDataAbstract>;

  ControlParametrizationModelAbstract(std::size_t nw, std::size_t nu) : nw_(nw), nu_(nu) {}  // numbers of w and of u
  virtual ~ControlParametrizationModelAbstract() = default;

  /// Computes data->w at the time t in [0, 1] for the parameters u (nu).
  virtual void calc(const Data& data, double t, const ConstVectorRef& u) const = 0;
  /// Computes data->dw_du at the t of the last calc.
  virtual void calcDiff(const Data& data, double t, const ConstVectorRef& u) const = 0;
  virtual Data createData() { return std::make_shared<ControlParametrizationDataAbstract>(this); }
  virtual bool checkData(const Data& data) { return data != nullptr; }
  /// Computes data->u for the constant control w (nw).
  virtual void params(const Data& data, double t, const ConstVectorRef& w) const = 0;
  /// Computes bounds of u that keep w within its bounds. With PolyOne they do so for t <= 1/2 only, with PolyTwoRK only
  /// at the times of the polynomial's nodes.
  virtual void convertBounds(const ConstVectorRef& w_lb, const ConstVectorRef& w_ub, VectorRef u_lb,
                             VectorRef u_ub) const = 0;
  /// Compute A dw_du, or dw_du^T A, at the t of the last calc. op: the product is set, added or subtracted in `out`.
  virtual void multiplyByJacobian(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A, MatrixRef out,
                                  AssignmentOp op = setto) const = 0;
  virtual void multiplyJacobianTransposeBy(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A, MatrixRef out,
                                           AssignmentOp op = setto) const = 0;
  Eigen::MatrixXd multiplyByJacobian_J(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A) const;
  Eigen::MatrixXd multiplyJacobianTransposeBy_J(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A) const;

  std::size_t get_nw() const { return nw_; }  // number of controls w
  std::size_t get_nu() const { return nu_; }  // number of parameters u

 protected:
  std::size_t nw_, nu_;
};

/// Data of the polynomials.
struct ControlParametrizationDataPoly : ControlParametrizationDataAbstract {
  using ControlParametrizationDataAbstract::ControlParametrizationDataAbstract;
  std::array<double, 3> c{};  // coefficients at the t of the last calc
};

/// The common base of the polynomials, which differ in their coefficients.
class ControlParametrizationModelPoly : public ControlParametrizationModelAbstract {
 public:
  void calc(const Data& data, double t, const ConstVectorRef& u) const override;
  void calcDiff(const Data& data, double t, const ConstVectorRef& u) const override;
  Data createData() override;
  bool checkData(const Data& data) override { return dynamic_cast<ControlParametrizationDataPoly*>(data.get()); }
  void params(const Data& data, double t, const ConstVectorRef& w) const override;
  void convertBounds(const ConstVectorRef& w_lb, const ConstVectorRef& w_ub, VectorRef u_lb,
                     VectorRef u_ub) const override;
  void multiplyByJacobian(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A, MatrixRef out,
                          AssignmentOp op = setto) const override;
  void multiplyJacobianTransposeBy(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A, MatrixRef out,
                                   AssignmentOp op = setto) const override;

 protected:
  /// terms: number of coefficients.
  ControlParametrizationModelPoly(std::size_t nw, std::size_t terms)
      : ControlParametrizationModelAbstract(nw, terms * nw), terms_(terms) {}
  virtual std::array<double, 3> coefficients(double t) const = 0;  // the coefficients at the time t
  std::size_t terms_;
};

/// Constant controls: w = u.
class ControlParametrizationModelPolyZero : public ControlParametrizationModelPoly {
 public:
  /// nw: number of controls.
  explicit ControlParametrizationModelPolyZero(std::size_t nw) : ControlParametrizationModelPoly(nw, 1) {}

 private:
  std::array<double, 3> coefficients(double) const override { return {1, 0, 0}; }
};

/// Linear controls: w = u_0 at t = 0, w = u_1 at t = 1/2.
class ControlParametrizationModelPolyOne : public ControlParametrizationModelPoly {
 public:
  /// nw: number of controls.
  explicit ControlParametrizationModelPolyOne(std::size_t nw) : ControlParametrizationModelPoly(nw, 2) {}

 private:
  std::array<double, 3> coefficients(double t) const override { return {1 - 2 * t, 2 * t, 0}; }
};

/// Quadratic controls: w = u_k at times 0, 1/3, 2/3 (three) or 0, 1/2, 1 (four). `two` throws std::invalid_argument.
class ControlParametrizationModelPolyTwoRK : public ControlParametrizationModelPoly {
 public:
  ControlParametrizationModelPolyTwoRK(std::size_t nw, RKType rktype);  // nw: number of controls

 private:
  std::array<double, 3> coefficients(double t) const override;
  RKType rktype_;
};

/// Computes dw_du of another model by differences with steps relative to max(1, |u_i|), e.g. for user-defined controls.
class ControlParametrizationModelNumDiff : public ControlParametrizationModelAbstract,
                                           public NumDiffOf<ControlParametrizationModelAbstract> {
 public:
  /// model: the model to differentiate.
  explicit ControlParametrizationModelNumDiff(std::shared_ptr<ControlParametrizationModelAbstract> model)
      : ControlParametrizationModelAbstract(internal::given("ControlParametrizationModelNumDiff", model)->get_nw(),
                                            model->get_nu()),
        NumDiffOf("ControlParametrizationModelNumDiff", model) {}
  void calc(const Data& data, double t, const ConstVectorRef& u) const override;
  void calcDiff(const Data& data, double t, const ConstVectorRef& u) const override;
  Data createData() override;
  void params(const Data& data, double t, const ConstVectorRef& w) const override;
  void convertBounds(const ConstVectorRef& w_lb, const ConstVectorRef& w_ub, VectorRef u_lb,
                     VectorRef u_ub) const override {
    model_->convertBounds(w_lb, w_ub, u_lb, u_ub);
  }
  void multiplyByJacobian(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A, MatrixRef out,
                          AssignmentOp op = setto) const override;
  void multiplyJacobianTransposeBy(const Data& data, const Eigen::Ref<const Eigen::MatrixXd>& A, MatrixRef out,
                                   AssignmentOp op = setto) const override;
};

/// Data of ControlParametrizationModelNumDiff.
struct ControlParametrizationDataNumDiff : ControlParametrizationDataAbstract {
  /// Allocates the data of the model.
  explicit ControlParametrizationDataNumDiff(const ControlParametrizationModelNumDiff* model)
      : ControlParametrizationDataAbstract(model), data_0(model->get_model()->createData()) {}
  std::shared_ptr<ControlParametrizationDataAbstract> data_0;
};

}  // namespace manycontact
