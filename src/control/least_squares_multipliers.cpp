#include <Eigen/Cholesky>

#include "kkt_residual.hpp"
#include "manycontact/control/joined_solver.hpp"
#include "manycontact/control/kkt_residual.hpp"

namespace manycontact {

namespace {

using Vectors = std::vector<Eigen::VectorXd>;

// A node's fx, and fu, lu without the controls that stand at a limit: their slope is the limit's multiplier.
struct FreeControls {
  Eigen::MatrixXd fx, fu;
  Eigen::VectorXd lu;
  FreeControls(const ActionModelAbstract& model, const ActionDataAbstract& d, const Eigen::VectorXd& u, bool limits)
      : lu(d.Lu) {
    d.dynamics(fx, fu);
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (!internal::stands_at_limit(model, u, i, limits)) continue;
      fu.col(i).setZero();
      lu[i] = 0;
    }
  }
};

// The Riccati recursion of the header's problem, and its multipliers along the steps it takes from dx_0 = 0.
Vectors of_one_part(const ShootingProblem& problem, const Vectors& us, bool limits) {
  const std::size_t T = problem.get_T();
  const Eigen::Index n = problem.get_ndx();
  std::vector<Eigen::MatrixXd> V(T + 1), K(T);
  Vectors v(T + 1), k(T), l(T + 1);
  V[T].setIdentity(n, n);
  v[T] = problem.data(T)->Lx;
  for (std::size_t t = T; t-- > 0;) {
    const ActionDataAbstract& d = *problem.data(t);
    const FreeControls free(*problem.model(t), d, us[t], limits);
    const Eigen::MatrixXd Vfu = V[t + 1] * free.fu, Qux = Vfu.transpose() * free.fx;
    Eigen::MatrixXd Quu = free.fu.transpose() * Vfu;
    Quu.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> llt(Quu);
    const Eigen::VectorXd Qu = free.lu + free.fu.transpose() * v[t + 1];
    k[t] = llt.solve(Qu);
    K[t] = llt.solve(Qux);
    V[t] = free.fx.transpose() * V[t + 1] * free.fx - Qux.transpose() * K[t];
    V[t].diagonal().array() += 1;
    v[t] = d.Lx + free.fx.transpose() * v[t + 1] - K[t].transpose() * Qu;
  }
  Eigen::VectorXd dx = Eigen::VectorXd::Zero(n);
  for (std::size_t t = 0;; ++t) {
    l[t] = v[t] + V[t] * dx;
    if (t == T) return l;
    const FreeControls free(*problem.model(t), *problem.data(t), us[t], limits);
    const Eigen::VectorXd du = -k[t] - K[t] * dx;
    dx = free.fx * dx + free.fu * du;
  }
}

}  // namespace

namespace internal {

bool stands_at_limit(const ActionModelAbstract& model, const Eigen::VectorXd& u, Eigen::Index i, bool limits) {
  return limits && model.get_has_control_limits() && (u[i] <= model.get_u_lb()[i] || u[i] >= model.get_u_ub()[i]);
}

Vectors least_squares_multipliers_of_nodes(const ShootingProblem& problem, const Vectors& us, bool limits) {
  Vectors out(problem.get_T() + 1, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.get_ndx())));
  for (const ShootingPart& part : separate(problem)) {
    Vectors own_us(us.size());
    for (std::size_t t = 0; t < us.size(); ++t) gather(us[t], part.u[t], own_us[t]);
    const Vectors own = SolverJoinedPart::serves(*part.problem)
                            ? least_squares_multipliers_of_joined(*part.problem, own_us, limits)
                            : of_one_part(*part.problem, own_us, limits);
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
