#pragma once
// Bounded controls without constraints: tau(x, u) = actuation(x, squashing(s)), with s unbounded. Names and interface
// are those of Crocoddyl's SquashingModelSmoothSat and ActuationSquashingModel.

#include "manycontact/action/actuation.hpp"

namespace manycontact {

class SquashingModelAbstract;

/// The controls u(s), and their derivative with respect to s.
struct SquashingDataAbstract {
  explicit SquashingDataAbstract(const SquashingModelAbstract* model);  // allocates the data of the model
  virtual ~SquashingDataAbstract() = default;
  Eigen::VectorXd u;      // ns: set by calc
  Eigen::MatrixXd du_ds;  // ns x ns: set by calcDiff
};

class SquashingModelAbstract {  // A function u(s).
 public:
  using DataPtr = std::shared_ptr<SquashingDataAbstract>;

  /// Throws std::invalid_argument for ns = 0.
  explicit SquashingModelAbstract(std::size_t ns);
  virtual ~SquashingModelAbstract() = default;
  virtual void calc(const DataPtr& data, const ConstVectorRef& s) = 0;      // computes data->u from s (ns)
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& s) = 0;  // computes data->du_ds
  /// Creates data of this model; one per thread.
  virtual std::shared_ptr<SquashingDataAbstract> createData() { return std::make_shared<SquashingDataAbstract>(this); }

  std::size_t get_ns() const { return ns_; }                    // number of squashed controls
  const Eigen::VectorXd& get_s_lb() const { return s_lb_; }     // lower bounds of s
  const Eigen::VectorXd& get_s_ub() const { return s_ub_; }     // upper bounds of s
  void set_s_lb(const Eigen::VectorXd& s_lb) { s_lb_ = s_lb; }  // sets lower bounds of s, for a user's barrier cost
  void set_s_ub(const Eigen::VectorXd& s_ub) { s_ub_ = s_ub; }  // sets upper bounds of s, for a user's barrier cost

 protected:
  std::size_t ns_;
  Eigen::VectorXd u_lb_, u_ub_, s_lb_, s_ub_;  // bounds of u; bounds of s, for a barrier
};

/// The function u = 1/2 (lb + ub + sqrt((s - lb)^2 + d^2) - sqrt((s - ub)^2 + d^2)), d = smooth (ub - lb). It is close
/// to s between the bounds, and saturates smoothly outside.
class SquashingModelSmoothSat : public SquashingModelAbstract {
 public:
  /// Throws std::invalid_argument unless the bounds are finite, u_lb < u_ub, and both have ns numbers.
  SquashingModelSmoothSat(const ConstVectorRef& u_lb, const ConstVectorRef& u_ub, std::size_t ns);
  void calc(const DataPtr& data, const ConstVectorRef& s) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& s) override;
  double get_smooth() const { return smooth_; }        // initially 0.1
  void set_smooth(double smooth);                      // not negative
  const Eigen::VectorXd& get_d() const { return d_; }  // d, one number per control

 private:
  double smooth_ = 0.1;
  Eigen::VectorXd d_;
};

/// An actuation with squashed controls: nu = ns.
class ActuationSquashingModel : public ActuationModelAbstract {
 public:
  /// nu: number of squashed controls.
  ActuationSquashingModel(std::shared_ptr<ActuationModelAbstract> actuation,
                          std::shared_ptr<SquashingModelAbstract> squashing, std::size_t nu);
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc, ActuationModelAbstract::calcDiff;
  /// Computes u = Mtau tau, with Mtau at the controls that actuation->commands returns.
  void commands(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& tau) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  void print(std::ostream& os) const override;
  const std::shared_ptr<SquashingModelAbstract>& get_squashing() const { return squashing_; }  // the function u(s)
  const std::shared_ptr<ActuationModelAbstract>& get_actuation() const { return actuation_; }  // the actuation

 private:
  std::shared_ptr<SquashingModelAbstract> squashing_;
  std::shared_ptr<ActuationModelAbstract> actuation_;
};

/// Data of ActuationSquashingModel.
struct ActuationSquashingData : ActuationDataAbstract {
  explicit ActuationSquashingData(const ActuationSquashingModel* model);  // allocates the data of the model
  std::shared_ptr<SquashingDataAbstract> squashing;
  std::shared_ptr<ActuationDataAbstract> actuation;
};

}  // namespace manycontact
