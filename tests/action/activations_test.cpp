// Activations agree with central differences, on both sides of their bounds, and with values calculated by hand.

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "manycontact/action/activation.hpp"

namespace manycontact {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Eigen::VectorXd vector(std::initializer_list<double> numbers) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), v.begin());
  return v;
}

// Component 0 has a lower bound only, 1 an upper one, 2 both, 3 none, 4 both at the same place.
ActivationBounds bounds() { return {vector({-0.5, -inf, -1, -inf, 0.2}), vector({inf, 0.5, 1, inf, 0.2})}; }

struct Case {
  const char* name;
  std::shared_ptr<ActivationModelAbstract> model;
};

std::vector<Case> cases() {
  const Eigen::VectorXd w = vector({0.5, 2, 3, 0, 1.5});
  return {{"quad", std::make_shared<ActivationModelQuad>(5)},
          {"weighted", std::make_shared<ActivationModelWeightedQuad>(w)},
          {"barrier", std::make_shared<ActivationModelQuadraticBarrier>(bounds())},
          {"weighted barrier", std::make_shared<ActivationModelWeightedQuadraticBarrier>(bounds(), w)},
          {"smooth norm", std::make_shared<ActivationModelSmooth1Norm>(5, 0.3)}};
}

double value(ActivationModelAbstract& model, const Eigen::VectorXd& r) {
  const auto data = model.createData();
  model.calc(data, r);
  return data->a_value;
}

Eigen::VectorXd gradient(ActivationModelAbstract& model, const Eigen::VectorXd& r) {
  const auto data = model.createData();
  model.calc(data, r);
  model.calcDiff(data, r);
  return data->Ar;
}

TEST(Activations, DerivativesMatchDifferences) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> draw(-2, 2);
  const double step = 1e-6;
  for (const Case& c : cases()) {
    int inside = 0, outside = 0;
    for (int trial = 0; trial < 50; ++trial) {
      Eigen::VectorXd r(5);
      for (double& number : r) number = draw(rng);
      const double away =
          std::min({std::abs(r[0] + 0.5), std::abs(r[1] - 0.5), std::abs(std::abs(r[2]) - 1), std::abs(r[4] - 0.2)});
      if (away < 10 * step) continue;
      std::abs(r[2]) < 1 ? ++inside : ++outside;
      const auto data = c.model->createData();
      data->Ar.setConstant(std::nan(""));
      data->Arr.diagonal().setConstant(std::nan(""));
      c.model->calc(data, r);
      c.model->calcDiff(data, r);
      for (int i = 0; i < 5; ++i) {
        const Eigen::VectorXd h = step * Eigen::VectorXd::Unit(5, i);
        EXPECT_NEAR(data->Ar[i], (value(*c.model, r + h) - value(*c.model, r - h)) / (2 * step), 2e-8) << c.name;
        const Eigen::VectorXd column = (gradient(*c.model, r + h) - gradient(*c.model, r - h)) / (2 * step);
        for (int k = 0; k < 5; ++k)
          EXPECT_NEAR(k == i ? data->Arr.diagonal()[i] : 0, column[k], 2e-8) << c.name << " " << i << k;
      }
    }
    EXPECT_GT(inside, 5) << c.name;
    EXPECT_GT(outside, 5) << c.name;
  }
}

// Activations of |r| have true Hessians that are not diagonal.
std::vector<Case> cases_of_norm() {
  return {{"smooth 2-norm", std::make_shared<ActivationModelSmooth2Norm>(5, 0.3)},
          {"2-norm barrier", std::make_shared<ActivationModel2NormBarrier>(5, 2.5)},
          {"2-norm barrier, true", std::make_shared<ActivationModel2NormBarrier>(5, 2.5, true)},
          {"flat exp", std::make_shared<ActivationModelQuadFlatExp>(5, 1.7)},
          {"flat log", std::make_shared<ActivationModelQuadFlatLog>(5, 1.7)}};
}

TEST(Activations, OfNormsMatchDifferences) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> draw(-2, 2);
  const double step = 1e-6;
  for (const Case& c : cases_of_norm()) {
    const std::string name = c.name;
    int inside = 0, outside = 0;
    for (int trial = 0; trial < 50; ++trial) {
      Eigen::VectorXd r(5);
      for (double& number : r) number = draw(rng);
      const double d = r.norm();
      if (std::abs(d - 2.5) < 10 * step) continue;
      d < 2.5 ? ++inside : ++outside;
      const auto data = c.model->createData();
      data->Ar.setConstant(std::nan(""));
      data->Arr.diagonal().setConstant(std::nan(""));
      c.model->calc(data, r);
      c.model->calcDiff(data, r);
      Eigen::MatrixXd H(5, 5);
      for (int i = 0; i < 5; ++i) {
        const Eigen::VectorXd h = step * Eigen::VectorXd::Unit(5, i);
        EXPECT_NEAR(data->Ar[i], (value(*c.model, r + h) - value(*c.model, r - h)) / (2 * step), 2e-8) << name;
        H.col(i) = (gradient(*c.model, r + h) - gradient(*c.model, r - h)) / (2 * step);
      }
      Eigen::VectorXd expected = H.diagonal();
      if (name == "smooth 2-norm")
        expected.setConstant(r.dot(H * r) / (d * d));  // the smallest eigenvalue is along r
      else if (name == "2-norm barrier")
        expected = r.cwiseAbs2() / (d * d) * (d < 2.5 ? 1 : 0);
      EXPECT_LT((data->Arr.diagonal() - expected).cwiseAbs().maxCoeff(), 2e-8) << name;
    }
    EXPECT_GT(inside, 5) << name;
    EXPECT_GT(outside, 5) << name;
  }
}

