#include "place_search.hpp"

#include "levenberg_marquardt.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "mixed.hpp"

namespace manycontact::internal {

namespace {

constexpr Damping kGoalDamping = {1e-9, 1e-9, 1e4};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

CoordinateLimits::CoordinateLimits(const Scene& scene)
    : lower(Eigen::VectorXd::Constant(scene.nq, -kInfinity)), upper(-lower), moved_by(scene.nq, -1), nv(scene.nv) {
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      const int n = joint.nv();
      if (joint.type == JointType::kFloating || joint.lower.size() != n || joint.upper.size() != n) continue;
      for (int k = 0; k < n; ++k) {
        if (!(joint.lower[k] <= joint.upper[k])) continue;
        const int at = robot.idx_q + joint.idx_q + k;
        lower[at] = joint.lower[k];
        upper[at] = joint.upper[k];
        if (joint.type != JointType::kPlanar || k == 2) moved_by[at] = robot.idx_v + joint.idx_v + k;
      }
    }
}

void CoordinateLimits::of_step(const Eigen::VectorXd& q, Eigen::VectorXd& low, Eigen::VectorXd& high) const {
  low.setConstant(nv, -kInfinity);
  high.setConstant(nv, kInfinity);
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (moved_by[i] >= 0) low[moved_by[i]] = lower[i] - q[i], high[moved_by[i]] = upper[i] - q[i];
}

// Returns whether all goals are met, up to the tolerance or to the rounding errors of positions as large as q.
bool PlaceSearch::exact(const Eigen::VectorXd& q, const Eigen::VectorXd& e) const {
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * (q.size() ? 1 + q.cwiseAbs().maxCoeff() : 1);
  return e.size() == 0 || e.cwiseAbs().maxCoeff() <= std::max(options_.tolerance, rounding);
}

Eigen::VectorXd PlaceSearch::moved(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) const {
  return limits_.within(integrate(scene_, q, dq));
}

void PlaceSearch::look_at(const Eigen::VectorXd& q) {
  if (of_.size() == q.size() && of_ == q) return;
  (void)rows_.errors(q);
  J_ = rows_.jacobian();
  limits_.of_step(q, low_, high_);
  of_ = q;
}

double PlaceSearch::run(Eigen::VectorXd& q) {
  const int most = tries_ + options_.iterations;
  reach_ = kInfinity;
  q = limits_.within(q);
  off_saddles(
      q, [&](Eigen::VectorXd& x) { descend(x, most); },
      [&](const Eigen::VectorXd& x) { return tries_ < most ? aside(x) : x; },
      [&](const Eigen::VectorXd& x) {
        const Eigen::VectorXd e = rows_.errors(x);
        return exact(x, e) ? 0 : e.norm();
      });
  const Eigen::VectorXd e = rows_.errors(q);
  const bool met = exact(q, e);
  out_of_steps_ = !met && tries_ >= most;
  return met ? 0 : e.norm();
}

void PlaceSearch::descend(Eigen::VectorXd& q, int most_tries) {
  tries_ += gauss_newton(q, most_tries - tries_);
  tries_ += newton(q, most_tries - tries_);
}

// Makes Gauss-Newton steps until convergence, or until kSlow steps in a row reduce |e| by less than kLeastGain.
int PlaceSearch::gauss_newton(Eigen::VectorXd& q, int most_tries) {
  constexpr double kLeastGain = 0.1;
  constexpr int kSlow = 3;  // one or two steps may be short only because coordinates reach their limits
  double last = kInfinity;
  int slow = 0;
  return levenberg_marquardt(
             kGoalDamping, most_tries, q, [&](const Eigen::VectorXd& x) { return rows_.errors(x); },
             [&](const Eigen::VectorXd& x, const Eigen::VectorXd& e, double mu, Eigen::VectorXd& dq) {
               look_at(x);
               if (!bounded_) bounded_.emplace(J_);
               bounded_->solve(J_, e, mu, low_.cwiseMax(-reach_), high_.cwiseMin(reach_), dq);
               return dq.allFinite() && (J_ * dq + e).norm() < (1 - kProgress) * e.norm();
             },
             [&](const Eigen::VectorXd& x, const Eigen::VectorXd& dq) { return moved(x, dq); },
             [&](const Eigen::VectorXd& x, const Eigen::VectorXd& e) {
               const double now = e.norm();
               if (now < last) slow = now > (1 - kLeastGain) * last ? slow + 1 : 0;
               last = now;
               return slow == kSlow || exact(x, e);
             })
      .tries;
}

// Takes Newton steps within a box (trust region) of equal size in radians and metres.
int PlaceSearch::newton(Eigen::VectorXd& q, int most_tries) {
  constexpr double kPoor = 0.25, kGood = 0.75;  // ratios of actual to expected decrease beyond which the box changes
  int tries = 0;
  double radius = 1;
  Eigen::VectorXd e = rows_.errors(q), dq;
  const NewtonStep::Gradient gradient = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const Eigen::VectorXd there = rows_.errors(integrate(scene_, q, x));
    return rows_.jacobian().transpose() * there;
  };
  while (tries < most_tries && radius > kProgress && !exact(q, e)) {
    look_at(q);
    if (!newton_) newton_.emplace(J_);
    const double energy = 0.5 * e.squaredNorm();
    const double expected = newton_->solve(J_, e.norm(), gradient, low_.cwiseMax(-radius), high_.cwiseMin(radius), dq);
    if (!(expected > kProgress * energy)) break;
    ++tries;
    const Eigen::VectorXd next = moved(q, dq), then = rows_.errors(next);
    const double gain = energy - 0.5 * then.squaredNorm(), length = dq.lpNorm<Eigen::Infinity>();
    if (!(gain >= kPoor * expected))
      radius = kPoor * length;
    else if (gain > kGood * expected && length >= radius)
      radius *= 2;
    if (!(gain > 0)) continue;
    q = next;
    e = then;
  }
  return tries;
}

// Returns q with the coordinates that goals depend on moved by up to kAside, within their limits.
Eigen::VectorXd PlaceSearch::aside(const Eigen::VectorXd& q) {
  look_at(q);
  reach_ = kReach;
  Eigen::VectorXd dq = kAside * mixed(scene_.nv, 0);
  for (Eigen::Index i = 0; i < dq.size(); ++i) {
    if (J_.outerIndexPtr()[i] == J_.outerIndexPtr()[i + 1]) dq[i] = 0;
    if (dq[i] < low_[i] || dq[i] > high_[i]) dq[i] = std::clamp(-dq[i], low_[i], high_[i]);
  }
  return moved(q, dq);
}

bool PlaceSearch::moves(int robot) const {
  const Robot& r = scene_.robots[robot];
  return J_.outerSize() > 0 && J_.outerIndexPtr()[r.idx_v] < J_.outerIndexPtr()[r.idx_v + r.model->nv];
}

std::vector<GoalLeft> PlaceSearch::left(const Eigen::VectorXd& q) {
  (void)rows_.errors(q);
  return rows_.left();
}

}  // namespace manycontact::internal
