#pragma once
// A subproblem whose nodes are ActionModelParts with couplings: robots in contact. The direction of FDDP is the
// solution (dx, du) of the linear-quadratic problem around the candidate, with the couplings' wrenches as variables
// (couplings.hpp, lq/problem.hpp). The lq::DirectionSolver of least predicted operations computes it: a Riccati
// recursion per robot and a Schur complement of the couplings, or islands through time. It equals that of SolverFDDP on
// nodes of the whole scene, with the same regularisation (rho on states and controls, none on wrenches).
//
// The forward pass is FDDP's with other gains. SolverFDDP's K = -du/dx of the whole scene is dense, and never appears;
// here each robot has the gains K_i of its own recursion, which takes the wrenches on it as given, and
//
//     u_i = us_i + s du_i - K_i (x_i (-) xs_i - s dx_i):
//
// At the state x of the linear model, both take the step u = us + s du. The feedback of the model's error differs, so
// that steps differ from those of SolverFDDP to second order, and perhaps the number of iterations, but not the
// solution. Gaps are kept at (1 - s) as in FDDP. The expected reduction of a step of length s is that of the
// linear-quadratic problem without the regularisation,
//
//     s (d0 + s d1 / 2),    d0 = -(q^T dx + r^T du + r_w^T dw),    d1 = -[dx; du; dw]^T H [dx; du; dw],
//
// which is what FDDP's expected improvement is at x = xs (+) s dx. Acceptance, regularisation and stopping are FDDP's.

#include "manycontact/control/direction.hpp"
#include "manycontact/lq/direction_solver.hpp"
#include "manycontact/lq/riccati.hpp"

namespace manycontact {

/// get_Vx: the multipliers of the states' equations at the full step; get_k: -du.
class CoupledDirection : public Direction {
 public:
  /// Whether all nodes of the problem have couplings of the same subproblems.
  static bool applies_to(const ShootingProblem& problem);
  CoupledDirection(ShootingPart part, bool is_whole) : Direction(std::move(part), is_whole) {}

  const char* name() const override { return solver_->name(); }
  std::vector<int> blocks() const override;
  /// The gains of the clusters of node t (lq/plan.hpp).
  std::vector<Gains> gains(std::size_t t) const override;
  const lq::Problem& problem_of_direction() const { return lq_; }
  const lq::Point& solution_of_direction() const { return z_; }
  const lq::Outcome& outcome() const { return outcome_; }

  void resize() override;
  /// Returns false also if the KKT error exceeds lq::kAccurate, e.g. with redundant, inconsistent couplings.
  bool compute(double preg, double dreg) override;
  Eigen::Vector2d improvement(bool) override { return improvement_; }
  double expected_reduction() const override { return improvement_[0] + 0.5 * improvement_[1]; }
  /// These correspond to RiccatiDirection's, with the clusters' gains K and the coupled Hessian instead of diag(Quu).
  void set_feed_forward(const Vectors& nu) override;
  void feed_forward_gradient(Vectors& g) override;
  void precondition_feed_forward(Vectors& g) override;

 private:
  void step_control(std::size_t t, double steplength) override;
  template <class Use>
  void each_cluster(std::size_t t, Use&& use);
  void add_feedback(std::size_t t, const Eigen::VectorXd& g, Eigen::VectorXd& to);
  void add_gains_times(std::size_t t, const Eigen::VectorXd& dx, Eigen::VectorXd& to);

  std::vector<ActionPart> blocks_;  // the nodes' parts, without models
  lq::Problem lq_;
  lq::Layout layout_;
  std::unique_ptr<lq::DirectionSolver> solver_;
  const lq::Riccati* policies_ = nullptr;  // policies of solver_
  lq::Point z_;
  lq::Outcome outcome_;
  Eigen::Vector2d improvement_ = Eigen::Vector2d::Zero();
  lq::Point preconditioned_;
  Eigen::VectorXd from_model_, of_cluster_, u_of_cluster_;  // workspace: x (-) xs - s dx by block; of a cluster
};

/// Predicted operations of a direction: by the dense recursion, and by the cheapest coupled method. They depend on the
/// sizes of each part's states and controls, and on the pairs of coupled parts at each running node.
struct CoupledPrediction {
  double dense = 0, coupled = 0;
};
CoupledPrediction predict_coupled(const std::vector<int>& nx, const std::vector<int>& nu,
                                  const std::vector<std::vector<std::pair<int, int>>>& couplings);

}  // namespace manycontact
