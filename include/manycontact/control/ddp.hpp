#pragma once
// Differential dynamic programming. The backward pass solves the linear-quadratic problem around the candidate xs, us
// with gaps fs. V' is the value function V of node t + 1, rho the regularisation. From V_T = l_T, for t = T - 1 ... 0:
//
//     Qx  = lx  + fx^T Vx'        Qu  = lu  + fu^T Vx'
//     Qxx = lxx + fx^T Vxx' fx    Qxu = lxu + fx^T Vxx' fu    Quu = luu + fu^T Vxx' fu + rho I
//     k = Quu^-1 Qu,  K = Quu^-1 Qxu^T
//     Vxx = Qxx - Qxu K + rho I,  Vx = Qx - K^T Qu  (+ Vxx fs_t if the candidate has gaps)
//
// The forward pass of step length s simulates u = us - s k - K (x (-) xs) from x0; the simulated motion has no gaps.
// Interface, algorithm and defaults are those of Crocoddyl 3.0's SolverDDP (Tassa et al., ICRA 2014; Mastalli et al.,
// ICRA 2020).

#include "manycontact/control/solver.hpp"
#include "manycontact/detail/control/limited_bfgs.hpp"

namespace manycontact {

class Direction;  // computes a search direction
class RiccatiDirection;
struct ShootingPart;

class SolverDDP : public SolverAbstract {  // Differential dynamic programming.
 public:
  using MatrixXdRowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Throws std::invalid_argument if `problem` is null.
  explicit SolverDDP(std::shared_ptr<ShootingProblem> problem) : SolverDDP(std::move(problem), Limits::kIgnored) {}
  SolverDDP(SolverDDP&&);  // moves the solver
  SolverDDP& operator=(SolverDDP&&);
  ~SolverDDP() override;

  bool solve(const Vectors& init_xs = DEFAULT_VECTOR, const Vectors& init_us = DEFAULT_VECTOR,
             std::size_t maxiter = 100, bool is_feasible = false, double init_reg = NAN) override;
  void computeDirection(bool recalc = true) override;
  double tryStep(double steplength = 1) override;
  /// Returns the expected reduction by a full step, |d0 + d1 / 2|. A larger regularisation makes this value smaller, so
  /// that a solve has converged only if the value is also small at the least regularisation.
  double stoppingCriteria() override;
  const Eigen::Vector2d& expectedImprovement() override;
  void resizeData() override;

