// Residuals, costs, constraints, contacts and impulses are evaluated without an action model (collector.hpp): they
// agree with the action model and with numerical differentiation.

#include "action/residual_factory.hpp"
#include "action/walker.hpp"
#include "manycontact/detail/action/frame_motion.hpp"
#include "manycontact/detail/algorithm/frames.hpp"

namespace manycontact::test {
namespace {

constexpr double kByHand = 1e-7;  // central differences, relative to the larger matrix

// Contains the walker's parts without an action model, with contact forces that depend on x and u.
struct ByHand : testing::Test {
  ByHand()
      : motion(*w.state->get_model()), torques(w.actuation->createData()), contacts(w.contacts->createData(&motion)) {
    std::mt19937 rng(3);
    const int nc = static_cast<int>(w.contacts->get_nc()), ndx = static_cast<int>(w.state->get_ndx());
    force = random_vector(nc, rng, 10);
    by_x = Eigen::MatrixXd::Random(nc, ndx);
    by_u = Eigen::MatrixXd::Random(nc, static_cast<Eigen::Index>(w.nu));
    update(w.x, w.u);
    w.actuation->calcDiff(torques, w.x, w.u);
    w.contacts->updateForceDiff(contacts, by_x, by_u);
  }
  // f = force + by_x (x (-) w.x) + by_u (u - w.u)
  void update(const Eigen::VectorXd& x, const Eigen::VectorXd& u) {
    motion.update(x.head(motion.scene.nq), x.tail(motion.scene.nv));
    w.actuation->calc(torques, x, u);
    w.contacts->updateForce(contacts, force + by_x * w.state->diff_dx(w.x, x) + by_u * (u - w.u));
  }
  std::function<void(const Eigen::VectorXd&, const Eigen::VectorXd&)> reevaluation() {
    return [this](const Eigen::VectorXd& x, const Eigen::VectorXd& u) { update(x, u); };
  }
  // Returns whether the residual needs no solution of the dynamics.
  static bool stands_alone(const ResidualModelAbstract& residual) {
    return !residual.depends_on().acceleration &&
           dynamic_cast<const ResidualModelContactControlGrav*>(&residual) == nullptr;
  }

