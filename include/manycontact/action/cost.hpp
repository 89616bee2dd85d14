#pragma once
// Costs a(r(x, u)) and their weighted sum, with Gauss-Newton Hessians. Names and interface of Crocoddyl.

#include "manycontact/action/activation.hpp"
#include "manycontact/action/cost_derivatives.hpp"
#include "manycontact/action/cost_groups.hpp"
#include "manycontact/action/residual.hpp"

namespace manycontact {

class CostModelAbstract;

struct CostDataAbstract {  // one cost at one x, u
  CostDataAbstract(CostModelAbstract* model, DataCollector* shared);
  virtual ~CostDataAbstract() = default;
  DataCollector* shared;
  double cost = 0;
  std::shared_ptr<const ResidualModelAbstract> of_residual;  // the models that made the data
  std::shared_ptr<const ActivationModelAbstract> of_activation;
  std::shared_ptr<ActivationDataAbstract> activation;
  std::shared_ptr<ResidualDataAbstract> residual;
  /// True of a class that a user derived: its calcDiff writes Lx, Lu, Lxx, Lxu and Luu, which the sum takes. Otherwise
  /// the sum reads the blocks of the residual.
  const bool own;
  /// Derivatives of this cost alone, without its weight, by calcDiff: ndx, nu, ndx x ndx, ndx x nu, nu x nu. They have
  /// no size in the data of an action model unless the cost is a user's own; there by whole_derivatives.
  Eigen::VectorXd Lx, Lu;
  Eigen::MatrixXd Lxx, Lxu, Luu;
  /// The same, after calcDiff: for looking at, made anew at each call.
  CostDerivatives whole_derivatives() const;
};
using CostDataResidual = CostDataAbstract;

/// l(x, u), the base of all costs. A class derived from it, or from CostModelResidual, is called by the sum as
/// Crocoddyl's are: calc sets data->cost, calcDiff sets data->Lx, Lu, Lxx, Lxu and Luu, which are zero at first. Its
/// Hessians are dense: a residual of one's own (residual.hpp), whose rows depend on few coordinates, costs less.
class CostModelAbstract {
 public:
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation,
                    std::shared_ptr<ResidualModelAbstract> residual);
  /// With the activation 1/2 |r|^2.
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual);
  /// Without a residual: calc may write data->residual->r, of the activation's nr numbers (none without an activation).
  /// nu: default nv.
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation,
                    std::size_t nu);
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation);
  CostModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nu);
  explicit CostModelAbstract(std::shared_ptr<StateAbstract> state);
  virtual ~CostModelAbstract() = default;

  /// data->cost.
  virtual void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x,
                    const ConstVectorRef& u) = 0;
  /// Of a terminal node: at u = 0 unless a class has it.
  virtual void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x);
  /// After calc. Throws std::logic_error unless a class has it.
  virtual void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x,
                        const ConstVectorRef& u);
  /// Of a terminal node, where Lx and Lxx are taken.
  virtual void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x);
  virtual std::shared_ptr<CostDataAbstract> createData(DataCollector* shared);

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  const std::shared_ptr<ActivationModelAbstract>& get_activation() const { return activation_; }
  const std::shared_ptr<ResidualModelAbstract>& get_residual() const { return residual_; }
  std::size_t get_nu() const { return residual_->get_nu(); }
  virtual void print(std::ostream& os) const;

 protected:
  std::shared_ptr<StateAbstract> state_;
  std::shared_ptr<ActivationModelAbstract> activation_;
  std::shared_ptr<ResidualModelAbstract> residual_;
  Eigen::VectorXd unone_;  // nu zeros
};
std::ostream& operator<<(std::ostream& os, const CostModelAbstract& model);

