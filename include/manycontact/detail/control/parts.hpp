#pragma once
// A node made of subproblems: the states, controls and costs of some robots each. With x_i, u_i of subproblem i,
//
//     x' = (f_1(x_1, u_1), f_2(x_2, u_2), ...),    l = sum_i l_i(x_i, u_i).
//
// Subproblems without contacts between them are decoupled: fx, fu and the Hessians are block diagonal, so that the cost
// is linear in the number of subproblems. Otherwise the subproblems have couplings (couplings.hpp): f_i and l_i then
// also depend on the wrenches on subproblem i, which follow from the states and controls of all subproblems.

#include "manycontact/action/diff_action.hpp"
#include "manycontact/control/shooting.hpp"

namespace manycontact {

struct ActionPart {  // One subproblem, and the indices of its coordinates in the node.
  std::shared_ptr<ActionModelAbstract> model;
  std::vector<int> x, dx, u;     // coordinates of the node that belong to the subproblem, in the subproblem's order
  std::vector<int> robots = {};  // numbers of its robots in the node's scene, in its order; for couplings
};

class Couplings;
struct CouplingData;

struct ActionDataParts : ActionDataAbstract {  // Data of ActionModelParts, subproblem by subproblem.
  using ActionDataAbstract::ActionDataAbstract;
  std::vector<std::shared_ptr<ActionDataAbstract>> parts;
  std::vector<Eigen::VectorXd> x, u;        // values last given to each subproblem; u includes wrenches
  std::shared_ptr<CouplingData> couplings;  // null if there are no couplings

  bool has_matrices() const override { return Fx.size() > 0; }
};

/// Subproblems of a scene as one node. calcDiff collects derivatives from the subproblems' data, also if these were
/// evaluated separately before.
class ActionModelParts : public NodeWithData<ActionModelParts, ActionModelAbstract, ActionDataParts> {
 public:
  static constexpr const char* kName = "ActionModelParts";

  /// Makes a node of decoupled subproblems. state: the state of all subproblems together. Each coordinate of x, dx, u
  /// must belong to one subproblem, otherwise std::invalid_argument is thrown. g and h are concatenated. Their bounds
  /// and the control limits are those of the subproblems at construction. There is no r (nr = 0).
  ActionModelParts(std::shared_ptr<StateAbstract> state, std::size_t nu, std::vector<ActionPart> parts);
  /// Makes a node with couplings: the scene's active contacts between robots of different subproblems. scene: the
  /// state's robots, with damping and contacts; only contacts flagged active count. Controls are the scene's torques,
  /// limited by the joints' efforts. Throws std::invalid_argument for models that couplings.hpp does not describe.
  ActionModelParts(std::shared_ptr<StateMultibody> state, Scene scene, std::vector<ActionPart> parts);

  std::shared_ptr<ActionDataAbstract> createData() override;
  /// Creates node data from existing data of the subproblems' models; the node evaluates these data with its own.
  std::shared_ptr<ActionDataAbstract> createData(std::vector<std::shared_ptr<ActionDataAbstract>> parts);
  bool checkData(const DataPtr& data) override;
  /// Collects cost, xnext, g and h from the subproblems' data without evaluating them. Forces of couplings remain those
  /// of the last calc.
  void collect(const DataPtr& data) const;
  /// Calls quasiStatic of each subproblem; with couplings, uses the derivatives of the whole node.
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_g_lb_T() const override { return g_lb_T_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return g_ub_T_; }

  const std::vector<ActionPart>& get_parts() const { return parts_; }  // the subproblems
  /// Returns the couplings of the node; null for decoupled subproblems.
  const std::shared_ptr<const Couplings>& get_couplings() const { return couplings_; }
  /// Makes a node with other models for the subproblems, and the indices, limits and storage of this node.
  std::shared_ptr<ActionModelParts> with_models(std::vector<ActionPart> parts) const;
  /// Selects the matrices of data created afterwards. With kDense (initially), the node's data contain dense
  /// derivatives for any solver, with the wrenches of couplings eliminated. With kSparse, only the subproblems' data
  /// contain derivatives, which SolverSparse reads; Lx, Lu and the node's matrices are empty.
  void set_storage(MatrixStorage storage);
  MatrixStorage get_storage() const { return storage_; }  // see set_storage

 private:
  void evaluate(ActionDataParts& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void differentiate(ActionDataParts& data, const ConstVectorRef& x, const ConstVectorRef* u) override;
  void take_values(const ConstVectorRef& x, const ConstVectorRef* u, ActionDataParts& data) const;
  void collect_derivatives(ActionDataParts& data) const;
  void check_parts();
  std::vector<ActionPart> parts_;
  std::shared_ptr<const Couplings> couplings_;
  Eigen::VectorXd g_lb_T_, g_ub_T_;
  MatrixStorage storage_ = MatrixStorage::kDense;
};

/// A shooting problem of one subproblem; data of its nodes belong to the nodes of the whole problem.
struct ShootingPart {
  std::shared_ptr<ShootingProblem> problem;
  std::vector<int> x, dx;           // coordinates as in ActionPart
  std::vector<std::vector<int>> u;  // controls as in ActionPart, one entry per running node
};

/// Separates a problem whose nodes are ActionModelParts without couplings, with the same x and dx in each node. Throws
/// std::invalid_argument for other ActionModelParts. A problem without ActionModelParts becomes one subproblem. Later
/// changes of the problem's nodes have no effect on the result.
std::vector<ShootingPart> separate(const ShootingProblem& problem);

/// Copy a subproblem's entries: gather sets part = whole(index), scatter sets whole(index) = part.
void gather(const Eigen::VectorXd& whole, const std::vector<int>& index, Eigen::VectorXd& part);
void scatter(const Eigen::VectorXd& part, const std::vector<int>& index, Eigen::VectorXd& whole);

}  // namespace manycontact