  Walker w;
  MultibodyData motion;
  std::shared_ptr<ActuationDataAbstract> torques;
  std::shared_ptr<ContactDataMultiple> contacts;
  Eigen::VectorXd force;
  Eigen::MatrixXd by_x, by_u;
};

TEST_F(ByHand, ResidualsAreAsTheirTwins) {
  DataCollectorActMultibodyInContact shared(&motion, torques, contacts);
  int count = 0;
  for (const auto& [name, residual] : all_residuals(w.state, w.actuation, *w.contacts, 5)) {
    if (!stands_alone(*residual)) continue;
    const auto data = residual->createData(&shared);
    ResidualModelNumDiff twin(residual);
    const auto expected = twin.createData(&shared);
    twin.set_reevals({reevaluation()});
    data->r.setConstant(NAN), data->Rx.setConstant(NAN), data->Ru.setConstant(NAN);
    residual->calc(data, w.x, w.u);
    residual->calcDiff(data, w.x, w.u);
    twin.calc(expected, w.x, w.u);
    twin.calcDiff(expected, w.x, w.u);
    EXPECT_EQ(data->r, expected->r) << name;
    EXPECT_LT(twin_difference(data->Rx, expected->Rx), kByHand) << name;
    EXPECT_LT(twin_difference(data->Ru, expected->Ru), kByHand) << name;
    EXPECT_EQ(data->Rx, data->whole_Rx()) << name;
    ++count;
  }
  EXPECT_GT(count, 30);
}

TEST_F(ByHand, WhatNeedsMoreThanIsGivenIsRefused) {
  DataCollectorActMultibodyInContact shared(&motion, torques, contacts);
  DataCollector nothing, motion_only(&motion);
  int refused = 0;
  for (const auto& [name, residual] : all_residuals(w.state, w.actuation, *w.contacts, 5)) {
    if (stands_alone(*residual)) continue;
    EXPECT_THROW((void)residual->createData(&shared), std::invalid_argument) << name;
    ++refused;
  }
  EXPECT_EQ(refused, 3);
  ResidualModelFrameTranslation place(w.state, w.left, Eigen::Vector3d(0, 0, 0), w.nu);
  EXPECT_THROW((void)place.createData(&nothing), std::invalid_argument);
  EXPECT_THROW((void)ResidualModelCoMPosition(w.state, Eigen::Vector3d(0, 0, 0)).createData(&nothing),
               std::invalid_argument);
  EXPECT_THROW((void)ResidualModelControlGrav(w.state, w.nu).createData(&motion_only), std::invalid_argument);
  EXPECT_NO_THROW((void)place.createData(&motion_only));
}

TEST_F(ByHand, CostsAndTheirSumAreAsTheirTwins) {
  DataCollectorActMultibodyInContact shared(&motion, torques, contacts);
  w.add_costs();
  w.costs->removeCost("effort");
  const auto sum = w.costs->createData(&shared);
  w.costs->calc(sum, w.x, w.u);
  w.costs->calcDiff(sum, w.x, w.u);
  double cost = 0;
  CostDerivatives expected;
  expected.resize(w.state->get_ndx(), w.nu, MatrixStorage::kDense);
  for (const auto& [name, item] : w.costs->get_costs()) {
    const auto data = item->cost->createData(&shared);
    item->cost->calc(data, w.x, w.u);
    item->cost->calcDiff(data, w.x, w.u);
    CostModelNumDiff twin(item->cost);
    const auto by_twin = twin.createData(&shared);
    twin.set_reevals({reevaluation()});
    twin.calc(by_twin, w.x, w.u);
    twin.calcDiff(by_twin, w.x, w.u);
    EXPECT_EQ(data->cost, by_twin->cost) << name;
    EXPECT_LT(twin_difference(data->Lx, by_twin->Lx), kByHand) << name;
    EXPECT_LT(twin_difference(data->Lu, by_twin->Lu), kByHand) << name;
    EXPECT_LT(twin_difference(data->Lxx, by_twin->Lxx), kByHand) << name;
    EXPECT_LT(twin_difference(data->Lxu, by_twin->Lxu), kByHand) << name;
    EXPECT_LT(twin_difference(data->Luu, by_twin->Luu), kByHand) << name;
    cost += item->weight * data->cost;
    expected.Lx += item->weight * data->Lx;
    expected.Luu += item->weight * data->Luu;
    expected.Lxx += item->weight * data->Lxx;
  }
  EXPECT_EQ(sum->cost, cost);
  EXPECT_EQ(sum->Lx, expected.Lx);
  EXPECT_EQ(sum->Lxx, expected.Lxx);
  EXPECT_EQ(sum->Luu, expected.Luu);
  EXPECT_GT(size_of(expected.Lx), 0);
}

// In an action model's own data sums are views, and single costs have no matrices.
TEST_F(ByHand, SumsShareTheirDerivativesWithAnAction) {
  w.add_costs();
  const auto model = w.model();
  const auto data = evaluated(*model, w.x, w.u);
  const CostDataSum& costs = *as_fwddyn(data).costs;
  EXPECT_EQ(costs.Lx, data->Lx);
  EXPECT_EQ(costs.Lx.data(), data->Lx.data());
  EXPECT_EQ(costs.Lxx.data(), data->Lxx.data());
  EXPECT_EQ(costs.costs.at("state")->Lx.size(), 0);
  EXPECT_EQ(costs.costs.at("state")->residual->Rx.size(), 0);
  DataCollector none;
  CostModelSum sum(w.state, w.nu);
  const auto by_hand = sum.createData(&none);
  by_hand->shareMemory(data.get());
  by_hand->Lx.setConstant(3);
  EXPECT_EQ(data->Lx, Eigen::VectorXd::Constant(data->Lx.size(), 3));
}

TEST_F(ByHand, ConstraintsAndTheirManagerAreAsTheirTwins) {
  DataCollectorActMultibodyInContact shared(&motion, torques, contacts);
  const FrictionCone cone(Eigen::Matrix3d::Identity(), 0.5);
  const auto add = [&](const char* name, std::shared_ptr<ResidualModelAbstract> residual, auto... bounds) {
    w.constraints->addConstraint(name, std::make_shared<ConstraintModelResidual>(w.state, residual, bounds...));
  };
  const Eigen::Vector3d low(-1, 0, 0.5), high(1, 0, 2);  // one of three is an equality
  add("com", std::make_shared<ResidualModelCoMPosition>(w.state, Eigen::Vector3d(0.1, 0, 0.7), w.nu), low, high);
  add("state", std::make_shared<ResidualModelState>(w.state, w.x_rest, w.nu));
  add("cone", std::make_shared<ResidualModelContactFrictionCone>(w.state, w.left, cone, w.nu), cone.get_lb(),
      cone.get_ub());
  for (const bool terminal : {false, true}) {
    const auto all = w.constraints->createData(&shared);
    if (terminal) {
      w.constraints->calc(all, w.x);
      w.constraints->calcDiff(all, w.x);
    } else {
      w.constraints->calc(all, w.x, w.u);
      w.constraints->calcDiff(all, w.x, w.u);
    }
    Eigen::Index g = 0, h = 0;
    for (const auto& [name, item] : w.constraints->get_constraints()) {
      if (terminal && !item->constraint->get_T_constraint()) continue;
      const auto data = item->constraint->createData(&shared);
      ConstraintModelNumDiff twin(item->constraint);
      const auto expected = twin.createData(&shared);
      twin.set_reevals({reevaluation()});
      if (terminal) {
        item->constraint->calc(data, w.x);
        item->constraint->calcDiff(data, w.x);
        twin.calcDiff(expected, w.x);
      } else {
        item->constraint->calc(data, w.x, w.u);
        item->constraint->calcDiff(data, w.x, w.u);
        twin.calcDiff(expected, w.x, w.u);
      }
      EXPECT_LT(twin_difference(data->Gx, expected->Gx), kByHand) << name;
      EXPECT_LT(twin_difference(data->Hx, expected->Hx), kByHand) << name;
      if (!terminal) {
        EXPECT_LT(twin_difference(data->Gu, expected->Gu), kByHand) << name;
      }
      EXPECT_EQ(all->g.segment(g, data->g.size()), data->g) << name;
      EXPECT_EQ(all->h.segment(h, data->h.size()), data->h) << name;
      EXPECT_EQ(all->Gx.middleRows(g, data->g.size()), data->Gx) << name;
      EXPECT_EQ(all->Hx.middleRows(h, data->h.size()), data->Hx) << name;
      g += data->g.size();
      h += data->h.size();
    }
    EXPECT_EQ(g, all->g.size());
    EXPECT_EQ(h, all->h.size());
    EXPECT_EQ(g, terminal ? 2 : 2 + 5);
  }
}

// Contacts of every type and reference frame, at the action's accelerations, agree with the action.
TEST(ContactsByHand, AreTheActions) {
  for (const ReferenceFrame frame : {LOCAL, WORLD, LOCAL_WORLD_ALIGNED}) {
    Walker w;
    w.contacts = std::make_shared<ContactModelMultiple>(w.state, w.nu);
    const Eigen::Vector2d gains(30, 5);
    const FrameIndex hand = w.state->get_model()->getFrameId("left_hand");
    w.contacts->addContact("a6", std::make_shared<ContactModel6D>(w.state, w.left, w.left_pref, frame, w.nu, gains));
    w.contacts->addContact(
        "b3", std::make_shared<ContactModel3D>(w.state, w.right, Eigen::Vector3d(0.1, 0, 0), frame, w.nu, gains));
    w.contacts->addContact(
        "c1", std::make_shared<ContactModel1D>(w.state, hand, 0.3, frame, Eigen::Matrix3d::Identity(), w.nu, gains));
    w.contacts->addContact(
        "d2", std::make_shared<ContactModel2D>(w.state, hand, Eigen::Vector2d(0.2, 0.4), w.nu, gains, frame), false);
    const auto model = w.model();
    const auto data = evaluated(*model, w.x, w.u);
    MultibodyData motion(*w.state->get_model());
    const auto by_hand = w.contacts->createData(&motion);
    const Eigen::VectorXd q = w.x.head(motion.scene.nq), v = w.x.tail(motion.scene.nv);
    motion.update(q, v);
    w.contacts->calc(by_hand, w.x);
    const Eigen::MatrixXd Jc = by_hand->Jc;
    motion.update(q, v, data->xout);
    w.contacts->calcDiff(by_hand, w.x);
    w.contacts->updateForce(by_hand, as_fwddyn(data).multibody->solution.f);
    Eigen::Index row = 0;
    Eigen::VectorXd torque = Eigen::VectorXd::Zero(motion.scene.nv);
    for (const auto& [name, contact] : as_fwddyn(data).multibody->contacts->contacts) {
      if (!contact->active) continue;
      const Eigen::Index nc = contact->Jc.rows();
      EXPECT_LT(twin_difference(by_hand->Jc.middleRows(row, nc), contact->Jc), 1e-13) << name;
      EXPECT_LT(twin_difference(by_hand->a0.segment(row, nc), contact->a0), 1e-12) << name;
      EXPECT_LT(twin_difference(by_hand->da0_dx.middleRows(row, nc), contact->da0_dx), 1e-12) << name;
      EXPECT_EQ(by_hand->contacts.at(name)->f, contact->f) << name;
      torque += contact->Jc.transpose() * contact->f;
      row += nc;
    }
    EXPECT_EQ(row, 10);
    EXPECT_TRUE(by_hand->contacts.at("d2")->f.isZero(0));
    // fext, at the joints, has the effect of J^T f.
    Eigen::VectorXd by_fext = Eigen::VectorXd::Zero(motion.scene.nv);
    const Robot& robot = motion.scene.robots[0];
    for (std::size_t j = 0; j < by_hand->fext.size(); ++j) {
      Mat6X<double> J(6, robot.model->nv);
      frame_jacobian<double>(*robot.model, motion.motion[0], robot.base, static_cast<int>(j), {},
                             ReferenceFrame::kLocal, J);
      by_fext += J.transpose() * by_hand->fext[j].toVector();
    }
    EXPECT_LT(twin_difference(by_fext, torque), 1e-12);
    // At accelerations other than zero a0 contains J a as well.
    w.contacts->calc(by_hand, w.x);
    const Eigen::VectorXd accelerated = by_hand->a0.head(row);
    motion.update(q, v);
    w.contacts->calc(by_hand, w.x);
    EXPECT_LT(twin_difference(accelerated, by_hand->a0.head(row) + (Jc * data->xout).head(row)), 1e-12);
  }
}

TEST(ContactsByHand, HaveTheWrenchOfTheirNumbers) {
  Walker w;
  MultibodyData motion(*w.state->get_model());
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const ContactModel1D one(w.state, w.left, 0.0, LOCAL, turned, w.nu);
  const auto data = one.createData(&motion);
  one.updateForce(data, Eigen::VectorXd::Constant(1, 2));
  EXPECT_LT(twin_difference(data->f.linear(), 2 * turned.row(2).transpose()), 1e-15);
  EXPECT_TRUE(data->f.angular().isZero(0));
  one.setZeroForce(data);
  EXPECT_TRUE(data->f.toVector().isZero(0) && data->fext.toVector().isZero(0));
  EXPECT_THROW(one.updateForce(data, Eigen::VectorXd::Zero(2)), std::invalid_argument);
  const auto of_action = w.model()->createData();
  EXPECT_THROW(w.left_contact->calc(as_fwddyn(of_action).multibody->contacts->contacts.at("left"), w.x),
               std::invalid_argument);
}

// dv0_dq is d(J v)/dq with v fixed.
TEST(ImpulsesByHand, AreTheDifferences) {
  Walker w;
  MultibodyData motion(*w.state->get_model());
  const Eigen::VectorXd v = w.x.tail(motion.scene.nv);
  ImpulseModelMultiple stack(w.state);
  stack.addImpulse("a", std::make_shared<ImpulseModel6D>(w.state, w.left, LOCAL));
  stack.addImpulse("b", std::make_shared<ImpulseModel3D>(w.state, w.right, WORLD));
  stack.addImpulse("c",
                   std::make_shared<ImpulseModel3D>(w.state, w.state->get_model()->getFrameId("left_hand"), LOCAL));
  const auto data = stack.createData(&motion);
  const auto velocity = [&](const Eigen::VectorXd& dq) {
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(2 * motion.scene.nv);
    dx.head(motion.scene.nv) = dq;
    const Eigen::VectorXd x = w.state->integrate_x(w.x, dx);
    motion.update(x.head(motion.scene.nq), v);
    stack.calc(data, Eigen::VectorXd());
    return Eigen::VectorXd(data->Jc * v);
  };
  Eigen::MatrixXd expected(12, motion.scene.nv);
  const double h = 1e-5;
  for (int i = 0; i < motion.scene.nv; ++i) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(motion.scene.nv, i);
    expected.col(i) = (velocity(step) - velocity(-step)) / (2 * h);
  }
  (void)velocity(Eigen::VectorXd::Zero(motion.scene.nv));
  stack.calcDiff(data, Eigen::VectorXd());
  EXPECT_LT(twin_difference(data->dv0_dq, expected), 1e-8);
  EXPECT_GT(size_of(expected), 0.1);
  const Eigen::MatrixXd df = Eigen::MatrixXd::Random(12, 2 * motion.scene.nv);
  stack.updateForce(data, Eigen::VectorXd::Ones(12));
  stack.updateForceDiff(data, df);
  EXPECT_EQ(data->impulses.at("b")->df_dx, df.middleRows(6, 3));
  EXPECT_EQ(data->impulses.at("c")->f, Eigen::VectorXd::Ones(3));
  const Eigen::MatrixXd dvnext = Eigen::MatrixXd::Random(motion.scene.nv, 2 * motion.scene.nv);
  stack.updateVelocity(data, v);
  stack.updateVelocityDiff(data, dvnext);
  EXPECT_EQ(data->vnext, v);
  EXPECT_EQ(data->dvnext_dx, dvnext);
}

// A residual as written for Crocoddyl: sin of the first coordinate times the second control.
class Own : public ResidualModelAbstract {
 public:
  Own(std::shared_ptr<StateAbstract> state, std::size_t nu) : ResidualModelAbstract(state, 2, nu, true, false, true) {}
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override {
    data->r << std::sin(x[7]) * u[1], u[0];
  }
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override {
    data->Rx(0, 6) = std::cos(x[7]) * u[1];
    data->Ru.row(0)[1] = std::sin(x[7]);
    data->Ru(1, 0) = 1;
  }
};

TEST(OwnResidual, WritesWholeMatricesAndCountsInAnAction) {
  Walker w;
  w.u.setLinSpaced(1, 2);
  const auto own = std::make_shared<Own>(w.state, w.nu);
  w.add_cost("own", own, 3);
  w.constraints->addConstraint("own", std::make_shared<ConstraintModelResidual>(w.state, own));
  const auto model = w.model();
  const auto data = evaluated(*model, w.x, w.u);
  DifferentialActionModelNumDiff twin(model);
  const auto expected = twin.createData();
  twin.calc(expected, w.x, w.u);
  twin.calcDiff(expected, w.x, w.u);
  EXPECT_LT(twin_difference(data->Lx, expected->Lx), kByHand);
  EXPECT_LT(twin_difference(data->Lu, expected->Lu), kByHand);
  EXPECT_LT(twin_difference(data->Hx, expected->Hx), kByHand);
  EXPECT_LT(twin_difference(data->Hu, expected->Hu), kByHand);
  EXPECT_GT(size_of(data->Lx), 0.01);
  EXPECT_GT(size_of(data->Hu), 0.1);
  EXPECT_TRUE(own->get_q_dependent());
  EXPECT_FALSE(own->get_v_dependent());
}

// A residual that writes blocks: |v|^2, in terminal nodes too.
struct OfBlocks : ResidualModelAbstract {
  explicit OfBlocks(std::shared_ptr<StateAbstract> state, std::size_t nu)
      : ResidualModelAbstract(std::move(state), 1, nu, Dependence{.v = true}) {}
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef&) override {
    data->r[0] = x.tail(static_cast<Eigen::Index>(state_->get_nv())).squaredNorm();
  }
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef&) override {
    const auto nv = static_cast<Eigen::Index>(state_->get_nv());
    data->blocks[0].Rx.rightCols(nv) = 2 * x.tail(nv).transpose();
  }
};

