#pragma once
// The common base of solvers of a ShootingProblem. It stores thresholds, callbacks, and the candidate xs, us with gaps
//
//     fs_0 = x0 (-) xs_0,    fs_(t+1) = f_t(xs_t, us_t) (-) xs_(t+1).
//
// The interface is that of Crocoddyl's SolverAbstract. A numerical failure is not an exception: solve() returns false,
// and reason() is the cause. Wrong arguments throw std::invalid_argument.

#include <cmath>
#include <memory>
#include <vector>

#include "manycontact/control/shooting.hpp"

namespace manycontact {

class CallbackAbstract;
inline const std::vector<Eigen::VectorXd> DEFAULT_VECTOR;

/// The norm of infeasibilities: largest entry, or sum of absolute values.
enum FeasibilityNorm { LInf = 0, L1 };

/// Why a solver stopped.
enum class StopReason {
  kNone,         // solve() has not run
  kConverged,    // feasible, stopping value below th_stop, and further criteria of the solver are met
  kIterations,   // maxiter iterations were made
  kNoDirection,  // no descent direction at the largest regularisation: non-finite numbers, or Quu not positive definite
  kNoStep,       // no step along a direction was accepted, up to the largest regularisation
  kInterrupted,  // interrupt() was called
  kInfeasible,   // constraints are violated, and no search from the result found a smaller violation
};
const char* to_string(StopReason reason);  // describes the reason in words

class SolverAbstract {  // The common base of solvers. Use one per thread.
 public:
  using Vectors = std::vector<Eigen::VectorXd>;

  /// Throws std::invalid_argument if `problem` is null.
  explicit SolverAbstract(std::shared_ptr<ShootingProblem> problem);
  virtual ~SolverAbstract() = default;

  /// Solves the problem from the candidate init_xs (T + 1 states; empty: the states' zeros), init_us (T controls;
  /// empty: zeros), with at most maxiter iterations. `is_feasible` states that init_xs is the simulation of init_us,
  /// without gaps; the flag is ignored if there are gaps. `init_reg` is the initial regularisation, NaN for the
  /// smallest. Returns true if converged; otherwise see reason(). Throws std::invalid_argument for wrong sizes.
  /// get_xs() and get_us() return the result until the next solve.
  virtual bool solve(const Vectors& init_xs = DEFAULT_VECTOR, const Vectors& init_us = DEFAULT_VECTOR,
                     std::size_t maxiter = 100, bool is_feasible = false, double init_reg = NAN) = 0;
  /// Computes the search direction: solves the linear-quadratic problem around the candidate. recalc: whether the
  /// candidate's derivatives are computed first.
  virtual void computeDirection(bool recalc) = 0;
  /// Tries a step along the direction; returns the reduction of the cost, or NaN if numbers are not finite there.
  virtual double tryStep(double steplength = 1) = 0;
  virtual double stoppingCriteria() = 0;
  /// Computes d = (d0, d1): the expected reduction of the cost by a step of length s is s (d0 + s d1 / 2).
  virtual const Eigen::Vector2d& expectedImprovement() = 0;
  virtual void resizeData();  // adapts the memory to the problem's nodes

  /// Compute the norm get_feasnorm() of gaps (stored in fs), violations of g's bounds, and h, after problem.calc.
  double computeDynamicFeasibility();
  double computeInequalityFeasibility();
  double computeEqualityFeasibility();
  void setCandidate(const Vectors& xs_warm = DEFAULT_VECTOR, const Vectors& us_warm = DEFAULT_VECTOR,
                    bool is_feasible = false);
  /// The functions that are called after each iteration. If a callback sets another list, that list is used from the
  /// next iteration.
  using Callbacks = std::vector<std::shared_ptr<CallbackAbstract>>;
  void setCallbacks(const Callbacks& callbacks);
  const Callbacks& getCallbacks() const { return *callbacks_; }
  /// Ends solve() after the current iteration. A callback may call it.
  void interrupt() { interrupted_ = true; }
  StopReason reason() const { return reason_; }

