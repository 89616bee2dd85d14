#pragma once
// Costs a(r(x, u)) and their weighted sum, with Gauss-Newton Hessians. Names and interface are Crocoddyl's.

#include "manycontact/action/activation.hpp"
#include "manycontact/action/residual.hpp"
#include "manycontact/detail/action/cost_derivatives.hpp"
#include "manycontact/detail/action/cost_groups.hpp"
#include "manycontact/detail/action/named_parts.hpp"

namespace manycontact {

class CostModelAbstract;

struct CostDataAbstract {                                             // The values of one cost at one x, u.
  CostDataAbstract(CostModelAbstract* model, DataCollector* shared);  // allocates the data of the model
  virtual ~CostDataAbstract() = default;
  DataCollector* shared;
  double cost = 0;
  std::shared_ptr<const ResidualModelAbstract> of_residual;  // the models that created the data
  std::shared_ptr<const ActivationModelAbstract> of_activation;
  std::shared_ptr<ActivationDataAbstract> activation;
  std::shared_ptr<ResidualDataAbstract> residual;
  /// Whether the cost is user-defined. If so, a sum of costs adds Lx, Lu, Lxx, Lxu, Luu; otherwise it reads the
  /// residual's blocks.
  const bool own;
  /// Derivatives of this cost without its weight, set by calcDiff: ndx, nu, ndx x ndx, ndx x nu, nu x nu. In an action
  /// model's data they are empty unless the cost's class is user-defined; call whole_derivatives instead.
  Eigen::VectorXd Lx, Lu;
  Eigen::MatrixXd Lxx, Lxu, Luu;
  /// Computes the derivatives after calcDiff, for inspection; allocates at each call.
  CostDerivatives whole_derivatives() const;
};
using CostDataResidual = CostDataAbstract;

/// A cost l(x, u), the base of all costs. Users may derive costs from this class, or from CostModelResidual. calc then
/// sets data->cost, and calcDiff sets data->Lx, Lu, Lxx, Lxu and Luu, which are initially zero. These Hessians are
/// dense. A user-defined residual (residual.hpp) whose rows depend on few coordinates takes less time.
class CostModelAbstract : public Printable {
 public:
  using DataPtr = std::shared_ptr<CostDataAbstract>;

  /// Throws std::invalid_argument for null pointers, and parts that do not belong together.
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation,
                    std::shared_ptr<ResidualModelAbstract> residual);
  /// Uses the activation 1/2 |r|^2.
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual)
      : CostModelAbstract(state, std::make_shared<ActivationModelQuad>(residual ? residual->get_nr() : 0), residual) {}
  /// Makes a cost without residual; calc may write data->residual->r (the activation's nr rows). nu: by default nv.
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation,
                    std::size_t nu = kDefaultNu);
  explicit CostModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu = kDefaultNu)
      : CostModelAbstract(state, std::make_shared<ActivationModelQuad>(0), nu) {}

  virtual void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) = 0;  // computes data->cost
  /// Computes the cost of a terminal node: by default the cost at u = 0.
  virtual void calc(const DataPtr& data, const ConstVectorRef& x) { calc(data, x, unone_); }
  /// Computes the derivatives after calc. The default throws std::logic_error.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u);

  /// Computes Lx and Lxx for a terminal node.
  virtual void calcDiff(const DataPtr& data, const ConstVectorRef& x) { calcDiff(data, x, unone_); }
  virtual std::shared_ptr<CostDataAbstract> createData(DataCollector* shared) {
    return std::make_shared<CostDataAbstract>(this, shared);
  }

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }  // the state given to the constructor
  const std::shared_ptr<ActivationModelAbstract>& get_activation() const { return activation_; }  // the activation
  const std::shared_ptr<ResidualModelAbstract>& get_residual() const { return residual_; }        // the residual
  std::size_t get_nu() const { return residual_->get_nu(); }                                      // number of controls
  void print(std::ostream& os) const override;  // prints type and sizes

 protected:
  std::shared_ptr<StateAbstract> state_;
  std::shared_ptr<ActivationModelAbstract> activation_;
  std::shared_ptr<ResidualModelAbstract> residual_;
  Eigen::VectorXd unone_;  // nu zeros
};

