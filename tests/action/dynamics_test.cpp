// Accelerations, forces and their derivatives of the action model agree with the truth in quadruple precision, and with
// the scene's own derivatives.

#include "action/problem.hpp"
#include "derivatives/judge.hpp"
#include "support/dense.hpp"
#include "support/golden.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

constexpr int kLargest = 60;

// Returns rows [a; f], columns [q | v | u] of an island, from the action's data.
Eigen::MatrixXd answer_of(const FwdDynData& d, std::size_t i) {
  const IslandColumns& c = d.multibody->islands[i];
  const Island& island = solved_island(d.multibody->solution, i);
  Eigen::MatrixXd out(island.size(), c.x.size() + c.u.size());
  out.topRows(island.nv) << d.Fx(c.v, c.x), d.Fu(c.v, c.u);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = d.multibody->scene.contacts[island.contacts[k]];
    const ContactDataAbstract& data = *d.multibody->contacts->contacts.at(contact.name);
    out.middleRows(island.nv + island.row_offset[k], contact.rows()) << data.df_dx, data.df_du;
  }
  return out;
}

void expect_true_derivatives(const Problem& p) {
  const auto model = p.model();
  const auto data = model->createData();
  FwdDynData& d = as_fwddyn(data);
  model->calc(data, p.x, p.u);
  const Scene& scene = d.multibody->scene;
  SceneData& solution = d.multibody->solution;
  const State s{p.x.head(scene.nq), p.x.tail(scene.nv), p.u};
  SceneData oracle(scene, {Method::kDense, {}});
  (void)solve(scene, s.q, s.v, s.u, oracle);
  const std::vector<double> condition = conditions(scene, oracle);
  EXPECT_LT(
      errors<double>(scene, solution, oracle.a, oracle.f, condition, free_accelerations(scene, s.q, s.v, s.u)).excess,
      1);
  EXPECT_TRUE(d.xout == solution.a);
  model->calcDiff(data, p.x, p.u);
  const std::vector<MatX<Quad>> truth = differences(scene, solution, s);
  for (std::size_t i = 0; i < island_count(solution); ++i) {
    const Island& island = solved_island(solution, i);
    const DerivativeErrors e =
        derivative_errors(scene, island, answer_of(d, i), truth[i], column_kinds(island, truth[i]), condition[i]);
    EXPECT_LT(e.excess, 1);
    EXPECT_GT(size_of(truth[i]), 0);
  }
  EXPECT_TRUE(Eigen::MatrixXd(d.Fx_sparse()) == d.Fx);
  EXPECT_TRUE(Eigen::MatrixXd(d.Fu_sparse()) == d.Fu);
}

class DynamicsOf : public testing::TestWithParam<std::string> {};

TEST_P(DynamicsOf, DerivativesAreTrue) {
  SceneFile file = load_small(GetParam());
  if (largest_island(file.scene) > kLargest) GTEST_SKIP() << "too large; the same code as of the small ones";
  std::mt19937 rng(21);
  disturb(file, rng);
  expect_true_derivatives(make_problem(file));
}

// The scene's own derivatives are computed without the action model, in its contacts' order.
TEST_P(DynamicsOf, AreTheScenesOwn) {
  SceneFile file = load_small(GetParam());
  std::mt19937 rng(22);
  disturb(file, rng);
  const Problem p = make_problem(file);
  const auto model = p.model();
  const auto data = model->createData();
  model->calc(data, p.x, p.u);
  model->calcDiff(data, p.x, p.u);
  SceneData own(file.scene);
  (void)solve(file.scene, file.q, file.v, file.u, own);
  differentiate(file.scene, own);
  const SceneDerivatives expected = dense_derivatives(file.scene, own);
  const double allowed = 1e-8;  // the contacts' order differs, and so does rounding
  EXPECT_LT(difference_of(data->xout, own.a), allowed * size_of(own.a));
  EXPECT_LT(difference_of(data->Fx.leftCols(file.scene.nv).eval(), expected.da_dq), allowed * size_of(expected.da_dq));
  EXPECT_LT(difference_of(data->Fx.rightCols(file.scene.nv).eval(), expected.da_dv), allowed * size_of(expected.da_dv));
  EXPECT_LT(difference_of(data->Fu, expected.da_du), allowed * size_of(expected.da_du));
}

INSTANTIATE_TEST_SUITE_P(Models, DynamicsOf, testing::ValuesIn(model_scenes()), scene_title);
INSTANTIATE_TEST_SUITE_P(Golden, DynamicsOf, testing::ValuesIn(golden_scenes()), scene_title);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(DynamicsOf);

class RandomDynamics : public testing::TestWithParam<int> {};

TEST_P(RandomDynamics, DerivativesAreTrue) {
  std::mt19937 rng(900 + GetParam());
  SceneOptions options;
  options.nrobots = 1 + GetParam() % 3;
  options.models = {ModelOptions{.floating_base = true}, ModelOptions{}};
  options.damping = GetParam() % 3 == 0 ? 1e-3 : 0;
  expect_true_derivatives(make_problem(random_scene(rng, options)));
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomDynamics, testing::Range(0, 8));

// quasiStatic gives quasi_static_u of Crocoddyl's figures.
class GoldenQuasiStatic : public testing::TestWithParam<std::string> {};

TEST_P(GoldenQuasiStatic, To1e8) {
  const Golden golden = load_golden(GetParam());
  if (!golden.quasi_static_u) GTEST_SKIP() << "this file has none";
  SceneFile file = load_scene(GetParam());
  if (golden.appended) file.scene = as_appended_by_pinocchio_3_7(file.scene);
  Problem p = make_problem(file);
  p.x.tail(file.scene.nv).setZero();
  const auto model = p.model();
  const auto data = model->createData();
  const Eigen::VectorXd u = model->quasiStatic_x(data, p.x);
  EXPECT_LT(difference_of(u, *golden.quasi_static_u), 1e-8 * size_of(*golden.quasi_static_u));
}
INSTANTIATE_TEST_SUITE_P(Golden, GoldenQuasiStatic, testing::ValuesIn(golden_scenes()), scene_title);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GoldenQuasiStatic);

// With torques on every coordinate u + J^T f = h has the minimum-norm solution u = (I + J^T J)^-1 h.
TEST(QuasiStatic, WithEveryCoordinateActuated) {
  for (int seed = 0; seed < 5; ++seed) {
    std::mt19937 rng(60 + seed);
    SceneOptions options;
    options.models = {ModelOptions{.floating_base = true}, ModelOptions{}};
    Problem p = make_problem(random_scene(rng, options), Actuated::kFull);
    const int nv = static_cast<int>(p.state->get_nv());
    p.x.tail(nv).setZero();
    const auto model = p.model();
    const auto data = model->createData();
    const Eigen::VectorXd u = model->quasiStatic_x(data, p.x);
    const Scene& scene = as_fwddyn(data).multibody->scene;
    const Terms terms(scene, as_fwddyn(data).multibody->solution.active, p.x.head(scene.nq), p.x.tail(nv),
                      Eigen::VectorXd::Zero(scene.nu));
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(nv, nv) + terms.J.transpose() * terms.J;
    const Eigen::VectorXd expected = solved(A, -terms.tau_b);
    EXPECT_LT(error_of(u, expected), 1e-10);
    EXPECT_GT(size_of(u), 0);
  }
}

}  // namespace
}  // namespace manycontact::test