TEST(OwnResidual, OfBlocksCountsInTerminalNodes) {
  Walker w;
  w.add_cost("own", std::make_shared<OfBlocks>(w.state, w.nu));
  const auto model = w.model();
  const auto data = model->createData();
  model->calc(data, w.x);
  model->calcDiff(data, w.x);
  DifferentialActionModelNumDiff twin(model);
  const auto expected = twin.createData();
  twin.calc(expected, w.x);
  twin.calcDiff(expected, w.x);
  EXPECT_LT(twin_difference(data->Lx, expected->Lx), kByHand);
  EXPECT_GT(size_of(data->Lx), 0.1);
}

// The height of a foot and its speed, from the motion of a frame.
struct OfFrame : ResidualModelAbstract {
  OfFrame(std::shared_ptr<StateAbstract> state, std::size_t nu, FrameIndex frame)
      : ResidualModelAbstract(std::move(state), 4, nu, true, false, false), frame_(frame) {}
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef&, const ConstVectorRef&) override {
    data->r << frame_placement(*state_, *data->shared, frame_).p, 1;
  }
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef&,
                const ConstVectorRef&) override {
    const auto J = frame_jacobian(*state_, *data->shared, frame_, LOCAL_WORLD_ALIGNED);
    data->Rx.topLeftCorner(3, J.cols()) = J.topRows(3);
  }
  FrameIndex frame_;
};

