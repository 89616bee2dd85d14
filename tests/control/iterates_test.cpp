// Iterates are Crocoddyl's on a task of ../shared/tasks, if present: an arm reaches with its hand, RK4, FDDP.

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "control/nodes.hpp"

namespace manycontact::test {
namespace {

const std::string kTask = std::string(MANYCONTACT_SHARED_DIR) + "/tasks/panda_reach_rk4";

struct Arm {
  SceneFile file = load_scene(kTask + "_scene.xml");
  std::shared_ptr<StateMultibody> state = std::make_shared<StateMultibody>(file.scene);
  std::shared_ptr<ActuationModelAbstract> actuation = std::make_shared<ActuationModelFull>(state);
  std::size_t nu = actuation->get_nu();
  FrameIndex hand = state->get_model()->getFrameId("panda_hand");
  Eigen::VectorXd x0 = (Eigen::VectorXd(18) << file.q, file.v).finished();

  // Uses the numbers of panda_reach_rk4.xml.
  std::shared_ptr<DifferentialActionModelAbstract> model(bool control, double reach, double still) const {
    auto costs = std::make_shared<CostModelSum>(state, nu);
    const auto add = [&](const char* name, std::shared_ptr<ResidualModelAbstract> residual, double weight) {
      costs->addCost(name, std::make_shared<CostModelResidual>(state, residual), weight);
    };
    const Eigen::Quaterniond quat(-0.0007288691434336904, 0.9949776468393071, -0.007264379583691248,
                                  0.09983075592797508);
    const SE3<double> goal{quat.toRotationMatrix(), {0.47634325824080204, 0.19999999999999984, 0.5446975742619171}};
    if (control) add("control", std::make_shared<ResidualModelControl>(state, nu), 1e-3);
    if (reach > 0) add("hand", std::make_shared<ResidualModelFramePlacement>(state, hand, goal, nu), reach);
    if (still > 0)
      add("still", std::make_shared<ResidualModelFrameVelocity>(state, hand, Vec6<double>::Zero(), LOCAL, nu), still);
    const Eigen::VectorXd weights =
        (Eigen::VectorXd(18) << Eigen::VectorXd::Constant(9, 0.5), Eigen::VectorXd::Constant(9, 0.1)).finished();
    costs->addCost("state",
                   std::make_shared<CostModelResidual>(state, std::make_shared<ActivationModelWeightedQuad>(weights),
                                                       std::make_shared<ResidualModelState>(state, x0, nu)),
                   1);
    return std::make_shared<DifferentialActionModelFreeFwdDynamics>(state, actuation, costs);
  }

  std::shared_ptr<ShootingProblem> problem() const {
    const NodePtr first = std::make_shared<IntegratedActionModelRK>(model(true, 0, 0), four, 0.02);
    const NodePtr second = std::make_shared<IntegratedActionModelRK>(model(true, 10, 0.5), four, 0.02);
    std::vector<NodePtr> nodes(20, first);
    nodes.resize(40, second);
    return std::make_shared<ShootingProblem>(x0, nodes,
                                             std::make_shared<IntegratedActionModelEuler>(model(false, 1000, 0), 0));
  }
};

Eigen::VectorXd vector_of(const nlohmann::json& numbers) {
  const auto v = numbers.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

TEST(Iterates, OfAnArmAreCrocoddyls) {
  if (!std::filesystem::exists(kTask + ".json")) GTEST_SKIP() << "skipped: no ../shared/tasks here";
  nlohmann::json golden;
  std::ifstream(kTask + ".json") >> golden;
  const auto problem = Arm().problem();
  const Guess guess = standing(*problem);
  SolverFDDP solver(problem);
  const auto log = std::make_shared<CallbackLogger>();
  solver.setCallbacks({log});
  EXPECT_TRUE(solver.solve(guess.xs, guess.us, 200));
  const nlohmann::json& iterations = golden["iterations"];
  ASSERT_EQ(log->costs.size(), iterations.size());
  for (std::size_t k = 0; k < iterations.size(); ++k) {
    const double cost = iterations[k]["cost"], stop = iterations[k]["stop"];
    EXPECT_EQ(log->steps[k], iterations[k]["step_length"].get<double>());
    EXPECT_EQ(log->pregs[k], iterations[k]["regularisation"].get<double>());
    EXPECT_EQ(log->feasible[k], iterations[k]["feasible"].get<bool>());
    if (stop < 1e-6) continue;  // rounding decides
    EXPECT_LT(std::abs(log->costs[k] - cost), 1e-6 * cost);
    EXPECT_LT(std::abs(log->stops[k] - stop), 1e-6 * stop);
  }
  for (std::size_t t = 0; t <= 40; ++t) EXPECT_LT(difference_of(solver.get_xs()[t], vector_of(golden["xs"][t])), 1e-5);
  for (std::size_t t = 0; t < 40; ++t) EXPECT_LT(difference_of(solver.get_us()[t], vector_of(golden["us"][t])), 1e-5);
}

}  // namespace
}  // namespace manycontact::test
