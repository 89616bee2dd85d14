#pragma once
// Problems with constraints g_lb <= g <= g_ub, h = 0, solved by the method of multipliers: an unconstrained solver
// minimises the augmented Lagrangian (detail/control/augmented_action.hpp) for fixed multipliers y and penalty rho.
// After each minimisation
//
//     y <- y+,    rho <- 10 rho  if  m = max |y+ - y| / rho  decreased by less than a factor of 10,
//
// until violation and KKT residual are small (Andreani, Birgin, Martinez, Schuverdt, SIAM J. Optim. 18, 2007; Nocedal &
// Wright 17.4). y+ are the multipliers that the minimum implies. m is the largest violation, where an inactive
// inequality has |y| / rho instead. The multipliers converge, so that constraints are met up to rounding errors at a
// moderate penalty. A minimisation ends if its expected reduction is below rho/2 (0.09 m)^2, with m of the previous
// minimisation: the remaining error of constraints is then about 0.09 m. A minimisation also ends if ten iterations
// reduce the augmented Lagrangian by less than a hundredth of the constraints' contribution, and the violation by less
// than half.
//
// The Gauss-Newton Hessian lacks the curvature of constraints and dynamics, weighted by multipliers. Near the end of an
// arm's reach the true Hessian is five times larger: steps overshoot, and minimisations converge slowly or not at all.
// If `stop` decreased by less than a factor of ten in two iterations, and by less than three in the last iteration, the
// quasi-Newton steps of SolverDDP::descend continue. If these steps fail too, Gauss-Newton steps continue.
//
// If the violation does not decrease although the constraints outweigh the cost, there are three possible causes: the
// constraints are infeasible, the penalty is too small, or the minimisation is stuck. Therefore a separate problem
// minimises only the violation: nodes with the cost 1/2 sum |c - P(c)|^2, where P projects values c of constraints onto
// their bounds. If its solution meets the constraints, the method continues from there. Otherwise searches start from
// some other motions, and at a stationary point from motions near it. If none of these searches finds a smaller
// violation than a stationary point has, the result is kInfeasible. (A smaller minimum may exist elsewhere.)
//
// Let r be the violations and C their Jacobian. A point is stationary if C^T r is below a millionth of |C| |r|, or if a
// step of the linearised problem reduces |r|^2 by less than a millionth. With control limits there is another test for
// kInfeasible: no search halved |r|, and controls at their limits would reduce |r|^2 by less than a tenth, to first
// order. If the searches end at no stationary point, the result is kNoStep, at the point with the smallest violation.
//
// In callbacks, `cost` is the problem's cost, `merit` the augmented Lagrangian; gfeas, hfeas are the violations after
// the step. A constraint at node 0 on the state alone cannot be influenced, because x0 is fixed.

#include <array>
#include <functional>

#include "manycontact/control/ddp.hpp"
#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/detail/control/parts.hpp"

namespace manycontact {

class SolverAugmentedLagrangian : public SolverAbstract {  // Solves constrained problems with an unconstrained solver.
 public:
  /// The type of functions that create the unconstrained solver for a given problem.
  using MakeSolver = std::function<std::shared_ptr<SolverDDP>(std::shared_ptr<ShootingProblem>)>;
  /// Uses SolverSparse if nodes are ActionModelParts without dense matrices; otherwise SolverBoxFDDP if a model has
  /// control limits, else SolverFDDP. Throws std::invalid_argument for a null problem.
  explicit SolverAugmentedLagrangian(std::shared_ptr<ShootingProblem> problem);
  /// Uses the solver that `make` returns. Throws std::invalid_argument for a null problem.
  SolverAugmentedLagrangian(std::shared_ptr<ShootingProblem> problem, const MakeSolver& make);
  ~SolverAugmentedLagrangian() override;
  SolverAugmentedLagrangian(const SolverAugmentedLagrangian&) = delete;
  SolverAugmentedLagrangian& operator=(const SolverAugmentedLagrangian&) = delete;

