#pragma once
// Couplings of a node's parts: contacts between bodies of different parts (robots that hold each other).
//
// Values are the whole scene's: accelerations a and forces of all contacts. Derivatives keep each coupling's wrench w
// as a variable of its own, in world axes about a point that stands still (A's origin at the state at hand), so that a
// part answers to its own state and to the wrenches on it, and to nothing else:
//
//     dx_i' = A_i dx_i + B_i [du_i; dw]           of a node of part i's robots alone (its own contacts solved there)
//     sum over both ends i of a coupling:  C_i dx_i + D_i [du_i; dw] = 0       r2 = J a + a0 + delta f = 0
//
// C_i, D_i: the share of part i in the coupling's rows, relative acceleration of its frames and stabilisation,
//
//     C_i = J_i da_i/dx_i + (rows' drift by x_i),    D_i = J_i da_i/d[u_i; w].
//
// A force that were fixed to A's frame instead would make B's torques depend on A's state (contact/derivatives.hpp).
// All couplings have six numbers w. A contact of m < 6 rows transmits F = W^T f only, so that the wrench that moves
// with A has no part in the complement N of W's rows; these are the other 6 - m rows of the coupling,
//
//     N (X^T w - (J_A dq_A) x* F + (turning of a world-aligned frame)) = 0.
//
// Eliminating dw gives the whole scene's derivatives exactly, Gauss-Newton Hessians of the costs included: a cost of
// part i is a function of (x_i, u_i, w). This is the structure that the couplings of lq/problem.hpp are for.

#include "manycontact/control/parts.hpp"
#include "manycontact/control/wrenches.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

/// A contact between two parts, A's and B's.
struct Coupling {
  int contact = 0, part_a = 0, part_b = 0;
};
/// The active contacts between robots of different parts. Throws std::invalid_argument for one whose A or B cannot
/// move. robots: of each part.
std::vector<Coupling> couplings_between(const Scene& scene, const std::vector<std::vector<int>>& robots);
/// What acts on a part, coupling by coupling, for its ActuationModelWrenches.
std::vector<WrenchEnd> wrench_ends(const Scene& scene, const std::vector<Coupling>& couplings,
                                   const std::vector<std::vector<int>>& robots, int part);

/// Of parts whose models are IntegratedActionModelEuler of a DifferentialActionModelContactFwdDynamics of their robots
/// and the contacts among these, actuated by ActuationModelWrenches: its controls are [u; wrenches]. Or that within an
/// augmented Lagrangian (augmented_action.hpp).
class Couplings {
 public:
  /// Throws std::invalid_argument where parts and scene do not fit.
  Couplings(Scene scene, const std::vector<ActionPart>& parts);

  const Scene& scene() const { return scene_; }
  const std::vector<Coupling>& couplings() const { return couplings_; }
  /// Per part: the couplings that hold it, in the order of its wrenches.
  const std::vector<std::vector<int>>& couplings_of_parts() const { return couplings_of_; }
  const std::string& name(std::size_t coupling) const;
  /// On A, in the contact's reference frame, as of the last solve.
  Eigen::VectorXd force(std::size_t coupling, const CouplingData& data) const;

  /// The whole scene's dynamics, and from them the wrenches on the parts: into d.u.
  void solve(const std::vector<ActionPart>& parts, const ConstVectorRef& x, const ConstVectorRef& u,
             ActionDataParts& d) const;
  /// C and D, after calcDiff of the parts.
  void differentiate(const std::vector<ActionPart>& parts, ActionDataParts& d) const;
  /// d's matrices, which are the node's: with the wrenches eliminated.
  void condense(const std::vector<ActionPart>& parts, ActionDataParts& d) const;

 private:
  void share_of_end(const std::vector<ActionPart>& parts, ActionDataParts& d, std::size_t coupling, bool of_a) const;
  Scene scene_;
  std::vector<Coupling> couplings_;
  std::vector<std::vector<int>> couplings_of_;
  std::vector<int> local_robot_;  // per robot of the scene: its number in its part
};

struct CouplingData {  // of a node, coupling by coupling
  CouplingData(const Couplings& of, const std::vector<ActionPart>& parts);

  std::vector<Eigen::MatrixXd> C, D;  // per part: its share in the rows of its couplings, six each: by differentiate
  SceneData solution;                 // of the whole scene: by solve
  struct OfRobot {
    explicit OfRobot(const Model& model) : kin(model), terms(model) {}
    Kinematics<double> kin;  // at the solution: by solve
    RneaDerivatives terms;   // of which the motion's are used: by differentiate
  };
  std::vector<std::unique_ptr<OfRobot>> robots;  // those that couplings hold
  struct OfCoupling {
    ContactSupport support;
    ContactData<double> rows;        // at the solution: by solve
    ContactDerivatives derivatives;  // by differentiate
  };
  std::vector<OfCoupling> couplings;
};

/// Gradients of l(x, u) + next^T x'(x, u) + y^T [g; h](x, u) of a node with couplings, the wrenches eliminated, at the
/// data's last calcDiff; of a terminal node gu is left alone. y: of the node's constraints, or none. Throws nothing;
/// not finite where couplings depend on each other.
void coupled_gradient(const ActionModelParts& model, const ActionDataParts& data, const Eigen::VectorXd& next,
                      bool terminal, const Eigen::VectorXd& y, Eigen::VectorXd& gx, Eigen::VectorXd& gu);
/// The same by other means, for those who judge an answer: how the wrenches answer to x and u is the whole scene's
/// dynamics differentiated (vjp), not the couplings' rows C, D. After calc(data, x, u) and calcDiff.
void scene_gradient(const ActionModelParts& model, ActionDataParts& data, const Eigen::VectorXd& next, bool terminal,
                    const Eigen::VectorXd& y, Eigen::VectorXd& gx, Eigen::VectorXd& gu);

}  // namespace manycontact
