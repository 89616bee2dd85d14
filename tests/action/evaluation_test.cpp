// calc, calcDiff and quasiStatic have further guarantees besides right numbers. api_test.cpp tests the other members.

#include "action/walker.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact::test {
namespace {

constexpr double kTolerance = 1e-11;  // for the same numbers computed differently

TEST(ActionApi, CalcGivesAccelerationAndCost) {
  Walker w;
  w.add_costs();
  const auto model = w.model();
  const DataPtr data = model->createData();
  model->calc(data, w.x, w.u);
  Scene scene = w.file.scene;
  for (Contact& c : scene.contacts) c.alpha = 100, c.beta = 20;
  SceneData own(scene);
  (void)solve(scene, w.x.head(scene.nq), w.x.tail(scene.nv), w.u, own);
  EXPECT_LT(error_of(data->xout, own.a), 1e-9);
  EXPECT_LT(error_of(contact_data(data, "left").f, own.f.head(6).eval()), 1e-9);
  double cost = 0;
  Eigen::Index at = 0;
  for (const auto& [name, item] : w.costs->get_costs()) {
    const Eigen::Index n = item->cost->get_residual()->get_nr();
    cost += item->weight * 0.5 * data->r.segment(at, n).squaredNorm();
    at += n;
  }
  EXPECT_NEAR(data->cost, cost, kTolerance * cost);
  EXPECT_GT(cost, 0);
}

// Crocoddyl: "the system acceleration is not updated ... it does not update the contact forces".
TEST(ActionApi, CalcOfTerminalNode) {
  Walker w;
  w.add_costs();
  w.constraints->addConstraint("com", w.com_within(-1, 1));
  w.constraints->addConstraint("friction", w.left_friction());
  const auto model = w.model();
  const DataPtr data = evaluated(*model, w.x, w.u);
  FwdDynData& d = as_fwddyn(data);
  std::mt19937 rng(2);
  const Eigen::VectorXd poison = random_vector(static_cast<int>(w.state->get_nv()), rng);
  data->xout = poison;
  for (auto& [name, contact] : d.multibody->contacts->contacts) contact->f.setConstant(7);
  const Eigen::VectorXd a = d.multibody->solution.a, f = d.multibody->solution.f;
  const Eigen::MatrixXd Fx = data->Fx, Fu = data->Fu;
  const Eigen::VectorXd x = w.moved(rng);
  model->calc(data, x);
  model->calcDiff(data, x);
  EXPECT_TRUE(data->xout == poison);
  for (auto& [name, contact] : d.multibody->contacts->contacts) EXPECT_TRUE((contact->f.array() == 7).all());
  EXPECT_TRUE(d.multibody->solution.a == a && d.multibody->solution.f == f);
  EXPECT_TRUE(data->Fx == Fx && data->Fu == Fu);
  // Only costs of the state remain, and no constraint that needs forces.
  Walker only;
  only.add_costs();
  only.costs->changeCostStatus("control", false);
  const auto reference = only.model();
  const DataPtr expected = reference->createData();
  reference->calc(expected, x, Eigen::VectorXd::Zero(w.nu));
  const double residuals = 0.5 * 0.5 * w.state->diff_dx(w.x_rest, x).squaredNorm();
  EXPECT_GT(data->cost, residuals);
  EXPECT_GT(size_of(data->Lx), 0);
  EXPECT_EQ(data->g.size(), 3);
  EXPECT_EQ(data->Gx.rows(), 3);
  const DataPtr again = model->createData();
  model->calc(again, x);
  EXPECT_EQ(again->cost, data->cost);
  w.costs->changeCostStatus("effort", false);
  expected->cost = 0;
  only.costs->changeCostStatus("effort", false);
  reference->calc(expected, x, Eigen::VectorXd::Zero(w.nu));
  model->calc(again, x);
  EXPECT_NEAR(again->cost, expected->cost, kTolerance * expected->cost);
}

// Crocoddyl: "calcDiff() computes the derivatives using the latest stored values by calc()", for any arguments.
class CalcDiff : public testing::TestWithParam<Actuated> {};

TEST_P(CalcDiff, IsAtTheLastCalc) {
  Walker w(GetParam());
  w.add_costs();
  w.constraints->addConstraint("com", w.com_within(-1, 1));
  w.constraints->addConstraint("friction", w.left_friction());
  const auto model = w.model();
  const DataPtr data = model->createData(), expected = evaluated(*model, w.x, w.u);
  std::mt19937 rng(3);
  const Eigen::VectorXd x2 = w.moved(rng), u2 = random_vector(static_cast<int>(w.nu), rng);
  evaluated(*model, x2, u2, data);
  EXPECT_GT(difference_of(*data, *expected), 0.01);
  model->calc(data, w.x, w.u);
  model->calcDiff(data, x2, u2);
  EXPECT_EQ(difference_of(*data, *expected), 0);
  model->calc(expected, w.x), model->calcDiff(expected, w.x);
  model->calc(data, w.x), model->calcDiff(data, x2);
  EXPECT_TRUE(data->Lx == expected->Lx && data->Lxx == expected->Lxx && data->Gx == expected->Gx);
  EXPECT_GT(size_of(data->Lx), 0);
}
INSTANTIATE_TEST_SUITE_P(Actuations, CalcDiff,
                         testing::Values(Actuated::kFloatingBase, Actuated::kFull, Actuated::kSquashed),
                         [](const auto& info) {
                           return std::string(info.param == Actuated::kFloatingBase ? "floating_base"
                                              : info.param == Actuated::kFull       ? "full"
                                                                                    : "squashed");
                         });

TEST(ActionApi, CalcDiffNeedsItsCalc) {
  Walker w;
  w.add_costs();
  const auto model = w.model();
  const DataPtr data = model->createData();
  const auto refused = [&](auto&& call, const char* expected) {
    try {
      call();
      ADD_FAILURE() << "not refused";
    } catch (const std::invalid_argument& e) {
      ADD_FAILURE() << e.what();
    } catch (const std::logic_error& e) {
      EXPECT_NE(std::string(e.what()).find(std::string("; call ") + expected + " before calcDiff"), std::string::npos)
          << e.what();
    }
  };
  const auto running = [&] { model->calcDiff(data, w.x, w.u); };
  const auto terminal = [&] { model->calcDiff(data, w.x); };
  refused(running, "calc(data, x, u)");
  refused(terminal, "calc(data, x)");
  model->calc(data, w.x);
  refused(running, "calc(data, x, u)");
  EXPECT_NO_THROW(terminal());
  model->calc(data, w.x, w.u);
  refused(terminal, "calc(data, x)");
  EXPECT_NO_THROW(running());
  EXPECT_NO_THROW(running());  // again, after the same calc
  model->quasiStatic_x(data, w.x_rest);
  refused(running, "calc(data, x, u)");
  model->calc(data, w.x, w.u);
  EXPECT_THROW(model->calc(data, w.x, Eigen::VectorXd::Zero(1)), std::invalid_argument);
  EXPECT_NO_THROW(running());  // a refused calc changes nothing
}

TEST(ActionApi, QuasiStatic) {
  for (Actuated how : {Actuated::kFloatingBase, Actuated::kFull, Actuated::kSquashed}) {
    Walker w(how);
    const auto model = w.model();
    const DataPtr data = model->createData();
    Eigen::VectorXd u = Eigen::VectorXd::Constant(w.nu, NAN);
    model->quasiStatic(data, u, w.x_rest);
    EXPECT_GT(size_of(u), 1e-3);
    EXPECT_TRUE(model->quasiStatic_x(data, w.x_rest) == u);
    EXPECT_TRUE(model->quasiStatic_x(data, w.x_rest, 1, 1e-3) == u);  // not iterative
    if (how == Actuated::kSquashed) continue;                         // exact only to first order in u
    model->calc(data, w.x_rest, u);
    EXPECT_LT(size_of(data->xout), 1e-9) << "the humanoid does not stand still";
    if (how == Actuated::kFloatingBase) {
      EXPECT_LT(error_of(u, quasi_static(w.file.scene, w.file.q)), 1e-9);
    }
  }
}

}  // namespace
}  // namespace manycontact::test