  /// Starts from the current multipliers and penalty: values of the last solve, or values that were set since. maxiter:
  /// number of iterations of all minimisations and searches together. Returns true if converged: violation <=
  /// get_th_constraint(), KKT residual <= get_th_kkt(), and stopping value < get_th_stop() or no step accepted.
  bool solve(const Vectors& init_xs = DEFAULT_VECTOR, const Vectors& init_us = DEFAULT_VECTOR,
             std::size_t maxiter = 100, bool is_feasible = false, double init_reg = NAN) override;
  /// Call the functions of the same names of the unconstrained solver. `solve` does not call these four functions;
  /// therefore they are final. To change them, derive from the unconstrained solver (MakeSolver).
  void computeDirection(bool recalc = true) final { inner_->computeDirection(recalc); }
  double tryStep(double steplength = 1) final { return inner_->tryStep(steplength); }
  double stoppingCriteria() final { return stop_ = inner_->stoppingCriteria(); }
  const Eigen::Vector2d& expectedImprovement() final { return d_ = inner_->expectedImprovement(); }
  void resizeData() override;

  /// Returns the multipliers of each node's [g; h] (T + 1 vectors, empty for nodes without constraints). They are >= 0
  /// at upper and <= 0 at lower bounds.
  Vectors get_multipliers() const;
  /// Sets the multipliers, as get_multipliers returns them. Throws std::invalid_argument for wrong sizes.
  void set_multipliers(const Vectors& multipliers);
  /// Returns the multipliers of the dynamics after a solve (T + 1 vectors of ndx), as the function kkt_residual takes
  /// them.
  const Vectors& get_dynamics_multipliers() const { return inner_->get_Vx(); }
  void reset();  // resets the multipliers to zero and the penalty to its initial value
  /// Calls the problem's circularAppend. Multipliers move with their nodes; the new node has zero multipliers.
  void circularAppend(std::shared_ptr<ActionModelAbstract> model);
  void circularAppend(std::shared_ptr<ActionModelAbstract> model, std::shared_ptr<ActionDataAbstract> data);

  const std::shared_ptr<SolverDDP>& get_inner() const { return inner_; }  // the unconstrained solver
  double get_violation() const { return violation_; }                     // largest violation, after a solve
  /// Returns the KKT residual after a solve, in units of get_kkt_scale().
  double get_kkt_residual() const { return kkt_; }
  std::size_t get_outer_iter() const { return outer_; }        // minimisations of the last solve
  double get_penalty() const { return rho_; }                  // the current penalty
  double get_penalty_init() const { return rho_init_; }        // initial penalty
  double get_penalty_factor() const { return rho_factor_; }    // factor of increases of the penalty
  double get_penalty_max() const { return rho_max_; }          // largest penalty
  double get_th_constraint() const { return th_constraint_; }  // threshold of the violation
  double get_th_kkt() const { return th_kkt_; }                // threshold of the KKT residual
  /// Returns the number of separate minimisations of the violation in the last solve.
  std::size_t get_restorations() const { return restorations_; }
  /// Returns the size of the cost, as in SolverDDP. The penalties (set_penalty_init, set_penalty_max) and th_stop are
  /// multiplied by this size, and th_kkt by get_kkt_scale(). With set_measures_scale(true) a solve computes both
  /// numbers at its guess.
  double get_scale() const { return scale_; }
  double get_kkt_scale() const { return kkt_scale_; }  // the unit of gradients, as in SolverDDP
  void set_measures_scale(bool measures_scale) { measures_scale_ = measures_scale; }  // see SolverDDP

  /// Throw std::invalid_argument for numbers out of range.
  void set_penalty(double penalty);        // above 0
  void set_penalty_init(double penalty);   // above 0; also sets the current penalty; reset() restores it
  void set_penalty_factor(double factor);  // above 1
  void set_penalty_max(double penalty);    // above 0
  void set_th_constraint(double x) { internal::kTolerance.set(th_constraint_, x, "SolverAugmentedLagrangian"); }
  void set_th_kkt(double x) { internal::kTolerance.set(th_kkt_, x, "SolverAugmentedLagrangian"); }

