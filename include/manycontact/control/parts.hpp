#pragma once
// A node of parts: the states, controls and costs of some robots each. With x_i, u_i a part's own,
//
//     x' = (f_1(x_1, u_1), f_2(x_2, u_2), ...),    l = sum_i l_i(x_i, u_i),
//
// where parts never meet, so that fx, fu and the Hessians are block diagonal: of each part's size they are, and linear
// in the parts together. Parts that hold each other have couplings besides (couplings.hpp): each f_i and l_i then also
// depends on the wrenches on the part, which follow from the states and controls of all.

#include "manycontact/action/diff_action.hpp"
#include "manycontact/control/shooting.hpp"

namespace manycontact {

struct ActionPart {  // one part of a scene, and where its coordinates are
  std::shared_ptr<ActionModelAbstract> model;
  std::vector<int> x, dx, u;     // which coordinates of the node's are the part's, in the part's order
  std::vector<int> robots = {};  // of a node with couplings: of its scene, in the order of the model's
};

class Couplings;
struct CouplingData;

struct ActionDataParts : ActionDataAbstract {  // of such a node, part by part
  using ActionDataAbstract::ActionDataAbstract;
  std::vector<std::shared_ptr<ActionDataAbstract>> parts;
  std::vector<Eigen::VectorXd> x, u;        // of each part, as last given; u with the wrenches on it
  std::shared_ptr<CouplingData> couplings;  // null without

  bool has_matrices() const override { return Fx.size() > 0; }
};

class ActionModelParts : public ActionModelAbstract {  // parts of a scene as one node
 public:
  /// state: of all parts. Each coordinate of x, dx, u is one part's, else std::invalid_argument. g and h are the
  /// parts', one after the other; their bounds and control limits are the parts' at construction. There is no r (nr =
  /// 0).
  ActionModelParts(std::shared_ptr<StateAbstract> state, std::size_t nu, std::vector<ActionPart> parts);
  /// With couplings: the scene's active contacts between robots of different parts. scene: the state's robots, with the
  /// contacts that its flags say active, and damping. Controls are the scene's torques, limited by the joints' efforts.
  /// A part's model is what couplings.hpp says, else std::invalid_argument.
  ActionModelParts(std::shared_ptr<StateMultibody> state, Scene scene, std::vector<ActionPart> parts);

  using ActionModelAbstract::calc;
  using ActionModelAbstract::calcDiff;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  /// Of the parts' data as they are: parts may have been evaluated on their own since.
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ActionDataAbstract> createData() override;
  /// Around data of the parts' models, which are evaluated with it.
  std::shared_ptr<ActionDataAbstract> createData(std::vector<std::shared_ptr<ActionDataAbstract>> parts);
  bool checkData(const std::shared_ptr<ActionDataAbstract>& data) override;
  /// Cost, xnext, g and h, of the parts' data as they are; forces of couplings stay those of the last calc.
  void collect(const std::shared_ptr<ActionDataAbstract>& data) const;
  /// By each part's; with couplings by the node's own derivatives.
  void quasiStatic(const std::shared_ptr<ActionDataAbstract>& data, VectorRef u, const ConstVectorRef& x,
                   std::size_t maxiter = 100, double tol = 1e-9) override;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_g_lb_T() const override { return g_lb_T_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return g_ub_T_; }

  const std::vector<ActionPart>& get_parts() const { return parts_; }
  /// Null of parts that never meet.
  const std::shared_ptr<const Couplings>& get_couplings() const { return couplings_; }
  /// The same node of other models, in the same places, with this one's limits and storage.
  std::shared_ptr<ActionModelParts> with_models(std::vector<ActionPart> parts) const;
  /// kDense (at first): the node's data hold its derivatives as dense matrices too, for any solver, with the wrenches
  /// of couplings eliminated. kSparse: only the parts' data hold theirs, which SolverSparse reads; Lx, Lu and the
  /// matrices of the node's are empty. Of data created from then on.
  void set_storage(MatrixStorage storage);
  MatrixStorage get_storage() const { return storage_; }

 private:
  void take_values(const ConstVectorRef& x, ActionDataParts& data) const;
  void take_values(const ConstVectorRef& x, const ConstVectorRef& u, ActionDataParts& data) const;
  void collect_derivatives(ActionDataParts& data) const;
  void check_parts();
  std::vector<ActionPart> parts_;
  std::shared_ptr<const Couplings> couplings_;
  Eigen::VectorXd g_lb_T_, g_ub_T_;
  MatrixStorage storage_ = MatrixStorage::kDense;
};

/// A shooting problem of one part alone; its nodes' data are the whole problem's.
struct ShootingPart {
  std::shared_ptr<ShootingProblem> problem;
  std::vector<int> x, dx;           // as in ActionPart
  std::vector<std::vector<int>> u;  // by running node
};

/// The parts of a problem whose nodes are ActionModelParts without couplings, of the same x and dx in each, else
/// std::invalid_argument. A problem without any such node is one part. They follow no later change of the problem's
/// nodes.
std::vector<ShootingPart> separate(const ShootingProblem& problem);

/// The part's numbers: part = whole(index), and back.
void gather(const Eigen::VectorXd& whole, const std::vector<int>& index, Eigen::VectorXd& part);
void scatter(const Eigen::VectorXd& part, const std::vector<int>& index, Eigen::VectorXd& whole);

}  // namespace manycontact
