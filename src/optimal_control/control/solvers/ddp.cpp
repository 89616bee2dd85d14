#include "manycontact/control/ddp.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "../nodes/nodes.hpp"
#include "cost_scale.hpp"
#include "manycontact/control/fit.hpp"
#include "manycontact/control/riccati_direction.hpp"
#include "step_lengths.hpp"

namespace manycontact {

using Vectors = std::vector<Eigen::VectorXd>;

SolverDDP::SolverDDP(SolverDDP&&) = default;
SolverDDP& SolverDDP::operator=(SolverDDP&&) = default;
SolverDDP::~SolverDDP() = default;

SolverDDP::SolverDDP(std::shared_ptr<ShootingProblem> problem, Limits limits)
    : SolverDDP(std::move(problem), limits, WithoutMatrices{}) {
  ShootingPart whole;
  whole.problem = problem_;
  if (limits_)
    directions_.push_back(std::make_unique<BoxDirection>(std::move(whole), true));
  else
    directions_.push_back(std::make_unique<RiccatiDirection>(std::move(whole), true, true));
  SolverDDP::allocateData();
}

// With limits th_stop is larger, because the expected improvement does not include the multipliers of the limits.
SolverDDP::SolverDDP(std::shared_ptr<ShootingProblem> problem, Limits limits, WithoutMatrices)
    : SolverAbstract(std::move(problem)), alphas_(internal::default_alphas()), limits_(limits == Limits::kKept) {
  if (limits_) th_stop_ = 5e-5;
}

void SolverDDP::resizeData() {
  SolverAbstract::resizeData();
  allocateData();
}

// Resizes the vectors of the solver and its directions to the problem. Allocates only those whose sizes have changed.
void SolverDDP::allocateData() {
  internal::fit_all(problem_->get_T() + 1, problem_->get_nx(), xs_try_);
  internal::fit_all(problem_->get_T() + 1, problem_->get_ndx(), Vx_);
  internal::fit_controls(*problem_, us_try_, k_);
  for (const auto& own : directions_) own->resize();
}

template <class Work>
void SolverDDP::each_direction(Work&& work) {
  if (directions_.size() == 1) return work(*directions_[0]);
  internal::each_node(problem_->get_nthreads(), directions_.size(), [&](std::size_t i) { work(*directions_[i]); });
}

const RiccatiDirection* SolverDDP::recursion() const {
  return directions_.size() == 1 ? dynamic_cast<const RiccatiDirection*>(directions_[0].get()) : nullptr;
}

namespace {

// Returns the list `get` of a RiccatiDirection, or an empty list if `recursion` is null (several subproblems).
template <class Kept>
const Kept& kept(const RiccatiDirection* recursion, const Kept& (RiccatiDirection::*get)() const) {
  static const Kept none;
  return recursion ? (recursion->*get)() : none;
}

RiccatiDirection& as_recursion(Direction& direction) {
  auto* own = dynamic_cast<RiccatiDirection*>(&direction);
  if (!own)
    throw std::logic_error(
        "SolverDDP: robots in contact with each other have no separate value functions, use backwardPass");
  return *own;
}

}  // namespace

using Matrices = std::vector<Eigen::MatrixXd>;
const Matrices& SolverDDP::get_Vxx() const { return kept(recursion(), &RiccatiDirection::get_Vxx); }
const Matrices& SolverDDP::get_Qxx() const { return kept(recursion(), &RiccatiDirection::get_Qxx); }
const Matrices& SolverDDP::get_Qxu() const { return kept(recursion(), &RiccatiDirection::get_Qxu); }
const Matrices& SolverDDP::get_Quu() const { return kept(recursion(), &RiccatiDirection::get_Quu); }
const Vectors& SolverDDP::get_Qx() const { return kept(recursion(), &RiccatiDirection::get_Qx); }
const Vectors& SolverDDP::get_Qu() const { return kept(recursion(), &RiccatiDirection::get_Qu); }
const std::vector<SolverDDP::MatrixXdRowMajor>& SolverDDP::get_K() const {
  return kept(recursion(), &RiccatiDirection::get_K);
}

void SolverDDP::takeCandidate(Direction& own) const { own.take_candidate(*problem_, xs_, us_, fs_, is_feasible_); }

void SolverDDP::backwardPass() {
  each_direction([this](Direction& own) {
    takeCandidate(own);
    own.is_sound_ = own.compute(preg_, dreg_);
    for (std::size_t t = 0; t < Vx_.size(); ++t) own.give_dx(own.Vx_[t], Vx_[t]);
    own.give_u(own.k_, k_);
  });
  sound_ = std::all_of(directions_.begin(), directions_.end(), [](const auto& own) { return own->is_sound_; });
}

void SolverDDP::computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model,
                                           const std::shared_ptr<ActionDataAbstract>& data) {
  require(t < problem_->get_T(), "SolverDDP::computeActionValueFunction",
          "the node does not exist, a number below T is expected");
  each_direction([&](Direction& own) {
    const bool whole = own.get_problem() == problem_;
    as_recursion(own).compute_action_value_function(t, whole ? *model : *own.get_problem()->model(t),
                                                    whole ? *data : *own.get_problem()->data(t));
  });
}

