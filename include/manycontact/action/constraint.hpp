#pragma once
// Constraints on residuals, and stacks of constraints. Names and interface are Crocoddyl's.

#include "manycontact/action/diff_action.hpp"
#include "manycontact/action/residual.hpp"
#include "manycontact/detail/action/named_parts.hpp"

namespace manycontact {

class ConstraintModelResidual;

/// The values of one constraint at one x, u, evaluated standalone.
struct ConstraintDataResidual {
  ConstraintDataResidual(ConstraintModelResidual* model, DataCollector* shared);  // allocates the data of the model
  DataCollector* shared;
  std::shared_ptr<ResidualDataAbstract> residual;
  Eigen::VectorXd g, h;    // ng, nh: set by calc
  Eigen::MatrixXd Gx, Gu;  // ng x ndx, ng x nu: set by calcDiff
  Eigen::MatrixXd Hx, Hu;  // nh x ndx, nh x nu: set by calcDiff
};
using ConstraintDataAbstract = ConstraintDataResidual;

/// A constraint lower <= r(x, u) <= upper. Components with equal bounds are equality constraints h = r - lower. This
/// class is final: define a constraint of your own by its residual r.
class ConstraintModelResidual final : public Printable {
 public:
  using DataPtr = std::shared_ptr<ConstraintDataResidual>;

  /// T_act: whether the constraint applies to terminal nodes, too. Residuals of controls, accelerations or forces never
  /// apply to terminal nodes. Throws std::invalid_argument for bounds of a wrong size.
  ConstraintModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual,
                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, bool T_act = true);
  /// Makes the constraint r = 0.
  ConstraintModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual,
                          bool T_act = true)
      : ConstraintModelResidual(state, residual, Eigen::VectorXd::Zero(residual ? residual->get_nr() : 0),
                                Eigen::VectorXd::Zero(residual ? residual->get_nr() : 0), T_act) {}

  /// For standalone evaluation, without an action model: calc computes data->g and data->h, then calcDiff computes
  /// their Jacobians.
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) { evaluate(data, x, &u); }
  void calc(const DataPtr& data, const ConstVectorRef& x) { evaluate(data, x, nullptr); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) { differentiate(data, x, &u); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) { differentiate(data, x, nullptr); }
  std::shared_ptr<ConstraintDataResidual> createData(DataCollector* shared) {
    return std::make_shared<ConstraintDataResidual>(this, shared);
  }

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }  // the state given to the constructor
  const std::shared_ptr<ResidualModelAbstract>& get_residual() const { return residual_; }  // the residual
  std::size_t get_nu() const { return residual_->get_nu(); }                                // number of controls
  std::size_t get_ng() const { return inequalities_.size(); }  // number of inequality constraints
  std::size_t get_nh() const { return equalities_.size(); }    // number of equality constraints
  bool get_T_constraint() const { return T_; }                 // whether the constraint applies to terminal nodes
  const Eigen::VectorXd& get_lb() const { return lb_; }        // lower bounds (nr)
  const Eigen::VectorXd& get_ub() const { return ub_; }        // upper bounds
  /// Returns the indices of the components of r that are inequalities, ascending.
  const std::vector<int>& get_inequalities() const { return inequalities_; }
  const std::vector<int>& get_equalities() const { return equalities_; }  // indices of the equalities in r
  void print(std::ostream& os) const override;                            // prints type and sizes

 private:
  void evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  std::shared_ptr<StateAbstract> state_;
  std::shared_ptr<ResidualModelAbstract> residual_;
  Eigen::VectorXd lb_, ub_;
  std::vector<int> inequalities_, equalities_;
  bool T_;
};

using ConstraintModelAbstract = ConstraintModelResidual;

struct ConstraintItem {  // A constraint, its name, and whether it is active.
  std::string name;
  std::shared_ptr<ConstraintModelAbstract> constraint;
  bool active = true;
};

/// The values of a stack of constraints.
struct ConstraintDataManager {
  /// Views of `out`, or of the data given to shareMemory. The Jacobians are set only if `out` has dense Jacobians.
  Eigen::Map<Eigen::VectorXd> g{nullptr, 0}, h{nullptr, 0};
  Eigen::Map<Eigen::MatrixXd> Gx{nullptr, 0, 0}, Gu{nullptr, 0, 0}, Hx{nullptr, 0, 0}, Hu{nullptr, 0, 0};
  /// Makes g, ..., Hu views of an action's data, which must outlive this object.
  template <class ActionData>
  void shareMemory(ActionData* data) {
    new (&g) Eigen::Map<Eigen::VectorXd>(data->g.data(), data->g.size());
    new (&h) Eigen::Map<Eigen::VectorXd>(data->h.data(), data->h.size());
    new (&Gx) Eigen::Map<Eigen::MatrixXd>(data->Gx.data(), data->Gx.rows(), data->Gx.cols());
    new (&Gu) Eigen::Map<Eigen::MatrixXd>(data->Gu.data(), data->Gu.rows(), data->Gu.cols());
    new (&Hx) Eigen::Map<Eigen::MatrixXd>(data->Hx.data(), data->Hx.rows(), data->Hx.cols());
    new (&Hu) Eigen::Map<Eigen::MatrixXd>(data->Hu.data(), data->Hu.rows(), data->Hu.cols());
  }
  /// Resizes an action's data for its model's constraints in a running or a terminal node, and calls shareMemory.
  template <class ActionModel, class ActionData>
  void resize(ActionModel* model, ActionData* data, bool running_node = true) {
    const auto ng = static_cast<Eigen::Index>(running_node ? model->get_ng() : model->get_ng_T());
    const auto nh = static_cast<Eigen::Index>(running_node ? model->get_nh() : model->get_nh_T());
    const auto ndx = static_cast<Eigen::Index>(model->get_state()->get_ndx());
    const auto nu = static_cast<Eigen::Index>(model->get_nu());
    data->g.conservativeResize(ng), data->h.conservativeResize(nh);
    data->Gx.conservativeResize(ng, ndx), data->Gu.conservativeResize(ng, nu);
    data->Hx.conservativeResize(nh, ndx), data->Hu.conservativeResize(nh, nu);
    shareMemory(data);
  }
  /// Resizes this object for a running or a terminal node. calc and calcDiff also do this.
  template <class Manager>
  void resize(Manager* model, bool running_node = true) {
    model->lay_out(*this, !running_node);
  }

