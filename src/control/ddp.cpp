#include "manycontact/control/ddp.hpp"

#include <algorithm>
#include <limits>

#include "cost_scale.hpp"
#include "kkt_residual.hpp"
#include "manycontact/control/euler.hpp"
#include "step_lengths.hpp"

namespace manycontact {

SolverDDP::SolverDDP(std::shared_ptr<ShootingProblem> problem) : SolverDDP(std::move(problem), WithoutMatrices{}) {
  SolverDDP::allocateData();
}

SolverDDP::SolverDDP(std::shared_ptr<ShootingProblem> problem, WithoutMatrices)
    : SolverAbstract(std::move(problem)), alphas_(internal::default_alphas()) {}

void SolverDDP::resizeData() {
  SolverAbstract::resizeData();
  allocateData();
}

namespace {

// Whether the backward pass finds a node's derivatives.
bool is_readable(const ActionDataAbstract& data, Eigen::Index ndx) {
  return data.has_matrices() ? data.Fx.rows() == ndx : dynamic_cast<const IntegratedActionDataEuler*>(&data) != nullptr;
}

template <class M>
void fit(M& matrix, Eigen::Index rows, Eigen::Index cols) {
  if (matrix.rows() != rows || matrix.cols() != cols) matrix.setZero(rows, cols);
}

}  // namespace

// Only what does not fit yet is allocated.
void SolverDDP::allocateData() {
  panel_node_ = kNoNode;
  const std::size_t T = problem_->get_T();
  const Eigen::Index nx = problem_->get_nx(), ndx = problem_->get_ndx();
  for (std::size_t t = 0; t <= T; ++t)
    require(is_readable(*problem_->data(t), ndx), "SolverDDP",
            "a node's data hold no matrices (ActionModelParts with storage kSparse), SolverSparse is expected");
  for (auto* states : {&xs_try_, &Vx_, &Vxx_fs_}) states->resize(T + 1);
  for (auto* vectors : {&us_try_, &dx_, &Qx_, &Qu_, &k_, &Quuk_}) vectors->resize(T);
  for (auto* matrices : {&Qxx_, &Qxu_, &Quu_}) matrices->resize(T);
  Vxx_.resize(T + 1);
  for (Eigen::MatrixXd& V : two_values_) fit(V, keeps_values_ ? 0 : ndx, keeps_values_ ? 0 : ndx);
  K_.resize(T);
  Quu_llt_.resize(T);
  for (std::size_t t = 0; t <= T; ++t) {
    fit(xs_try_[t], nx, 1);
    fit(Vx_[t], ndx, 1);
    if (keeps_values_) fit(Vxx_[t], ndx, ndx);
    fit(Vxx_fs_[t], ndx, 1);
    if (t == T) break;
    const Eigen::Index nu = problem_->get_runningModels()[t]->get_nu();
    for (auto* u : {&us_try_, &Qu_, &k_, &Quuk_}) fit((*u)[t], nu, 1);
    for (auto* x : {&dx_, &Qx_}) fit((*x)[t], ndx, 1);
    if (keeps_values_) {
      fit(Qxx_[t], ndx, ndx);
      fit(Qxu_[t], ndx, nu);
      fit(Quu_[t], nu, nu);
    }
    fit(K_[t], nu, ndx);
    if (Quu_llt_[t].rows() != nu) Quu_llt_[t] = Eigen::LLT<Eigen::MatrixXd>(Eigen::MatrixXd::Identity(nu, nu));
  }
  fit(step_, ndx, 1);
  fit(xnext_, nx, 1);
}

void SolverDDP::start(const std::vector<Eigen::VectorXd>& init_xs, const std::vector<Eigen::VectorXd>& init_us,
                      bool is_feasible, double init_reg) {
  (void)problem_->is_updated();
  resizeData();
  setCandidate(init_xs, init_us, is_feasible);
  limitGuess();
  us_guess_ = us_;
  rolled_out_ = false;
  preg_ = dreg_ = std::isnan(init_reg) ? reg_min_ * scale_ : init_reg;
  was_feasible_ = false;
  interrupted_ = false;
  kkt_ = NAN;
  polishing_ = 0;
  reason_ = StopReason::kNone;
}

bool SolverDDP::solve(const std::vector<Eigen::VectorXd>& init_xs, const std::vector<Eigen::VectorXd>& init_us,
                      std::size_t maxiter, bool is_feasible, double init_reg) {
  start(init_xs, init_us, is_feasible, init_reg);
  bool recalc = true;
  reason_ = StopReason::kIterations;
  for (iter_ = 0; iter_ < maxiter; ++iter_) {
    if (!findDirection(recalc)) {
      reason_ = StopReason::kNoDirection;
      break;
    }
    recalc = searchLine() || rollOutCandidate();
    if (!adaptRegularization()) {
      reason_ = StopReason::kNoStep;
      break;
    }
    stoppingCriteria();
    callCallbacks();
    if (was_feasible_ && stop_ < th_stop_ * scale_) {
      reason_ = StopReason::kConverged;
      break;
    }
    if (interrupted_) {
      reason_ = StopReason::kInterrupted;
      break;
    }
  }
  if (reason_ == StopReason::kConverged && std::isfinite(th_kkt_)) reason_ = polish(maxiter);
  if (reason_ == StopReason::kNoStep && keeps_limits() && is_feasible_) reason_ = descendWithinLimits(maxiter);
  return reason_ == StopReason::kConverged;
}

// Crocoddyl's box rule leaves what clamped controls have yet to move out of the expected improvement and of the value
// function, so that directions may be no descent. The gradient of `descend` is exact.
StopReason SolverDDP::descendWithinLimits(std::size_t maxiter) {
  struct Restore {
    double &number, value;
    ~Restore() { number = value; }
  } restore{th_stop_, th_stop_};
  if (!stepped_) problem_->calc(xs_, us_);  // the data are of the last try
  const double rounding = std::numeric_limits<double>::epsilon() * std::abs(cost_) / scale_;
  constexpr int kRounds = 20, kIdle = 3;  // each of one backward pass; of them in a row that gain nothing
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0, idle = 0; round < kRounds && idle < kIdle; ++round) {
    if (std::isfinite(th_kkt_)) th_stop_ = std::max(1e-6 * restore.value, rounding);
    preg_ = dreg_ = reg_min_ * scale_;
    const StopReason reason = descend(maxiter);
    if (reason == StopReason::kInterrupted || reason == StopReason::kNoDirection) return reason;
    if (!std::isfinite(th_kkt_)) return reason;
    problem_->calc(xs_, us_);
    calcDiff();
    const auto l = internal::least_squares_multipliers_of_nodes(*problem_, us_, true);
    Eigen::VectorXd work;
    kkt_ = internal::kkt_residual_of_nodes(*problem_, xs_, us_, l, true, {}, work);
    if (kkt_ <= th_kkt_ * scale_) return StopReason::kConverged;
    idle = kkt_ < 0.5 * least ? 0 : idle + 1;
    least = std::min(least, kkt_);
  }
  return StopReason::kNoStep;
}

