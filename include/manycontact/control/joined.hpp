#pragma once
// A node of parts (robots) that hold each other: contacts between bodies of different parts are its bonds.
//
// Values are the whole scene's: accelerations a and forces of all contacts. Derivatives keep each bond's wrench w as a
// variable of its own, in world axes about a point that stands still (A's origin at the state at hand), so that a part
// answers to its own state and to the wrenches on it, and to nothing else:
//
//     dx_i' = A_i dx_i + B_i [du_i; dw_bonds]        of a node of part i's robots alone (its own contacts solved there)
//     sum over both ends i of bond b:  C_i dx_i + D_i [du_i; dw_bonds] = 0       r2 = J a + a0 + delta f = 0
//
// C_i, D_i: the share of part i in the bond's rows, relative acceleration of its frames and stabilisation,
//
//     C_i = J_i da_i/dx_i + (rows' drift by x_i),    D_i = J_i da_i/d[u_i; w].
//
// A force that were fixed to A's frame instead would make B's torques depend on A's state (contact/derivatives.hpp).
// All bonds have six numbers w. A contact of m < 6 rows transmits F = W^T f only, so that the wrench that moves with A
// has no part in the complement N of W's rows; these are the other 6 - m rows of the bond,
//
//     N (X^T w - (J_A dq_A) x* F + (turning of a world-aligned frame)) = 0.
//
// Eliminating dw gives the whole scene's derivatives exactly, Gauss-Newton Hessians of the costs included: a cost of
// part i is a function of (x_i, u_i, w). This is the structure that the bonds of lq/problem.hpp are for.

#include "manycontact/control/euler.hpp"
#include "manycontact/control/parts.hpp"
#include "manycontact/control/wrenches.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

/// model: an IntegratedActionModelEuler of a DifferentialActionModelContactFwdDynamics of these robots and their own
/// contacts, actuated by ActuationModelWrenches: its controls are [u; wrenches]. Or that within an augmented Lagrangian
/// (augmented_action.hpp). u: the node's controls among them.
struct JoinedPart : ActionPart {
  std::vector<int> robots;  // of the scene, in the order of the model's
};

/// A bond of a node: its contact, and the parts of A and of B.
struct JoinedBond {
  int contact = 0, part_a = 0, part_b = 0;
};
/// The active contacts between robots of different parts. Throws std::invalid_argument for one whose A or B cannot
/// move. robots: of each part.
std::vector<JoinedBond> bonds_between(const Scene& scene, const std::vector<std::vector<int>>& robots);
/// What acts on a part, bond by bond, for its ActuationModelWrenches.
std::vector<WrenchEnd> wrench_ends(const Scene& scene, const std::vector<JoinedBond>& bonds,
                                   const std::vector<std::vector<int>>& robots, int part);

class ActionModelJoined;

struct ActionDataJoined : ActionDataAbstract {  // of such a node, part by part and bond by bond
  /// parts: data of the parts' models.
  ActionDataJoined(const ActionModelJoined* model, std::vector<std::shared_ptr<ActionDataAbstract>> parts);
  ActionDataJoined(const ActionModelJoined* model, std::vector<std::shared_ptr<ActionDataAbstract>> parts,
                   WithoutMatrices);

  std::vector<std::shared_ptr<ActionDataAbstract>> parts;
  std::vector<Eigen::VectorXd> x, u;  // of each part, as last given; u with the wrenches on it: by calc
  std::vector<Eigen::MatrixXd> C, D;  // per part: its share in the rows of its bonds, six each: by calcDiff
  SceneData solution;                 // of the whole scene: by calc(data, x, u)

  struct OfRobot {
    explicit OfRobot(const Model& model) : kin(model), terms(model) {}
    Kinematics<double> kin;  // at the solution: by calc
    RneaDerivatives terms;   // of which the motion's are used: by calcDiff
  };
  std::vector<std::unique_ptr<OfRobot>> robots;  // those that bonds hold
  struct OfBond {
    ContactSupport support;
    ContactData<double> rows;        // at the solution: by calc
    ContactDerivatives derivatives;  // by calcDiff
  };
  std::vector<OfBond> bonds;

