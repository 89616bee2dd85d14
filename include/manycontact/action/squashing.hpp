#pragma once
// Controls within bounds without constraints: tau(x, u) = actuation(x, squashing(s)), s any number. Names and interface
// of Crocoddyl's SquashingModelSmoothSat and ActuationSquashingModel.

#include "manycontact/action/actuation.hpp"

namespace manycontact {

class SquashingModelAbstract;

/// u and its derivative.
struct SquashingDataAbstract {
  explicit SquashingDataAbstract(const SquashingModelAbstract* model);
  virtual ~SquashingDataAbstract() = default;
  Eigen::VectorXd u;      // ns: by calc
  Eigen::MatrixXd du_ds;  // ns x ns: by calcDiff
};

class SquashingModelAbstract {  // u(s)
 public:
  /// Throws std::invalid_argument for ns = 0.
  explicit SquashingModelAbstract(std::size_t ns);
  virtual ~SquashingModelAbstract() = default;
  virtual void calc(const std::shared_ptr<SquashingDataAbstract>& data, const ConstVectorRef& s) = 0;
  virtual void calcDiff(const std::shared_ptr<SquashingDataAbstract>& data, const ConstVectorRef& s) = 0;
  virtual std::shared_ptr<SquashingDataAbstract> createData() { return std::make_shared<SquashingDataAbstract>(this); }

  std::size_t get_ns() const { return ns_; }
  const Eigen::VectorXd& get_s_lb() const { return s_lb_; }
  const Eigen::VectorXd& get_s_ub() const { return s_ub_; }
  void set_s_lb(const Eigen::VectorXd& s_lb) { s_lb_ = s_lb; }
  void set_s_ub(const Eigen::VectorXd& s_ub) { s_ub_ = s_ub; }

 protected:
  std::size_t ns_;
  Eigen::VectorXd u_lb_, u_ub_, s_lb_, s_ub_;  // of u; of s, for a barrier on it
};

/// u = 1/2 (lb + ub + sqrt((s - lb)^2 + d^2) - sqrt((s - ub)^2 + d^2)), d = smooth (ub - lb): s between the bounds,
/// smoothly held within them beyond.
class SquashingModelSmoothSat : public SquashingModelAbstract {
 public:
  /// Finite bounds, lb < ub, of ns numbers; else std::invalid_argument.
  SquashingModelSmoothSat(const ConstVectorRef& u_lb, const ConstVectorRef& u_ub, std::size_t ns);
  void calc(const std::shared_ptr<SquashingDataAbstract>& data, const ConstVectorRef& s) override;
  void calcDiff(const std::shared_ptr<SquashingDataAbstract>& data, const ConstVectorRef& s) override;
  double get_smooth() const { return smooth_; }  // at first 0.1
  void set_smooth(double smooth);                // not negative
  const Eigen::VectorXd& get_d() const { return d_; }

 private:
  double smooth_ = 0.1;
  Eigen::VectorXd d_;
};

/// An actuation whose controls are squashed first: nu = ns.
class ActuationSquashingModel : public ActuationModelAbstract {
 public:
  ActuationSquashingModel(std::shared_ptr<ActuationModelAbstract> actuation,
                          std::shared_ptr<SquashingModelAbstract> squashing, std::size_t nu);
  void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc;
  void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  using ActuationModelAbstract::calcDiff;
  /// u = Mtau tau, Mtau at the controls that the actuation alone would take.
  void commands(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& tau) override;
  std::shared_ptr<ActuationDataAbstract> createData() override;
  void print(std::ostream& os) const override;
  const std::shared_ptr<SquashingModelAbstract>& get_squashing() const { return squashing_; }
  const std::shared_ptr<ActuationModelAbstract>& get_actuation() const { return actuation_; }

 private:
  std::shared_ptr<SquashingModelAbstract> squashing_;
  std::shared_ptr<ActuationModelAbstract> actuation_;
};

/// Of both its parts.
struct ActuationSquashingData : ActuationDataAbstract {
  explicit ActuationSquashingData(const ActuationSquashingModel* model);
  std::shared_ptr<SquashingDataAbstract> squashing;
  std::shared_ptr<ActuationDataAbstract> actuation;
};

}  // namespace manycontact
