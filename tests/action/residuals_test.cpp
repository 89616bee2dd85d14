// Every residual is tested on random scenes: Jacobians against central differences of calc, through the action model,
// with all actuations, in running and terminal nodes; values against other computations; misuse.

#include <gtest/gtest.h>

#include "action/problem.hpp"
#include "action/residual_factory.hpp"
#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/detail/algorithm/energy.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "support/applied.hpp"

namespace manycontact::test {
namespace {

double size_of(const Eigen::MatrixXd& M) { return M.size() ? M.cwiseAbs().maxCoeff() : 0; }

// Contains a random scene's action with every residual as a cost of its own.
struct Tried {
  Problem problem;
  std::vector<NamedResidual> residuals;
  std::shared_ptr<DifferentialActionModelContactFwdDynamics> model;
  std::shared_ptr<DifferentialActionDataAbstract> data;

  explicit Tried(const RandomScene& scene, Actuated how, unsigned seed) : problem(make_problem(scene, how)) {
    residuals = all_residuals(problem.state, problem.actuation, *problem.contacts, seed);
    for (const NamedResidual& r : residuals)
      problem.costs->addCost(r.name, std::make_shared<CostModelResidual>(problem.state, r.residual), 1);
    model = problem.model(false);
    data = model->createData();
  }
  const ResidualDataAbstract& of(const std::string& name) const {
    return *as_fwddyn(data).costs->costs.at(name)->residual;
  }
};

// Returns d r/d(direction) of all residuals, stacked, from four values: the error is of fourth order.
template <class Move>
Eigen::VectorXd derivative(Tried& t, bool terminal, Move&& move) {
  const double h = 2e-4;
  const auto r = [&](double s) -> Eigen::VectorXd {
    Eigen::VectorXd x = t.problem.x, u = t.problem.u;
    move(s, x, u);
    terminal ? t.model->calc(t.data, x) : t.model->calc(t.data, x, u);
    return t.data->r;
  };
  return (8 * (r(h) - r(-h)) - (r(2 * h) - r(-2 * h))) / (12 * h);
}

void expect_jacobians(Tried& t, bool terminal, const std::string& where) {
  const Problem& p = t.problem;
  const std::size_t ndx = p.state->get_ndx(), nu = terminal ? 0 : p.u.size();
  Eigen::MatrixXd expected(t.model->get_nr(), ndx + nu);
  for (std::size_t j = 0; j < ndx; ++j)
    expected.col(j) = derivative(t, terminal, [&](double s, Eigen::VectorXd& x, Eigen::VectorXd&) {
      x = p.state->integrate_x(p.x, s * Eigen::VectorXd::Unit(ndx, j));
    });
  for (std::size_t j = 0; j < nu; ++j)
    expected.col(ndx + j) = derivative(t, terminal, [&](double s, Eigen::VectorXd&, Eigen::VectorXd& u) { u[j] += s; });

  for (auto& [name, cost] : as_fwddyn(t.data).costs->costs)
    for (ResidualBlock& block : cost->residual->blocks)
      if (!block.constant) block.Rx.setConstant(NAN), block.Ru.setConstant(NAN);
  if (terminal) {
    t.model->calc(t.data, p.x);
    t.model->calcDiff(t.data, p.x);
  } else {
    t.model->calc(t.data, p.x, p.u);
    t.model->calcDiff(t.data, p.x, p.u);
  }
  Eigen::Index at = 0;
  for (const auto& [name, item] : p.costs->get_costs()) {
    const ResidualDataAbstract& data = t.of(name);
    const Eigen::MatrixXd truth = expected.middleRows(at, data.r.size());
    Eigen::MatrixXd given(truth.rows(), truth.cols());
    if (terminal)
      given = data.whole_Rx();
    else
      given << data.whole_Rx(), data.whole_Ru();
    at += data.r.size();
    const ResidualModelAbstract& model = *item->cost->get_residual();
    const Dependence& on = model.depends_on();
    const double allowed = on.acceleration || on.forces ? 1e-7 : 1e-10;  // solves cost the differences some digits
    const double size = std::max(1.0, size_of(truth));
    EXPECT_TRUE(given.allFinite()) << where << " " << name;
    EXPECT_LT(size_of(given - truth) / size, allowed) << where << " " << name;

    std::vector<int> seen(data.r.size(), 0);
    for (const ResidualBlock& block : data.blocks)
      for (int row : block.rows) EXPECT_EQ(seen[row]++, 0) << where << " " << name;
    const auto dq = truth.leftCols(ndx / 2), dv = truth.middleCols(ndx / 2, ndx / 2), du = truth.rightCols(nu);
    if (!model.get_q_dependent()) {
      EXPECT_EQ(size_of(dq), 0) << name;
    }
    if (!model.get_v_dependent()) {
      EXPECT_EQ(size_of(dv), 0) << name;
    }
    if (!model.get_u_dependent()) {
      EXPECT_EQ(size_of(du), 0) << name;
    }
    if (!terminal && (on.u || on.acceleration)) {
      EXPECT_GT(size_of(du), 0) << name;
    }
  }
}

class Residuals : public testing::TestWithParam<Actuated> {};

TEST_P(Residuals, JacobiansMatchDifferences) {
  std::map<std::string, int> count;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 rng(seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    RandomScene scene = random_scene(rng, options);
    if (seed > 2) add_random_forces(scene.scene, rng);
    Tried t(scene, GetParam(), seed);
    for (const NamedResidual& r : t.residuals) ++count[r.name.substr(0, r.name.find('_'))];
    const std::string where = "seed " + std::to_string(seed);
    expect_jacobians(t, false, where);
    expect_jacobians(t, true, where + " terminal");
    expect_jacobians(t, false, where + " again");
    for (const auto& [name, item] : t.problem.contacts->get_contacts()) {  // islands separate
      t.problem.contacts->changeContactStatus(name, false);
      expect_jacobians(t, false, where + " without " + name);
      for (const auto& [cost, residual] : as_fwddyn(t.data).costs->costs)
        if (cost.starts_with("Contact") && cost.ends_with("_" + name)) {
          EXPECT_EQ(size_of(residual->residual->r), 0) << cost;
        }
      t.problem.contacts->changeContactStatus(name, true);
      break;
    }
    expect_jacobians(t, false, where + " contact back");
  }
  EXPECT_EQ(count.size(), 16);  // every residual came up
}

INSTANTIATE_TEST_SUITE_P(, Residuals, testing::Values(Actuated::kFloatingBase, Actuated::kFull, Actuated::kSquashed),
                         [](const auto& info) {
                           return info.param == Actuated::kFull       ? "full"
                                  : info.param == Actuated::kSquashed ? "squashed"
                                                                      : "floating_base";
                         });

TEST(ResidualValues, AreThoseOfTheScene) {
  std::mt19937 rng(11);
  SceneOptions options;
  Tried t(random_scene(rng, options), Actuated::kFull, 11);
  const Problem& p = t.problem;
  t.model->calc(t.data, p.x, p.u);
  const DataCollector& shared = *as_fwddyn(t.data).multibody;
  for (const NamedResidual& named : t.residuals) {
    const Eigen::VectorXd& r = t.of(named.name).r;
    if (const auto* com = dynamic_cast<ResidualModelCoMPosition*>(named.residual.get())) {
      double mass = 0;
      Eigen::Vector3d first = Eigen::Vector3d::Zero();
      for (int i = 0; i < shared.scene.nrobots(); ++i) {
        if (com->get_robot() >= 0 && com->get_robot() != i) continue;
        const double m = shared.scene.robots[i].model->mass();
        mass += m;
        first += m * center_of_mass<double>(shared.kinematics(i));
      }
      EXPECT_LT((r + com->get_reference() - first / mass).norm(), 1e-12) << named.name;
    }
    if (const auto* model = dynamic_cast<ResidualModelCentroidalMomentum*>(named.residual.get())) {
      double mass = 0;
      Eigen::Vector3d first = Eigen::Vector3d::Zero();
      Vec6<double> h = Vec6<double>::Zero();
      for (int i = 0; i < shared.scene.nrobots(); ++i) {
        if (model->get_robot() >= 0 && model->get_robot() != i) continue;
        const double m = shared.scene.robots[i].model->mass();
        mass += m;
        first += m * center_of_mass<double>(shared.kinematics(i));
        h += momentum<double>(shared.kinematics(i));
      }
      const Eigen::Vector3d c = first / mass, l = h.head<3>();
      h.tail<3>() -= c.cross(l);
      EXPECT_LT((r + model->get_reference() - h).norm(), 1e-11 * (1 + h.norm())) << named.name;
    }
    if (const auto* model = dynamic_cast<ResidualModelFrameVelocity*>(named.residual.get())) {
      const auto& f = p.state->get_model()->frames[model->get_id()];
      const ReferenceFrame axes = model->get_type() == LOCAL   ? ReferenceFrame::kLocal
                                  : model->get_type() == WORLD ? ReferenceFrame::kWorld
                                                               : ReferenceFrame::kLocalWorldAligned;
      const Vec6<double> v = frame_velocity<double>(shared.kinematics(f.robot), shared.scene.robots[f.robot].base,
                                                    f.joint, f.placement, axes);
      EXPECT_LT((r + model->get_reference() - v).norm(), 1e-13 * (1 + v.norm())) << named.name;
    }
  }
}

// tau - (g - tau_s - J^T f) is M a at rest; a node without controls has -(g - tau_s).
TEST(ResidualValues, OfGravityAreWhatAccelerates) {
  for (const bool pushed : {false, true}) {
    SCOPED_TRACE(pushed);
    std::mt19937 rng(11);
    RandomScene scene = random_scene(rng, {});
    if (pushed) add_random_forces(scene.scene, rng);
    Tried t(scene, Actuated::kFull, 11);
    const Problem& p = t.problem;
    const DataCollector& shared = *as_fwddyn(t.data).multibody;
    Eigen::VectorXd still = p.x;
    still.tail(p.state->get_nv()).setZero();
    t.model->calc(t.data, still, p.u);
    Eigen::VectorXd Ma = Eigen::VectorXd::Zero(p.u.size());
    for (int i = 0; i < shared.scene.nrobots(); ++i) {
      const Robot& robot = shared.scene.robots[i];
      Eigen::MatrixXd M(robot.model->nv, robot.model->nv);
      unpack_inertia<double>(*robot.model, joint_space_inertia(shared.scene, shared.solution, i).data(), M);
      Ma.segment(robot.idx_v, robot.model->nv) = M * t.data->xout.segment(robot.idx_v, robot.model->nv);
    }
    const Eigen::VectorXd by_contacts = t.of("ContactControlGrav").r, alone = t.of("ControlGrav").r;
    EXPECT_LT((by_contacts - Ma).norm(), 1e-9 * (1 + by_contacts.norm()));
    t.model->calc(t.data, still);
    EXPECT_LT((alone - p.u - t.of("ControlGrav").r).norm(), 1e-12 * (1 + alone.norm()));
  }
}

TEST(Cones, HoldWhatTheySay) {
  const FrictionCone cone(Eigen::Matrix3d::Identity(), 0.5, 4, false, 1, 10);
  Eigen::MatrixXd A(5, 3);
  A << 1, 0, -0.5, -1, 0, -0.5, 0, 1, -0.5, 0, -1, -0.5, 0, 0, 1;
  EXPECT_LT((cone.get_A() - A).norm(), 1e-15);
  EXPECT_EQ(cone.get_lb()[4], 1);
  EXPECT_EQ(cone.get_ub()[4], 10);
  EXPECT_EQ(cone.get_ub()[0], 0);
  EXPECT_NEAR(FrictionCone(Eigen::Matrix3d::Identity(), 0.5).get_A()(0, 2), -0.5 * std::sqrt(0.5), 1e-15);
  // A rotated cone contains the rotated forces.
  std::mt19937 rng(3);
  const Eigen::Matrix3d R = random_rotation(rng);
  EXPECT_LT((FrictionCone(R, 0.5, 4, false).get_A() * R - A).norm(), 1e-14);

  // L and W are half the box: the rows are those of Crocoddyl's comments.
  const double L = 0.1, W = 0.05, mu = 0.5;
  const WrenchCone wrench(Eigen::Matrix3d::Identity(), mu, {2 * L, 2 * W}, 4, false);
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(17, 6);
  B.topLeftCorner(5, 3) = A;
  B.middleRows(5, 4) << 0, 0, -W, 1, 0, 0, 0, 0, -W, -1, 0, 0, 0, 0, -L, 0, 1, 0, 0, 0, -L, 0, -1, 0;
  const double m = -mu * (L + W);
  B.middleRows(9, 4) << W, L, m, -mu, -mu, -1, W, -L, m, -mu, mu, -1, -W, L, m, mu, -mu, -1, -W, -L, m, mu, mu, -1;
  B.middleRows(13, 4) << W, L, m, mu, mu, 1, W, -L, m, mu, -mu, 1, -W, L, m, -mu, mu, 1, -W, -L, m, -mu, -mu, 1;
  EXPECT_LT((wrench.get_A() - B).norm(), 1e-15);
  EXPECT_LT((CoPSupport(wrench).get_A() - B.middleRows(5, 4)).norm(), 1e-15);
  const WrenchCone turned(R, mu, {2 * L, 2 * W}, 4, false);
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(6, 6);
  T.topLeftCorner(3, 3) = T.bottomRightCorner(3, 3) = R;
  EXPECT_LT((turned.get_A() * T - B).norm(), 1e-14);
  EXPECT_TRUE(WrenchCone().get_A().allFinite());

  EXPECT_THROW(FrictionCone(R, -0.1), std::invalid_argument);
  EXPECT_THROW(FrictionCone(R, 0.1, 3), std::invalid_argument);
  EXPECT_THROW(FrictionCone(R, 0.1, 0), std::invalid_argument);
  EXPECT_THROW(FrictionCone(R, 0.1, 4, true, -1), std::invalid_argument);
  EXPECT_THROW(CoPSupport(R, {-1, 1}), std::invalid_argument);
}

TEST(ResidualMisuse, IsRefused) {
  std::mt19937 rng(5);
  RandomScene s = random_scene(rng);
  const Problem p = make_problem(s, Actuated::kFull);
  const auto state = p.state;
  const std::size_t none = state->get_model()->frames.size(), nv = state->get_nv();
  const Eigen::VectorXd wrong = Eigen::VectorXd::Zero(nv + 1);
  using E = std::invalid_argument;
  EXPECT_THROW(ResidualModelFrameTranslation(state, none, Eigen::Vector3d::Zero()), E);
  EXPECT_THROW(ResidualModelContactFrictionCone(state, none, FrictionCone()), E);
  EXPECT_THROW(ResidualModelState(state, wrong), E);
  EXPECT_THROW(ResidualModelJointAcceleration(state, wrong), E);
  EXPECT_THROW(ResidualModelJointEffort(state, p.actuation, wrong), E);
  EXPECT_THROW(ResidualModelJointEffort(state, p.actuation, nv + 1), E);
  EXPECT_THROW(ResidualModelJointEffort(state, nullptr), E);
  EXPECT_THROW(ResidualModelControl(state, nv).set_reference(wrong), E);
  EXPECT_THROW(ResidualModelCoMPosition(state, Eigen::Vector3d::Zero(), nv, 99), E);
  EXPECT_THROW(ResidualModelContactForce(state, 0, Vec6<double>::Zero(), 4), E);
  EXPECT_THROW(ResidualModelContactForce(state, 0, Vec6<double>::Zero(), 6, nv, false), E);
  EXPECT_THROW(ResidualModelContactFrictionCone(state, 0, FrictionCone())
                   .set_reference(FrictionCone(Eigen::Matrix3d::Identity(), 1, 6)),
               E);

  const auto contacts = std::make_shared<ContactModelMultiple>(state);
  contacts->addContact("point", std::make_shared<ContactModel3D>(state, 0, Eigen::Vector3d::Zero(), LOCAL));
  const auto data_with = [&](std::shared_ptr<ResidualModelAbstract> residual) {
    const auto costs = std::make_shared<CostModelSum>(state);
    costs->addCost("it", std::make_shared<CostModelResidual>(state, residual), 1);
    DifferentialActionModelContactFwdDynamics(state, p.actuation, contacts, costs).createData();
  };
  data_with(std::make_shared<ResidualModelContactFrictionCone>(state, 0, FrictionCone()));
  const auto refused = [&](std::shared_ptr<ResidualModelAbstract> residual, const std::string& part) {
    try {
      data_with(residual);
      ADD_FAILURE() << "not refused: " << part;
    } catch (const E& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  refused(std::make_shared<ResidualModelContactFrictionCone>(state, 1, FrictionCone()), "frame 1 has no contact");
  refused(std::make_shared<ResidualModelContactForce>(state, 0, Vec6<double>::Zero(), 6), "3D");
  refused(std::make_shared<ResidualModelContactWrenchCone>(state, 0, WrenchCone()), "6D contact is expected");
  refused(std::make_shared<ResidualModelContactCoPPosition>(state, 0, CoPSupport()), "6D contact is expected");
}

}  // namespace
}  // namespace manycontact::test
