// Every public member of Crocoddyl's and sobec's DifferentialActionModelContactFwdDynamics has its name and meaning.
// The table in src/doc/action.md names the test of each member.

#include <sstream>
#include <thread>
#include <type_traits>

#include "action/walker.hpp"

namespace manycontact::test {
namespace {

TEST(ActionApi, Types) {
  static_assert(std::is_same_v<ActionModel::ActuationModelAbstract, ActuationModelAbstract>);
  static_assert(std::is_same_v<ActionModel::Base, DifferentialActionModelAbstract>);
  static_assert(std::is_base_of_v<ActionModel::Base, ActionModel>);
  static_assert(std::is_same_v<ActionModel::ConstraintModelManager, ConstraintModelManager>);
  static_assert(std::is_same_v<ActionModel::ContactModelMultiple, ContactModelMultiple>);
  static_assert(std::is_same_v<ActionModel::crocoContactModelMultiple, ContactModelMultiple>);
  static_assert(std::is_same_v<ActionModel::CostModelSum, CostModelSum>);
  static_assert(std::is_same_v<ActionModel::Data, DifferentialActionDataContactFwdDynamics>);
  static_assert(std::is_same_v<ActionModel::DifferentialActionDataAbstract, DifferentialActionDataAbstract>);
  static_assert(std::is_same_v<ActionModel::MathBase, MathBase>);
  static_assert(std::is_same_v<ActionModel::MatrixXs, Eigen::MatrixXd>);
  static_assert(std::is_same_v<ActionModel::VectorXs, Eigen::VectorXd>);
  static_assert(std::is_same_v<ActionModel::Scalar, double>);
  static_assert(std::is_same_v<ActionModel::StateAbstract, StateAbstract>);
  static_assert(std::is_same_v<ActionModel::StateMultibody, StateMultibody>);
  static_assert(std::has_virtual_destructor_v<ActionModel>);
  using Base = ActionModel::Base;
  static_assert(std::is_same_v<Base::DifferentialActionDataAbstract, DifferentialActionDataAbstract>);
  static_assert(std::is_same_v<Base::MathBase::MatrixXs, Base::MatrixXs>);
  static_assert(std::is_same_v<Base::MathBase::VectorXs, Base::VectorXs>);
  static_assert(std::is_same_v<Base::MathBase::Scalar, Base::Scalar>);
  static_assert(std::is_same_v<Base::StateAbstract, StateAbstract>);
}

// A program written for Crocoddyl constructs these, with arguments in its order and with its defaults.
TEST(ActionApi, Constructors) {
  Walker w;
  w.add_costs();
  ActionModel plain(w.state, w.actuation, w.contacts, w.costs);
  EXPECT_EQ(plain.get_damping_factor(), 0);
  EXPECT_FALSE(plain.get_enable_force());
  EXPECT_EQ(plain.get_constraints(), nullptr);
  ActionModel damped(w.state, w.actuation, w.contacts, w.costs, 1e-3, true);
  EXPECT_EQ(damped.get_damping_factor(), 1e-3);
  EXPECT_TRUE(damped.get_enable_force());
  ActionModel constrained(w.state, w.actuation, w.contacts, w.costs, w.constraints);
  EXPECT_EQ(constrained.get_damping_factor(), 0);
  EXPECT_FALSE(constrained.get_enable_force());
  EXPECT_EQ(constrained.get_constraints(), w.constraints);
  ActionModel both(w.state, w.actuation, w.contacts, w.costs, w.constraints, 1e-3, true);
  EXPECT_EQ(both.get_damping_factor(), 1e-3);
  EXPECT_TRUE(both.get_enable_force());
  const DataPtr a = evaluated(plain, w.x, w.u), b = evaluated(constrained, w.x, w.u);
  EXPECT_EQ(difference_of(*b, *a), 0);
  EXPECT_EQ(difference_of(*evaluated(both, w.x, w.u), *evaluated(damped, w.x, w.u)), 0);
}

// enable_force requests derivatives of the contact forces, which nothing else requests here.
TEST(ActionApi, EnableForce) {
  Walker w;
  const DataPtr without = evaluated(*w.model(false), w.x, w.u), with = evaluated(*w.model(true), w.x, w.u);
  EXPECT_EQ(contact_data(without, "left").df_dx.size(), 0);
  EXPECT_EQ(contact_data(with, "left").df_dx.rows(), 6);
  EXPECT_EQ(contact_data(with, "left").df_dx.cols(), static_cast<Eigen::Index>(w.state->get_ndx()));
  EXPECT_EQ(contact_data(with, "left").df_du.cols(), static_cast<Eigen::Index>(w.nu));
  EXPECT_GT(size_of(contact_data(with, "left").df_dx), 0);
  EXPECT_EQ(difference_of(*without, *with), 0);
}

TEST(ActionApi, Getters) {
  Walker w;
  w.add_costs();
  w.constraints->addConstraint("com", w.com_within(-1, 1));
  w.constraints->addConstraint("com_held", w.com_within(0.3, 0.3));
  const auto model = w.model();
  EXPECT_EQ(model->get_actuation(), w.actuation);
  EXPECT_EQ(model->get_contacts(), w.contacts);
  EXPECT_EQ(model->get_costs(), w.costs);
  EXPECT_EQ(model->get_constraints(), w.constraints);
  EXPECT_EQ(model->get_state(), w.state);
  EXPECT_EQ(&model->get_pinocchio(), w.state->get_pinocchio().get());
  EXPECT_EQ(&model->get_model(), w.state->get_model().get());
  EXPECT_EQ(model->get_pinocchio().nv, w.file.scene.nv);
  EXPECT_EQ(model->get_nu(), static_cast<std::size_t>(w.file.scene.nu));
  EXPECT_EQ(model->get_nr(), w.state->get_ndx() + w.nu + 3 + 6 + w.state->get_nv());
  EXPECT_EQ(model->get_ng(), 3u);
  EXPECT_EQ(model->get_nh(), 3u);
  w.costs->changeCostStatus("com", false);
  w.constraints->changeConstraintStatus("com_held", false);
  EXPECT_EQ(model->get_nr(), w.state->get_ndx() + w.nu + 6 + w.state->get_nv());
  EXPECT_EQ(model->get_nh(), 0u);
  EXPECT_EQ(evaluated(*model, w.x, w.u)->r.size(), static_cast<Eigen::Index>(model->get_nr()));
}

TEST(ActionApi, CreateDataAndCheckData) {
  Walker w;
  w.add_costs();
  w.constraints->addConstraint("com", w.com_within(-1, 1));
  const auto model = w.model(), other = w.model();
  const DataPtr data = model->createData();
  const Eigen::Index nv = w.state->get_nv(), ndx = w.state->get_ndx(), nu = w.nu;
  ASSERT_NE(std::dynamic_pointer_cast<ActionModel::Data>(data), nullptr);
  EXPECT_EQ(data->xout.size(), nv);
  EXPECT_EQ(data->Fx.rows(), nv);
  EXPECT_EQ(data->Fx.cols(), ndx);
  EXPECT_EQ(data->Fu.cols(), nu);
  EXPECT_EQ(data->r.size(), static_cast<Eigen::Index>(model->get_nr()));
  EXPECT_EQ(data->Lx.size(), ndx);
  EXPECT_EQ(data->Lu.size(), nu);
  EXPECT_EQ(data->Lxx.cols(), ndx);
  EXPECT_EQ(data->Lxu.cols(), nu);
  EXPECT_EQ(data->Luu.rows(), nu);
  EXPECT_EQ(data->g.size(), 3);
  EXPECT_EQ(data->Gx.rows(), 3);
  EXPECT_EQ(data->h.size(), 0);
  EXPECT_TRUE(model->checkData(data));
  EXPECT_FALSE(other->checkData(data));
  EXPECT_FALSE(model->checkData(other->createData()));
  EXPECT_FALSE(model->checkData(std::make_shared<DifferentialActionDataAbstract>(model.get())));
  EXPECT_FALSE(model->checkData(nullptr));
}

TEST(ActionApi, Print) {
  Walker w;
  w.add_costs();
  w.constraints->addConstraint("com", w.com_within(-1, 1));
  const auto model = w.model();
  model->set_damping_factor(0.25);
  std::ostringstream printed, shifted;
  model->print(printed);
  shifted << *model;
  EXPECT_EQ(printed.str(), shifted.str());
  for (const std::string& text :
       {std::string("DifferentialActionModelContactFwdDynamics"), "nx=" + std::to_string(w.state->get_nx()),
        "ndx=" + std::to_string(w.state->get_ndx()), "nu=" + std::to_string(w.nu), std::string("nc=12"),
        "nr=" + std::to_string(model->get_nr()), std::string("ng=3"), std::string("nh=0"), std::string("damping=0.25")})
    EXPECT_NE(printed.str().find(text), std::string::npos) << text << " in " << printed.str();
}

// A replaced armature has the effect of a scene whose models have it.
TEST(ActionApi, Armature) {
  Walker w;
  w.add_costs();
  const auto model = w.model();
  EXPECT_TRUE(model->get_armature() == w.state->get_model()->armature);
  const DataPtr data = evaluated(*model, w.x, w.u);
  const auto inertia = [](const Scene& scene, const SceneData& d) {
    const std::span<const double> M = joint_space_inertia(scene, d, 0);
    return std::vector<double>(M.begin(), M.end());
  };
  const std::vector<double> M = inertia(as_fwddyn(data).multibody->scene, as_fwddyn(data).multibody->solution);
  std::mt19937 rng(5);
  const Eigen::VectorXd armature = random_vector(static_cast<int>(w.state->get_nv()), rng).cwiseAbs();
  model->set_armature(armature);
  EXPECT_TRUE(model->get_armature() == armature);
  evaluated(*model, w.x, w.u, data);

  Scene scene = w.file.scene;
  Model copy = *scene.robots[0].model;
  copy.armature = armature;
  scene.robots[0].model = std::make_shared<const Model>(copy);
  for (Contact& c : scene.contacts) c.alpha = 100, c.beta = 20;
  SceneData own(scene, {Method::kAuto, {}, SimdLevel::kOff});
  (void)solve(scene, w.x.head(scene.nq), w.x.tail(scene.nv), w.u, own);
  differentiate(scene, own);
  EXPECT_LT(error_of(data->xout, own.a), 1e-9);
  EXPECT_LT(error_of(data->Fx.leftCols(scene.nv).eval(), dense_derivatives(scene, own).da_dq), 1e-8);
  EXPECT_TRUE(inertia(as_fwddyn(data).multibody->scene, as_fwddyn(data).multibody->solution) == inertia(scene, own));
  EXPECT_FALSE(M == inertia(scene, own));
  EXPECT_EQ(difference_of(*evaluated(*model, w.x, w.u), *data), 0);  // those of data created afterwards
  model->set_armature(w.state->get_model()->armature);
  evaluated(*model, w.x, w.u, data);
  EXPECT_TRUE(inertia(as_fwddyn(data).multibody->scene, as_fwddyn(data).multibody->solution) == M);
}

TEST(ActionApi, Damping) {
  Walker w;
  const auto model = w.model();
  const DataPtr data = evaluated(*model, w.x, w.u);
  const Eigen::VectorXd undamped = data->xout;
  model->set_damping_factor(0.02);
  EXPECT_EQ(model->get_damping_factor(), 0.02);
  evaluated(*model, w.x, w.u, data);
  Scene scene = w.file.scene;
  for (Contact& c : scene.contacts) c.alpha = 100, c.beta = 20;
  scene.damping = 0.02;
  SceneData own(scene);
  (void)solve(scene, w.x.head(scene.nq), w.x.tail(scene.nv), w.u, own);
  EXPECT_LT(error_of(data->xout, own.a), 1e-9);
  EXPECT_GT(error_of(data->xout, undamped), 1e-6);
  w.damping = 0.02;
  EXPECT_LT(difference_of(*data, *evaluated(*w.model(), w.x, w.u)), 1e-9);
  for (double bad : {-1e-9, static_cast<double>(NAN), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(model->set_damping_factor(bad), std::invalid_argument);
  EXPECT_EQ(model->get_damping_factor(), 0.02);
}

TEST(ActionApi, ControlLimits) {
  Walker w;
  const auto model = w.model();
  EXPECT_TRUE(model->get_has_control_limits());
  const Eigen::VectorXd efforts = w.state->get_model()->effortLimit.tail(w.nu);
  EXPECT_TRUE(efforts.allFinite());
  EXPECT_TRUE(model->get_u_ub() == efforts);
  EXPECT_TRUE(model->get_u_lb() == -efforts);
  EXPECT_EQ(model->get_u_ub()[0], w.state->get_model()->effortLimit[6]);
  const Eigen::VectorXd none = Eigen::VectorXd::Constant(w.nu, std::numeric_limits<double>::infinity());
  model->set_u_lb(-none);
  EXPECT_FALSE(model->get_has_control_limits());
  model->set_u_ub(none);
  EXPECT_TRUE(model->get_u_ub() == none);
  Eigen::VectorXd one = -none;
  one[3] = -2;
  model->set_u_lb(one);
  EXPECT_FALSE(model->get_has_control_limits());
  model->set_u_ub(-one);
  EXPECT_TRUE(model->get_has_control_limits());
  EXPECT_TRUE(model->get_u_lb() == one);
  // Torques on the floating base have no limit, nor does a custom actuation.
  EXPECT_FALSE(Walker(Actuated::kFull).model()->get_u_ub().head(6).array().isFinite().any());
  EXPECT_FALSE(Walker(Actuated::kSquashed).model()->get_has_control_limits());
}

// The bounds are those of the active terminal constraints, in the order of names.
TEST(ActionApi, TerminalConstraintBounds) {
  Walker w;
  const auto model = w.model();
  w.constraints->addConstraint("a torques",
                               std::make_shared<ConstraintModelResidual>(
                                   w.state, std::make_shared<ResidualModelControl>(w.state, w.nu),
                                   Eigen::VectorXd::Constant(w.nu, -50), Eigen::VectorXd::Constant(w.nu, 50)));
  w.constraints->addConstraint("com", w.com_within(-1, 2));
  const auto data = model->createData();
  model->calc(data, w.x);
  EXPECT_EQ(data->g.size(), 3);
  EXPECT_TRUE(w.constraints->get_lb_T() == Eigen::Vector3d::Constant(-1));
  EXPECT_TRUE(w.constraints->get_ub_T() == Eigen::Vector3d::Constant(2));
  EXPECT_EQ(w.constraints->get_lb().size(), static_cast<Eigen::Index>(w.nu) + 3);
}

// As in Crocoddyl they are the manager's; values that the user sets stay as long as the set of constraints does.
TEST(ActionApi, ConstraintBounds) {
  Walker w;
  const auto model = w.model();
  const ActionModel& constant = *model;
  EXPECT_EQ(constant.get_g_lb().size(), 0);
  const auto expect_bounds = [&](const std::vector<double>& lower, const std::vector<double>& upper) {
    EXPECT_EQ(std::vector<double>(constant.get_g_lb().begin(), constant.get_g_lb().end()), lower);
    EXPECT_EQ(std::vector<double>(constant.get_g_ub().begin(), constant.get_g_ub().end()), upper);
    EXPECT_EQ(model->get_ng(), lower.size());
  };
  w.constraints->addConstraint("a", w.com_within(-1, 1));
  expect_bounds({-1, -1, -1}, {1, 1, 1});
  w.constraints->addConstraint("b", w.com_within(-2, 2), false);
  expect_bounds({-1, -1, -1}, {1, 1, 1});
  w.constraints->changeConstraintStatus("b", true);
  expect_bounds({-1, -1, -1, -2, -2, -2}, {1, 1, 1, 2, 2, 2});
  w.constraints->changeConstraintStatus("a", false);
  expect_bounds({-2, -2, -2}, {2, 2, 2});
  w.constraints->changeConstraintStatus("a", true);
  w.constraints->changeConstraintStatus("b", false);  // as many as before, and others
  expect_bounds({-1, -1, -1}, {1, 1, 1});
  model->set_g_lb(Eigen::Vector3d(-7, -8, -9));
  expect_bounds({-7, -8, -9}, {1, 1, 1});
  model->set_g_ub(Eigen::Vector3d(7, 8, 9));
  w.constraints->changeConstraintStatus("a", true);  // is active already
  evaluated(*model, w.x, w.u);
  expect_bounds({-7, -8, -9}, {7, 8, 9});
  w.constraints->removeConstraint("a");
  expect_bounds({}, {});
  w.constraints->addConstraint("a", w.com_within(-3, 3));  // as many again
  expect_bounds({-3, -3, -3}, {3, 3, 3});
  // A numerical twin has its model's.
  DifferentialActionModelNumDiff twin(model);
  twin.set_g_ub(Eigen::Vector3d(4, 5, 6));
  expect_bounds({-3, -3, -3}, {4, 5, 6});
  EXPECT_TRUE(twin.get_g_ub() == model->get_g_ub());
  // Without a manager there are no bounds.
  ActionModel plain(w.state, w.actuation, w.contacts, w.costs);
  EXPECT_EQ(plain.get_ng(), 0u);
  EXPECT_EQ(plain.get_nh(), 0u);
  EXPECT_EQ(plain.get_g_ub().size(), 0);
  EXPECT_NO_THROW(plain.set_g_lb(Eigen::VectorXd()));
}

struct Derived : ActionModel {
  using ActionModel::ActionModel;
  using ActionModel::g_lb_;
  using ActionModel::g_ub_;
  using ActionModel::has_control_limits_;
  using ActionModel::ng_;
  using ActionModel::nh_;
  using ActionModel::nr_;
  using ActionModel::nu_;
  using ActionModel::state_;
  using ActionModel::u_lb_;
  using ActionModel::u_ub_;
  using ActionModel::unone_;
  using ActionModel::update_has_control_limits;
};

TEST(ActionApi, ProtectedMembers) {
  Walker w;
  w.add_costs();
  w.constraints->addConstraint("com", w.com_within(-1, 2));
  w.constraints->addConstraint("com_held", w.com_within(0.3, 0.3));
  Derived model(w.state, w.actuation, w.contacts, w.costs, w.constraints);
  EXPECT_EQ(model.nu_, w.nu);
  EXPECT_EQ(model.nr_, model.get_nr());
  EXPECT_EQ(model.ng_, 3u);
  EXPECT_EQ(model.nh_, 3u);
  EXPECT_EQ(model.state_, w.state);
  EXPECT_TRUE(model.g_lb_ == Eigen::Vector3d(-1, -1, -1));
  EXPECT_TRUE(model.g_ub_ == Eigen::Vector3d(2, 2, 2));
  EXPECT_TRUE(model.unone_ == Eigen::VectorXd::Zero(w.nu));
  EXPECT_TRUE(model.u_lb_ == model.get_u_lb());
  EXPECT_TRUE(model.u_ub_ == model.get_u_ub());
  EXPECT_TRUE(model.has_control_limits_);
  model.u_lb_.setConstant(-std::numeric_limits<double>::infinity());
  EXPECT_TRUE(model.get_has_control_limits());
  model.update_has_control_limits();
  EXPECT_FALSE(model.has_control_limits_);
  model.set_g_lb(Eigen::Vector3d(-4, -5, -6));
  EXPECT_TRUE(model.g_lb_ == Eigen::Vector3d(-4, -5, -6));
}

// A user's own model on the base class has a = u - q on each coordinate and the cost |u|^2 / 2 + |x|^2 / 2.
struct Springs : DifferentialActionModelAbstract {
  Springs(std::shared_ptr<StateMultibody> state, std::size_t nu)
      : DifferentialActionModelAbstract(state, nu, 5, 2, 1) {}
  using DifferentialActionModelAbstract::calc;
  using DifferentialActionModelAbstract::calcDiff;
  using DifferentialActionModelAbstract::unone_;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    data->xout = u - x.head(state_->get_nv());
    data->cost = 0.5 * (u.squaredNorm() + x.squaredNorm());
  }
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    data->Fx.leftCols(state_->get_nv()) = -Eigen::MatrixXd::Identity(nu_, nu_);
    data->Fu.setIdentity();
    data->Lx = x;
    data->Lu = u;
  }
};

TEST(ActionApi, BaseClass) {
  const SceneFile file =
      load_text("<scene name=\"arm\"><robot name=\"arm\" urdf=\"arm.urdf\" base=\"fixed\"/></scene>");
  const auto state = std::make_shared<StateMultibody>(file.scene);
  const std::size_t nv = state->get_nv();
  Springs model(state, nv);
  EXPECT_EQ(model.get_nr(), 5u);
  EXPECT_EQ(model.get_ng(), 2u);
  EXPECT_EQ(model.get_nh(), 1u);
  EXPECT_EQ(model.get_g_lb().size(), 2);
  EXPECT_FALSE(model.get_has_control_limits());
  model.set_g_lb(Eigen::Vector2d(1, 2));
  EXPECT_TRUE(model.get_g_lb() == Eigen::Vector2d(1, 2));
  model.set_g_ub(Eigen::Vector2d(3, 4));
  EXPECT_TRUE(model.get_g_ub() == Eigen::Vector2d(3, 4));
  const DataPtr data = model.createData();
  EXPECT_EQ(data->r.size(), 5);
  EXPECT_TRUE(model.checkData(data));
  EXPECT_FALSE(model.checkData(nullptr));
  std::mt19937 rng(9);
  Eigen::VectorXd x = random_vector(static_cast<int>(2 * nv), rng);
  model.calc(data, x);  // by default with no controls
  EXPECT_TRUE(data->xout == -x.head(nv));
  EXPECT_EQ(data->cost, 0.5 * x.squaredNorm());
  model.calcDiff(data, x);
  EXPECT_TRUE(data->Lx == x && data->Lu == model.unone_);
  x.tail(nv).setZero();
  EXPECT_LT(difference_of(model.quasiStatic_x(data, x), x.head(nv).eval()), 1e-14);
  std::ostringstream out;
  out << model;
  EXPECT_NE(out.str().find("nu=" + std::to_string(nv)), std::string::npos);
}

// Threads share one model; each has its own data.
TEST(ActionApi, Threads) {
  Walker w;
  w.add_costs();
  w.constraints->addConstraint("friction", w.left_friction());
  const auto model = w.model();
  const DataPtr expected = evaluated(*model, w.x, w.u);
  const Eigen::VectorXd bounds = model->get_g_ub();
  std::vector<double> worst(4, NAN);
  std::vector<std::thread> threads;
  for (double& error : worst)
    threads.emplace_back([&] {
      const DataPtr data = model->createData();
      for (int k = 0; k < 20; ++k) evaluated(*model, w.x, w.u, data);
      error = difference_of(*data, *expected) + (model->get_g_ub() == bounds ? 0 : 1);
    });
  for (std::thread& thread : threads) thread.join();
  for (double error : worst) EXPECT_EQ(error, 0);
}

// A program may spell the scalar out.
TEST(ActionApi, NamesOfPinocchio) {
  static_assert(ReferenceFrame::LOCAL == LOCAL && ReferenceFrame::WORLD == WORLD);
  static_assert(ReferenceFrame::LOCAL_WORLD_ALIGNED == LOCAL_WORLD_ALIGNED);
  static_assert(Contact1D == ContactType::k1D && Contact2D == ContactType::k2D);
  static_assert(Contact3D == ContactType::k3D && Contact6D == ContactType::k6D);
  static_assert(std::is_same_v<MotionTpl<double>, Motion> && std::is_same_v<ForceTpl<double>, Force>);
  const SE3Tpl<double> M(Eigen::Matrix3d(Eigen::Matrix3d::Identity()), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(M.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(M.rotation(), SE3<double>::Identity().rotation());
}

TEST(ActionApi, NamesWithTpl) {
  using Scalar = double;
  Walker w;
  const auto state = std::make_shared<StateMultibodyTpl<Scalar>>(w.state->get_model());
  const auto actuation = std::make_shared<ActuationModelFloatingBaseTpl<Scalar>>(state);
  const auto contacts = std::make_shared<ContactModelMultipleTpl<Scalar>>(state, actuation->get_nu());
  contacts->addContact("left", std::make_shared<ContactModel6DTpl<Scalar>>(state, w.left, w.left_pref, LOCAL, w.nu));
  const auto costs = std::make_shared<CostModelSumTpl<Scalar>>(state, actuation->get_nu());
  costs->addCost(
      "u",
      std::make_shared<CostModelResidualTpl<Scalar>>(state, std::make_shared<ActivationModelQuadTpl<Scalar>>(w.nu),
                                                     std::make_shared<ResidualModelControlTpl<Scalar>>(state, w.nu)),
      1);
  DifferentialActionModelContactFwdDynamicsTpl<Scalar> model(state, actuation, contacts, costs);
  const std::shared_ptr<DifferentialActionDataAbstractTpl<Scalar>> data = model.createData();
  model.calc(data, w.x, w.u);
  EXPECT_EQ(data->cost, 0.5 * w.u.squaredNorm());
}

template <class Scalar>
concept HasScalar = requires { typename StateMultibodyTpl<Scalar>; };
static_assert(HasScalar<double> && !HasScalar<float>);

}  // namespace
}  // namespace manycontact::test
