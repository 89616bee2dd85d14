#pragma once
// Constraints on residuals, and their stack. Names and interface of Crocoddyl.

#include "manycontact/action/diff_action.hpp"
#include "manycontact/action/residual.hpp"

namespace manycontact {

class ConstraintModelResidual;

/// One constraint at one x, u, by hand.
struct ConstraintDataResidual {
  ConstraintDataResidual(ConstraintModelResidual* model, DataCollector* shared);
  DataCollector* shared;
  std::shared_ptr<ResidualDataAbstract> residual;
  Eigen::VectorXd g, h;    // ng, nh: by calc
  Eigen::MatrixXd Gx, Gu;  // ng x ndx, ng x nu: by calcDiff
  Eigen::MatrixXd Hx, Hu;  // nh x ndx, nh x nu: by calcDiff
};
using ConstraintDataAbstract = ConstraintDataResidual;

/// lower <= r(x, u) <= upper; components whose bounds are equal are equality constraints h = r - lower. A constraint of
/// one's own is this one of a residual of one's own: the stack evaluates residuals, and a derived class does not compile.
class ConstraintModelResidual final {
 public:
  /// In terminal nodes too, unless `T_act` is false or the residual needs controls, accelerations or forces.
  ConstraintModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual,
                          const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, bool T_act = true);
  /// r = 0.
  ConstraintModelResidual(std::shared_ptr<StateAbstract> state, std::shared_ptr<ResidualModelAbstract> residual,
                          bool T_act = true);

  /// By hand: data->g, data->h; then their Jacobians.
  void calc(const std::shared_ptr<ConstraintDataResidual>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<ConstraintDataResidual>& data, const ConstVectorRef& x);
  void calcDiff(const std::shared_ptr<ConstraintDataResidual>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calcDiff(const std::shared_ptr<ConstraintDataResidual>& data, const ConstVectorRef& x);
  std::shared_ptr<ConstraintDataResidual> createData(DataCollector* shared);

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  const std::shared_ptr<ResidualModelAbstract>& get_residual() const { return residual_; }
  std::size_t get_nu() const { return residual_->get_nu(); }
  std::size_t get_ng() const { return inequalities_.size(); }
  std::size_t get_nh() const { return equalities_.size(); }
  bool get_T_constraint() const { return T_; }
  const Eigen::VectorXd& get_lb() const { return lb_; }  // nr
  const Eigen::VectorXd& get_ub() const { return ub_; }
  /// Components of r that are inequalities, equalities; ascending.
  const std::vector<int>& get_inequalities() const { return inequalities_; }
  const std::vector<int>& get_equalities() const { return equalities_; }
  void print(std::ostream& os) const;

 private:
  void pick_values(ConstraintDataResidual& data) const;
  void pick_jacobians(ConstraintDataResidual& data) const;
  std::shared_ptr<StateAbstract> state_;
  std::shared_ptr<ResidualModelAbstract> residual_;
  Eigen::VectorXd lb_, ub_;
  std::vector<int> inequalities_, equalities_;
  bool T_;
};
std::ostream& operator<<(std::ostream& os, const ConstraintModelResidual& model);

using ConstraintModelAbstract = ConstraintModelResidual;

struct ConstraintItem {  // a constraint by its name, and whether it is active
  std::string name;
  std::shared_ptr<ConstraintModelAbstract> constraint;
  bool active = true;
};

/// g, h and their Jacobians are written into the action's data; by hand they are data of their own.
struct ConstraintDataManager {
  /// Views on out's, or on those that shareMemory was given: by hand. Jacobians where out has dense ones.
  Eigen::Map<Eigen::VectorXd> g{nullptr, 0}, h{nullptr, 0};
  Eigen::Map<Eigen::MatrixXd> Gx{nullptr, 0, 0}, Gu{nullptr, 0, 0}, Hx{nullptr, 0, 0}, Hu{nullptr, 0, 0};
  /// From now on g, ..., Hu are those of an action's data, which must live as long.
  template <class ActionData>
  void shareMemory(ActionData* data) {
    new (&g) Eigen::Map<Eigen::VectorXd>(data->g.data(), data->g.size());
    new (&h) Eigen::Map<Eigen::VectorXd>(data->h.data(), data->h.size());
    new (&Gx) Eigen::Map<Eigen::MatrixXd>(data->Gx.data(), data->Gx.rows(), data->Gx.cols());
    new (&Gu) Eigen::Map<Eigen::MatrixXd>(data->Gu.data(), data->Gu.rows(), data->Gu.cols());
    new (&Hx) Eigen::Map<Eigen::MatrixXd>(data->Hx.data(), data->Hx.rows(), data->Hx.cols());
    new (&Hu) Eigen::Map<Eigen::MatrixXd>(data->Hu.data(), data->Hu.rows(), data->Hu.cols());
  }
  /// An action's data with room for its model's constraints, of a running or a terminal node, and shared.
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
  /// The data's own, of a running or a terminal node. Evaluation does this itself.
  template <class Manager>
  void resize(Manager* model, bool running_node = true) {
    model->lay_out(*this, !running_node);
  }

