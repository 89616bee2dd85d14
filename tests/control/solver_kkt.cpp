#include "solver_kkt.hpp"

#include <Eigen/LU>
#include <cmath>

#include "manycontact/control/fit.hpp"

namespace manycontact::test {

using Eigen::Index;

SolverKKT::SolverKKT(std::shared_ptr<ShootingProblem> problem) : SolverAbstract(std::move(problem)) {
  for (int n = 0; n < 10; ++n) alphas_.push_back(std::ldexp(1, -n));
  SolverKKT::resizeData();
}

void SolverKKT::resizeData() {
  SolverAbstract::resizeData();
  const std::size_t T = problem_->get_T();
  nx_ = static_cast<Index>((T + 1) * problem_->get_nx());
  ndx_ = static_cast<Index>((T + 1) * problem_->get_ndx());
  nu_ = 0;
  for (const Eigen::VectorXd& u : us_) nu_ += u.size();
  const Index size = 2 * ndx_ + nu_;
  if (kkt_.rows() != size) kkt_.setZero(size, size);
  for (Eigen::VectorXd* x : {&kktref_, &primaldual_})
    if (x->size() != size) x->setZero(size);
  internal::fit_all(T + 1, problem_->get_nx(), xs_try_);
  internal::fit_all(T + 1, problem_->get_ndx(), dxs_, lambdas_);
  internal::fit_controls(*problem_, us_try_, dus_);
}

bool SolverKKT::solve(const std::vector<Eigen::VectorXd>& init_xs, const std::vector<Eigen::VectorXd>& init_us,
                      std::size_t maxiter, bool is_feasible, double) {
  resizeData();
  setCandidate(init_xs, init_us, is_feasible);
  was_feasible_ = interrupted_ = false;
  reason_ = StopReason::kIterations;
  for (iter_ = 0; iter_ < maxiter; ++iter_) {
    computeDirection(true);
    if (!primaldual_.allFinite()) {
      reason_ = StopReason::kNoDirection;
      break;
    }
    expectedImprovement();
    for (const double alpha : alphas_) {
      steplength_ = alpha;
      dV_ = tryStep(alpha);
      if (std::isnan(dV_)) continue;
      dVexp_ = alpha * (d_[0] + 0.5 * alpha * d_[1]);
      if (!(d_[0] < th_grad_ || !is_feasible_ || dV_ > th_acceptstep_ * dVexp_)) continue;
      was_feasible_ = is_feasible_;
      setCandidate(xs_try_, us_try_, true);
      cost_ = cost_try_;
      break;
    }
    stoppingCriteria();
    callCallbacks();
    if (was_feasible_ && stop_ < th_stop_) reason_ = StopReason::kConverged;
    if (interrupted_) reason_ = StopReason::kInterrupted;
    if (reason_ != StopReason::kIterations) break;
  }
  return reason_ == StopReason::kConverged;
}

void SolverKKT::computeDirection(bool recalc) {
  if (recalc) calcDiff();
  primaldual_ = kkt_.partialPivLu().solve(-kktref_);
  const Index n = static_cast<Index>(problem_->get_ndx());
  Index u = ndx_;
  for (std::size_t t = 0; t < dxs_.size(); ++t) {
    const Index x = static_cast<Index>(t) * n;
    dxs_[t] = primaldual_.segment(x, n);
    lambdas_[t] = primaldual_.segment(ndx_ + nu_ + x, n);
    if (t == dus_.size()) break;
    dus_[t] = primaldual_.segment(u, dus_[t].size());
    u += dus_[t].size();
  }
}

double SolverKKT::tryStep(double steplength) {
  for (std::size_t t = 0; t < xs_.size(); ++t)
    problem_->model(t)->get_state()->integrate(xs_[t], steplength * dxs_[t], xs_try_[t]);
  for (std::size_t t = 0; t < us_.size(); ++t) us_try_[t] = us_[t] + steplength * dus_[t];
  cost_try_ = problem_->calc(xs_try_, us_try_);
  return raiseIfNaN(cost_try_) ? std::numeric_limits<double>::quiet_NaN() : cost_ - cost_try_;
}

double SolverKKT::stoppingCriteria() {
  const Index primal = ndx_ + nu_;
  stop_ = (kktref_.head(primal) + kkt_.topRightCorner(primal, ndx_) * primaldual_.tail(ndx_)).squaredNorm() +
          kktref_.tail(ndx_).squaredNorm();
  return stop_;
}

const Eigen::Vector2d& SolverKKT::expectedImprovement() {
  const Index primal = ndx_ + nu_;
  const auto w = primaldual_.head(primal);
  d_[0] = -kktref_.head(primal).dot(w);
  d_[1] = -w.dot(kkt_.topLeftCorner(primal, primal) * w);
  return d_;
}

double SolverKKT::calcDiff() {
  problem_->calc(xs_, us_);
  cost_ = problem_->calcDiff(xs_, us_);
  const Index n = static_cast<Index>(problem_->get_ndx()), primal = ndx_ + nu_;
  kkt_.block(primal, 0, n, n).setIdentity();
  problem_->model(0)->get_state()->diff(problem_->get_x0(), xs_[0], kktref_.segment(primal, n));
  Index u = ndx_;
  for (std::size_t t = 0; t < xs_.size(); ++t) {
    const ActionDataAbstract& d = *problem_->data(t);
    require(d.Lxx.rows() == n, "SolverKKT", "the nodes keep no matrices (ActionModelParts with storage kSparse)");
    const Index x = static_cast<Index>(t) * n, next = primal + n + x;
    kkt_.block(x, x, n, n) = d.Lxx;
    kktref_.segment(x, n) = d.Lx;
    if (t == us_.size()) break;
    const Index nu = us_[t].size();
    kkt_.block(x, u, n, nu) = d.Lxu;
    kkt_.block(u, x, nu, n) = d.Lxu.transpose();
    kkt_.block(u, u, nu, nu) = d.Luu;
    kkt_.block(next, x, n, n) = -d.Fx;
    kkt_.block(next, u, n, nu) = -d.Fu;
    kkt_.block(next, x + n, n, n).setIdentity();
    kktref_.segment(u, nu) = d.Lu;
    problem_->model(t)->get_state()->diff(d.xnext, xs_[t + 1], kktref_.segment(next, n));
    u += nu;
  }
  kkt_.topRightCorner(primal, ndx_) = kkt_.bottomLeftCorner(ndx_, primal).transpose();
  return cost_;
}

}  // namespace manycontact::test