void SolverDDP::computeGains(std::size_t t) {
  require(t < problem_->get_T(), "SolverDDP::computeGains", "the node does not exist, a number below T is expected");
  each_direction([&](Direction& own) {
    own.is_sound_ = as_recursion(own).compute_gains(t);
    own.give_u(own.k_, k_);
  });
  sound_ = std::all_of(directions_.begin(), directions_.end(), [](const auto& own) { return own->is_sound_; });
}

void SolverDDP::computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>&) {
  require(t < problem_->get_T(), "SolverDDP::computeValueFunction",
          "the node does not exist, a number below T is expected");
  each_direction([&](Direction& own) {
    as_recursion(own).compute_value_function(t);
    own.give_dx(own.Vx_[t], Vx_[t]);
  });
}

void SolverDDP::start(const Vectors& init_xs, const Vectors& init_us, bool is_feasible, double init_reg) {
  (void)problem_->is_updated();
  resizeData();
  setCandidate(init_xs, init_us, is_feasible);
  limitGuess();
  us_guess_ = us_;
  rolled_out_ = false;
  preg_ = dreg_ = std::isnan(init_reg) ? reg_min_ * scale_ : init_reg;
  was_feasible_ = false;
  interrupted_ = false;
  reported_ = 0;
  kkt_ = NAN;
  polishing_ = 0;
  reason_ = StopReason::kNone;
}

bool SolverDDP::solve(const Vectors& init_xs, const Vectors& init_us, std::size_t maxiter, bool is_feasible,
                      double init_reg) {
  start(init_xs, init_us, is_feasible, init_reg);
  if (judges_ && keeps_limits()) allocateDescent();  // reserves memory for the optimality test at the end
  reason_ = iterate(0, maxiter);
  constexpr int kRounds = 3;
  for (int round = 0;; ++round) {
    // Crocoddyl's rule may stop before the optimum. Therefore the KKT residual decides, or, without th_kkt, the
    // projected gradient.
    const bool by_kkt = std::isfinite(th_kkt_);
    const bool doubted = reason_ == StopReason::kConverged && judges_ && keeps_limits() && !by_kkt;
    if (!(doubted && !isOptimalWithinLimits()) && !(reason_ == StopReason::kNoStep && is_feasible_)) break;
    if (!keeps_limits()) {
      if (by_kkt) reason_ = judgeWithoutStep();
      break;
    }
    const double before = cost_;
    reason_ = descendWithinLimits(maxiter);
    // If quasi-Newton steps make no further progress, steps with Crocoddyl's box rule continue from their result.
    if (reason_ != StopReason::kNoStep || round == kRounds || !(judges_ || by_kkt) || !(cost_ < before)) break;
    problem_->calc(xs_, us_);
    preg_ = dreg_ = reg_min_ * scale_;
    reason_ = iterate(std::max<std::size_t>(reported_, 1), maxiter);
  }
  return reason_ == StopReason::kConverged;
}