  std::map<std::string, std::shared_ptr<ResidualDataAbstract>> constraints;
  std::vector<std::shared_ptr<ResidualModelAbstract>> of;  // the residuals they were created by
  DataCollector* shared = nullptr;
  std::size_t version = 0, status = 0;  // of the model when last laid out
  bool terminal = false;
  DifferentialActionDataAbstract* out = nullptr;
  std::unique_ptr<DifferentialActionDataAbstract> own;  // by hand: out
  // Parts of the residuals' blocks that are rows of g, and of h.
  struct Part {
    std::size_t block = 0;             // of the residual
    std::vector<int> from, to;         // rows of the block, rows of g (of h)
    std::size_t xplan = 0, uplan = 0;  // in the sparse matrices
  };
  std::map<std::string, std::vector<Part>> g_parts, h_parts;
};

class ConstraintModelManager {  // a stack of constraints by their names
 public:
  using ConstraintModelContainer = std::map<std::string, std::shared_ptr<ConstraintItem>>;

  ConstraintModelManager(std::shared_ptr<StateAbstract> state, std::size_t nu);
  explicit ConstraintModelManager(std::shared_ptr<StateAbstract> state);  // nu = nv

  /// Throw std::invalid_argument for a name that is taken (unknown), a constraint of another state or nu.
  void addConstraint(const std::string& name, std::shared_ptr<ConstraintModelAbstract> constraint, bool active = true);
  void removeConstraint(const std::string& name);
  void changeConstraintStatus(const std::string& name, bool active);
  bool getConstraintStatus(const std::string& name) const;

  /// out->g, out->h (of a terminal node without u); then their Jacobians. They are resized when the active set, or the
  /// kind of node, has changed.
  void calc(const std::shared_ptr<ConstraintDataManager>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calc(const std::shared_ptr<ConstraintDataManager>& data, const ConstVectorRef& x);
  void calcDiff(const std::shared_ptr<ConstraintDataManager>& data, const ConstVectorRef& x, const ConstVectorRef& u);
  void calcDiff(const std::shared_ptr<ConstraintDataManager>& data, const ConstVectorRef& x);
  std::shared_ptr<ConstraintDataManager> createData(DataCollector* shared, DifferentialActionDataAbstract* out);
  std::shared_ptr<ConstraintDataManager> createData(DataCollector* shared);  // by hand
  /// Lays out the residuals' blocks again (the islands changed), and the sizes of out's vectors and matrices.
  void lay_out(ConstraintDataManager& data, bool terminal) const;

  const std::shared_ptr<StateAbstract>& get_state() const { return state_; }
  const ConstraintModelContainer& get_constraints() const { return constraints_; }
  std::size_t get_nu() const { return nu_; }
  std::size_t get_ng() const { return ng_; }  // of the active constraints
  std::size_t get_nh() const { return nh_; }
  std::size_t get_ng_T() const { return ng_T_; }  // of those that hold in a terminal node
  std::size_t get_nh_T() const { return nh_T_; }
  const Eigen::VectorXd& get_lb() const { return lb_; }  // ng
  const Eigen::VectorXd& get_ub() const { return ub_; }
  const Eigen::VectorXd& get_lb_T() const { return lb_T_; }  // ng_T: of a terminal node's g
  const Eigen::VectorXd& get_ub_T() const { return ub_T_; }
  const std::set<std::string>& get_active_set() const { return active_set_; }
  const std::set<std::string>& get_inactive_set() const { return inactive_set_; }
  std::size_t get_version() const { return version_; }  // of the set of constraints
  std::size_t get_status() const { return status_; }    // counts switches
  void print(std::ostream& os) const;

 private:
  void count();
  bool holds(const ConstraintItem& item, bool terminal) const;
  template <class F>
  void for_each_holding(ConstraintDataManager& data, bool terminal, F&& f) const;
  /// Throws std::invalid_argument where a constraint was replaced since the data were created.
  void check_residuals(const char* where, const ConstraintDataManager& data) const;
  void prepare(const char* where, ConstraintDataManager& data, const ConstVectorRef& x, bool terminal) const;
  void stack_values(ConstraintDataManager& data, bool terminal) const;
  void stack_jacobians(ConstraintDataManager& data, bool terminal) const;
  std::shared_ptr<StateAbstract> state_;
  ConstraintModelContainer constraints_;
  std::size_t nu_, ng_ = 0, nh_ = 0, ng_T_ = 0, nh_T_ = 0, version_ = 0, status_ = 0;
  Eigen::VectorXd lb_, ub_, lb_T_, ub_T_;
  std::set<std::string> active_set_, inactive_set_;
};
std::ostream& operator<<(std::ostream& os, const ConstraintModelManager& model);

}  // namespace manycontact
