// manycontact/crocoddyl.hpp compiles a program of Crocoddyl unchanged, except for its state.

#include "manycontact/crocoddyl.hpp"

#include <gtest/gtest.h>

#include "manycontact/io/urdf.hpp"

namespace crocoddyl {
namespace program {  // programs reopen the namespace
namespace {

std::shared_ptr<StateMultibody> humanoid() {
  return std::make_shared<StateMultibody>(std::make_shared<const manycontact::Model>(
      manycontact::load_urdf(MANYCONTACT_SOURCE_DIR "/models/humanoid.urdf", {.floating_base = true})));
}

void fail(int code) { throw_pretty("code " << code); }

std::string warned(const std::function<void()>& act) {
  testing::internal::CaptureStderr();
  act();
  return testing::internal::GetCapturedStderr();
}

TEST(Crocoddyl, ThrowPretty) {
  try {
    fail(7);
    FAIL();
  } catch (const Exception& e) {
    EXPECT_EQ(e.getMessage(), "code 7");
    EXPECT_NE(e.getExtraData().find("crocoddyl_test.cpp"), std::string::npos);
    EXPECT_NE(std::string(e.what()).find("fail"), std::string::npos);
  }
}

TEST(Crocoddyl, StacksWarnAndGoOn) {
  const auto state = humanoid();
  CostModelSum costs(state);
  const auto cost = std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelState>(state));
  costs.addCost("a", cost, 1);
  EXPECT_EQ(warned([&] { costs.addCost("a", cost, 2); }),
            "Warning: we couldn't add the a cost item, it already existed.\n");
  EXPECT_EQ(costs.get_costs().at("a")->weight, 1);
  EXPECT_EQ(warned([&] { costs.changeCostStatus("b", true); }),
            "Warning: we couldn't change the status of the b cost item, it doesn't exist.\n");
  EXPECT_EQ(warned([&] { costs.removeCost("b"); }), "Warning: we couldn't remove the b cost item, it doesn't exist.\n");
  EXPECT_EQ(warned([&] { EXPECT_FALSE(costs.getCostStatus("b")); }),
            "Warning: we couldn't get the status of the b cost item, it doesn't exist.\n");
  EXPECT_EQ(warned([&] { costs.removeCost("a"); }), "");
  EXPECT_EQ(costs.get_nr(), 0u);

  const FrameIndex sole = state->get_pinocchio()->getFrameId("left_sole");
  ContactModelMultiple contacts(state);
  const auto contact = std::make_shared<ContactModel6D>(state, sole, SE3Tpl<double>(), LOCAL);
  contacts.addContact("c", contact);
  EXPECT_NE(warned([&] { contacts.addContact("c", contact); }), "");
  EXPECT_NE(warned([&] { contacts.removeContact("d"); }), "");
  EXPECT_EQ(contacts.get_nc(), 6u);
  ImpulseModelMultiple impulses(state);
  impulses.addImpulse("i", std::make_shared<ImpulseModel3D>(state, sole));
  EXPECT_NE(warned([&] { impulses.addImpulse("i", std::make_shared<ImpulseModel3D>(state, sole)); }), "");
  EXPECT_NE(warned([&] { impulses.changeImpulseStatus("j", false); }), "");
  EXPECT_EQ(impulses.get_nc(), 3u);
  ConstraintModelManager constraints(state);
  const auto constraint = std::make_shared<ConstraintModelResidual>(state, std::make_shared<ResidualModelState>(state));
  constraints.addConstraint("g", constraint);
  EXPECT_NE(warned([&] { constraints.addConstraint("g", constraint); }), "");
  EXPECT_NE(warned([&] { constraints.removeConstraint("h"); }), "");
  EXPECT_EQ(constraints.get_nh(), state->get_ndx());
}

// Action models and problems accept these stacks.
TEST(Crocoddyl, AWholeProgram) {
  const auto state = humanoid();
  const auto actuation = std::make_shared<ActuationModelFloatingBase>(state);
  const std::size_t nu = actuation->get_nu();
  const auto contacts = std::make_shared<ContactModelMultiple>(state, nu);
  const auto costs = std::make_shared<CostModelSum>(state, nu);
  const auto constraints = std::make_shared<ConstraintModelManager>(state, nu);
  costs->addCost("x", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelState>(state, nu)), 1);
  costs->addCost("u", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelControl>(state, nu)),
                 1e-3);
  const auto node = std::make_shared<IntegratedActionModelEuler>(
      std::make_shared<DifferentialActionModelContactFwdDynamics>(state, actuation, contacts, costs, constraints),
      0.01);
  const auto problem = std::make_shared<ShootingProblem>(
      state->zero(), std::vector<std::shared_ptr<ActionModelAbstract>>(5, node), node);
  SolverFDDP solver(problem);
  solver.solve();
  EXPECT_GT(solver.get_iter(), 0u);
  EXPECT_TRUE(std::isfinite(solver.get_cost()));
}

