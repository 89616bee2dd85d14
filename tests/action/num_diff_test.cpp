// Derivatives of the action model agree with numerical differentiation: every residual with every activation as a cost
// and as a constraint, on every contact and actuation, running and terminal, one by one and in their sum.

#include "manycontact/action/num_diff.hpp"

#include <gtest/gtest.h>

#include "action/problem.hpp"
#include "action/residual_factory.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {
namespace {

constexpr double kTwinTolerance = 1e-6;

struct Case {
  const char* name;
  int seed;
  Actuated actuation;
};

Problem problem_of(const Case& c) {
  std::mt19937 rng(c.seed);
  SceneOptions options;
  options.nrobots = 1 + c.seed % 3;
  options.models = {ModelOptions{.floating_base = true, .armature = 0.1}, ModelOptions{}};
  options.damping = c.seed % 4 == 0 ? 1e-2 : 0;
  options.same_link = 0;
  return make_problem(random_scene(rng, options), c.actuation);
}

std::shared_ptr<ActivationModelAbstract> activation(int k, std::size_t nr, std::mt19937& rng) {
  const int n = static_cast<int>(nr);
  const Eigen::VectorXd weights = random_vector(n, rng).cwiseAbs() + Eigen::VectorXd::Constant(n, 0.1);
  Eigen::VectorXd lower = random_vector(n, rng), upper = lower + random_vector(n, rng).cwiseAbs();
  if (n > 1) lower[0] = -std::numeric_limits<double>::infinity();
  switch (k % 5) {
    case 0:
      return std::make_shared<ActivationModelQuad>(nr);
    case 1:
      return std::make_shared<ActivationModelWeightedQuad>(weights);
    case 2:
      return std::make_shared<ActivationModelQuadraticBarrier>(ActivationBounds(lower, upper, 0.9));
    case 3:
      return std::make_shared<ActivationModelWeightedQuadraticBarrier>(ActivationBounds(lower, upper), weights);
    default:
      return std::make_shared<ActivationModelSmooth1Norm>(nr, 0.1);
  }
}

// Returns the largest difference, relative to the larger of the twin's entries and the rounding error of such values.
double error(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& twin, double values) {
  if (mine.size() == 0 && twin.size() == 0) return 0;
  const double difference = difference_of(mine, twin);
  return difference == 0 ? 0 : difference / std::max(size_of(twin), 1e-3 * values);
}

class NumDiff : public testing::TestWithParam<Case> {
 protected:
  Problem p = problem_of(GetParam());
  std::mt19937 rng{static_cast<unsigned>(GetParam().seed)};
  std::vector<NamedResidual> residuals = all_residuals(p.state, p.actuation, *p.contacts, 3);
};

TEST_P(NumDiff, ResidualsAndConstraints) {
  for (const NamedResidual& r : residuals) {
    const Eigen::VectorXd lower = random_vector(static_cast<int>(r.residual->get_nr()), rng);
    Eigen::VectorXd upper = lower;
    upper[0] += 1;  // one inequality, the others equalities
    p.constraints->addConstraint(r.name, std::make_shared<ConstraintModelResidual>(p.state, r.residual, lower, upper));
  }
  const auto model = p.model(false);  // residuals that need force derivatives switch them on
  DifferentialActionModelNumDiff twin(model);
  for (bool terminal : {false, true}) {
    SCOPED_TRACE(terminal ? "terminal" : "running");
    const auto data = model->createData(), numbers = twin.createData();
    evaluate(*model, data, p, terminal);
    evaluate(twin, numbers, p, terminal);
    if (!terminal) {
      EXPECT_LT(error(data->Fx, numbers->Fx, size_of(data->xout)), kTwinTolerance);
      EXPECT_LT(error(data->Fu, numbers->Fu, size_of(data->xout)), kTwinTolerance);
    }
    Eigen::Index g = 0, h = 0;
    int active = 0;
    for (const auto& [name, item] : p.constraints->get_constraints()) {
      const ConstraintModelResidual& c = *item->constraint;
      if (terminal && !c.get_T_constraint()) continue;
      const Eigen::Index ng = c.get_ng(), nh = c.get_nh(), n = ng + nh;
      Eigen::MatrixXd Rx(n, data->Gx.cols()), Rx_twin = Rx, Ru(n, data->Gu.cols()), Ru_twin = Ru;
      Eigen::VectorXd r(n);
      Rx << data->Gx.middleRows(g, ng), data->Hx.middleRows(h, nh);
      Ru << data->Gu.middleRows(g, ng), data->Hu.middleRows(h, nh);
      Rx_twin << numbers->Gx.middleRows(g, ng), numbers->Hx.middleRows(h, nh);
      Ru_twin << numbers->Gu.middleRows(g, ng), numbers->Hu.middleRows(h, nh);
      r << data->g.segment(g, ng), data->h.segment(h, nh);
      EXPECT_LT(error(Rx, Rx_twin, size_of(r)), kTwinTolerance) << name;
      if (!terminal) {
        EXPECT_LT(error(Ru, Ru_twin, size_of(r)), kTwinTolerance) << name;
      }
      active += size_of(Rx) > 0 || size_of(Ru) > 0;
      g += ng, h += nh;
    }
    EXPECT_EQ(g, data->g.size());
    EXPECT_EQ(h, data->h.size());
    EXPECT_GT(active, 10);
    EXPECT_TRUE(Eigen::MatrixXd(data->Gx_sparse()) == data->Gx);
    EXPECT_TRUE(Eigen::MatrixXd(data->Hx_sparse()) == data->Hx);
    if (!terminal) {
      EXPECT_TRUE(Eigen::MatrixXd(data->Gu_sparse()) == data->Gu);
    }
    if (!terminal) {
      EXPECT_TRUE(Eigen::MatrixXd(data->Hu_sparse()) == data->Hu);
    }
  }
}

TEST_P(NumDiff, CostsWithEveryActivation) {
  int k = GetParam().seed;
  for (const NamedResidual& r : residuals)
    p.costs->addCost(
        r.name, std::make_shared<CostModelResidual>(p.state, activation(k++, r.residual->get_nr(), rng), r.residual),
        uniform(rng, 0.1, 2), false);
  const auto model = p.model(false);
  DifferentialActionModelNumDiff twin(model, true);  // its Hessians are not used
  const auto data = model->createData(), numbers = twin.createData();
  const auto compare = [&](const std::string& name) {
    for (bool terminal : {false, true}) {
      SCOPED_TRACE(name + (terminal ? ", terminal" : ", running"));
      evaluate(*model, data, p, terminal);
      evaluate(twin, numbers, p, terminal);
      if (!terminal) {
        EXPECT_LT(error(data->Lu, numbers->Lu, std::abs(data->cost)), kTwinTolerance);
      }
      EXPECT_EQ(data->cost, numbers->cost);
      EXPECT_LT(error(data->Lx, numbers->Lx, std::abs(data->cost)), kTwinTolerance);
    }
  };
  for (const NamedResidual& r : residuals) {
    p.costs->changeCostStatus(r.name, true);
    compare(r.name);
    p.costs->changeCostStatus(r.name, false);
  }
  for (const NamedResidual& r : residuals) p.costs->changeCostStatus(r.name, true);
  compare("all");
}

// Gauss-Newton's Hessian is sum w Rx^T Arr Rx, of the residuals' whole matrices.
TEST_P(NumDiff, HessiansAreGaussNewtons) {
  int k = GetParam().seed;
  for (const NamedResidual& r : residuals)
    p.costs->addCost(
        r.name, std::make_shared<CostModelResidual>(p.state, activation(k++, r.residual->get_nr(), rng), r.residual),
        uniform(rng, 0.1, 2));
  const auto model = p.model(false);
  const auto data = model->createData();
  model->calc(data, p.x, p.u);
  model->calcDiff(data, p.x, p.u);
  Eigen::VectorXd Lx = 0 * data->Lx, Lu = 0 * data->Lu;
  Eigen::MatrixXd Lxx = 0 * data->Lxx, Lxu = 0 * data->Lxu, Luu = 0 * data->Luu;
  for (const auto& [name, cost] : as_fwddyn(data).costs->costs) {
    const double w = p.costs->get_costs().at(name)->weight;
    const Eigen::MatrixXd Rx = cost->residual->whole_Rx(), Ru = cost->residual->whole_Ru(), A = cost->activation->Arr;
    Lx += w * Rx.transpose() * cost->activation->Ar;
    Lu += w * Ru.transpose() * cost->activation->Ar;
    Lxx += w * Rx.transpose() * A * Rx;
    Lxu += w * Rx.transpose() * A * Ru;
    Luu += w * Ru.transpose() * A * Ru;
    const CostDerivatives own = cost->whole_derivatives();
    EXPECT_LT(error_of(own.Lx, Rx.transpose() * cost->activation->Ar), 1e-14);
    EXPECT_LT(error_of(own.Lu, Ru.transpose() * cost->activation->Ar), 1e-14);
    EXPECT_LT(error_of(own.Lxx, Rx.transpose() * A * Rx), 1e-14);
    EXPECT_LT(error_of(own.Lxu, Rx.transpose() * A * Ru), 1e-14);
    EXPECT_LT(error_of(own.Luu, Ru.transpose() * A * Ru), 1e-14);
  }
  EXPECT_LT(error_of(data->Lx, Lx), 1e-12);
  EXPECT_LT(error_of(data->Lu, Lu), 1e-12);
  EXPECT_LT(error_of(data->Lxx, Lxx), 1e-12);
  EXPECT_LT(error_of(data->Lxu, Lxu), 1e-12);
  EXPECT_LT(error_of(data->Luu, Luu), 1e-12);
  EXPECT_LT(error_of(Eigen::MatrixXd(data->Lxx_sparse()), data->Lxx), 1e-14);
  EXPECT_LT(error_of(Eigen::MatrixXd(data->Lxu_sparse()), data->Lxu), 1e-14);
  EXPECT_LT(error_of(Eigen::MatrixXd(data->Luu_sparse()), data->Luu), 1e-14);
  EXPECT_EQ(data->Lxx, data->Lxx.transpose().eval());
  EXPECT_EQ(data->Luu, data->Luu.transpose().eval());
}

std::vector<Case> cases() {
  std::vector<Case> out;
  const std::pair<const char*, Actuated> kinds[] = {
      {"floating_base", Actuated::kFloatingBase}, {"full", Actuated::kFull}, {"squashed", Actuated::kSquashed}};
  for (int seed = 40; seed < 46; ++seed) {
    const auto& [name, how] = kinds[seed % 3 == 0 ? 0 : (seed / 2) % 3];
    out.push_back({name, seed, how});
  }
  return out;
}
INSTANTIATE_TEST_SUITE_P(Problems, NumDiff, testing::ValuesIn(cases()), [](const auto& info) {
  return std::string(info.param.name) + "_" + std::to_string(info.param.seed);
});

// Second differences are exact for a cost that is quadratic in x and u.
TEST(NumDiffTwin, HessiansBySecondDifferences) {
  Problem p = problem_of({"", 40, Actuated::kFull});
  const std::size_t nu = p.actuation->get_nu();
  std::mt19937 rng(1);
  p.costs->addCost("u",
                   std::make_shared<CostModelResidual>(p.state, activation(1, nu, rng),
                                                       std::make_shared<ResidualModelControl>(p.state, nu)),
                   2);
  const auto model = p.model();
  DifferentialActionModelNumDiff twin(model);
  const auto data = model->createData(), numbers = twin.createData();
  model->calc(data, p.x, p.u), model->calcDiff(data, p.x, p.u);
  twin.calc(numbers, p.x, p.u), twin.calcDiff(numbers, p.x, p.u);
  EXPECT_LT(error_of(numbers->Luu, data->Luu), 1e-5);
  EXPECT_LT(size_of(numbers->Lxx), 1e-5);
  EXPECT_THROW(twin.calc(data, p.x, p.u), std::invalid_argument);
  EXPECT_THROW(twin.set_disturbance(0), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