StopReason SolverDDP::iterate(std::size_t first, std::size_t maxiter) {
  bool recalc = true;
  // The box rule may make hundreds of short steps. Then `descend` makes longer steps, but only if th_kkt is set.
  // Otherwise the iterates are those of Crocoddyl.
  constexpr double kShort = 1. / 16;
  constexpr int kManyShort = 10;
  int short_steps = 0;  // consecutive short steps
  for (iter_ = first; iter_ < maxiter; ++iter_) {
    if (!findDirection(recalc)) return StopReason::kNoDirection;
    recalc = searchLine() || rollOutCandidate();
    if (!adaptRegularization()) return StopReason::kNoStep;
    stop_ = stoppingCriteria();
    callCallbacks();
    if (was_feasible_ && stop_ < th_stop_ * scale_) {
      if (std::isfinite(th_kkt_)) {
        const StopReason polished = polish(maxiter);
        // With limits, `polish` may cycle between them until maxiter. kNoStep makes `solve` continue with `descend`.
        return keeps_limits() && polished == StopReason::kIterations ? StopReason::kNoStep : polished;
      }
      if (keeps_limits() || stopsUnregularised()) return StopReason::kConverged;
    }
    if (interrupted_) return StopReason::kInterrupted;
    short_steps = stepped_ && is_feasible_ && steplength_ <= kShort ? short_steps + 1 : 0;
    if (keeps_limits() && std::isfinite(th_kkt_) && short_steps == kManyShort) return StopReason::kNoStep;
  }
  return StopReason::kIterations;
}

bool SolverDDP::findDirection(bool recalc) {
  const auto compute = [this](bool again) {
    // backwardPass sets it to false if it fails; an overridden computeDirection may not call backwardPass
    sound_ = true;
    computeDirection(again);
  };
  for (compute(recalc); !sound_; compute(false)) {
    increaseRegularization();
    if (preg_ == reg_max_ * scale_) return false;
  }
  return true;
}

// Decreases the regularisation after long steps, and increases it after short steps. Returns false at its maximum.
bool SolverDDP::adaptRegularization() {
  if (steplength_ > th_stepdec_) decreaseRegularization();
  if (steplength_ > th_stepinc_) return true;
  increaseRegularization();
  return preg_ != reg_max_ * scale_;
}

// Makes the first accepted step the candidate. Returns false if no step is accepted.
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

Eigen::Vector2d SolverDDP::improvement(bool gaps) {
  Eigen::Vector2d d = Eigen::Vector2d::Zero();
  for (const auto& own : directions_) d += own->improvement(gaps);
  return d;
}

// Returns d0 = sum Qu^T k, d1 = - sum k^T Quu k, summed over nodes, for the step u = us - s k.
const Eigen::Vector2d& SolverDDP::expectedImprovement() { return d_ = improvement(false); }

double SolverDDP::expectedReduction() const {
  double out = 0;
  for (const auto& own : directions_) out += own->expected_reduction();
  return out;
}

double SolverDDP::calcDiff() {
  if (iter_ == 0) problem_->calc(xs_, us_);
  cost_ = problem_->calcDiff(xs_, us_);
  if (iter_ == 0 && measures_scale_) measureScale();
  ffeas_ = computeDynamicFeasibility();
  if (keeps_limits() && ffeas_ <= th_gaptol_) is_feasible_ = true;  // limits apply only to feasible candidates
  constexpr double kRounded = 1e-12;  // largest gaps, relative to the states, that may be rounding errors
  // The caller may have declared a guess with gaps feasible.
  if (iter_ == 0 && is_feasible_)
    is_feasible_ = ffeas_ <= std::max(th_gaptol_, kRounded * internal::largest_number(xs_));
  gfeas_ = computeInequalityFeasibility();
  hfeas_ = computeEqualityFeasibility();
  return cost_;
}