TEST(Activations, OfNormsByHand) {
  const Eigen::VectorXd r = vector({0.3, 0, 0.4, 0, 0}), zero = Eigen::VectorXd::Zero(5);
  EXPECT_DOUBLE_EQ(value(*cases_of_norm()[0].model, r), std::sqrt(0.3 + 0.25));
  EXPECT_DOUBLE_EQ(value(*cases_of_norm()[1].model, r), 2);
  EXPECT_DOUBLE_EQ(value(*cases_of_norm()[3].model, r), 1 - std::exp(-0.25 / 1.7));
  EXPECT_DOUBLE_EQ(value(*cases_of_norm()[4].model, r), std::log(1 + 0.25 / 1.7));
  EXPECT_EQ(value(*cases_of_norm()[1].model, 10 * r), 0);
  EXPECT_EQ(gradient(*cases_of_norm()[1].model, zero), zero);  // the kink
  EXPECT_EQ(value(*cases_of_norm()[3].model, zero), 0);
  EXPECT_NE(value(*cases_of_norm()[3].model, 1e-12 * r), 0);  // no digits are lost near 0
}

TEST(Activations, ValuesByHand) {
  const Eigen::VectorXd r = vector({-1, 1, 3, 100, 0.2});
  EXPECT_DOUBLE_EQ(value(*cases()[0].model, r), (1 + 1 + 9 + 1e4 + 0.04) / 2);
  EXPECT_DOUBLE_EQ(value(*cases()[1].model, r), (0.5 + 2 + 27 + 0 + 1.5 * 0.04) / 2);
  EXPECT_DOUBLE_EQ(value(*cases()[2].model, r), (0.25 + 0.25 + 4) / 2);
  EXPECT_DOUBLE_EQ(value(*cases()[3].model, r), (0.25 * 0.25 + 4 * 0.25 + 9 * 4) / 2);
  EXPECT_DOUBLE_EQ(value(*cases()[4].model, vector({0, 0, 0, 0, 0})), 5 * std::sqrt(0.3));
}

TEST(Activations, BarrierIsFlatInsideAndUnitOutside) {
  ActivationModelQuadraticBarrier model(bounds());
  const auto data = model.createData();
  model.calcDiff(data, vector({0, 0, 0, -1e9, 0.2}));
  EXPECT_EQ(data->Ar, Eigen::VectorXd::Zero(5));
  EXPECT_EQ(data->Arr.diagonal(), vector({0, 0, 0, 0, 1}));  // equal bounds: an equality, curved everywhere
  model.calcDiff(data, vector({-1, 1, -2, 1e9, 0.1}));
  EXPECT_EQ(data->Arr.diagonal(), vector({1, 1, 1, 0, 1}));
}

TEST(Activations, BoundsAreDrawnIn) {
  const ActivationBounds b(vector({-inf, 0, 1, -2}), vector({3, inf, 3, 6}), 0.5);
  EXPECT_EQ(b.lb, vector({-inf, 0, 1.5, 0}));
  EXPECT_EQ(b.ub, vector({3, inf, 2.5, 4}));
  const ActivationBounds whole(vector({0.1}), vector({0.7}), 1);
  EXPECT_EQ(whole.lb[0], 0.1);
  EXPECT_EQ(whole.ub[0], 0.7);
}

template <class Call>
std::string refusal(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Activations, MisuseIsRefused) {
  EXPECT_EQ(refusal([] {
              ActivationBounds(vector({0, 0}), vector({1}));
            }),
            "ActivationBounds: ub has 1 numbers, expected 2");
  EXPECT_NE(refusal([] { ActivationBounds(vector({2}), vector({1})); }), "");
  EXPECT_NE(refusal([] { ActivationBounds(vector({std::nan("")}), vector({1})); }), "");
  EXPECT_NE(refusal([] { ActivationBounds(vector({inf}), vector({inf})); }), "");
  EXPECT_NE(refusal([] { ActivationBounds(vector({0}), vector({1}), 1.5); }), "");
  EXPECT_NE(refusal([] { ActivationBounds(vector({0}), vector({1}), std::nan("")); }), "");
  EXPECT_NE(refusal([] { ActivationModelWeightedQuadraticBarrier(bounds(), vector({1})); }), "");
  EXPECT_NE(refusal([] { ActivationModelSmooth1Norm(3, 0); }), "");
  EXPECT_NE(refusal([] { ActivationModelSmooth2Norm(3, 0); }), "");
  EXPECT_NE(refusal([] { ActivationModel2NormBarrier(3, -1); }), "");
  EXPECT_NE(refusal([] { ActivationModelQuadFlatExp(3, 0); }), "");
  EXPECT_NE(refusal([] { ActivationModelQuadFlatLog(3).set_alpha(std::nan("")); }), "");
  EXPECT_NE(refusal([] { ActivationModelWeightedQuad(vector({1, 2})).set_weights(vector({1})); }), "");
  std::vector<Case> all = cases(), of_norm = cases_of_norm();
  all.insert(all.end(), of_norm.begin(), of_norm.end());
  for (const Case& c : all) {
    const auto data = c.model->createData();
    EXPECT_NE(refusal([&] {
                c.model->calc(data, vector({1, 2}));
              }).find("r has 2 numbers, expected 5"),
              std::string::npos);
    EXPECT_NE(refusal([&] { c.model->calcDiff(data, vector({1, 2})); }).find("r has 2 numbers"), std::string::npos);
  }
}

}  // namespace
}  // namespace manycontact
