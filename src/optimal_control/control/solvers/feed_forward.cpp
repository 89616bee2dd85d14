// SolverDDP::descend makes quasi-Newton steps with respect to the feed-forward terms nu (control/ddp.hpp).

#include <algorithm>
#include <limits>

#include "manycontact/control/ddp.hpp"

namespace manycontact {

using Vectors = std::vector<Eigen::VectorXd>;

namespace {

constexpr double kArmijo = 1e-4;             // least accepted share of the reduction that the slope predicts
constexpr double kSlope = 0.8;               // largest slope after a step, relative to that before (Hager and Zhang)
constexpr double kLeast = 0.1, kMost = 0.5;  // bounds of the next step length, relative to a rejected step length
constexpr int kTrials = 12;
constexpr double kShort = 0.11, kVeryShort = 0.01;  // two step lengths below kShort or one below kVeryShort end descend

}  // namespace

void SolverDDP::allocateDescent() {
  nu_ = g_ = g_try_ = us_;
  bfgs_.reserve(us_);
}

// Searches for a step along nu_ that reduces the cost enough. If the expected reduction is below the cost's rounding
// error, the step must reduce the slope enough instead. Sets g_try_ to the gradient after the step.
bool SolverDDP::searchFeedForward() {
  const double rounding = std::max(th_grad_ * scale_, 100 * std::numeric_limits<double>::epsilon() * std::abs(cost_));
  setFeedForward(nu_);
  steplength_ = 1;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double shortest = kLeast * steplength_, longest = kMost * steplength_, expected = -steplength_ * slope_;
    const double dV = tryStep(steplength_);
    if (std::isnan(dV)) {
      steplength_ = shortest;
      continue;
    }
    dV_ = dV;
    dVexp_ = expected;
    double next = steplength_ * expected / (2 * (expected - dV));  // minimum of the parabola
    if (dV >= kArmijo * expected || (expected < rounding && dV > -rounding)) {
      problem_->calcDiff(xs_try_, us_try_);
      computeFeedForwardGradient(g_try_);
      const double slope = dot(g_try_, nu_);
      if (expected >= rounding || slope <= kSlope * -slope_) return true;
      next = steplength_ * slope_ / (slope_ - slope);
    }
    steplength_ = std::clamp(next, shortest, longest);
  }
  return false;
}

// Computes nu_ = -H g_ with the inverse Hessian H of L-BFGS, and sets `stop` to the reduction that Gauss-Newton
// predicts. Controls that nu_ would move beyond a limit end at the limit. The slope is that of this clamped step.
void SolverDDP::computeFeedForwardDirection() {
  nu_ = g_;
  preconditionFeedForward(nu_);
  stop_ = 0.5 * dot(g_, nu_);
  const auto finish = [this] {
    for (Eigen::VectorXd& nu : nu_) nu = -nu;
    holdFeedForward(nu_);
    for (std::size_t t = 0; keeps_limits() && t < nu_.size(); ++t) {
      const ActionModelAbstract& model = *problem_->model(t);
      if (!model.get_has_control_limits()) continue;
      nu_[t] += us_[t];
      nu_[t] = nu_[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
      nu_[t] -= us_[t];
    }
    slope_ = dot(g_, nu_);
  };
  if (bfgs_.pairs() > 0) {
    nu_ = g_;
    bfgs_.begin(nu_);
    preconditionFeedForward(nu_);
    bfgs_.finish(nu_);
    finish();
    if (slope_ >= 0) {  // the clamped direction does not descend
      bfgs_.forget();
      nu_ = g_;
      preconditionFeedForward(nu_);
      finish();
    }
  } else {
    finish();
  }
  // Only the negative gradient is guaranteed to descend after clamping.
  if (slope_ >= 0 && stop_ > 0) {
    const double size = 2 * stop_ / dot(g_, g_);
    for (std::size_t t = 0; t < nu_.size(); ++t) nu_[t] = size * g_[t];
    finish();
  }
  d_ << -slope_, slope_;
}

StopReason SolverDDP::descend(std::size_t maxiter) {
  require(is_feasible_, "SolverDDP::descend", "the candidate has gaps, a candidate without gaps is expected");
  interrupted_ = false;
  iter_ = 0;
  if (judges_) preg_ = dreg_ = reg_min_ * scale_;  // a larger regularisation would make `stop` smaller
  if (!findDirection(true)) return reason_ = StopReason::kNoDirection;
  for (std::size_t t = 0; t < xs_.size(); ++t) xs_try_[t] = xs_[t];
  for (std::size_t t = 0; t < us_.size(); ++t) us_try_[t] = us_[t];
  allocateDescent();
  computeFeedForwardGradient(g_);
  bfgs_.forget();
  int short_steps = 0;
  for (; iter_ < maxiter; ++iter_) {
    computeFeedForwardDirection();
    held_changed_ = false;
    stepped_ = slope_ < 0 && searchFeedForward();
    if (stepped_) {
      if (held_changed_)
        bfgs_.forget();
      else
        bfgs_.add(steplength_, nu_, g_, g_try_);
      std::swap(g_, g_try_);
      setCandidate(xs_try_, us_try_, true);
      was_feasible_ = true;
      cost_ = cost_try_;
    }
    callCallbacks();
    if (stop_ < th_stop_ * scale_) return reason_ = StopReason::kConverged;
    if (interrupted_) return reason_ = StopReason::kInterrupted;
    short_steps = stepped_ && steplength_ >= kShort ? 0 : short_steps + 1;
    if (!stepped_ || steplength_ < kVeryShort || short_steps == 2) return reason_ = StopReason::kNoStep;
  }
  return reason_ = StopReason::kIterations;
}

}  // namespace manycontact
