#pragma once
// A node made of subproblems: the states, controls and costs of some robots each. With x_i, u_i those of subproblem i,
//
//     x' = (f_1(x_1, u_1), f_2(x_2, u_2), ...),    l = sum_i l_i(x_i, u_i).
//
// Subproblems without contacts between them are decoupled. Then fx, fu and the Hessians are block diagonal, so that the
// cost is linear in the number of subproblems. Otherwise they have couplings (couplings.hpp): each f_i and l_i also
// depends on the wrenches on the subproblem, which follow from the states and controls of all.

#include "manycontact/action/diff_action.hpp"
#include "manycontact/control/shooting.hpp"

namespace manycontact {

struct ActionPart {  // One subproblem of a scene, and the places of its coordinates.
  std::shared_ptr<ActionModelAbstract> model;
  std::vector<int> x, dx, u;     // coordinates of the node that belong to the subproblem, in its order
  std::vector<int> robots = {};  // robots' numbers in the node's scene, in the subproblem's order; for couplings
};

class Couplings;
struct CouplingData;

struct ActionDataParts : ActionDataAbstract {  // Data of ActionModelParts, subproblem by subproblem.
  using ActionDataAbstract::ActionDataAbstract;
  std::vector<std::shared_ptr<ActionDataAbstract>> parts;
  std::vector<Eigen::VectorXd> x, u;        // each subproblem's values as last given; u includes the wrenches on it
  std::shared_ptr<CouplingData> couplings;  // null without couplings

  bool has_matrices() const override { return Fx.size() > 0; }
};

/// Subproblems of a scene as one node. calcDiff collects derivatives from the subproblems' data as they are, which may
/// have been evaluated separately.
class ActionModelParts : public NodeWithData<ActionModelParts, ActionModelAbstract, ActionDataParts> {
 public:
  static constexpr const char* kName = "ActionModelParts";

  /// Makes a node of decoupled subproblems. state: of all of them. Each coordinate of x, dx, u belongs to one
  /// subproblem, otherwise std::invalid_argument is thrown. g and h are concatenated; their bounds and the control
  /// limits are those of the subproblems at construction. There is no r (nr = 0).
  ActionModelParts(std::shared_ptr<StateAbstract> state, std::size_t nu, std::vector<ActionPart> parts);
  /// Makes a node with couplings: the scene's active contacts between robots of different subproblems. scene: the
  /// state's robots, with its damping, and contacts of which those with the flag are active. Controls are the scene's
  /// torques, limited by the joints' efforts. Throws std::invalid_argument for models other than those described in
  /// couplings.hpp.
  ActionModelParts(std::shared_ptr<StateMultibody> state, Scene scene, std::vector<ActionPart> parts);

  std::shared_ptr<ActionDataAbstract> createData() override;
  /// Creates data that contain given data of the subproblems' models, which are evaluated with them.
  std::shared_ptr<ActionDataAbstract> createData(std::vector<std::shared_ptr<ActionDataAbstract>> parts);
  bool checkData(const DataPtr& data) override;
  /// Collects cost, xnext, g and h from the subproblems' data as they are. Forces of couplings remain those of the last
  /// calc.
  void collect(const DataPtr& data) const;
  /// Uses each subproblem's quasiStatic; with couplings, the node's own derivatives.
  void quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter = 100,
                   double tol = 1e-9) override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_g_lb_T() const override { return g_lb_T_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return g_ub_T_; }

  const std::vector<ActionPart>& get_parts() const { return parts_; }  // the subproblems
  /// Null for decoupled subproblems.
  const std::shared_ptr<const Couplings>& get_couplings() const { return couplings_; }
  /// Makes the same node with other models in the same places, with the limits and storage of this one.
  std::shared_ptr<ActionModelParts> with_models(std::vector<ActionPart> parts) const;
  /// Selects the matrices of data created afterwards. With kDense (initially) the node's data also contain dense
  /// derivatives, for any solver, with the wrenches of couplings eliminated. With kSparse only the subproblems' data
  /// contain derivatives, which SolverSparse reads; Lx, Lu and the node's matrices are empty.
  void set_storage(MatrixStorage storage);
  MatrixStorage get_storage() const { return storage_; }  // which matrices the data contain

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

/// A shooting problem of one subproblem; its nodes' data are those of the whole problem.
struct ShootingPart {
  std::shared_ptr<ShootingProblem> problem;
  std::vector<int> x, dx;           // coordinates as in ActionPart
  std::vector<std::vector<int>> u;  // one entry per running node
};

/// Separates a problem whose nodes are ActionModelParts without couplings, with the same x and dx in each node.
/// Otherwise throws std::invalid_argument. A problem without any such node has one subproblem. Later changes of the
/// problem's nodes have no effect on the result.
std::vector<ShootingPart> separate(const ShootingProblem& problem);

/// Copy the numbers of a subproblem: part = whole(index), or whole(index) = part.
void gather(const Eigen::VectorXd& whole, const std::vector<int>& index, Eigen::VectorXd& part);
void scatter(const Eigen::VectorXd& part, const std::vector<int>& index, Eigen::VectorXd& whole);

}  // namespace manycontact