 private:
  class Relay;  // callback of the unconstrained solver
  class Watch;  // callback of the minimisation of the violation
  /// The augmented Lagrangian of a node with constraints, or of a subproblem with constraints in ActionModelParts.
  struct Augmented {
    std::shared_ptr<ActionModelAugmentedLagrangian> model;
    std::shared_ptr<ActionDataAugmentedLagrangian> data;
    std::vector<int> rows;  // rows of the node's [g; h] in this model
  };
  struct Copy {  // a model and its data
    std::shared_ptr<ActionModelAbstract> model;
    std::shared_ptr<ActionDataAbstract> data;
  };
  struct Node {
    Copy own, copy;                    // the problem's node, and the node of the augmented Lagrangian
    std::vector<Augmented> augmented;  // empty if the node has no constraints; `copy` is then the problem's node
    Eigen::Index rows = 0;             // number of rows of the problem's [g; h]
  };
  Copy augment(const Copy& of, bool terminal, const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
               std::vector<Augmented>& out) const;
  Copy augment_leaf(const Copy& of, const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                    std::vector<Augmented>& out) const;
  Copy augment_parts(const ActionModelParts& whole, const ActionDataParts& data, bool terminal,
                     const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                     std::vector<Augmented>& out) const;
  struct Restoration;
  Restoration violationAlone(double met, std::size_t maxiter);
  void evaluate(Restoration& own);
  void regulariseLeast(Restoration& own);
  void leastViolation(Restoration& own);
  void level(Restoration& own);
  void take(Restoration& own);
  bool isBeyondLimits(Restoration& own);
  enum class Beside { kFalls, kComesBack, kUnclear };
  Beside lookBeside(Restoration& own, double by);
  double jacobianSize(Restoration& own);
  double violationSlope(Restoration& own);
  bool isStationary(Restoration& own);
  bool movesInLineFrom(const Vectors& us_before);
  void takeCostOf(double violation);
  StopReason restore(std::size_t maxiter);
  bool reportRestoration(const SolverAbstract& solver);
  Node decorated(std::size_t t, const Eigen::VectorXd& multipliers) const;
  void decorate();
  bool is_decorated() const;
  void collectParts();
  void start(const Vectors& init_xs, const Vectors& init_us, bool is_feasible);
  void minimise(std::size_t maxiter, double init_reg);
  void descend(std::size_t last, double init_reg);
  void takeCandidate();
  void reportIteration();
  void measureViolation();
  bool crawls();
  bool isSlow();
  void assess();
  StopReason judge(std::size_t maxiter);
  void startAgain();
  bool comesNoCloser(StopReason inner);
  void updateMultipliers();

  MakeSolver make_;
  bool augments_all_ = false;  // augments nodes and subproblems without constraints too
  std::shared_ptr<ShootingProblem> augmented_;
  std::shared_ptr<SolverDDP> inner_;
  std::vector<Node> nodes_;  // T + 1
  Eigen::VectorXd work_;
  double rho_init_ = 10, rho_ = 10, rho_factor_ = 10, rho_max_ = 1e9;
  double th_constraint_ = 1e-8, th_kkt_ = 1e-7;
  double tolerance_ = 0;  // stopping tolerance of the current minimisation
  double violation_ = 0, kkt_ = 0;
  double measure_ = 0, last_measure_ = 0;  // m of the last minimisation, and of the minimisation before it
  double last_violation_ = 0, best_kkt_ = 0;
  double window_merit_ = 0, window_violation_ = 0;
  int window_ = 0;                        // number of iterations of the current minimisation
  bool crawls_ = false;                   // the minimisation was ended because its reductions became too small
  std::array<double, 2> last_stops_{};    // `stop` of the previous two iterations
  double failed_stop_ = 0;                // `stop` when quasi-Newton steps failed in this minimisation, else infinite
  bool slow_ = false;                     // isSlow() ended the Gauss-Newton steps, to try quasi-Newton steps
  bool curved_ = false;                   // quasi-Newton steps replace Gauss-Newton steps
  StopReason ended_ = StopReason::kNone;  // why the minimisation ended
  bool moved_ = false;                    // the minimisation accepted a step
  int stuck_ = 0;                         // consecutive minimisations without progress
  int flat_ = 0;                          // consecutive minimisations in which dominating constraints made no progress
  std::size_t outer_ = 0, restorations_ = 0;
  double scale_ = 1, kkt_scale_ = 1;
  bool measures_scale_ = false;
};

}  // namespace manycontact