// From a candidate that meets the stopping rule. Steps are accepted unseen where what they are to gain is less than the
// cost's rounding.
StopReason SolverDDP::polish(std::size_t maxiter) {
  struct Restore {
    double &number, value;
    ~Restore() { number = value; }
  } restore{th_grad_, th_grad_};
  th_grad_ = std::max(th_grad_, 100 * std::numeric_limits<double>::epsilon() * std::abs(cost_) / scale_);
  for (bool moved = true;; ++polishing_) {
    if (moved) {
      calcDiff();
      const auto l = internal::least_squares_multipliers_of_nodes(*problem_, us_, keeps_limits());
      Eigen::VectorXd work;
      kkt_ = internal::kkt_residual_of_nodes(*problem_, xs_, us_, l, keeps_limits(), {}, work);
    }
    if (kkt_ <= th_kkt_ * scale_) return StopReason::kConverged;
    if (polishing_ == maxiter) return StopReason::kIterations;
    if (!findDirection(false)) return StopReason::kNoDirection;
    moved = searchLine();
    if (!adaptRegularization()) return StopReason::kNoStep;
  }
}

namespace {

// All finite and below 1e30.
bool is_sound(const Eigen::VectorXd& x) {
  for (double number : x)
    if (!(std::abs(number) < 1e30)) return false;
  return true;
}

}  // namespace

