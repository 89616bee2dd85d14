#include <algorithm>
#include <limits>

#include "manycontact/control/parts.hpp"
#include "manycontact/task/optimize.hpp"

namespace manycontact {

namespace {

// |x|, infinity where a number is not finite.
double largest(const Eigen::VectorXd& x) {
  if (!x.allFinite()) return std::numeric_limits<double>::infinity();
  return x.size() > 0 ? x.lpNorm<Eigen::Infinity>() : 0;
}

using Vectors = std::vector<Eigen::VectorXd>;

// By the derivatives of the last calcDiff.
double of_part(const ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& l, bool limits) {
  const std::size_t T = problem.get_T();
  const StateAbstract& state = *problem.get_terminalModel()->get_state();
  double worst =
      std::max(largest(state.diff_dx(xs[0], problem.get_x0())), largest(problem.get_terminalData()->Lx - l[T]));
  for (std::size_t t = 0; t < T; ++t) {
    const ActionModelAbstract& model = *problem.get_runningModels()[t];
    const ActionDataAbstract& data = *problem.get_runningDatas()[t];
    worst = std::max({worst, largest(state.diff_dx(xs[t + 1], data.xnext)),
                      largest(data.Lx + data.Fx.transpose() * l[t + 1] - l[t])});
    if (model.get_nu() == 0) continue;
    Eigen::VectorXd slope = data.Lu + data.Fu.transpose() * l[t + 1];
    if (limits && model.get_has_control_limits())
      slope = us[t] - (us[t] - slope).cwiseMax(model.get_u_lb()).cwiseMin(model.get_u_ub());
    worst = std::max(worst, largest(slope));
  }
  return worst;
}

}  // namespace

double kkt_residual(ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& multipliers,
                    bool limits) {
  problem.calc(xs, us);
  problem.calcDiff(xs, us);
  double worst = 0;
  for (const ShootingPart& part : separate(problem)) {
    Vectors own_xs(xs.size()), own_us(us.size()), l(xs.size());
    for (std::size_t t = 0; t < xs.size(); ++t) {
      gather(xs[t], part.x, own_xs[t]);
      gather(multipliers[t], part.dx, l[t]);
      if (t < us.size()) gather(us[t], part.u[t], own_us[t]);
    }
    worst = std::max(worst, of_part(*part.problem, own_xs, own_us, l, limits));
  }
  return worst;
}

}  // namespace manycontact