// A sum also works on a vector space, standalone and with residuals of one's own.
TEST(Crocoddyl, SumsOnAVectorSpace) {
  const auto state = std::make_shared<StateVector>(4);
  CostModelSum costs(state, 2);
  const Eigen::Vector4d xref(1, 2, 3, 4), x(0, 1, 0, 1);
  const Eigen::Vector2d u(5, 6);
  costs.addCost("x", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelState>(state, xref, 2)),
                2);
  costs.addCost("u", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelControl>(state, 2)), 3);
  DataCollectorAbstract shared;
  const auto data = costs.createData(&shared);
  costs.calc(data, x, u);
  costs.calcDiff(data, x, u);
  EXPECT_DOUBLE_EQ(data->cost, (x - xref).squaredNorm() + 1.5 * u.squaredNorm());
  EXPECT_LT((data->Lx - 2 * (x - xref)).norm(), 1e-14);
  EXPECT_LT((data->Lu - 3 * u).norm(), 1e-14);
  EXPECT_LT((data->Lxx - 2 * Eigen::Matrix4d::Identity()).norm(), 1e-14);
  ActionModelLQR lqr(4, 2);
  const auto node = lqr.createData();
  data->shareMemory(node.get());
  costs.calcDiff(data, x, u);
  EXPECT_LT((node->Lx - 2 * (x - xref)).norm(), 1e-14);
  EXPECT_EQ(node->Lxu.norm(), 0);
}

TEST(Crocoddyl, PseudoInverseOfAnyRank) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(5, 2) * Eigen::MatrixXd::Random(2, 4);
  const Eigen::MatrixXd b = ::pseudoInverse(a);
  EXPECT_LT((a * b * a - a).norm(), 1e-13);
  EXPECT_LT((b * a * b - b).norm(), 1e-12 * b.norm());
}

TEST(Crocoddyl, ControlsHaveATwin) {
  const auto model = std::make_shared<ControlParametrizationModelPolyTwoRK>(3, RKType::four);
  ControlParametrizationModelNumDiff twin(model);
  const auto data = model->createData(), expected = twin.createData();
  const Eigen::VectorXd u = Eigen::VectorXd::Random(static_cast<Eigen::Index>(model->get_nu()));
  model->calc(data, 0.3, u);
  model->calcDiff(data, 0.3, u);
  twin.calc(expected, 0.3, u);
  twin.calcDiff(expected, 0.3, u);
  EXPECT_EQ(data->w, expected->w);
  EXPECT_LT((data->dw_du - expected->dw_du).norm(), 1e-9);
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(2, 3), B = Eigen::MatrixXd::Random(3, 2);
  EXPECT_LT((model->multiplyByJacobian_J(data, A) - twin.multiplyByJacobian_J(expected, A)).norm(), 1e-9);
  EXPECT_LT((model->multiplyJacobianTransposeBy_J(data, B) - twin.multiplyJacobianTransposeBy_J(expected, B)).norm(),
            1e-9);
}

}  // namespace
}  // namespace program
}  // namespace crocoddyl
