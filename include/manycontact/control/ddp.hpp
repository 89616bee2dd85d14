#pragma once
// Differential dynamic programming. The backward pass solves the linear-quadratic problem around the candidate: from
// V_T = l_T, for t = T - 1 ... 0, with V' of t + 1 and the regularisation rho (of Vxx and Quu),
//
//     Qx  = lx  + fx^T Vx'        Qu  = lu  + fu^T Vx'
//     Qxx = lxx + fx^T Vxx' fx    Qxu = lxu + fx^T Vxx' fu    Quu = luu + fu^T Vxx' fu + rho I
//     k = Quu^-1 Qu,  K = Quu^-1 Qxu^T
//     Vxx = Qxx - Qxu K + rho I,  Vx = Qx - K^T Qu  (+ Vxx fs_t where the candidate has gaps)
//
// and the forward pass of step length s rolls u = us - s k - K (x (-) xs) out from x0, closing all gaps. Interface,
// algorithm and defaults of Crocoddyl 3.0's SolverDDP (Tassa, Mansard, Todorov, ICRA 2014; Mastalli et al., ICRA 2020).

#include "manycontact/control/limited_bfgs.hpp"
#include "manycontact/control/solver.hpp"

namespace manycontact {

class Direction;  // how a step is found
class RiccatiDirection;
struct ShootingPart;

class SolverDDP : public SolverAbstract {  // differential dynamic programming
 public:
  using MatrixXdRowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  explicit SolverDDP(std::shared_ptr<ShootingProblem> problem);
  SolverDDP(SolverDDP&&);
  SolverDDP& operator=(SolverDDP&&);
  ~SolverDDP() override;

  bool solve(const std::vector<Eigen::VectorXd>& init_xs = DEFAULT_VECTOR,
             const std::vector<Eigen::VectorXd>& init_us = DEFAULT_VECTOR, std::size_t maxiter = 100,
             bool is_feasible = false, double init_reg = NAN) override;
  void computeDirection(bool recalc = true) override;
  double tryStep(double steplength = 1) override;
  /// |d0 + d1 / 2|, the expected reduction of a full step.
  double stoppingCriteria() override;
  const Eigen::Vector2d& expectedImprovement() override;
  void resizeData() override;