class CostModelResidual : public CostModelAbstract {  // The cost a(r(x, u)) of a residual.
 public:
  /// Throws std::invalid_argument for null pointers, and parts that do not belong together.
  CostModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation,
                    std::shared_ptr<ResidualModelAbstract> residual)
      : CostModelAbstract(std::move(state), std::move(activation), std::move(residual)) {}
  /// Uses the activation 1/2 |r|^2.
  CostModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual)
      : CostModelAbstract(std::move(state), std::move(residual)) {}

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override { evaluate(data, x, &u); }
  void calc(const DataPtr& data, const ConstVectorRef& x) override { evaluate(data, x, nullptr); }
  /// Computes the Jacobians of the residual and the derivatives of the activation.
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    differentiate(data, x, &u);
  }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) override { differentiate(data, x, nullptr); }
  void print(std::ostream& os) const override;

 private:
  void check(const char* where, const DataPtr& data) const;
  void evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
};

struct CostItem {  // A cost, its name, its weight, and whether it is active.
  std::string name;
  std::shared_ptr<CostModelAbstract> cost;
  double weight = 1;
  bool active = true;
};

struct CostDataSum {                    // The sum's value and derivatives.
  double cost = 0;                      // set by calc
  CostDerivatives* derivatives = &own;  // where calcDiff writes: the action's data, or `own` in standalone evaluation
  /// Views of `*derivatives`, or of the data given to shareMemory; set by calcDiff.
  Eigen::Map<Eigen::VectorXd> Lx{nullptr, 0}, Lu{nullptr, 0};
  Eigen::Map<Eigen::MatrixXd> Lxx{nullptr, 0, 0}, Lxu{nullptr, 0, 0}, Luu{nullptr, 0, 0};
  std::map<std::string, std::shared_ptr<CostDataAbstract>> costs;
  DataCollector* shared = nullptr;
  std::size_t version = 0;      // changes with the model's set of costs
  CostGroups groups;            // set by lay_out
  std::vector<double> weights;  // workspace of calcDiff
  CostDerivatives own;

  /// Makes Lx, ..., Luu views of an action's data, which must outlive this object.
  template <class ActionData>
  void shareMemory(ActionData* data) {
    new (&Lx) Eigen::Map<Eigen::VectorXd>(data->Lx.data(), data->Lx.size());
    new (&Lu) Eigen::Map<Eigen::VectorXd>(data->Lu.data(), data->Lu.size());
    new (&Lxx) Eigen::Map<Eigen::MatrixXd>(data->Lxx.data(), data->Lxx.rows(), data->Lxx.cols());
    new (&Lxu) Eigen::Map<Eigen::MatrixXd>(data->Lxu.data(), data->Lxu.rows(), data->Lxu.cols());
    new (&Luu) Eigen::Map<Eigen::MatrixXd>(data->Luu.data(), data->Luu.rows(), data->Luu.cols());
  }

  CostDataSum() = default;
  CostDataSum(const CostDataSum&) = delete;  // derivatives may point to own
};

/// A weighted sum of costs with names.
class CostModelSum : public NamedParts<StateAbstract, CostItem> {
 public:
  using DataPtr = std::shared_ptr<CostDataSum>;

  using CostModelContainer = Container;

  /// nu: number of controls, by default nv. Throws std::invalid_argument for null pointers.
  explicit CostModelSum(std::shared_ptr<StateAbstract> state, std::size_t nu = kDefaultNu);

  /// Throw std::invalid_argument for a new name that exists already, for an unknown name, and for costs of another
  /// state or nu.
  void addCost(const std::string& name, std::shared_ptr<CostModelAbstract> cost, double weight, bool active = true);
  void removeCost(const std::string& name);
  void changeCostStatus(const std::string& name, bool active);
  bool getCostStatus(const std::string& name) const { return part(name).active; }  // whether it is active

  /// calc computes data->cost, the weighted sum of the active costs, and calcDiff its derivatives data->derivatives.
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) { evaluate(data, x, &u); }
  void calc(const DataPtr& data, const ConstVectorRef& x) { evaluate(data, x, nullptr); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) { differentiate(data, x, &u); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) { differentiate(data, x, nullptr); }
  /// out: receives the derivatives, and must have the model's sizes; null: the sum is evaluated standalone.
  std::shared_ptr<CostDataSum> createData(DataCollector* shared, CostDerivatives* out = nullptr);
  /// Updates the residuals' blocks and the patterns of data->derivatives after the contact islands changed.
  void lay_out(CostDataSum& data) const;

  const CostModelContainer& get_costs() const { return parts_; }  // the costs
  std::size_t get_nr() const { return nr_; }                      // residual rows of the active costs
  std::size_t get_nr_total() const { return nr_total_; }          // residual rows of all costs

 private:
  void check(const char* where, const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) const;
  void evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void add_up(CostDataSum& data, bool terminal) const;
  void add_up_by_hand(CostDataSum& data, bool terminal) const;
  std::size_t nr_ = 0, nr_total_ = 0;
};

}  // namespace manycontact