TEST(OwnResidual, OfAFrame) {
  Walker w;
  w.add_cost("own", std::make_shared<OfFrame>(w.state, w.nu, w.left));
  const auto model = w.model();
  const auto data = evaluated(*model, w.x, w.u);
  DifferentialActionModelNumDiff twin(model);
  const auto expected = twin.createData();
  twin.calc(expected, w.x, w.u);
  twin.calcDiff(expected, w.x, w.u);
  EXPECT_LT(twin_difference(data->Lx, expected->Lx), kByHand);
  EXPECT_GT(size_of(data->Lx), 0.01);
  const DataCollector& shared = *as_fwddyn(data).multibody;
  const auto nv = static_cast<Eigen::Index>(w.state->get_nv());
  EXPECT_LT(twin_difference(frame_velocity(*w.state, shared, w.left),
                            frame_jacobian(*w.state, shared, w.left) * w.x.tail(nv)),
            1e-12);
  EXPECT_THROW((void)frame_placement(*w.state, shared, 100000), std::invalid_argument);
}

TEST(OwnResidual, WithoutDerivativesSaysSo) {
  struct None : ResidualModelAbstract {
    explicit None(std::shared_ptr<StateAbstract> state) : ResidualModelAbstract(std::move(state), 1) {}
    void calc(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&, const ConstVectorRef&) override {}
    using ResidualModelAbstract::calc;
  };
  Walker w;
  None none(w.state);
  DataCollector shared;
  const auto data = none.createData(&shared);
  EXPECT_THROW(none.calcDiff(data, w.x, w.u), std::logic_error);
}

// Parts with another state object of the same robots are the same parts.
TEST(SameSpace, OfTheSameMultibody) {
  Walker w;
  const auto twin = std::make_shared<StateMultibody>(w.state->get_model());
  EXPECT_TRUE(same_space(*twin, *w.state));
  w.costs->addCost(
      "state", std::make_shared<CostModelResidual>(twin, std::make_shared<ResidualModelState>(twin, w.x_rest, w.nu)),
      1);
  const auto data = evaluated(*w.model(), w.x, w.u);
  EXPECT_GT(data->cost, 0);
  const auto other = std::make_shared<StateMultibody>(w.file.scene);
  EXPECT_FALSE(same_space(*other, *w.state));
}

}  // namespace
}  // namespace manycontact::test