  /// Derivatives of all nodes at the candidate, and its feasibilities; returns the cost.
  virtual double calcDiff();
  /// Where it fails, direction_is_sound() is false and what it leaves is of no use.
  virtual void backwardPass();
  bool direction_is_sound() const { return sound_; }
  /// xs_try, us_try and cost_try, which is NaN where numbers are not finite. The step length is in [0, 1].
  virtual void forwardPass(double steplength);
  /// A node's step of the backward pass; of SolverSparse every part's, which are of its own nodes. These three are for
  /// looking at: backwardPass does not call them, so that no class can have its own. backwardPass is what to override.
  virtual void computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model,
                                          const std::shared_ptr<ActionDataAbstract>& data) final;
  /// Of the node that computeActionValueFunction was last of, else std::invalid_argument.
  virtual void computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model) final;
  virtual void computeGains(std::size_t t) final;
  virtual void increaseRegularization();
  virtual void decreaseRegularization();
  virtual void allocateData();
  /// Goes on from the candidate, which has no gaps, by quasi-Newton steps on the feed-forward terms, until `stop`, what
  /// Gauss-Newton expects to gain, is below th_stop. For problems with curvature that Gauss-Newton does not see, that
  /// of nonlinear constraints and dynamics by their multipliers: where the Hessian is more than twice Gauss-Newton's,
  /// full steps overshoot so far that they diverge, and shorter ones converge slowly. In
  ///
  ///     u = us + nu - K (x (-) xs),    K and Quu of one backward pass,
  ///
  /// Gauss-Newton's Hessian by nu is diag(Quu) (complete the squares of the backward pass), from which L-BFGS starts
  /// (limited_bfgs.hpp); the gradient is exact, with p_T = lx_T,
  ///
  ///     g = lu + fu^T p',    p = lx + fx^T p' - K^T g.
  ///
  /// Steps meet Armijo's condition; where they gain less than the cost's rounding, the slope's of Hager and Zhang (SIAM
  /// J. Optim. 16, 2005, (4.1)). Callbacks are called after each, as in solve. kNoStep also where steps stay short: the
  /// candidate is too far for one backward pass to serve.
  StopReason descend(std::size_t maxiter);
  /// The memory of `descend`, which takes it at its first call otherwise.
  void allocateDescent();
  /// Whether a solve that keeps limits examines its own verdict (box_solvers.hpp): unless another solver does.
  void set_judges(bool judges) { judges_ = judges; }
  /// Whether controls stay within the models' limits.
  bool keeps_limits() const { return limits_; }
  /// Whether the last iteration took a step.
  bool has_stepped() const { return stepped_; }
  /// Whether the last solve, of a solver that keeps limits, found no step from a candidate with gaps and went on from
  /// the motion of the guess's controls: Crocoddyl's rule plans as if there were no limits until the gaps are closed,
  /// which tight limits never let happen.
  bool has_rolled_out() const { return rolled_out_; }
  /// What a full step is expected to reduce the cost by, at the direction of a candidate without gaps.
  double expectedReduction() const;
  /// One, of the whole; of SolverSparse one for each part.
  const std::vector<std::unique_ptr<Direction>>& directions() const { return directions_; }

  /// The size of the cost. Thresholds and the limits of the regularisation are numbers for a cost whose Hessian is of
  /// ordinary size; they are multiplied by it (th_stop, th_grad, th_kkt, reg_min, reg_max), so that the weights of a
  /// problem times a number give the same motion. 1 at first.
  double get_scale() const { return scale_; }
  void set_scale(double scale);  // > 0, or std::invalid_argument
  /// Whether a solve sets it by the Hessians at its guess (cost_scale.hpp): 1 at ordinary sizes. Not at first, so that
  /// regularisations are Crocoddyl's at every size.
  bool get_measures_scale() const { return measures_scale_; }
  void set_measures_scale(bool measures_scale) { measures_scale_ = measures_scale; }

  double get_reg_incfactor() const { return reg_incfactor_; }
  double get_reg_decfactor() const { return reg_decfactor_; }
  double get_reg_min() const { return reg_min_; }
  double get_reg_max() const { return reg_max_; }
  const std::vector<double>& get_alphas() const { return alphas_; }
  double get_th_stepdec() const { return th_stepdec_; }
  double get_th_stepinc() const { return th_stepinc_; }
  double get_th_grad() const { return th_grad_; }
  double get_th_kkt() const { return th_kkt_; }
  /// Of the candidate, with least_squares_multipliers, where a solve looked at it; else NaN.
  double get_kkt_residual() const { return kkt_; }
  /// Steps after the stopping rule was met, to a KKT residual below th_kkt. Callbacks do not see them.
  std::size_t get_polishing_iter() const { return polishing_; }
  /// Of several parts: their directions have Vxx and K, and what stands with these; here they are empty.
  const std::vector<Eigen::MatrixXd>& get_Vxx() const;
  const std::vector<Eigen::MatrixXd>& get_Qxx() const;
  const std::vector<Eigen::MatrixXd>& get_Qxu() const;
  const std::vector<Eigen::MatrixXd>& get_Quu() const;
  const std::vector<Eigen::VectorXd>& get_Qx() const;
  const std::vector<Eigen::VectorXd>& get_Qu() const;
  const std::vector<MatrixXdRowMajor>& get_K() const;
  const std::vector<Eigen::VectorXd>& get_Vx() const { return Vx_; }
  const std::vector<Eigen::VectorXd>& get_k() const { return k_; }
  /// Throw std::invalid_argument for numbers out of range.
  void set_reg_incfactor(double reg_factor);           // > 1
  void set_reg_decfactor(double reg_factor);           // > 1
  void set_reg_min(double regmin);                     // >= 0
  void set_reg_max(double regmax);                     // >= 0
  void set_alphas(const std::vector<double>& alphas);  // positive, falling
  void set_th_stepdec(double th_step);                 // in (0, 1]
  void set_th_stepinc(double th_step);                 // in (0, 1]
  void set_th_grad(double th_grad);                    // >= 0
  /// > 0, infinite at first: where th_stop is met, a solve goes on until the KKT residual (kkt_residual.hpp) is not
  /// above it, for at most maxiter steps more. (The stopping value is an energy, in the unit of the cost.) Where no
  /// step gains anything, it alone says whether that is the optimum.
  void set_th_kkt(double th_kkt);

 protected:
  enum class Limits { kIgnored, kKept };
  SolverDDP(std::shared_ptr<ShootingProblem> problem, Limits limits);
  /// For solvers that make the directions themselves.
  SolverDDP(std::shared_ptr<ShootingProblem> problem, Limits limits, WithoutMatrices);
  /// Sets up the candidate and the regularisation.
  void start(const std::vector<Eigen::VectorXd>& init_xs, const std::vector<Eigen::VectorXd>& init_us, bool is_feasible,
             double init_reg);
  /// After a new direction, before steps are tried; and after each of them.
  virtual void prepareImprovement() { d_ = Eigen::Vector2d(expectedImprovement()); }
  virtual void updateImprovement() {}
  /// Whether the step tried is accepted, by dV and dVexp, and if so whether its states are feasible.
  virtual bool accepts() const;
  virtual bool closesGaps() const { return true; }
  bool findDirection(bool recalc);
  bool searchLine();
  bool adaptRegularization();
  StopReason polish(std::size_t maxiter);
  StopReason descendWithinLimits(std::size_t maxiter);
  bool isOptimalWithinLimits();
  StopReason judgeWithoutStep();
  /// Of every part, in parallel: work(direction).
  template <class Work>
  void each_direction(Work&& work);
  /// xs_try, us_try and cost_try, with the gaps of the running nodes (of the terminal one) shortened by the step length
  /// only.
  void rollOut(double steplength, bool keep_gaps, bool keep_terminal_gap);
  /// The sum of the directions' dg and dq; gaps: with what they add.
  Eigen::Vector2d improvement(bool gaps);
  /// Of `descend`: k = -nu, for the next forward passes.
  void setFeedForward(const std::vector<Eigen::VectorXd>& nu);
  /// g at us_try, where nodes are differentiated; zero of controls that stand at a limit and would leave it.
  void computeFeedForwardGradient(std::vector<Eigen::VectorXd>& g);
  /// g <- diag(Quu)^-1 g
  void preconditionFeedForward(std::vector<Eigen::VectorXd>& g);
  /// The guess us onto the limits that are kept; without gaps it is one no longer where that changes it.
  void limitGuess();
  /// Whether the search ended with gaps left and the motion of the guess's controls became the candidate.
  bool rollOutCandidate();

  std::vector<std::unique_ptr<Direction>> directions_;
  double reg_incfactor_ = 10, reg_decfactor_ = 10, reg_min_ = 1e-9, reg_max_ = 1e9;
  double scale_ = 1;
  bool measures_scale_ = false, judges_ = true;
  double cost_try_ = 0;
  std::vector<Eigen::VectorXd> xs_try_, us_try_, us_guess_;
  std::vector<Eigen::VectorXd> Vx_, k_;  // T + 1, T
  std::vector<double> alphas_;
  double th_grad_ = 1e-12, th_stepdec_ = 0.5, th_stepinc_ = 0.01;
  double th_kkt_ = std::numeric_limits<double>::infinity(), kkt_ = NAN;
  std::size_t polishing_ = 0;
  bool sound_ = false, stepped_ = false, rolled_out_ = false;
  bool held_changed_ = false;  // other controls stand at limits than at the gradient before

 private:
  void measureScale();
  void takeCandidate(Direction& direction) const;
  const RiccatiDirection* recursion() const;
  template <class Work>
  void each_feed_forward(std::vector<Eigen::VectorXd>& whole, Work&& work);
  /// Sets to zero what the last gradient has as zero for limits.
  void holdFeedForward(std::vector<Eigen::VectorXd>& nu);
  void computeFeedForwardDirection();
  bool searchFeedForward();
  bool limits_;
  LimitedBfgs bfgs_;
  std::vector<Eigen::VectorXd> nu_, g_, g_try_;  // of descend: direction, gradients
  double slope_ = 0;                             // g^T nu
};

}  // namespace manycontact
