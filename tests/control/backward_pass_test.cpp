// The backward pass uses the structure of symplectic Euler; it agrees with dense matrices and the formulas of ddp.hpp.

#include <Eigen/Core>

#include "control/nodes.hpp"

namespace manycontact::test {
namespace {

// The solver uses the derivatives of this other class as they are.
struct DenseEuler : IntegratedActionModelEuler {
  using IntegratedActionModelEuler::IntegratedActionModelEuler;
};

// Sets random gaps, at random states near p.x.
template <class Solver>
void prepare(Solver& solver, const Problem& p) {
  std::mt19937 rng(9);
  std::vector<Eigen::VectorXd> xs, us;
  for (std::size_t t = 0; t <= solver.get_problem()->get_T(); ++t)
    xs.push_back(p.state->integrate_x(p.x, random_vector(static_cast<int>(p.state->get_ndx()), rng, 0.1)));
  for (std::size_t t = 0; t < solver.get_problem()->get_T(); ++t)
    us.push_back(random_vector(static_cast<int>(p.actuation->get_nu()), rng));
  solver.solve(xs, us, 0);
  solver.set_preg(1e-3);
  solver.computeDirection(true);
}

class BackwardPass : public testing::TestWithParam<int> {};

TEST_P(BackwardPass, OfSymplecticEulerIsThatOfItsMatrices) {
  const Problem p = problem_with_costs(GetParam());
  const auto model = p.model();
  const NodePtr terminal = std::make_shared<IntegratedActionModelEuler>(model, 0);
  const auto solved = [&](const NodePtr& node) {
    SolverFDDP solver(std::make_shared<ShootingProblem>(p.x, std::vector<NodePtr>(3, node), terminal));
    prepare(solver, p);
    EXPECT_TRUE(solver.direction_is_sound());
    return solver;
  };
  const SolverFDDP by_structure = solved(std::make_shared<IntegratedActionModelEuler>(model, 0.02));
  const SolverFDDP by_matrices = solved(std::make_shared<DenseEuler>(model, 0.02));
  for (std::size_t t = 0; t < 3; ++t) {
    EXPECT_LT(error_of(by_structure.get_Qxx()[t], by_matrices.get_Qxx()[t]), 1e-9);
    EXPECT_LT(error_of(by_structure.get_Qxu()[t], by_matrices.get_Qxu()[t]), 1e-9);
    EXPECT_LT(error_of(by_structure.get_Quu()[t], by_matrices.get_Quu()[t]), 1e-9);
    EXPECT_LT(error_of(by_structure.get_Qx()[t], by_matrices.get_Qx()[t]), 1e-9);
    EXPECT_LT(error_of(by_structure.get_Qu()[t], by_matrices.get_Qu()[t]), 1e-9);
    EXPECT_GT(size_of(by_structure.get_Vxx()[t]), 0);
  }
}

// Nodes without matrices give the same; a calc in between, e.g. of a rejected step, does not change derivatives.
TEST_P(BackwardPass, OfPanelsIsThatOfMatrices) {
  Problem p = problem_with_costs(GetParam());
  p.constraints = std::make_shared<ConstraintModelManager>(p.state, p.actuation->get_nu());
  const auto model = p.model(), panels = p.model();
  panels->set_storage(MatrixStorage::kPanel);
  if (as_fwddyn(model->createData()).multibody->islands.size() > 1) {
    EXPECT_THROW((void)panels->createData(), std::invalid_argument);
    return;
  }
  const auto solved = [&](const auto& m) {
    const NodePtr node = std::make_shared<IntegratedActionModelEuler>(m, 0.02);
    const NodePtr terminal = std::make_shared<IntegratedActionModelEuler>(m, 0);
    SolverFDDP solver(std::make_shared<ShootingProblem>(p.x, std::vector<NodePtr>(3, node), terminal));
    prepare(solver, p);
    node->calc(solver.get_problem()->get_runningDatas()[1], p.x, p.u);
    solver.computeDirection(false);
    EXPECT_TRUE(solver.direction_is_sound());
    return solver;
  };
  const SolverFDDP by_panels = solved(panels), by_matrices = solved(model);
  std::mt19937 rng(GetParam());
  for (std::size_t t = 0; t < 3; ++t) {
    EXPECT_LT(error_of(by_panels.get_Qxx()[t], by_matrices.get_Qxx()[t]), 1e-9);
    EXPECT_LT(error_of(by_panels.get_Vx()[t], by_matrices.get_Vx()[t]), 1e-9);
    EXPECT_LT(error_of(Eigen::MatrixXd(by_panels.get_K()[t]), Eigen::MatrixXd(by_matrices.get_K()[t])), 1e-7);
    const ActionDataAbstract& own = *by_panels.get_problem()->get_runningDatas()[t];
    const ActionDataAbstract& d = *by_matrices.get_problem()->get_runningDatas()[t];
    EXPECT_FALSE(own.has_matrices());
    EXPECT_EQ(own.Fx.size() + own.Lxx.size(), 0);
    Eigen::MatrixXd fx, fu;
    own.dynamics(fx, fu);
    EXPECT_LT(error_of(fx, d.Fx), 1e-12);
    EXPECT_LT(error_of(fu, d.Fu), 1e-12);
    const Eigen::VectorXd l = random_vector(static_cast<int>(fx.rows()), rng);
    Eigen::VectorXd gx(fx.cols()), gu(fu.cols());
    own.pull_back(l, gx, gu);
    EXPECT_LT(error_of(gx, Eigen::VectorXd(d.Fx.transpose() * l)), 1e-12);
    EXPECT_LT(error_of(gu, Eigen::VectorXd(d.Fu.transpose() * l)), 1e-12);
  }
}

TEST_P(BackwardPass, PanelsAreOfEulerWithoutConstraints) {
  const Problem p = problem_with_costs(GetParam());
  const auto model = p.model();
  if (as_fwddyn(model->createData()).multibody->islands.size() > 1) return;
  model->set_storage(MatrixStorage::kPanel);
  EXPECT_GT(model->get_ng() + model->get_nh(), 0u);
  EXPECT_THROW((void)IntegratedActionModelEuler(model, 0.02).createData(), std::invalid_argument);
}

TEST_P(BackwardPass, FollowsItsFormulas) {
  const Problem p = problem_with_costs(GetParam());
  const NodePtr node = std::make_shared<DenseEuler>(p.model(), 0.02);
  SolverFDDP solver(std::make_shared<ShootingProblem>(p.x, std::vector<NodePtr>(3, node), node));
  prepare(solver, p);
  for (std::size_t t = 0; t < 3; ++t) {
    const ActionDataAbstract& d = *solver.get_problem()->get_runningDatas()[t];
    const Eigen::MatrixXd &V = solver.get_Vxx()[t + 1], I = Eigen::MatrixXd::Identity(V.rows(), V.rows());
    const Eigen::VectorXd &v = solver.get_Vx()[t + 1], &gap = solver.get_fs()[t];
    const Eigen::MatrixXd Qxx = d.Lxx + d.Fx.transpose() * V * d.Fx, Qxu = d.Lxu + d.Fx.transpose() * V * d.Fu;
    Eigen::MatrixXd Quu = d.Luu + d.Fu.transpose() * V * d.Fu;
    Quu.diagonal().array() += 1e-3;
    const Eigen::VectorXd Qx = d.Lx + d.Fx.transpose() * v, Qu = d.Lu + d.Fu.transpose() * v;
    EXPECT_LT(error_of(solver.get_Qxx()[t], Qxx), 1e-11);
    EXPECT_LT(error_of(solver.get_Qxu()[t], Qxu), 1e-11);
    EXPECT_LT(error_of(solver.get_Quu()[t], Quu), 1e-11);
    EXPECT_LT(error_of(solver.get_Qx()[t], Qx), 1e-11);
    EXPECT_LT(error_of(solver.get_Qu()[t], Qu), 1e-11);
    const Eigen::MatrixXd K = solver.get_K()[t];
    EXPECT_LT(difference_of(solver.get_Quu()[t] * K, solver.get_Qxu()[t].transpose()),
              1e-11 * size_of(Quu) * size_of(K) * K.rows());
    EXPECT_LT(error_of(solver.get_Vxx()[t], Qxx - Qxu * K + 1e-3 * I),
              1e-9 * size_of(Qxx) / size_of(solver.get_Vxx()[t]));
    EXPECT_LT(difference_of(solver.get_Vx()[t], Qx - K.transpose() * Qu + solver.get_Vxx()[t] * gap),
              1e-9 * (size_of(Qx) + size_of(Qxx)));
    EXPECT_GT(size_of(gap), 0);
    EXPECT_TRUE(solver.get_Vxx()[t] == solver.get_Vxx()[t].transpose());
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, BackwardPass, testing::Range(40, 46));

}  // namespace
}  // namespace manycontact::test
