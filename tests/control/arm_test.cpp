// In a program for Crocoddyl, after a change of namespace and of the state's construction, an arm reaches a pose.

#include <gtest/gtest.h>

#include "manycontact/crocoddyl.hpp"
#include "manycontact/io/urdf.hpp"

namespace {

using Eigen::VectorXd;

template <class Scalar>
void build(std::shared_ptr<crocoddyl::ActionModelAbstractTpl<Scalar>>& running,
           std::shared_ptr<crocoddyl::ActionModelAbstractTpl<Scalar>>& terminal) {
  using StateMultibody = crocoddyl::StateMultibodyTpl<Scalar>;
  using CostModelSum = crocoddyl::CostModelSumTpl<Scalar>;
  using CostModelAbstract = crocoddyl::CostModelAbstractTpl<Scalar>;
  using CostModelResidual = crocoddyl::CostModelResidualTpl<Scalar>;
  using Vector3s = typename crocoddyl::MathBaseTpl<Scalar>::Vector3s;
  using Matrix3s = typename crocoddyl::MathBaseTpl<Scalar>::Matrix3s;
  using Vector6s = typename crocoddyl::MathBaseTpl<Scalar>::Vector6s;

  auto state = std::make_shared<StateMultibody>(
      std::make_shared<crocoddyl::Model>(crocoddyl::load_urdf(MANYCONTACT_SOURCE_DIR "/models/arm.urdf", {})));
  const auto tool = state->get_pinocchio()->getFrameId("tool");
  Matrix3s down = Matrix3s::Identity();
  down.diagonal() << 1, -1, -1;
  std::shared_ptr<CostModelAbstract> goal = std::make_shared<CostModelResidual>(
      state, std::make_shared<crocoddyl::ResidualModelFramePlacementTpl<Scalar>>(
                 state, tool, crocoddyl::SE3<Scalar>{down, Vector3s(0.5, 0.2, 0.4)}));
  std::shared_ptr<CostModelAbstract> still = std::make_shared<CostModelResidual>(
      state, std::make_shared<crocoddyl::ResidualModelFrameVelocityTpl<Scalar>>(state, tool, Vector6s(Vector6s::Zero()),
                                                                                crocoddyl::LOCAL_WORLD_ALIGNED));
  std::shared_ptr<CostModelAbstract> rest =
      std::make_shared<CostModelResidual>(state, std::make_shared<crocoddyl::ResidualModelStateTpl<Scalar>>(state));
  std::shared_ptr<CostModelAbstract> torques =
      std::make_shared<CostModelResidual>(state, std::make_shared<crocoddyl::ResidualModelControlTpl<Scalar>>(state));

  auto on_the_way = std::make_shared<CostModelSum>(state), at_the_end = std::make_shared<CostModelSum>(state);
  on_the_way->addCost("goal", goal, 1);
  on_the_way->addCost("rest", rest, 1e-1);
  on_the_way->addCost("torques", torques, 1e-3);
  at_the_end->addCost("goal", goal, 1e3);
  at_the_end->addCost("still", still, 1e1);

  auto actuation = std::make_shared<crocoddyl::ActuationModelFullTpl<Scalar>>(state);
  const auto integrated = [&](const auto& costs, double step) {
    return std::make_shared<crocoddyl::IntegratedActionModelEulerTpl<Scalar>>(
        std::make_shared<crocoddyl::DifferentialActionModelFreeFwdDynamicsTpl<Scalar>>(state, actuation, costs), step);
  };
  running = integrated(on_the_way, 1e-2);
  terminal = integrated(at_the_end, 0);
}

struct Program {
  static constexpr std::size_t N = 100;
  std::shared_ptr<crocoddyl::ActionModelAbstract> running, terminal;
  std::shared_ptr<crocoddyl::StateMultibody> state;
  std::shared_ptr<crocoddyl::ShootingProblem> problem;
  std::vector<VectorXd> xs, us;

