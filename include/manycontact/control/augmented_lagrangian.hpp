#pragma once
// Problems with the nodes' constraints g_lb <= g <= g_ub, h = 0, by the method of multipliers: an unconstrained solver
// minimises the augmented Lagrangian (augmented_action.hpp) at fixed multipliers y and penalty rho; then
//
//     y <- y+,    rho <- 10 rho  where  m = max |y+ - y| / rho  fell by less than 10 times,
//
// until violation and KKT residual are small (Andreani, Birgin, Martinez, Schuverdt, SIAM J. Optim. 18, 2007; Nocedal &
// Wright 17.4). m is the violation, and for inequalities that do not bind the distance of y to zero. Since multipliers
// converge, constraints are met to rounding at a moderate penalty. A minimisation stops where its expected reduction is
// below rho/2 (0.09 m)^2, m of the one before: what is missed then moves constraints by about 0.09 m. It also stops
// where ten iterations gained less than a hundredth of what the constraints add to the cost.
//
// Gauss-Newton's Hessian lacks the constraints' and the dynamics' curvature, weighted by their multipliers. Where these
// are large (a hand at the end of its reach: the Hessian is five times Gauss-Newton's in some directions) its steps
// overshoot, and its minimisations converge slowly or not at all. Where `stop` fell by less than ten times in two
// iterations, and by less than three in the last, SolverDDP::descend goes on with what it learns of that curvature;
// where that fails too, the solver goes on until `stop` is ten times less.
//
// Where the violation comes no closer although the constraints outweigh the cost, they may be impossible, or the
// penalty too small yet, or the minimisation stuck. So the least violation is asked for, by a problem of its own
// (restoration.cpp): the same nodes at the cost 1/2 sum |c - P(c)|^2. Where it finds a point that meets the
// constraints, the method goes on from there. Where it ends at a stationary point, steps from beside that come back to
// it, and searches from some other motions find nothing less, the solve ends there as kInfeasible. (A nonconvex problem
// may have a lesser one all the same.) Stationary: with r the violations and C their Jacobian, C^T r is a millionth of
// |C| |r|, or a step of the linearised problem takes less than a millionth of |r|^2 off. Where it ends elsewhere
// nothing is shown: kNoStep, at the nearest that was found.
//
// In each iteration's report cost is the problem's, merit the augmented Lagrangian, gfeas and hfeas the violations
// after the step. What the first state alone decides (a constraint of node 0 on x0) nobody can meet but x0.

#include <array>
#include <functional>

#include "manycontact/control/augmented_action.hpp"
#include "manycontact/control/ddp.hpp"
#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/control/parts.hpp"

namespace manycontact {

class SolverAugmentedLagrangian : public SolverAbstract {  // constraints, by any of these solvers
 public:
  /// The unconstrained solver, of a problem it is given.
  using MakeSolver = std::function<std::shared_ptr<SolverDDP>(std::shared_ptr<ShootingProblem>)>;
  /// By SolverBoxFDDP where a model has control limits, else by SolverFDDP; by SolverSparse where nodes are
  /// ActionModelParts without matrices of their own.
  explicit SolverAugmentedLagrangian(std::shared_ptr<ShootingProblem> problem);
  SolverAugmentedLagrangian(std::shared_ptr<ShootingProblem> problem, const MakeSolver& make);
  ~SolverAugmentedLagrangian() override;
  SolverAugmentedLagrangian(const SolverAugmentedLagrangian&) = delete;
  SolverAugmentedLagrangian& operator=(const SolverAugmentedLagrangian&) = delete;

  /// Starts from the multipliers and the penalty at hand: those of the last solve, or as set. maxiter: iterations of
  /// all minimisations together. True when converged: violation <= get_th_constraint(), KKT residual <= get_th_kkt()
  /// and the stopping value < get_th_stop().
  bool solve(const std::vector<Eigen::VectorXd>& init_xs = DEFAULT_VECTOR,
             const std::vector<Eigen::VectorXd>& init_us = DEFAULT_VECTOR, std::size_t maxiter = 100,
             bool is_feasible = false, double init_reg = NAN) override;
  /// Those of the unconstrained solver, on the augmented Lagrangian. A class with its own is to be derived from that one
  /// (MakeSolver): here it would not be called.
  void computeDirection(bool recalc = true) final { inner_->computeDirection(recalc); }
  double tryStep(double steplength = 1) final { return inner_->tryStep(steplength); }
  double stoppingCriteria() final { return stop_ = inner_->stoppingCriteria(); }
  const Eigen::Vector2d& expectedImprovement() final { return d_ = inner_->expectedImprovement(); }
  void resizeData() override;

  /// Of each node's [g; h] (T + 1 vectors, empty where there are none): >= 0 at an upper bound, <= 0 at a lower one.
  std::vector<Eigen::VectorXd> get_multipliers() const;
  /// Throws std::invalid_argument where sizes do not fit.
  void set_multipliers(const std::vector<Eigen::VectorXd>& multipliers);
  /// Of the dynamics, as in kkt_residual: after a solve.
  const std::vector<Eigen::VectorXd>& get_dynamics_multipliers() const { return inner_->get_Vx(); }
  /// Forgets multipliers and penalty.
  void reset();
  /// The problem's circularAppend; multipliers move with their nodes, those of the new one are zero.
  void circularAppend(std::shared_ptr<ActionModelAbstract> model);
  void circularAppend(std::shared_ptr<ActionModelAbstract> model, std::shared_ptr<ActionDataAbstract> data);