void SolverDDP::limitGuess() {
  if (!keeps_limits()) return;
  for (std::size_t t = 0; t < us_.size(); ++t) {
    const ActionModelAbstract& model = *problem_->model(t);
    if (!model.get_has_control_limits()) continue;
    us_try_[t] = us_[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
    if (us_try_[t] == us_[t]) continue;
    us_[t] = us_try_[t];
    is_feasible_ = false;
  }
}

// Directions from a candidate with gaps are those without limits, of which no step may be worth anything, and which
// leave controls at one limit or the other. What the guess's controls lead to has no gaps, and from there on the limits
// are in the direction.
bool SolverDDP::rollOutCandidate() {
  if (!keeps_limits() || is_feasible_) return false;
  for (std::size_t t = 0; t < us_.size(); ++t) us_try_[t] = us_guess_[t];
  problem_->rollout(us_try_, xs_try_);
  cost_try_ = problem_->total_cost();
  for (const Eigen::VectorXd& x : xs_try_)
    if (raiseIfNaN(cost_try_) || !is_sound(x)) return false;
  setCandidate(xs_try_, us_try_, true);
  cost_ = cost_try_;
  preg_ = dreg_ = reg_min_ * scale_;
  steplength_ = 1;
  return stepped_ = rolled_out_ = true;
}

// More and more regularised until there is one.
bool SolverDDP::findDirection(bool recalc) {
  for (computeDirection(recalc); !sound_; computeDirection(false)) {
    increaseRegularization();
    if (preg_ == reg_max_ * scale_) return false;
  }
  return true;
}

// Less after long steps, more after short ones; false at the largest.
bool SolverDDP::adaptRegularization() {
  if (steplength_ > th_stepdec_) decreaseRegularization();
  if (steplength_ > th_stepinc_) return true;
  increaseRegularization();
  return preg_ != reg_max_ * scale_;
}

// The first of the step lengths that is accepted becomes the candidate; false when none is.
bool SolverDDP::searchLine() {
  prepareImprovement();
  stepped_ = false;
  for (double alpha : alphas_) {
    steplength_ = alpha;
    const double dV = tryStep(alpha);
    if (std::isnan(dV)) continue;
    dV_ = dV;
    updateImprovement();
    dVexp_ = alpha * (d_[0] + 0.5 * alpha * d_[1]);
    if (!accepts()) continue;
    was_feasible_ = is_feasible_;
    setCandidate(xs_try_, us_try_, closesGaps());
    cost_ = cost_try_;
    return stepped_ = true;
  }
  return false;
}

bool SolverDDP::accepts() const {
  return dVexp_ >= 0 && (std::abs(d_[0]) < th_grad_ * scale_ || !is_feasible_ || dV_ > th_acceptstep_ * dVexp_);
}

void SolverDDP::computeDirection(bool recalc) {
  if (recalc) calcDiff();
  backwardPass();
}

double SolverDDP::tryStep(double steplength) {
  forwardPass(steplength);
  return cost_ - cost_try_;
}

double SolverDDP::stoppingCriteria() {
  stop_ = std::abs(d_[0] + 0.5 * d_[1]);
  return stop_;
}

// Of u = us - s k:  d0 = sum Qu^T k,  d1 = - sum k^T Quu k
const Eigen::Vector2d& SolverDDP::expectedImprovement() {
  d_.setZero();
  for (std::size_t t = 0; t < problem_->get_T(); ++t) {
    d_[0] += Qu_[t].dot(k_[t]);
    d_[1] -= k_[t].dot(Quuk_[t]);
  }
  return d_;
}

// Newton's: half of d0
double SolverDDP::expectedReduction() const {
  double out = 0;
  for (std::size_t t = 0; t < k_.size(); ++t) out += 0.5 * Qu_[t].dot(k_[t]);
  return out;
}

double SolverDDP::calcDiff() {
  if (iter_ == 0) problem_->calc(xs_, us_);
  cost_ = problem_->calcDiff(xs_, us_);
  if (iter_ == 0 && measures_scale_) measureScale();
  ffeas_ = computeDynamicFeasibility();
  if (keeps_limits() && ffeas_ <= th_gaptol_) is_feasible_ = true;  // else limits would wait for gaps to close
  gfeas_ = computeInequalityFeasibility();
  hfeas_ = computeEqualityFeasibility();
  return cost_;
}

void SolverDDP::forwardPass(double steplength) { rollOut(steplength, false, false); }

void SolverDDP::rollOut(double steplength, bool keep_gaps, bool keep_terminal_gap) {
  require(steplength >= 0 && steplength <= 1, "Solver::forwardPass", "a step length in [0, 1] is expected");
  const std::size_t T = problem_->get_T();
  cost_try_ = 0;
  xnext_ = problem_->get_x0();
  for (std::size_t t = 0; t <= T; ++t) {
    if (t < T ? keep_gaps : keep_terminal_gap) {
      step_ = (steplength - 1) * fs_[t];
      problem_->model(t)->get_state()->integrate(xnext_, step_, xs_try_[t]);
    } else {
      xs_try_[t] = xnext_;
    }
    if (!problem_->by_state_alone(t)) stepControl(t, steplength);
    problem_->calc_node(t, xs_try_, us_try_);
    cost_try_ += problem_->data(t)->cost;
    if (t < T) xnext_ = problem_->data(t)->xnext;
    if (raiseIfNaN(cost_try_) || !is_sound(xnext_)) {
      cost_try_ = std::numeric_limits<double>::quiet_NaN();
      return;
    }
  }
}

// u = us - s k - K (x (-) xs)
void SolverDDP::stepControl(std::size_t t, double steplength) {
  problem_->model(t)->get_state()->diff(xs_[t], xs_try_[t], dx_[t]);
  us_try_[t] = us_[t] - steplength * k_[t];
  us_try_[t].noalias() -= K_[t] * dx_[t];
  limitControl(t);
}

void SolverDDP::increaseRegularization() { dreg_ = preg_ = std::min(preg_ * reg_incfactor_, reg_max_ * scale_); }

void SolverDDP::decreaseRegularization() { dreg_ = preg_ = std::max(preg_ / reg_decfactor_, reg_min_ * scale_); }

void SolverDDP::set_scale(double scale) {
  require(scale > 0 && std::isfinite(scale), "SolverDDP::set_scale", "a positive number is expected");
  scale_ = scale;
  adoptScale();
}

// The regularisation at hand was chosen for the scale before.
void SolverDDP::measureScale() {
  const double before = scale_;
  set_scale(internal::cost_scale(*problem_));
  preg_ *= scale_ / before;
  dreg_ *= scale_ / before;
}

void SolverDDP::set_reg_incfactor(double regfactor) {
  require(regfactor > 1, "SolverDDP::set_reg_incfactor", "a number above 1 is expected");
  reg_incfactor_ = regfactor;
}
void SolverDDP::set_reg_decfactor(double regfactor) {
  require(regfactor > 1, "SolverDDP::set_reg_decfactor", "a number above 1 is expected");
  reg_decfactor_ = regfactor;
}
void SolverDDP::set_reg_min(double regmin) {
  require(regmin >= 0, "SolverDDP::set_reg_min", "a number that is not negative is expected");
  reg_min_ = regmin;
}
void SolverDDP::set_reg_max(double regmax) {
  require(regmax >= 0, "SolverDDP::set_reg_max", "a number that is not negative is expected");
  reg_max_ = regmax;
}
void SolverDDP::set_alphas(const std::vector<double>& alphas) {
  internal::check_alphas("SolverDDP::set_alphas", alphas);
  alphas_ = alphas;
}
void SolverDDP::set_th_stepdec(double th_stepdec) {
  require(th_stepdec > 0 && th_stepdec <= 1, "SolverDDP::set_th_stepdec", "a number in (0, 1] is expected");
  th_stepdec_ = th_stepdec;
}
void SolverDDP::set_th_stepinc(double th_stepinc) {
  require(th_stepinc > 0 && th_stepinc <= 1, "SolverDDP::set_th_stepinc", "a number in (0, 1] is expected");
  th_stepinc_ = th_stepinc;
}
void SolverDDP::set_th_kkt(double th_kkt) {
  require(th_kkt > 0, "SolverDDP::set_th_kkt", "a positive tolerance is expected");
  th_kkt_ = th_kkt;
}
void SolverDDP::set_th_grad(double th_grad) {
  require(th_grad >= 0, "SolverDDP::set_th_grad", "a number that is not negative is expected");
  th_grad_ = th_grad;
}

}  // namespace manycontact
