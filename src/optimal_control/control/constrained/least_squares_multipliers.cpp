#include <limits>

#include "kkt_residual.hpp"
#include "manycontact/control/kkt_residual.hpp"
#include "manycontact/lq/choose.hpp"
#include "quadratic_model.hpp"

namespace manycontact {

namespace {

using Vectors = std::vector<Eigen::VectorXd>;

// The problem of the header. The wrenches of couplings are variables whose only cost is Lw. Controls at a limit are
// left out: their gradient is the multiplier of the limit.
lq::Problem problem_of(const ShootingProblem& problem, const Vectors& us, bool limits,
                       const std::vector<ActionPart>& blocks) {
  lq::Problem out = internal::structure_of(problem, blocks);
  internal::fill_nodes(problem, internal::Terms::kWithoutHessians, out);
  for (std::size_t t = 0; t <= us.size(); ++t)
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      lq::Group& group = out.knots[t].groups[i];
      group.Q.setIdentity();
      if (t == us.size()) continue;
      for (std::size_t j = 0; j < blocks[i].u.size(); ++j) {
        const Eigen::Index at = static_cast<Eigen::Index>(j);
        group.R(at, at) = 1;
        if (blocks[i].u[j] >= us[t].size() ||
            !internal::stands_at_limit(*problem.model(t), us[t], blocks[i].u[j], limits))
          continue;
        group.B.col(at).setZero();
        group.D.col(at).setZero();
        group.r[at] = 0;
      }
    }
  return out;
}

// Returns NaN if there is no solution, for instance if couplings are dependent and contradictory.
Vectors of_part(const ShootingProblem& problem, const Vectors& us, bool limits) {
  const std::vector<ActionPart> blocks = internal::blocks_of(problem);
  const lq::Problem lq = problem_of(problem, us, limits, blocks);
  const std::unique_ptr<lq::DirectionSolver> solver = lq::choose(lq);
  lq::Point z;
  const bool answered = solver->factorize(lq).status == lq::Status::kOk;
  const lq::Status status = answered ? solver->solve(lq, z).status : lq::Status::kSingular;
  const lq::Layout layout(lq);
  Vectors out(problem.get_T() + 1,
              Eigen::VectorXd::Constant(problem.get_ndx(), std::numeric_limits<double>::quiet_NaN()));
  if (status != lq::Status::kOk && status != lq::Status::kInaccurate) return out;
  for (std::size_t t = 0; t < out.size(); ++t)
    for (std::size_t i = 0; i < blocks.size(); ++i)
      scatter(z.lambda[t].segment(layout.x[i], lq.nx[i]), blocks[i].dx, out[t]);
  return out;
}

}  // namespace

namespace internal {

bool stands_at_limit(const ActionModelAbstract& model, const Eigen::VectorXd& u, Eigen::Index i, bool limits) {
  return limits && model.get_has_control_limits() && (u[i] <= model.get_u_lb()[i] || u[i] >= model.get_u_ub()[i]);
}

Vectors least_squares_multipliers_of_nodes(const ShootingProblem& problem, const Vectors& us, bool limits) {
  Vectors out(problem.get_T() + 1, Eigen::VectorXd::Zero(problem.get_ndx()));
  for (const ShootingPart& part : separate(problem)) {
    Vectors own_us(us.size());
    for (std::size_t t = 0; t < us.size(); ++t) gather(us[t], part.u[t], own_us[t]);
    const Vectors own = of_part(*part.problem, own_us, limits);
    for (std::size_t t = 0; t < out.size(); ++t) scatter(own[t], part.dx, out[t]);
  }
  return out;
}

}  // namespace internal

Vectors least_squares_multipliers(ShootingProblem& problem, const Vectors& xs, const Vectors& us, bool limits) {
  problem.calc(xs, us);
  problem.calcDiff(xs, us);
  return internal::least_squares_multipliers_of_nodes(problem, us, limits);
}

}  // namespace manycontact