  const std::shared_ptr<ShootingProblem>& get_problem() const { return problem_; }  // the problem that is solved
  const Vectors& get_xs() const { return xs_; }                                     // states of the candidate (T + 1)
  const Vectors& get_us() const { return us_; }                                     // controls of the candidate (T)
  const Vectors& get_fs() const { return fs_; }                                     // gaps of the candidate (T + 1)
  bool get_is_feasible() const { return is_feasible_; }                             // whether the candidate has no gaps
  double get_cost() const { return cost_; }                                         // cost of the candidate
  double get_merit() const { return merit_; }                                       // the merit function
  double get_stop() const { return stop_; }                                         // the stopping value
  const Eigen::Vector2d& get_d() const { return d_; }                               // the expected improvement (d0, d1)
  double get_dV() const { return dV_; }                                             // reduction of the cost
  double get_dPhi() const { return dPhi_; }                                         // reduction of the merit
  double get_dVexp() const { return dVexp_; }                                       // expected reduction of the cost
  double get_dPhiexp() const { return dPhiexp_; }                                   // expected reduction of the merit
  double get_dfeas() const { return dfeas_; }                                       // reduction of the infeasibility
  double get_feas() const { return feas_; }                                         // total infeasibility
  double get_ffeas() const { return ffeas_; }                                       // norm of the candidate's gaps
  double get_gfeas() const { return gfeas_; }                                       // violation of the candidate's g
  double get_hfeas() const { return hfeas_; }                                       // norm of the candidate's h
  double get_ffeas_try() const { return ffeas_try_; }          // norm of the gaps after the tried step
  double get_gfeas_try() const { return gfeas_try_; }          // violation of g after the tried step
  double get_hfeas_try() const { return hfeas_try_; }          // norm of h after the tried step
  double get_preg() const { return preg_; }                    // regularisation of the primal variables
  double get_dreg() const { return dreg_; }                    // regularisation of the dual variables
  double get_steplength() const { return steplength_; }        // length of the last step
  double get_th_acceptstep() const { return th_acceptstep_; }  // share of the expected reduction that accepts a step
  double get_th_stop() const { return th_stop_; }              // threshold of the stopping value
  double get_th_gaptol() const { return th_gaptol_; }          // threshold of gaps
  FeasibilityNorm get_feasnorm() const { return feasnorm_; }   // norm of infeasibilities
  std::size_t get_iter() const { return iter_; }               // number of iterations
  /// Sets the candidate states (T + 1); throws std::invalid_argument for wrong sizes.
  void set_xs(const Vectors& xs);
  /// Sets the candidate controls (T); throws std::invalid_argument for wrong sizes.
  void set_us(const Vectors& us);

  /// Throw std::invalid_argument for numbers out of range.
  void set_preg(double x) { internal::kNotNegative.set(preg_, x, "Solver::set_preg"); }
  void set_dreg(double x) { internal::kNotNegative.set(dreg_, x, "Solver::set_dreg"); }
  void set_th_acceptstep(double x) { internal::kShare.set(th_acceptstep_, x, "Solver::set_th_acceptstep"); }
  void set_th_stop(double x) { internal::kPositive.set(th_stop_, x, "Solver::set_th_stop"); }
  void set_th_gaptol(double x) { internal::kNotNegative.set(th_gaptol_, x, "Solver::set_th_gaptol"); }
  void set_feasnorm(FeasibilityNorm feasnorm) { feasnorm_ = feasnorm; }  // norm of infeasibilities

 protected:
  /// Throws std::invalid_argument for wrong sizes.
  void check_xs(const char* where, const Vectors& xs) const;
  /// Throws std::invalid_argument for wrong sizes.
  void check_us(const char* where, const Vectors& us) const;
  /// Calls each callback of the current list. A callback may replace the list.
  void callCallbacks();
  std::shared_ptr<ShootingProblem> problem_;
  Vectors xs_, us_, fs_;  // states (T + 1), controls (T) and gaps (T + 1) of the candidate
  std::shared_ptr<const Callbacks> callbacks_ = std::make_shared<const Callbacks>();
  bool is_feasible_ = false, was_feasible_ = false;
  double cost_ = 0, merit_ = 0, stop_ = 0;
  Eigen::Vector2d d_ = Eigen::Vector2d::Zero();
  double dV_ = 0, dPhi_ = 0, dVexp_ = 0, dPhiexp_ = 0;
  double dfeas_ = 0, feas_ = 0, ffeas_ = 0, gfeas_ = 0, hfeas_ = 0, ffeas_try_ = 0, gfeas_try_ = 0, hfeas_try_ = 0;
  double preg_ = 0, dreg_ = 0;
  double steplength_ = 1, th_acceptstep_ = 0.1, th_stop_ = 1e-9, th_gaptol_ = 1e-16;
  FeasibilityNorm feasnorm_ = LInf;
  std::size_t iter_ = 0, reported_ = 0;  // reported_: iterations of the solve that callbacks have received
  bool interrupted_ = false;
  StopReason reason_ = StopReason::kNone;

 private:
  internal::LoopTime gaps_time_;
};

class CallbackAbstract {  // A function that is called after each iteration.
 public:
  virtual ~CallbackAbstract() = default;
  virtual void operator()(SolverAbstract& solver) = 0;  // called with the solver after each iteration
};

/// Returns whether a number is not finite, or at least 1e30.
bool raiseIfNaN(double value);

}  // namespace manycontact