  const std::shared_ptr<SolverDDP>& get_inner() const { return inner_; }
  double get_violation() const { return violation_; }    // largest, after a solve
  double get_kkt_residual() const { return kkt_; }       // after a solve
  std::size_t get_outer_iter() const { return outer_; }  // minimisations done by the last solve
  double get_penalty() const { return rho_; }
  double get_penalty_init() const { return rho_init_; }
  double get_penalty_factor() const { return rho_factor_; }
  double get_penalty_max() const { return rho_max_; }
  double get_th_constraint() const { return th_constraint_; }
  double get_th_kkt() const { return th_kkt_; }
  /// How often the last solve asked for the least violation alone.
  std::size_t get_restorations() const { return restorations_; }
  /// As SolverDDP's: the size of the cost, by which the penalties (set_penalty_init, set_penalty_max), th_stop and
  /// th_kkt are multiplied, measured at the guess of a solve where it may.
  double get_scale() const { return scale_; }
  void set_measures_scale(bool measures_scale) { measures_scale_ = measures_scale; }
  /// Throw std::invalid_argument for numbers out of range.
  void set_penalty(double penalty);              // > 0
  void set_penalty_init(double penalty);         // > 0; of new solvers, and after reset()
  void set_penalty_factor(double factor);        // > 1
  void set_penalty_max(double penalty);          // > 0
  void set_th_constraint(double th_constraint);  // > 0
  void set_th_kkt(double th_kkt);                // > 0

 private:
  class Relay;  // the unconstrained solver's callback
  class Watch;  // that of the least violation's
  /// A node with constraints, or such a part of ActionModelParts, within the augmented Lagrangian.
  struct Augmented {
    std::shared_ptr<ActionModelAugmentedLagrangian> model;
    std::shared_ptr<ActionDataAugmentedLagrangian> data;
    std::vector<int> rows;  // which of the node's [g; h] are its
  };
  struct Copy {  // a model, and its data
    std::shared_ptr<ActionModelAbstract> model;
    std::shared_ptr<ActionDataAbstract> data;
  };
  struct Node {
    Copy own, copy;                    // of the problem, and what became of it
    std::vector<Augmented> augmented;  // none without constraints: the problem's own node
    Eigen::Index rows = 0;             // of the problem's [g; h]
  };
  Copy augment(const Copy& of, bool terminal, const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
               std::vector<Augmented>& out) const;
  Copy augment_leaf(const Copy& of, const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                    std::vector<Augmented>& out) const;
  Copy augment_parts(const ActionModelParts& whole, const ActionDataParts& data, bool terminal,
                     const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                     std::vector<Augmented>& out) const;
  struct Restoration;
  Restoration violationAlone(double met);
  void evaluate(Restoration& own);
  void leastViolation(Restoration& own);
  void level(Restoration& own);
  void take(Restoration& own);
  enum class Beside { kFalls, kComesBack, kUnclear };
  Beside lookBeside(Restoration& own, double by);
  double jacobianSize(Restoration& own);
  double violationSlope(Restoration& own);
  bool isStationary(Restoration& own);
  bool movesInLineFrom(const std::vector<Eigen::VectorXd>& us_before);
  void takeCostOf(double violation);
  StopReason restore(std::size_t maxiter);
  bool reportRestoration(const SolverAbstract& solver);
  Node decorated(std::size_t t, const Eigen::VectorXd& multipliers) const;
  void decorate();
  bool is_decorated() const;
  void collectParts();
  void start(const std::vector<Eigen::VectorXd>& init_xs, const std::vector<Eigen::VectorXd>& init_us,
             bool is_feasible);
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
  bool augments_all_ = false;  // nodes and parts without constraints too
  std::shared_ptr<ShootingProblem> augmented_;
  std::shared_ptr<SolverDDP> inner_;
  std::vector<Node> nodes_;  // T + 1
  Eigen::VectorXd work_;
  double rho_init_ = 10, rho_ = 10, rho_factor_ = 10, rho_max_ = 1e9;
  double th_constraint_ = 1e-8, th_kkt_ = 1e-7;
  double tolerance_ = 0;  // of the minimisation at hand
  double violation_ = 0, kkt_ = 0;
  double measure_ = 0, last_measure_ = 0;  // m of the minimisation just done, of the one before
  double last_violation_ = 0, best_kkt_ = 0;
  double window_merit_ = 0, window_violation_ = 0;
  int window_ = 0;                        // iterations of the minimisation
  bool crawls_ = false;                   // it was ended for that
  std::array<double, 2> last_stops_{};    // of the two iterations before
  double failed_stop_ = 0;                // where quasi-Newton steps failed, of this minimisation
  bool slow_ = false;                     // the solver was ended for that
  bool curved_ = false;                   // quasi-Newton steps serve
  StopReason ended_ = StopReason::kNone;  // of the minimisation
  bool moved_ = false;                    // the minimisation accepted a step
  int stuck_ = 0;                         // minimisations in a row that brought nothing
  int flat_ = 0;                          // that brought constraints no closer, though these outweigh the cost
  std::size_t outer_ = 0, total_ = 0, restorations_ = 0;
  double scale_ = 1;
  bool measures_scale_ = false;
};

}  // namespace manycontact
