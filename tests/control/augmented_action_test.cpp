// A node has its constraints in its cost: value, gradient and Hessian agree with differences and with the projection.

#include "control/nodes.hpp"

namespace manycontact::test {
namespace {

// The constraints are random and linear. Some inequalities bind below, some above, some not; two have one side only.
struct Augmented {
  std::shared_ptr<ActionModelLQR> lqr = std::make_shared<ActionModelLQR>(ActionModelLQR::Random(5, 3, 6, 2));
  std::shared_ptr<ActionModelAugmentedLagrangian> model;
  NodeDataPtr data, inner;
  Eigen::VectorXd x, u, y;

  explicit Augmented(int seed) {
    std::mt19937 rng(seed);
    x = random_vector(5, rng), u = random_vector(3, rng), y = random_vector(8, rng);
    inner = lqr->createData();
    lqr->calc(inner, x, u);
    Eigen::VectorXd lower = inner->g.array() - 0.7, upper = inner->g.array() + 0.7;
    lower[0] = inner->g[0] + 0.3, upper[0] = kInfinity;
    upper[1] = inner->g[1] - 0.3, lower[1] = -kInfinity;
    lower[2] = upper[2] = inner->g[2] + 0.1;
    y[3] = 2, y[4] = -2;  // moves beyond the bounds at rho = 2
    y[5] = 0.1;
    lqr->set_g_lb(lower);
    lqr->set_g_ub(upper);
    model = std::make_shared<ActionModelAugmentedLagrangian>(lqr);
    model->set_multipliers(y);
    model->set_penalty(2);
    data = model->createData();
  }
};

TEST(AugmentedAction, ValueIsThatOfTheProjection) {
  Augmented a(1);
  for (const bool terminal : {false, true}) {
    if (terminal) {
      a.model->calc(a.data, a.x);
      a.lqr->calc(a.inner, a.x);
    } else {
      a.model->calc(a.data, a.x, a.u);
      a.lqr->calc(a.inner, a.x, a.u);
    }
    Eigen::VectorXd z(8), p(8);
    z << a.inner->g, a.inner->h;
    z += a.y / 2;
    p << z.head(6).cwiseMax(a.lqr->get_g_lb()).cwiseMin(a.lqr->get_g_ub()), Eigen::Vector2d::Zero();
    const double expected = a.inner->cost + (z - p).squaredNorm() - a.y.squaredNorm() / 4;
    EXPECT_NEAR(a.data->cost, expected, 1e-14 * (1 + std::abs(a.inner->cost) + z.squaredNorm()));
    EXPECT_LT(error_of(static_cast<ActionDataAugmentedLagrangian&>(*a.data).y_next, 2 * (z - p)), 1e-14);
    EXPECT_EQ(a.data->xnext, a.inner->xnext);
    EXPECT_EQ(a.model->get_ng() + a.model->get_nh(), 0u);
  }
}

// The constraints are linear and no bound is near a kink, so the Gauss-Newton Hessian is exact and differences are
// accurate to rounding: eps / h for gradients, eps / h^2 for Hessians, h = eps^(1/3), eps^(1/4).
TEST(AugmentedAction, DerivativesAreThoseOfTheValue) {
  for (int seed = 1; seed < 6; ++seed) {
    Augmented a(seed);
    ActionModelNumDiff twin(a.model);
    const NodeDataPtr expected = twin.createData();
    for (const bool terminal : {false, true}) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << (terminal ? ", terminal" : ""));
      for (Eigen::MatrixXd* m : {&a.data->Lxx, &a.data->Lxu, &a.data->Luu, &a.data->Fx}) m->setConstant(NAN);
      if (terminal) {
        a.model->calc(a.data, a.x), a.model->calcDiff(a.data, a.x);
        twin.calc(expected, a.x), twin.calcDiff(expected, a.x);
      } else {
        a.model->calc(a.data, a.x, a.u), a.model->calcDiff(a.data, a.x, a.u);
        twin.calc(expected, a.x, a.u), twin.calcDiff(expected, a.x, a.u);
        EXPECT_LT((a.data->Lu - expected->Lu).lpNorm<Eigen::Infinity>(), 1e-8);
        EXPECT_LT((a.data->Luu - expected->Luu).lpNorm<Eigen::Infinity>(), 1e-5);
        EXPECT_LT((a.data->Lxu - expected->Lxu).lpNorm<Eigen::Infinity>(), 1e-5);
        EXPECT_LT((a.data->Fx - expected->Fx).lpNorm<Eigen::Infinity>(), 1e-8);
        EXPECT_GT((a.data->Luu - a.lqr->get_R()).norm(), 0.1);
      }
      EXPECT_LT((a.data->Lx - expected->Lx).lpNorm<Eigen::Infinity>(), 1e-8);
      EXPECT_LT((a.data->Lxx - expected->Lxx).lpNorm<Eigen::Infinity>(), 1e-5);
      EXPECT_EQ(a.data->Lxx, a.data->Lxx.transpose());
      EXPECT_GT((a.data->Lxx - a.lqr->get_Q()).norm(), 0.1);
    }
  }
}

TEST(AugmentedAction, RefusesMisuse) {
  EXPECT_THROW(ActionModelAugmentedLagrangian(nullptr), std::invalid_argument);
  Augmented a(1);
  EXPECT_THROW(a.model->set_penalty(0), std::invalid_argument);
  EXPECT_THROW(a.model->calc(a.inner, a.x, a.u), std::invalid_argument);
  EXPECT_THROW(a.model->createData(nullptr), std::invalid_argument);
  a.model->set_multipliers(Eigen::VectorXd::Zero(7));
  EXPECT_THROW(a.model->calc(a.data, a.x, a.u), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
