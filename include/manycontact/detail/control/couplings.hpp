#pragma once
// Couplings of a node's subproblems: contacts between bodies of different subproblems, for example between robots that
// carry an object together.
//
// Values are those of the whole scene: accelerations a and forces f of all contacts. Derivatives treat each coupling's
// wrench w as a separate variable, in world axes about a fixed point (A's current origin). Subproblem i (state x_i,
// controls u_i) then depends only on x_i, u_i and the wrenches on it:
//
//     dx_i' = A_i dx_i + B_i [du_i; dw]                              subproblem i, its own contacts solved
//     sum over both ends i of a coupling:  C_i dx_i + D_i [du_i; dw] = 0      r2 = J a + a0 + delta f = 0
//
// C_i, D_i are the contributions of subproblem i to the coupling's rows, whose terms are the relative acceleration of
// the coupled frames and the stabilisation:
//
//     C_i = J_i da_i/dx_i + (derivative of the rows' bias with respect to x_i),    D_i = J_i da_i/d[u_i; w].
//
// A force fixed to A's frame would make B's torques depend on A's state (detail/contact/derivatives.hpp), but w does
// not. Each coupling has six numbers w, though a contact of m < 6 rows transmits only F = W^T f, W its rows. The wrench
// that moves with A has no component in the complement N of W's rows; this gives the other 6 - m rows of the coupling,
//
//     N (X^T w - (J_A dq_A) x* F + (rotation of a world-aligned frame)) = 0.
//
// Elimination of dw gives the exact derivatives of the whole scene. This includes Gauss-Newton Hessians of the costs,
// as a cost of subproblem i is a function of (x_i, u_i, w).

#include "manycontact/detail/control/parts.hpp"
#include "manycontact/detail/control/wrenches.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

/// A contact between frame A of subproblem part_a and frame B' of subproblem part_b; contact: its number in the scene.
struct Coupling {
  int contact = 0, part_a = 0, part_b = 0;
};
/// Lists the active contacts between robots of different subproblems. robots: the robots' numbers, per subproblem.
/// Throws std::invalid_argument for a contact whose A or B cannot move.
std::vector<Coupling> couplings_between(const Scene& scene, const std::vector<std::vector<int>>& robots);
/// Returns the wrenches on subproblem `part`, in the order of its couplings, for its ActuationModelWrenches.
std::vector<WrenchEnd> wrench_ends(const Scene& scene, const std::vector<Coupling>& couplings,
                                   const std::vector<std::vector<int>>& robots, int part);

/// The couplings of a node. Each subproblem's model is an IntegratedActionModelEuler of a
/// DifferentialActionModelContactFwdDynamics of its robots, with the contacts among these robots. It is actuated by
/// ActuationModelWrenches, with controls [u; wrenches], and may be within an augmented Lagrangian
/// (augmented_action.hpp).
class Couplings {
 public:
  /// Lists the couplings of the subproblems. Throws std::invalid_argument if these do not fit the scene.
  Couplings(Scene scene, const std::vector<ActionPart>& parts);

  const Scene& scene() const { return scene_; }                          // all robots, with gravity
  const std::vector<Coupling>& couplings() const { return couplings_; }  // by the number of their contacts
  /// Returns the couplings of each subproblem, in the order of its wrenches.
  const std::vector<std::vector<int>>& couplings_of_parts() const { return couplings_of_; }
  /// Returns the name of a coupling's contact.
  const std::string& name(std::size_t coupling) const { return scene_.contacts[couplings_[coupling].contact].name; }
  /// Returns the force on frame A of a coupling at the last solve, in the contact's reference frame [N, N m].
  Eigen::VectorXd force(std::size_t coupling, const CouplingData& data) const;

  /// Solves the dynamics of the whole scene, and stores the controls and wrenches of the subproblems in d.u.
  void solve(const std::vector<ActionPart>& parts, const ConstVectorRef& x, const ConstVectorRef& u,
             ActionDataParts& d) const;
  /// Computes C and D of all subproblems, after their calcDiff.
  void differentiate(const std::vector<ActionPart>& parts, ActionDataParts& d) const;
  /// Computes the node's matrices in `d` from those of the subproblems, with the wrenches eliminated.
  void condense(const std::vector<ActionPart>& parts, ActionDataParts& d) const;

 private:
  void share_of_end(const std::vector<ActionPart>& parts, ActionDataParts& d, std::size_t coupling, bool of_a) const;
  Scene scene_;
  std::vector<Coupling> couplings_;
  std::vector<std::vector<int>> couplings_of_;
  std::vector<int> local_robot_;  // one entry per robot of the scene: its number in its subproblem
};

struct CouplingData {                                                       // The data of all couplings of a node.
  CouplingData(const Couplings& of, const std::vector<ActionPart>& parts);  // allocates the data

  std::vector<Eigen::MatrixXd> C, D;  // one matrix per subproblem: its contribution to the rows of its
                                      // couplings, six rows each; set by differentiate
  SceneData solution;                 // accelerations and forces of the whole scene; set by solve
  /// The workspace of one robot.
  struct OfRobot {
    explicit OfRobot(const Model& model) : kin(model), terms(model) {}  // allocates the workspace
    Kinematics<double> kin;                                             // motion at the solution; set by solve
    RneaDerivatives terms;                                              // its derivatives: set by differentiate
  };
  std::vector<std::unique_ptr<OfRobot>> robots;  // one per robot of the scene; null if no coupling acts on it
  /// The workspace of one coupling.
  struct OfCoupling {
    ContactSupport support;
    ContactData<double> rows;        // constraint rows at the solution; set by solve
    ContactDerivatives derivatives;  // derivatives of the rows: set by differentiate
  };
  std::vector<OfCoupling> couplings;
};

/// Computes the gradients of l(x, u) + next^T x'(x, u) + y^T [g; h](x, u) of a node with couplings, at the data's last
/// calcDiff, with the wrenches eliminated. For a terminal node gu is unchanged. y: multipliers of the constraints g, h,
/// or empty. The result is not finite if couplings are redundant.
void coupled_gradient(const ActionModelParts& model, const ActionDataParts& data, const Eigen::VectorXd& next,
                      bool terminal, const Eigen::VectorXd& y, Eigen::VectorXd& gx, Eigen::VectorXd& gu);
/// Computes the gradients of coupled_gradient in another way, to check a solution: derivatives of the wrenches come
/// from the whole scene's dynamics (vjp), not from the couplings' C, D. Call it after calc(data, x, u) and calcDiff.
void scene_gradient(const ActionModelParts& model, ActionDataParts& data, const Eigen::VectorXd& next, bool terminal,
                    const Eigen::VectorXd& y, Eigen::VectorXd& gx, Eigen::VectorXd& gu);

}  // namespace manycontact