  std::map<std::string, std::shared_ptr<ResidualDataAbstract>> constraints;
  std::vector<std::shared_ptr<ResidualModelAbstract>> of;  // the residual models that created the data
  DataCollector* shared = nullptr;
  std::size_t version = 0, status = 0;  // version() and get_status() of the model when the blocks were set up
  bool terminal = false;
  DifferentialActionDataAbstract* out = nullptr;
  std::unique_ptr<DifferentialActionDataAbstract> own;  // the data that `out` points to in standalone evaluation
  /// The rows of one block of a residual's Jacobian that are rows of g, or of h.
  struct Part {
    std::size_t block = 0;             // number of the residual's block
    std::vector<int> from, to;         // row `from[i]` of the block is row `to[i]` of g (of h)
    std::size_t xplan = 0, uplan = 0;  // numbers of the block in the sparse matrices of x and of u
  };
  std::map<std::string, std::vector<Part>> g_parts, h_parts;
};

/// A stack of constraints with names.
class ConstraintModelManager : public NamedParts<StateAbstract, ConstraintItem> {
 public:
  using DataPtr = std::shared_ptr<ConstraintDataManager>;

  using ConstraintModelContainer = Container;

  /// nu: number of controls, by default nv. Throws std::invalid_argument for null pointers.
  explicit ConstraintModelManager(std::shared_ptr<StateAbstract> state, std::size_t nu = kDefaultNu);

  /// Throw std::invalid_argument for a new name that exists already, for an unknown name, and for constraints of
  /// another state or nu.
  void addConstraint(const std::string& name, std::shared_ptr<ConstraintModelAbstract> constraint, bool active = true);
  void removeConstraint(const std::string& name) { remove(name); }
  void changeConstraintStatus(const std::string& name, bool active) { change_status(name, active); }
  bool getConstraintStatus(const std::string& name) const { return part(name).active; }  // whether the part is active

  /// calc computes out->g and out->h, and calcDiff their Jacobians; without u, those of a terminal node. Both functions
  /// resize them after constraints were switched on or off.
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) { evaluate(data, x, &u); }
  void calc(const DataPtr& data, const ConstVectorRef& x) { evaluate(data, x, nullptr); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) { differentiate(data, x, &u); }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x) { differentiate(data, x, nullptr); }
  std::shared_ptr<ConstraintDataManager> createData(DataCollector* shared, DifferentialActionDataAbstract* out);
  std::shared_ptr<ConstraintDataManager> createData(DataCollector* shared);  // creates data for standalone evaluation
  /// Resizes the vectors and matrices in `out`, and updates the residuals' blocks if the contact islands changed.
  void lay_out(ConstraintDataManager& data, bool terminal) const;

  const ConstraintModelContainer& get_constraints() const { return parts_; }  // the constraints
  std::size_t get_ng() const { return ng_; }                                  // active inequality constraints
  std::size_t get_nh() const { return nh_; }                                  // active equality constraints
  std::size_t get_ng_T() const { return ng_T_; }                              // rows of g in a terminal node
  std::size_t get_nh_T() const { return nh_T_; }                              // rows of h in a terminal node
  const Eigen::VectorXd& get_lb() const { return lb_; }                       // lower bounds (ng)
  const Eigen::VectorXd& get_ub() const { return ub_; }                       // upper bounds
  const Eigen::VectorXd& get_lb_T() const { return lb_T_; }  // lower bounds of a terminal node's g (ng_T)
  const Eigen::VectorXd& get_ub_T() const { return ub_T_; }  // upper bounds of a terminal node's g
  std::size_t get_status() const { return status_; }         // number of changes of the set of active constraints

 private:
  void count() override;
  /// Throws std::invalid_argument if a constraint was replaced since the data were created.
  void check_residuals(const char* where, const ConstraintDataManager& data) const;
  void prepare(const char* where, const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) const;
  void evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u);
  void stack_values(ConstraintDataManager& data, bool terminal) const;
  void stack_jacobians(ConstraintDataManager& data, bool terminal) const;
  std::size_t ng_ = 0, nh_ = 0, ng_T_ = 0, nh_T_ = 0, status_ = 0;
  Eigen::VectorXd lb_, ub_, lb_T_, ub_T_;
};

}  // namespace manycontact
