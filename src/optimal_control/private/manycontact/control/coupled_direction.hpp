#pragma once
// The direction of a subproblem whose nodes are ActionModelParts with couplings (robots in contact). It is the solution
// (dx, du, dw) of the linear-quadratic problem around the candidate, with the couplings' wrenches w as variables
// (couplings.hpp, lq/problem.hpp). The lq::DirectionSolver with the fewest predicted operations computes this solution.
// dx, du equal those of SolverFDDP on nodes of the whole scene, with the same regularisation of states and controls.
//
// The forward pass of step length s has other gains than FDDP. The gains K = -du/dx of the whole scene, which
// SolverFDDP has, are dense and not computed. Each cluster i of robots has the gains K_i of its own recursion at given
// wrenches:
//
//     u_i = us_i + s du_i - K_i (x_i (-) xs_i - s dx_i)
//
// At the linear model's states x = xs (+) s dx the controls are us + s du as in SolverFDDP; elsewhere steps differ to
// second order. The number of iterations may differ, the solution does not. Gaps are multiplied by (1 - s) as in FDDP.
// The expected reduction of the cost is that of the linear-quadratic problem without the regularisation,
//
//     s (d0 + s d1 / 2),    d0 = -(q^T dx + r^T du + r_w^T dw),    d1 = -[dx; du; dw]^T H [dx; du; dw],
//
// which equals FDDP's expected improvement at x = xs (+) s dx. Acceptance, regularisation and stopping are FDDP's.

#include "manycontact/control/direction.hpp"
#include "manycontact/lq/direction_solver.hpp"
#include "manycontact/lq/riccati.hpp"

namespace manycontact {

/// A direction for coupled subproblems. get_Vx: multipliers of the states' equations at the full step; get_k: -du.
class CoupledDirection : public Direction {
 public:
  /// Returns whether all nodes of the problem have couplings between the same subproblems.
  static bool applies_to(const ShootingProblem& problem);
  CoupledDirection(ShootingPart part, bool is_whole) : Direction(std::move(part), is_whole) {}

  const char* name() const override { return solver_->name(); }
  std::vector<int> blocks() const override;
  std::vector<Gains> gains(std::size_t t) const override;  // gains of the clusters (lq/plan.hpp)
  const lq::Problem& problem_of_direction() const { return lq_; }
  const lq::Point& solution_of_direction() const { return z_; }
  const lq::Outcome& outcome() const { return outcome_; }

  void resize() override;
  bool compute(double preg, double dreg) override;  // returns false also if the KKT error exceeds lq::kAccurate
  Eigen::Vector2d improvement(bool) override { return improvement_; }
  double expected_reduction() const override { return improvement_[0] + 0.5 * improvement_[1]; }
  /// Override RiccatiDirection's functions with the clusters' gains K, and the coupled Hessian instead of diag(Quu).
  void set_feed_forward(const Vectors& nu) override;
  void feed_forward_gradient(Vectors& g) override;
  void precondition_feed_forward(Vectors& g) override;

 private:
  void step_control(std::size_t t, double steplength) override;
  template <class Use>
  void each_cluster(std::size_t t, Use&& use);
  void add_feedback(std::size_t t, const Eigen::VectorXd& g, Eigen::VectorXd& to);
  void add_gains_times(std::size_t t, const Eigen::VectorXd& dx, Eigen::VectorXd& to);

  std::vector<ActionPart> blocks_;  // coordinates of the nodes' subproblems; the models are null
  lq::Problem lq_;
  lq::Layout layout_;
  std::unique_ptr<lq::DirectionSolver> solver_;
  const lq::Riccati* policies_ = nullptr;  // the recursion in solver_ that contains the gains of the clusters
  lq::Point z_;
  lq::Outcome outcome_;
  Eigen::Vector2d improvement_ = Eigen::Vector2d::Zero();
  lq::Point preconditioned_;
  Eigen::VectorXd from_model_, of_cluster_, u_of_cluster_;  // x (-) xs - s dx; parts of one cluster
};

/// Predicted operations of a direction with the dense recursion, and with the cheapest coupled method. nx, nu: numbers
/// of states and controls of each subproblem. couplings: pairs of coupled subproblems at each running node.
struct CoupledPrediction {
  double dense = 0, coupled = 0;
};
CoupledPrediction predict_coupled(const std::vector<int>& nx, const std::vector<int>& nu,
                                  const std::vector<std::vector<std::pair<int, int>>>& couplings);

}  // namespace manycontact
