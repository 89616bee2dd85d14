// Robots are so deep that a scene's own solve uses sparse-bodies. Contacts, gravity torques and every residual agree
// with the dense reference solver and numerical differentiation. (Impulses: tests/control/impulse_test.cpp.)

#include "action/problem.hpp"
#include "action/residual_factory.hpp"
#include "action/walker.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact::test {
namespace {

constexpr double kOfDifferences = 1e-6;

class DeepRobot : public testing::TestWithParam<std::pair<int, bool>> {
 protected:
  RandomScene s = deep_scene(GetParam().first, GetParam().second);
  Problem p = make_problem(s);
  std::vector<NamedResidual> residuals = all_residuals(p.state, p.actuation, *p.contacts, 3);
};

TEST_P(DeepRobot, IsOneForSparseBodiesAndIsSolvedRight) {
  SceneData by_bodies(s.scene), oracle(s.scene, {Method::kDense, {}});
  Eigen::VectorXd u = p.u;
  ASSERT_GT(s.scene.contacts.size(), 1u);
  (void)solve(s.scene, s.q, s.v, u, by_bodies);
  EXPECT_EQ(by_bodies.report.islands[0].method, Method::kSparseBodies);
  (void)solve(s.scene, s.q, s.v, u, oracle);
  const auto model = p.model();
  const auto data = model->createData();
  model->calc(data, p.x, p.u);
  EXPECT_LT(difference_of(data->xout, oracle.a), 1e-8 * size_of(oracle.a));
  for (const auto& [name, contact] : as_fwddyn(data).multibody->contacts->contacts)
    for (std::size_t c = 0; c < s.scene.contacts.size(); ++c)
      if (s.scene.contacts[c].name == name) {
        EXPECT_LT(difference_of(contact->f, contact_force(s.scene, oracle, static_cast<int>(c))),
                  1e-8 * size_of(oracle.f))
            << name;
      }
}

TEST_P(DeepRobot, HasTheDerivativesOfItsTwin) {
  std::mt19937 rng(4);
  for (const NamedResidual& r : residuals) {
    p.costs->addCost(r.name, std::make_shared<CostModelResidual>(p.state, r.residual), uniform(rng, 0.1, 2));
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(r.residual->get_nr()));
    p.constraints->addConstraint(r.name, std::make_shared<ConstraintModelResidual>(p.state, r.residual, zero, zero));
  }
  const auto model = p.model();
  DifferentialActionModelNumDiff twin(model, true);
  for (const bool terminal : {false, true}) {
    SCOPED_TRACE(terminal ? "terminal" : "running");
    const auto data = model->createData(), numbers = twin.createData();
    evaluate(*model, data, p, terminal);
    evaluate(twin, numbers, p, terminal);
    if (!terminal) {
      EXPECT_LT(twin_difference(data->Fx, numbers->Fx), kOfDifferences);
      EXPECT_LT(twin_difference(data->Fu, numbers->Fu), kOfDifferences);
      EXPECT_LT(twin_difference(data->Lu, numbers->Lu), kOfDifferences);
    }
    EXPECT_EQ(data->cost, numbers->cost);
    EXPECT_LT(twin_difference(data->Lx, numbers->Lx), kOfDifferences);
    Eigen::Index h = 0;
    for (const auto& [name, item] : p.constraints->get_constraints()) {
      if (terminal && !item->constraint->get_T_constraint()) continue;
      const Eigen::Index nh = static_cast<Eigen::Index>(item->constraint->get_nh());
      EXPECT_LT(twin_difference(data->Hx.middleRows(h, nh), numbers->Hx.middleRows(h, nh)), kOfDifferences) << name;
      if (!terminal) {
        EXPECT_LT(twin_difference(data->Hu.middleRows(h, nh), numbers->Hu.middleRows(h, nh)), kOfDifferences) << name;
      }
      h += nh;
    }
    EXPECT_EQ(h, data->h.size());
    EXPECT_GT(h, 100);
  }
}

TEST_P(DeepRobot, HasTorquesThatHoldItStill) {
  p.x.tail(static_cast<Eigen::Index>(p.state->get_nv())).setZero();
  const auto model = p.model();
  const auto data = model->createData();
  const Eigen::VectorXd u = model->quasiStatic_x(data, p.x);
  Scene scene = as_fwddyn(data).multibody->scene;
  EXPECT_LT(error_of(u, quasi_static(scene, p.x.head(scene.nq))), 1e-9);
}

// Some residuals need no solution of the dynamics.
TEST_P(DeepRobot, HasResidualsByHand) {
  MultibodyData motion(*p.state->get_model());
  const auto torques = p.actuation->createData();
  const auto contacts = p.contacts->createData(&motion);
  const auto update = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& u) {
    motion.update(x.head(motion.scene.nq), x.tail(motion.scene.nv));
    p.actuation->calc(torques, x, u);
    p.contacts->calc(contacts, x);
  };
  update(p.x, p.u);
  p.actuation->calcDiff(torques, p.x, p.u);
  p.contacts->calcDiff(contacts, p.x);
  DataCollectorActMultibodyInContact shared(&motion, torques, contacts);
  int count = 0;
  for (const auto& [name, residual] : residuals) {
    const Dependence& on = residual->depends_on();
    if (on.acceleration || on.forces || dynamic_cast<const ResidualModelContactControlGrav*>(residual.get())) continue;
    const auto data = residual->createData(&shared);
    ResidualModelNumDiff twin(residual);
    const auto expected = twin.createData(&shared);
    twin.set_reevals({update});
    residual->calc(data, p.x, p.u);
    residual->calcDiff(data, p.x, p.u);
    twin.calc(expected, p.x, p.u);
    twin.calcDiff(expected, p.x, p.u);
    EXPECT_LT(twin_difference(data->Rx, expected->Rx), kOfDifferences) << name;
    EXPECT_LT(twin_difference(data->Ru, expected->Ru), kOfDifferences) << name;
    ++count;
  }
  EXPECT_GT(count, 15);
}

INSTANTIATE_TEST_SUITE_P(Scenes, DeepRobot,
                         testing::Values(std::pair{10, false}, std::pair{12, true}, std::pair{13, false}),
                         [](const auto& info) {
                           return (info.param.second ? "floating_" : "fixed_") + std::to_string(info.param.first);
                         });

}  // namespace
}  // namespace manycontact::test