class CostModelResidual : public CostModelAbstract {  // a(r(x, u))
 public:
  CostModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ActivationModelAbstract> activation,
                    std::shared_ptr<ResidualModelAbstract> residual)
      : CostModelAbstract(std::move(state), std::move(activation), std::move(residual)) {}
  CostModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual)
      : CostModelAbstract(std::move(state), std::move(residual)) {}

  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x) override;
  /// Jacobians of the residual, derivatives of the activation.
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x) override;
  void print(std::ostream& os) const override;

 private:
  void check(const char* where, const std::shared_ptr<CostDataAbstract>& data) const;
  void finish_derivatives(CostDataAbstract& data, bool terminal) const;
};

struct CostItem {  // a cost by its name, with its weight, and whether it is active
  std::string name;
  std::shared_ptr<CostModelAbstract> cost;
  double weight = 1;
  bool active = true;
};

struct CostDataSum {                    // the sum's value and derivatives
  double cost = 0;                      // by calc
  CostDerivatives* derivatives = &own;  // by calcDiff, where the sum is an action model's
  /// By calcDiff: views on those derivatives; by hand on the data's own, or on those that shareMemory was given.
  Eigen::Map<Eigen::VectorXd> Lx{nullptr, 0}, Lu{nullptr, 0};
  Eigen::Map<Eigen::MatrixXd> Lxx{nullptr, 0, 0}, Lxu{nullptr, 0, 0}, Luu{nullptr, 0, 0};
  std::map<std::string, std::shared_ptr<CostDataAbstract>> costs;
  DataCollector* shared = nullptr;
  std::size_t version = 0;      // of the model's set of costs
  CostGroups groups;            // by lay_out
  std::vector<double> weights;  // scratch of calcDiff
  CostDerivatives own;

  /// From now on Lx, ..., Luu are those of an action's data, which must live as long.
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

class CostModelSum {  // a weighted sum of costs by their names
 public:
  using CostModelContainer = std::map<std::string, std::shared_ptr<CostItem>>;

  CostModelSum(std::shared_ptr<StateAbstract> state, std::size_t nu);
  explicit CostModelSum(std::shared_ptr<StateAbstract> state);  // nu = nv

  /// Throw std::invalid_argument for a name that is taken (unknown), a cost of another state or nu.
  void addCost(const std::string& name, std::shared_ptr<CostModelAbstract> cost, double weight, bool active = true);
  void removeCost(const std::string& name);
  void changeCostStatus(const std::string& name, bool active);
  bool getCostStatus(const std::string& name) const;

  /// data->cost and, with weights, data->derivatives of the active costs.
  void calc(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x);
  void calcDiff(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calcDiff(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x);
  /// The derivatives go into `out` when it is given, of the right sizes; else the sum is evaluated by hand.
  std::shared_ptr<CostDataSum> createData(DataCollector* shared, CostDerivatives* out = nullptr);
  /// Lays out the residuals' blocks again (the islands changed) and the patterns of data->derivatives.
  void lay_out(CostDataSum& data) const;

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  const CostModelContainer& get_costs() const { return costs_; }
  std::size_t get_nu() const { return nu_; }
  std::size_t get_nr() const { return nr_; }              // of the active costs
  std::size_t get_nr_total() const { return nr_total_; }  // of all
  const std::set<std::string>& get_active_set() const { return active_set_; }
  const std::set<std::string>& get_inactive_set() const { return inactive_set_; }
  std::size_t get_version() const { return version_; }
  void print(std::ostream& os) const;

 private:
  void count(const CostItem& item);
  void check(const char* where, const CostDataSum& data, const ConstVectorRef& x) const;
  void add_up(CostDataSum& data, bool terminal) const;
  void add_up_by_hand(CostDataSum& data, bool terminal) const;
  std::shared_ptr<StateAbstract> state_;
  CostModelContainer costs_;
  std::size_t nu_, nr_ = 0, nr_total_ = 0, version_ = 0;
  std::set<std::string> active_set_, inactive_set_;
};
std::ostream& operator<<(std::ostream& os, const CostModelSum& model);

}  // namespace manycontact