  /// Computes the derivatives of all nodes at the candidate, and the candidate's infeasibilities; returns the cost.
  virtual double calcDiff();
  /// Computes the search direction. If it fails, direction_is_sound() is false, and the direction is unusable.
  virtual void backwardPass();
  bool direction_is_sound() const { return sound_; }
  /// Computes xs_try, us_try and cost_try for a step length in [0, 1]. cost_try is NaN if numbers are not finite.
  virtual void forwardPass(double steplength);
  /// Computes Qx, Qu, Qxx, Qxu, Quu of node t, in SolverSparse for each subproblem. This function, computeGains and
  /// computeValueFunction are for inspection: the backward pass does not call them. Therefore they are final.
  virtual void computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model,
                                          const std::shared_ptr<ActionDataAbstract>& data) final;
  /// Compute Vx, Vxx, or k, K of node t. Throw std::invalid_argument unless computeActionValueFunction was last called
  /// for t.
  virtual void computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model) final;
  virtual void computeGains(std::size_t t) final;
  virtual void increaseRegularization();
  virtual void decreaseRegularization();
  virtual void allocateData();
  /// Takes quasi-Newton steps in the feed-forward terms nu, from a candidate without gaps. They end when `stop`, the
  /// reduction of the cost that the Gauss-Newton model predicts, is below th_stop. The steps suit problems whose
  /// constraints and dynamics have a curvature that Gauss-Newton neglects. If the Hessian is more than twice that of
  /// Gauss-Newton, full Gauss-Newton steps diverge, and shorter ones converge slowly. The controls are
  ///
  ///     u = us + nu - K (x (-) xs),    K and Quu of one backward pass.
  ///
  /// L-BFGS (detail/control/limited_bfgs.hpp) starts from the Gauss-Newton Hessian with respect to nu, diag(Quu). The
  /// gradient g is exact. The costates are p and p' (of node t + 1), with p_T = lx_T:
  ///
  ///     g = lu + fu^T p',    p = lx + fx^T p' - K^T g.
  ///
  /// Steps satisfy Armijo's condition. Steps that gain less than the rounding error of the cost satisfy the slope
  /// condition of Hager and Zhang (SIAM J. Optim. 16, 2005, (4.1)). Callbacks are called after each step. The result is
  /// kNoStep also if steps remain short: the candidate is then too far from the solution for one backward pass.
  StopReason descend(std::size_t maxiter);
  void allocateDescent();  // allocates the memory of `descend` before its first call
  /// Sets whether a solve checks its result; true initially. With control limits, the check is that of box_solvers.hpp.
  /// Otherwise the solve computes the stopping value again at the least regularisation. Use false if an outer solver
  /// checks the result.
  void set_judges(bool judges) { judges_ = judges; }
  bool keeps_limits() const { return limits_; }  // whether controls stay within the models' limits
  bool has_stepped() const { return stepped_; }  // whether the last iteration took a step
  /// Returns whether the last solve with limits accepted no step from a candidate with gaps, and therefore continued
  /// from a simulation of the guess's controls. Directions from a candidate with gaps ignore the limits, as in
  /// Crocoddyl.
  bool has_rolled_out() const { return rolled_out_; }
  /// Returns the expected reduction of the cost by a full step along the direction, for a candidate without gaps.
  double expectedReduction() const;
  /// Returns the search directions: one for the whole problem, or one per subproblem in SolverSparse.
  const std::vector<std::unique_ptr<Direction>>& directions() const { return directions_; }

  /// Returns the size of the cost, initially 1. Thresholds and limits of the regularisation (th_stop, th_grad, th_kkt,
  /// reg_min, reg_max) are multiplied by this size, so that a common factor of all weights does not change the motion.
  double get_scale() const { return scale_; }
  void set_scale(double scale);  // above 0, or std::invalid_argument is thrown
  /// Returns whether a solve computes the scale from the Hessians at its guess (1 for costs of ordinary size).
  /// Initially false: regularisations are then Crocoddyl's for costs of any size, and only th_kkt is multiplied by
  /// get_kkt_scale().
  bool get_measures_scale() const { return measures_scale_; }
  void set_measures_scale(bool measures_scale) { measures_scale_ = measures_scale; }
  /// Returns the unit of the cost's gradients in KKT residuals: the value of set_scale, or a value that a solve
  /// measures. The measured value is the geometric mean of the smallest Hessian of controls, at any node, and the
  /// largest Hessian. It is proportional to the cost, so that a common factor of all weights does not change whether a
  /// solve converges.
  double get_kkt_scale() const { return kkt_scale_; }

  double get_reg_incfactor() const { return reg_incfactor_; }        // factor of increases of the regularisation
  double get_reg_decfactor() const { return reg_decfactor_; }        // factor of decreases of the regularisation
  double get_reg_min() const { return reg_min_; }                    // smallest regularisation
  double get_reg_max() const { return reg_max_; }                    // largest regularisation
  const std::vector<double>& get_alphas() const { return alphas_; }  // step lengths that are tried
  double get_th_stepdec() const { return th_stepdec_; }  // the regularisation decreases above this step length
  double get_th_stepinc() const { return th_stepinc_; }  // the regularisation increases below this step length
  double get_th_grad() const { return th_grad_; }        // threshold of the gradient, below which a step is accepted
  double get_th_kkt() const { return th_kkt_; }          // threshold of the KKT residual
  /// Returns the candidate's KKT residual [get_kkt_scale()], computed with least_squares_multipliers; NaN if not
  /// computed.
  double get_kkt_residual() const { return kkt_; }
  /// Returns the number of steps after th_stop was met, until the KKT residual was below th_kkt, without calls of
  /// callbacks.
  std::size_t get_polishing_iter() const { return polishing_; }
  /// Returns the T + 1 matrices Vxx of the backward pass. With several subproblems, directions() has all results except
  /// Vx and k.
  const std::vector<Eigen::MatrixXd>& get_Vxx() const;
  const std::vector<Eigen::MatrixXd>& get_Qxx() const;  // T Hessians of the action value, ndx x ndx
  const std::vector<Eigen::MatrixXd>& get_Qxu() const;  // T Hessians of the action value, ndx x nu
  const std::vector<Eigen::MatrixXd>& get_Quu() const;  // T Hessians of the action value, nu x nu
  const Vectors& get_Qx() const;                        // T gradients of the action value (ndx)
  const Vectors& get_Qu() const;                        // T gradients of the action value (nu)
  const std::vector<MatrixXdRowMajor>& get_K() const;   // T feedback gains, nu x ndx
  const Vectors& get_Vx() const { return Vx_; }         // gradients of the value function (T + 1)
  const Vectors& get_k() const { return k_; }           // feed-forward terms (T)

  /// Throw std::invalid_argument for numbers out of range.
  void set_reg_incfactor(double x) { internal::kAboveOne.set(reg_incfactor_, x, "SolverDDP::set_reg_incfactor"); }
  void set_reg_decfactor(double x) { internal::kAboveOne.set(reg_decfactor_, x, "SolverDDP::set_reg_decfactor"); }
  void set_reg_min(double x) { internal::kNotNegative.set(reg_min_, x, "SolverDDP::set_reg_min"); }
  void set_reg_max(double x) { internal::kNotNegative.set(reg_max_, x, "SolverDDP::set_reg_max"); }
  void set_alphas(const std::vector<double>& alphas);  // positive and decreasing
  void set_th_stepdec(double x) { internal::kShare.set(th_stepdec_, x, "SolverDDP::set_th_stepdec"); }
  void set_th_stepinc(double x) { internal::kShare.set(th_stepinc_, x, "SolverDDP::set_th_stepinc"); }
  void set_th_grad(double x) { internal::kNotNegative.set(th_grad_, x, "SolverDDP::set_th_grad"); }

  /// Sets th_kkt, the largest KKT residual (kkt_residual.hpp) of a converged solve (> 0; initially infinite). When
  /// th_stop is met, a solve continues until the KKT residual is small too, for at most maxiter further steps. If no
  /// step reduces the cost, the KKT residual alone decides whether the candidate is optimal.
  void set_th_kkt(double x) { internal::kTolerance.set(th_kkt_, x, "SolverDDP::set_th_kkt"); }

 protected:
  /// Whether control limits are used.
  enum class Limits { kIgnored, kKept };
  /// Throws std::invalid_argument if `problem` is null.
  SolverDDP(std::shared_ptr<ShootingProblem> problem, Limits limits);
  /// Makes a solver without directions, for derived classes that create the directions themselves.
  SolverDDP(std::shared_ptr<ShootingProblem> problem, Limits limits, WithoutMatrices);
  /// Initialises the candidate and the regularisation.
  void start(const Vectors& init_xs, const Vectors& init_us, bool is_feasible, double init_reg);
  /// Prepares the expected improvement; called after a new direction was computed, before steps are tried.
  virtual void prepareImprovement() { d_ = Eigen::Vector2d(expectedImprovement()); }
  virtual void updateImprovement() {}  // updates the expected improvement after each tried step
  /// Returns whether the tried step is accepted, from the actual and the expected reduction of the cost, dV and dVexp.
  virtual bool accepts() const;
  virtual bool closesGaps() const { return true; }  // whether an accepted step closes all gaps
  bool findDirection(bool recalc);  // computes a direction; increases the regularisation until this succeeds
  bool searchLine();                // tries steps along the direction; returns whether one was accepted
  bool adaptRegularization();  // adapts the regularisation to the last step; returns whether it is below its maximum
  StopReason iterate(std::size_t first,
                     std::size_t maxiter);              // Crocoddyl's iterations from number `first` on, and polish
  StopReason polish(std::size_t maxiter);               // continues until the KKT residual is below th_kkt
  StopReason descendWithinLimits(std::size_t maxiter);  // continues with `descend`, within control limits
  bool isOptimalWithinLimits();                         // whether the projected gradient predicts no reduction
  bool stopsUnregularised();      // whether the stopping value is also small at the least regularisation
  StopReason judgeWithoutStep();  // decides the result after no step was accepted
  /// Calls work(direction) for every subproblem, in parallel.
  template <class Work>
  void each_direction(Work&& work);
  /// Computes xs_try, us_try and cost_try. keep_gaps, keep_terminal_gap: the gaps of the running nodes, or that of the
  /// terminal node, are multiplied by 1 - steplength; otherwise they are closed.
  void rollOut(double steplength, bool keep_gaps, bool keep_terminal_gap);
  /// Returns the sum of (dg, dq) of Direction::improvement over the directions; `gaps`: with the contributions of gaps.
  Eigen::Vector2d improvement(bool gaps);
  void setFeedForward(const Vectors& nu);  // sets k = -nu for the next forward passes of `descend`
  /// Computes the gradient g of `descend` at us_try. g is zero for controls at a limit that a step would exceed.
  void computeFeedForwardGradient(Vectors& g);
  void preconditionFeedForward(Vectors& g);  // g <- diag(Quu)^-1 g
  /// Projects the guessed controls onto the limits. A guess without gaps has gaps if the projection changes it.
  void limitGuess();
  /// If the search ended with gaps, makes a simulation of the guess's controls the candidate, and returns true.
  bool rollOutCandidate();

  std::vector<std::unique_ptr<Direction>> directions_;
  double reg_incfactor_ = 10, reg_decfactor_ = 10, reg_min_ = 1e-9, reg_max_ = 1e9;
  double scale_ = 1, kkt_scale_ = 1;
  bool measures_scale_ = false, judges_ = true;
  double cost_try_ = 0;
  Vectors xs_try_, us_try_, us_guess_;
  Vectors Vx_, k_;  // gradients of the value function (T + 1) and feed-forward terms (T)
  std::vector<double> alphas_;
  double th_grad_ = 1e-12, th_stepdec_ = 0.5, th_stepinc_ = 0.01;
  double th_kkt_ = std::numeric_limits<double>::infinity(), kkt_ = NAN;
  std::size_t polishing_ = 0;
  bool sound_ = false, stepped_ = false, rolled_out_ = false;
  bool held_changed_ = false;  // the last gradient has other controls at limits than the gradient before it

 private:
  void measureScale();
  void takeCandidate(Direction& direction) const;
  const RiccatiDirection* recursion() const;
  template <class Work>
  void each_feed_forward(Vectors& whole, Work&& work);
  /// Sets the components of nu to zero whose controls were at a limit at the last gradient.
  void holdFeedForward(Vectors& nu);
  void computeFeedForwardDirection();
  bool searchFeedForward();
  bool limits_;
  LimitedBfgs bfgs_;
  Vectors nu_, g_, g_try_;  // direction and gradients of descend
  double slope_ = 0;        // g^T nu
};

}  // namespace manycontact
