#include "beside.hpp"

#include <algorithm>
#include <random>

namespace manycontact::task {

namespace {

constexpr int kTries = 4;
constexpr double kChange = 1e-2;  // relative to the largest control, or to 1 if that is larger
constexpr double kFall = 1e-10;   // relative to the cost: above its rounding error

using Vectors = std::vector<Eigen::VectorXd>;

void limit(const ShootingProblem& problem, Vectors& us) {
  for (std::size_t t = 0; t < us.size(); ++t) {
    const ActionModelAbstract& model = *problem.model(t);
    if (model.get_has_control_limits()) us[t] = us[t].cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
  }
}

}  // namespace

bool falls_beside(ShootingProblem& problem, bool limits, double cost, Vectors& xs, Vectors& us) {
  double largest = 1;
  for (const Eigen::VectorXd& u : us)
    if (u.size() > 0) largest = std::max(largest, u.lpNorm<Eigen::Infinity>());
  std::mt19937 random(1);
  std::normal_distribution<double> change(0, kChange * largest);
  const Vectors centre = us;
  double least = cost - kFall * std::abs(cost);
  bool found = false;
  for (int k = 0; k < kTries; ++k) {
    Vectors tried = centre, motion(xs.size());
    for (Eigen::VectorXd& u : tried)
      for (double& number : u) number += change(random);
    if (limits) limit(problem, tried);
    problem.rollout(tried, motion);
    const double own = problem.total_cost();
    if (!(own < least)) continue;
    least = own;
    found = true;
    us = tried;
    xs = motion;
  }
  return found;
}

}  // namespace manycontact::task