  Program() {
    build<double>(running, terminal);
    state = std::static_pointer_cast<crocoddyl::StateMultibody>(running->get_state());
    VectorXd x0 = state->zero();
    x0.head(7) << 0.2, 0.4, -0.1, 1.2, 0.3, 0.8, 0;
    const std::vector<std::shared_ptr<crocoddyl::ActionModelAbstract>> models(N, running);
    problem = std::make_shared<crocoddyl::ShootingProblem>(x0, models, terminal);
    xs.assign(N + 1, x0);
    us.assign(N, VectorXd::Zero(running->get_nu()));
    for (std::size_t i = 0; i < N; ++i) {
      const std::shared_ptr<crocoddyl::ActionModelAbstract>& model = problem->get_runningModels()[i];
      const std::shared_ptr<crocoddyl::ActionDataAbstract>& data = problem->get_runningDatas()[i];
      model->quasiStatic(data, us[i], x0);
    }
  }
  // Returns the costs of the node, as a user gets them.
  static const std::shared_ptr<manycontact::CostModelSum>& costs(
      const std::shared_ptr<crocoddyl::ActionModelAbstract>& node) {
    const auto euler = std::static_pointer_cast<crocoddyl::IntegratedActionModelEuler>(node);
    return std::static_pointer_cast<crocoddyl::DifferentialActionModelFreeFwdDynamics>(euler->get_differential())
        ->get_costs();
  }
  double distance(const VectorXd& x) const {
    const auto data = terminal->createData();
    terminal->calc(data, x);
    const auto euler = std::static_pointer_cast<crocoddyl::IntegratedActionDataEuler>(data);
    return std::static_pointer_cast<crocoddyl::DifferentialActionDataFreeFwdDynamics>(euler->differential)
        ->costs->costs.at("goal")
        ->residual->r.norm();
  }
};

TEST(ArmProgram, Reaches) {
  Program p;
  crocoddyl::SolverFDDP solver(p.problem);
  std::vector<std::shared_ptr<crocoddyl::CallbackAbstract>> callbacks;
  std::ostringstream out;
  callbacks.push_back(std::make_shared<crocoddyl::CallbackVerbose>());
  std::streambuf* before = std::cout.rdbuf(out.rdbuf());
  solver.setCallbacks(callbacks);
  const bool converged = solver.solve(p.xs, p.us, 200, false, 0.1);
  std::cout.rdbuf(before);
  EXPECT_TRUE(converged) << to_string(solver.reason());
  EXPECT_NE(out.str().find("iter"), std::string::npos);
  EXPECT_GT(p.distance(p.xs[0]), 0.3);
  EXPECT_LT(p.distance(solver.get_xs().back()), 0.02);
  const auto again = p.problem->rollout_us(solver.get_us());
  EXPECT_LT((again.back() - solver.get_xs().back()).norm(), 1e-8);

  // DDP from this solution has nothing left to do.
  crocoddyl::SolverDDP ddp(p.problem);
  EXPECT_TRUE(ddp.solve(solver.get_xs(), solver.get_us(), 10, true));
  EXPECT_LE(ddp.get_iter(), 2u);
  EXPECT_NEAR(ddp.get_cost(), solver.get_cost(), 1e-8 * solver.get_cost());
}

// With another goal, other weights and fewer costs the problem is solved again from its last solution.
TEST(ArmProgram, FollowsAMovedGoal) {
  Program p;
  crocoddyl::SolverFDDP solver(p.problem);
  EXPECT_TRUE(solver.solve(p.xs, p.us, 200));
  const auto costs = Program::costs(p.terminal);
  const auto goal = std::static_pointer_cast<crocoddyl::ResidualModelFramePlacement>(
      costs->get_costs().find("goal")->second->cost->get_residual());
  crocoddyl::SE3<double> pose = goal->get_reference();
  pose.p[1] -= 0.3;
  goal->set_reference(pose);  // shared with the running nodes
  EXPECT_GT(p.distance(solver.get_xs().back()), 0.2);
  EXPECT_TRUE(solver.solve(solver.get_xs(), solver.get_us(), 200, false));
  EXPECT_LT(p.distance(solver.get_xs().back()), 0.02);
  const double with_torques = solver.get_cost();
  Program::costs(p.running)->changeCostStatus("torques", false);
  EXPECT_FALSE(Program::costs(p.running)->getCostStatus("torques"));
  costs->get_costs().at("goal")->weight = 1e4;
  EXPECT_TRUE(solver.solve(solver.get_xs(), solver.get_us(), 200, true));
  EXPECT_LT(solver.get_cost(), with_torques);
  EXPECT_LT(p.distance(solver.get_xs().back()), 0.01);
  p.problem->circularAppend(p.running);
  p.problem->set_x0(solver.get_xs()[1]);
  EXPECT_TRUE(solver.solve(solver.get_xs(), solver.get_us(), 200, false));
}

}  // namespace
