// Squashed controls, thrusters, and numerical differentiation of actuations, activations and states are tested.

#include <cmath>

#include "action/walker.hpp"
#include "manycontact/io/urdf.hpp"

namespace manycontact::test {
namespace {

constexpr double kOfTwins = 1e-8;

void expect_as_its_twin(const std::shared_ptr<ActuationModelAbstract>& model, const Eigen::VectorXd& x,
                        const Eigen::VectorXd& u) {
  const auto data = model->createData();
  ActuationModelNumDiff twin(model);
  const auto expected = twin.createData();
  model->calc(data, x, u);
  model->calcDiff(data, x, u);
  twin.calcDiff(expected, x, u);
  EXPECT_EQ(data->tau, expected->tau);
  EXPECT_LT(twin_difference(data->dtau_dx, expected->dtau_dx), kOfTwins);
  EXPECT_LT(twin_difference(data->dtau_du, expected->dtau_du), kOfTwins);
  EXPECT_GT(Eigen::MatrixXd(data->dtau_du).norm(), 0.1);
  model->torqueTransform(data, x, u);
  const Eigen::MatrixXd B = data->dtau_du, M = data->Mtau;
  EXPECT_LT(twin_difference(B * M * B, B), 1e-12);
}

struct Quadrotor {
  std::shared_ptr<StateMultibody> state = std::make_shared<StateMultibody>(
      std::make_shared<const Model>(load_urdf(MANYCONTACT_SOURCE_DIR "/models/box.urdf", {.floating_base = true})));
  std::vector<Thruster> thrusters;
  Quadrotor() {
    for (int k = 0; k < 4; ++k)
      thrusters.emplace_back(
          SE3<double>{Eigen::Matrix3d::Identity(), {0.2 * std::cos(k * M_PI / 2), 0.2 * std::sin(k * M_PI / 2), 0}},
          0.02, k % 2 ? CW : CCW);
  }
};

TEST(Thrusters, PushAtTheirPlaces) {
  Quadrotor q;
  q.thrusters[0].pose.R = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const auto model = std::make_shared<ActuationModelFloatingBaseThrusters>(q.state, q.thrusters);
  ASSERT_EQ(model->get_nu(), 4u);
  const Eigen::VectorXd x = q.state->rand(), u = Eigen::Vector4d(1, 2, 3, 4);
  expect_as_its_twin(model, x, u);
  const auto data = model->createData();
  model->calc(data, x, u);
  Vec6<double> wrench = Vec6<double>::Zero();
  for (int k = 0; k < 4; ++k) {
    const Thruster& t = q.thrusters[static_cast<std::size_t>(k)];
    Vec6<double> own;
    own << 0, 0, 1, 0, 0, (t.type == CW ? 1 : -1) * t.ctorque;
    wrench += u[k] * t.pose.act_force(own);
  }
  EXPECT_LT(twin_difference(data->tau, wrench), 1e-15);
  model->commands(data, x, wrench);
  EXPECT_LT(twin_difference(data->u, u), 1e-12);
  q.thrusters.pop_back();
  EXPECT_THROW(model->set_thrusters(q.thrusters), std::invalid_argument);
  const auto fixed = std::make_shared<StateMultibody>(
      std::make_shared<const Model>(load_urdf(MANYCONTACT_SOURCE_DIR "/models/arm.urdf")));
  EXPECT_THROW(ActuationModelFloatingBaseThrusters(fixed, q.thrusters), std::invalid_argument);
}

// tau_set has these bits: a multicopter is pushed along its z, and rotates.
TEST(Thrusters, SayWhatTheyMove) {
  const Quadrotor q;
  const auto data = ActuationModelFloatingBaseThrusters(q.state, q.thrusters).createData();
  EXPECT_EQ(data->tau_set, (std::vector<bool>{false, false, true, true, true, true}));
}

TEST(Thrusters, DriveAnAction) {
  const Quadrotor q;
  const auto model = std::make_shared<ActuationModelFloatingBaseThrusters>(q.state, q.thrusters);
  const auto contacts = std::make_shared<ContactModelMultiple>(q.state, 4);
  const auto costs = std::make_shared<CostModelSum>(q.state, 4);
  const auto action = std::make_shared<DifferentialActionModelContactFwdDynamics>(q.state, model, contacts, costs);
  const auto data = action->createData();
  const Eigen::VectorXd hover = action->quasiStatic_x(data, q.state->zero());
  EXPECT_LT((hover.array() - hover.mean()).abs().maxCoeff(), 1e-10 * hover.mean());
  action->calc(data, q.state->zero(), hover);
  EXPECT_LT(data->xout.norm(), 1e-10);
  action->calcDiff(data, q.state->zero(), hover);
  DifferentialActionModelNumDiff twin(action);
  const auto expected = twin.createData();
  twin.calc(expected, q.state->zero(), hover);
  twin.calcDiff(expected, q.state->zero(), hover);
  EXPECT_LT(twin_difference(data->Fx, expected->Fx), 1e-7);
  EXPECT_LT(twin_difference(data->Fu, expected->Fu), 1e-7);
}

TEST(Squashing, KeepsWithinItsBoundsSmoothly) {
  const Eigen::Vector2d low(-1, 2), high(3, 2.5);
  SquashingModelSmoothSat squashing(low, high, 2);
  const auto data = squashing.createData();
  for (const double s : {-1e3, -1.0, 0.7, 2.2, 3.0, 1e3}) {
    squashing.calc(data, Eigen::Vector2d::Constant(s));
    EXPECT_TRUE((data->u.array() >= low.array() - 1e-3).all() && (data->u.array() <= high.array() + 1e-3).all()) << s;
    const Eigen::VectorXd u = data->u;
    squashing.calcDiff(data, Eigen::Vector2d::Constant(s));
    squashing.calc(data, Eigen::Vector2d::Constant(s + 1e-5));
    EXPECT_LT(twin_difference((data->u - u) / 1e-5, data->du_ds.diagonal()), 1e-3) << s;
  }
  EXPECT_EQ(squashing.get_s_lb(), low);
  squashing.set_smooth(0.5);
  EXPECT_LT(twin_difference(squashing.get_d(), 0.5 * (high - low)), 1e-15);
  EXPECT_THROW(squashing.set_smooth(-1), std::invalid_argument);
  EXPECT_THROW(SquashingModelSmoothSat(high, low, 2), std::invalid_argument);
  EXPECT_THROW(SquashingModelSmoothSat(low, high, 3), std::invalid_argument);
}

TEST(Squashing, OfAnActuation) {
  const Walker w;
  const auto n = static_cast<Eigen::Index>(w.nu);
  const auto squashing = std::make_shared<SquashingModelSmoothSat>(Eigen::VectorXd::Constant(n, -20),
                                                                   Eigen::VectorXd::Constant(n, 10), w.nu);
  const auto model = std::make_shared<ActuationSquashingModel>(w.actuation, squashing, w.nu);
  expect_as_its_twin(model, w.x, 3 * w.u);
  const auto data = model->createData();
  EXPECT_EQ(data->tau_set, w.actuation->createData()->tau_set);
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(n, -0.5, 0.5);
  model->calc(data, w.x, u);
  model->commands(data, w.x, data->tau);
  EXPECT_TRUE(data->u.allFinite());
  EXPECT_THROW(ActuationSquashingModel(w.actuation, squashing, w.nu + 1), std::invalid_argument);
}

TEST(Actuations, OfAFixedBaseAndOfAnyState) {
  const auto state = std::make_shared<StateMultibody>(
      std::make_shared<const Model>(load_urdf(MANYCONTACT_SOURCE_DIR "/models/arm.urdf")));
  const auto floating = std::make_shared<ActuationModelFloatingBase>(state);
  EXPECT_EQ(floating->get_nu(), state->get_nv());
  const Eigen::VectorXd x = state->rand();
  const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(static_cast<Eigen::Index>(state->get_nv()), 1, 2);
  expect_as_its_twin(floating, x, u);
  const auto any = std::make_shared<StateNumDiff>(state);  // no StateMultibody
  const auto full = std::make_shared<ActuationModelFull>(any);
  EXPECT_EQ(full->get_nu(), state->get_nv());
  expect_as_its_twin(full, x, u);
}

TEST(NumDiffOfParts, States) {
  const Walker w;
  const Eigen::VectorXd x0 = w.x, x1 = w.state->integrate_x(w.x, 0.1 * Eigen::VectorXd::Random(w.state->get_ndx()));
  const Eigen::VectorXd dx = 0.3 * Eigen::VectorXd::Random(static_cast<Eigen::Index>(w.state->get_ndx()));
  const StateNumDiff twin(w.state);
  for (const Jcomponent which : {first, second}) {
    EXPECT_LT(twin_difference(w.state->Jdiff_Js(x0, x1, which)[0], twin.Jdiff_Js(x0, x1, which)[0]), kOfTwins);
    const Eigen::MatrixXd J = w.state->Jintegrate_Js(x0, dx, which)[0];
    EXPECT_LT(twin_difference(J, twin.Jintegrate_Js(x0, dx, which)[0]), kOfTwins);
    Eigen::MatrixXd mine = Eigen::MatrixXd::Random(dx.size(), 3), other = mine;
    w.state->JintegrateTransport(x0, dx, mine, which);
    twin.JintegrateTransport(x0, dx, other, which);
    EXPECT_LT(twin_difference(mine, other), kOfTwins);
  }
  EXPECT_EQ(twin.diff_dx(x0, x1), w.state->diff_dx(x0, x1));
  EXPECT_EQ(twin.zero(), w.state->zero());
  EXPECT_EQ(twin.get_nv(), w.state->get_nv());
}

TEST(NumDiffOfParts, Activations) {
  const Eigen::VectorXd r = Eigen::VectorXd::LinSpaced(4, -1, 1.7);
  const auto model = std::make_shared<ActivationModelQuadFlatLog>(4, 0.7);
  const auto data = model->createData();
  model->calc(data, r);
  model->calcDiff(data, r);
  ActivationModelNumDiff twin(model);
  const auto expected = twin.createData();
  twin.calc(expected, r);
  twin.calcDiff(expected, r);
  EXPECT_EQ(data->a_value, expected->a_value);
  EXPECT_LT(twin_difference(data->Ar, expected->Ar), kOfTwins);
  EXPECT_LT(twin_difference(data->Arr.diagonal(), expected->Arr.diagonal()), kOfTwins);
  EXPECT_THROW(twin.set_disturbance(0), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