void SolverDDP::forwardPass(double steplength) { rollOut(steplength, false, false); }

void SolverDDP::rollOut(double steplength, bool keep_gaps, bool keep_terminal_gap) {
  require(steplength >= 0 && steplength <= 1, "Solver::forwardPass", "a step length in [0, 1] is expected");
  each_direction([&](Direction& own) {
    takeCandidate(own);
    own.cost_try_ = own.roll_out(steplength, keep_gaps, keep_terminal_gap);
  });
  cost_try_ = 0;
  for (const auto& own : directions_) cost_try_ += own->cost_try_;  // NaN if any is NaN
  if (raiseIfNaN(cost_try_)) cost_try_ = std::numeric_limits<double>::quiet_NaN();
  each_direction([this](Direction& own) {  // thread-safe: directions write different entries
    for (std::size_t t = 0; t < xs_try_.size(); ++t) own.give_x(own.xs_try_[t], xs_try_[t]);
    own.give_u(own.us_try_, us_try_);
  });
}

void SolverDDP::increaseRegularization() { dreg_ = preg_ = std::min(preg_ * reg_incfactor_, reg_max_ * scale_); }

void SolverDDP::decreaseRegularization() { dreg_ = preg_ = std::max(preg_ / reg_decfactor_, reg_min_ * scale_); }

void SolverDDP::set_scale(double scale) {
  require(scale > 0 && std::isfinite(scale), "SolverDDP::set_scale", "a positive number is expected");
  scale_ = kkt_scale_ = scale;
  for (const auto& own : directions_) own->set_scale(scale_);
}

// Measures the scales at the candidate. Adapts the current regularisation, which was chosen for the previous scale.
void SolverDDP::measureScale() {
  const double before = scale_;
  const internal::CostScale measured = internal::cost_scale(*problem_);
  set_scale(measured.cost);
  kkt_scale_ = measured.gradient;
  preg_ *= scale_ / before;
  dreg_ *= scale_ / before;
}

void SolverDDP::set_alphas(const std::vector<double>& alphas) {
  internal::check_alphas("SolverDDP::set_alphas", alphas);
  alphas_ = alphas;
}
// Calls work(direction, share) for each direction with its share of the controls in `whole`, and copies the share back.
template <class Work>
void SolverDDP::each_feed_forward(Vectors& whole, Work&& work) {
  whole.resize(us_.size());
  for (std::size_t t = 0; t < us_.size(); ++t) whole[t].resize(us_[t].size());
  each_direction([&](Direction& own) {
    own.take_u(whole, own.feed_forward_);
    work(own, own.feed_forward_);
    own.give_u(own.feed_forward_, whole);
  });
}

void SolverDDP::setFeedForward(const Vectors& nu) {
  each_direction([&](Direction& own) {
    own.take_u(nu, own.feed_forward_);
    own.set_feed_forward(own.feed_forward_);
    own.give_u(own.k_, k_);
  });
}

void SolverDDP::computeFeedForwardGradient(Vectors& g) {
  each_feed_forward(g, [this](Direction& own, Vectors& own_g) {
    own.take_u(us_try_, own.us_try_);
    own.held_changed_ = false;
    own.feed_forward_gradient(own_g);
  });
  for (const auto& own : directions_) held_changed_ |= own->held_changed_;
}

void SolverDDP::preconditionFeedForward(Vectors& g) {
  each_feed_forward(g, [](Direction& own, Vectors& own_g) { own.precondition_feed_forward(own_g); });
}

void SolverDDP::holdFeedForward(Vectors& nu) {
  each_feed_forward(nu, [](Direction& own, Vectors& own_nu) { own.hold_feed_forward(own_nu); });
}

}  // namespace manycontact
