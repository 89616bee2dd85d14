#pragma once
// Nodes and problems for the tests of the control layer.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "action/problem.hpp"
#include "action/residual_factory.hpp"
#include "action/walker.hpp"
#include "manycontact/control.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using NodePtr = std::shared_ptr<ActionModelAbstract>;
using NodeDataPtr = std::shared_ptr<ActionDataAbstract>;

/// A state of a scene.
struct QuadState {
  VecX<Quad> q, v;
};

/// Returns the largest difference, relative to the larger of the second matrix and the rounding error of such values.
inline double twin_error(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& twin, double values) {
  const double difference = difference_of(mine, twin);
  return difference == 0 ? 0 : difference / std::max(size_of(twin), 1e-3 * values);
}

/// Returns (8 (f(e) - f(-e)) - (f(2e) - f(-2e))) / 12e, on the manifold, of a node's next state along (dx, du). It
/// overwrites `data`.
inline Eigen::VectorXd fourth_order(const Problem& p, const NodePtr& model, const NodeDataPtr& data,
                                    const Eigen::VectorXd& dx, const Eigen::VectorXd& du, double e) {
  model->calc(data, p.x, p.u);
  const Eigen::VectorXd middle = data->xnext;
  const auto at = [&](double s) {
    const Eigen::VectorXd x = p.state->integrate_x(p.x, s * dx), u = p.u + s * du;
    model->calc(data, x, u);
    return p.state->diff_dx(middle, data->xnext);
  };
  return (8 * (at(e) - at(-e)) - (at(2 * e) - at(-2 * e))) / (12 * e);
}

/// Returns [x_0; u_0; x_1; ...] of a solver's solution.
inline Eigen::VectorXd stacked(const SolverAbstract& solver) {
  std::vector<double> z;
  for (std::size_t t = 0; t < solver.get_xs().size(); ++t) {
    z.insert(z.end(), solver.get_xs()[t].begin(), solver.get_xs()[t].end());
    if (t < solver.get_us().size()) z.insert(z.end(), solver.get_us()[t].begin(), solver.get_us()[t].end());
  }
  return Eigen::Map<Eigen::VectorXd>(z.data(), static_cast<Eigen::Index>(z.size()));
}

/// Returns a scene of one to three robots with contacts, every residual as a cost, and some as constraints.
inline Problem problem_with_costs(int seed) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.nrobots = 1 + seed % 3;
  options.models = {ModelOptions{.floating_base = true, .armature = 0.1}, ModelOptions{}};
  options.same_link = 0;
  Problem p = make_problem(random_scene(rng, options));
  int k = 0;
  for (const NamedResidual& r : all_residuals(p.state, p.actuation, *p.contacts, 3)) {
    p.costs->addCost(r.name, std::make_shared<CostModelResidual>(p.state, r.residual), uniform(rng, 0.1, 2));
    if (k++ % 5) continue;
    const Eigen::VectorXd lower = random_vector(static_cast<int>(r.residual->get_nr()), rng);
    Eigen::VectorXd upper = lower;
    upper[0] += 1;  // one inequality, the others equalities
    p.constraints->addConstraint(r.name, std::make_shared<ConstraintModelResidual>(p.state, r.residual, lower, upper));
  }
  return p;
}

/// Returns a humanoid that reaches with a hand, on both soles, over T nodes of 20 ms.
inline std::shared_ptr<ShootingProblem> reaching_humanoid(std::size_t T, double hand = 50) {
  Walker w;
  w.add_cost("state", std::make_shared<ResidualModelState>(w.state, w.x_rest, w.nu), 0.5);
  w.add_cost("control", std::make_shared<ResidualModelControl>(w.state, w.nu), 1e-3);
  w.add_cost("hand",
             std::make_shared<ResidualModelFrameTranslation>(w.state, w.state->get_model()->getFrameId("left_hand"),
                                                             Eigen::Vector3d(0.3, 0.3, 1), w.nu),
             hand);
  const NodePtr running = std::make_shared<IntegratedActionModelEuler>(w.model(), 0.02);
  const NodePtr terminal = std::make_shared<IntegratedActionModelEuler>(w.model(), 0);
  return std::make_shared<ShootingProblem>(w.x_rest, std::vector<NodePtr>(T, running), terminal);
}

struct Guess {
  std::vector<Eigen::VectorXd> xs, us;
};
/// Returns x0 everywhere and the controls that keep it at rest.
inline Guess standing(ShootingProblem& problem) {
  const std::vector<Eigen::VectorXd> xs(problem.get_T() + 1, problem.get_x0());
  return {xs, problem.quasiStatic_xs(std::vector<Eigen::VectorXd>(problem.get_T(), problem.get_x0()))};
}

}  // namespace manycontact::test