  bool has_matrices() const override { return Fx.size() > 0; }
  const std::string& name_of_bond(std::size_t b) const { return names_[b]; }
  /// On A, in the contact's reference frame, as of the last calc(data, x, u).
  Eigen::VectorXd force_of_bond(std::size_t b) const {
    return solution.f.segment(solution.f_offset[static_cast<std::size_t>(contacts_[b])], rows_[b]);
  }

 private:
  void make_work(const ActionModelJoined& model);
  std::vector<std::string> names_;
  std::vector<int> contacts_, rows_;
};

class ActionModelJoined : public ActionModelAbstract {  // robots that hold each other as one node
 public:
  /// scene: the state's robots, with the contacts that its flags say active, and damping. Controls are the scene's
  /// torques, limited by the joints' efforts. g and h are the parts', one after the other. Throws std::invalid_argument
  /// where parts and scene do not fit.
  ActionModelJoined(std::shared_ptr<StateMultibody> state, Scene scene, std::vector<JoinedPart> parts);

  using ActionModelAbstract::calc;
  using ActionModelAbstract::calcDiff;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) override;
  std::shared_ptr<ActionDataAbstract> createData() override;
  /// Around data of the parts' models, which are evaluated with it.
  std::shared_ptr<ActionDataAbstract> createData(std::vector<std::shared_ptr<ActionDataAbstract>> parts);
  bool checkData(const std::shared_ptr<ActionDataAbstract>& data) override;
  /// Cost, xnext, g and h, of the parts' data as they are; forces stay those of the last calc.
  void collect(const std::shared_ptr<ActionDataAbstract>& data) const;
  void print(std::ostream& os) const override;

  const Eigen::VectorXd& get_g_lb_T() const override { return g_lb_T_; }
  const Eigen::VectorXd& get_g_ub_T() const override { return g_ub_T_; }
  const Scene& get_scene() const { return scene_; }
  const std::vector<JoinedPart>& get_parts() const { return parts_; }
  const std::vector<JoinedBond>& get_bonds() const { return bonds_; }
  /// Per part: the bonds that hold it, in the order of its wrenches.
  const std::vector<std::vector<int>>& bonds_of_parts() const { return bonds_of_; }
  /// As ActionModelParts': kDense (at first) eliminates the wrenches, for any solver; kSparse leaves the node's own
  /// matrices, Lx and Lu empty, for SolverSparse.
  void set_storage(MatrixStorage storage);
  MatrixStorage get_storage() const { return storage_; }

 private:
  void check_parts() const;
  void solve_bonds(ActionDataJoined& data, const ConstVectorRef& x, const ConstVectorRef& u) const;
  void differentiate_bonds(ActionDataJoined& data) const;
  void share_of_end(ActionDataJoined& data, std::size_t bond, bool of_a) const;
  void add_force_rows(const ActionDataJoined::OfBond& bond, Eigen::Index first, Eigen::Index w, MatrixRef C,
                      MatrixRef D) const;
  void condense(ActionDataJoined& data, bool terminal) const;
  Scene scene_;
  std::vector<JoinedPart> parts_;
  std::vector<JoinedBond> bonds_;
  std::vector<std::vector<int>> bonds_of_;
  std::vector<int> local_robot_;  // per robot of the scene: its number in its part
  Eigen::VectorXd g_lb_T_, g_ub_T_;
  MatrixStorage storage_ = MatrixStorage::kDense;
};

/// Gradients of l(x, u) + next^T x'(x, u) + y^T [g; h](x, u) with the wrenches eliminated, at the data's last calcDiff;
/// of a terminal node gu is left alone. y: of the node's constraints, or none. Throws nothing; not finite where bonds
/// depend on each other.
void joined_gradient(const ActionModelJoined& model, const ActionDataJoined& data, const Eigen::VectorXd& next,
                     bool terminal, const Eigen::VectorXd& y, Eigen::VectorXd& gx, Eigen::VectorXd& gu);
/// The same by other means, for those who judge an answer: how the wrenches answer to x and u is the whole scene's
/// dynamics differentiated (vjp), not the bonds' rows C, D. After calc(data, x, u) and calcDiff.
void scene_gradient(const ActionModelJoined& model, ActionDataJoined& data, const Eigen::VectorXd& next, bool terminal,
                    const Eigen::VectorXd& y, Eigen::VectorXd& gx, Eigen::VectorXd& gu);

}  // namespace manycontact
