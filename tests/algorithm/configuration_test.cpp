// Configurations of a whole scene are tested.

#include "manycontact/algorithm/configuration.hpp"

#include <numbers>
#include <stdexcept>

#include "algorithm/shapes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The scene has every shape of robot once, each on a base somewhere.
class SceneOfShapes : public testing::Test {
 protected:
  SceneOfShapes() {
    for (const Shape& shape : shapes()) {
      const auto model = std::make_shared<Model>(random_model(rng, shape.options));
      add_robot(scene, shape.name, model, random_placement(rng, 2));
    }
    q = random_configuration(scene, rng);
    v = random_vector(scene.nv, rng, 0.5).cwiseMax(-1).cwiseMin(1);
  }
  // Returns f(robot) of each robot, one after the other.
  template <class F>
  VectorXd of_robots(int n, F&& f) const {
    VectorXd all(n);
    Eigen::Index at = 0;
    for (const Robot& robot : scene.robots) {
      const VectorXd part = f(robot);
      all.segment(at, part.size()) = part;
      at += part.size();
    }
    EXPECT_EQ(at, n);
    return all;
  }

  std::mt19937 rng{3};
  Scene scene;
  VectorXd q, v;
};

TEST_F(SceneOfShapes, NeutralStartsFloatingBasesWhereTheyStand) {
  const VectorXd start = neutral(scene);
  int floating = 0;
  EXPECT_EQ(of_robots(scene.nq,
                      [&](const Robot& r) {
                        VectorXd own = neutral(*r.model);
                        if (r.model->floating_base) own.head<7>() = start.segment<7>(r.idx_q);
                        return own;
                      }),
            start);
  for (const Robot& r : scene.robots) {
    if (!r.model->floating_base) continue;
    ++floating;
    EXPECT_LE(difference_of(placement_of_pose(start.segment<7>(r.idx_q)), r.base), 8 * kEps);
  }
  EXPECT_GT(floating, 3);
  EXPECT_LT(floating, scene.nrobots());
}

TEST_F(SceneOfShapes, IntegrateAndDifferenceAreThoseOfTheRobots) {
  const VectorXd next = integrate(scene, q, v);
  EXPECT_EQ(next, of_robots(scene.nq, [&](const Robot& r) {
              VectorXd out(r.model->nq);
              integrate<double>(*r.model, q.segment(r.idx_q, r.model->nq), v.segment(r.idx_v, r.model->nv), out);
              return out;
            }));
  EXPECT_LE(difference_of(difference(scene, q, next), v), kTight);
  VectorXd filled = VectorXd::Constant(scene.nv, NAN);
  difference(scene, q, next, filled);
  EXPECT_EQ(filled, difference(scene, q, next));
}

TEST_F(SceneOfShapes, IntegrateInPlace) {
  const VectorXd next = integrate(scene, q, v);
  VectorXd x = q;
  integrate(scene, x, v, x);
  EXPECT_EQ(x, next);
}

TEST_F(SceneOfShapes, WrongSizesAreRefused) {
  const VectorXd short_q = q.head(scene.nq - 1), long_v = VectorXd::Zero(scene.nv + 1);
  VectorXd out(scene.nq), d(scene.nv);
  EXPECT_THROW(integrate(scene, short_q, v), std::invalid_argument);
  EXPECT_THROW(integrate(scene, q, long_v), std::invalid_argument);
  EXPECT_THROW(integrate(scene, q, v, d), std::invalid_argument);
  EXPECT_THROW(difference(scene, short_q, q), std::invalid_argument);
  EXPECT_THROW(difference(scene, q, short_q), std::invalid_argument);
  EXPECT_THROW(difference(scene, q, q, out), std::invalid_argument);
}

TEST_F(SceneOfShapes, RandomConfigurationsAreOnTheManifoldAndRepeatable) {
  std::mt19937 one(8), two(8);
  VectorXd sum = VectorXd::Zero(scene.nq);
  for (int k = 0; k < 400; ++k) {
    const VectorXd x = random_configuration(scene, one);
    ASSERT_EQ(x, random_configuration(scene, two));
    EXPECT_LE(difference_of(integrate(scene, x, VectorXd::Zero(scene.nv)), x), 8 * kEps);  // unit quaternions
    sum += x - neutral(scene);
    for (const Robot& r : scene.robots)
      if (r.model->floating_base) {
        EXPECT_LE(size_of(x.segment<3>(r.idx_q) - r.base.p), 1);
      }
  }
  // the mean of 400 within +-pi has a deviation of pi / sqrt(3 * 400) = 0.09; of 400 orientations every w is likely
  for (const Robot& r : scene.robots)
    for (const Joint& joint : r.model->joints) {
      const auto mean = sum.segment(r.idx_q + joint.idx_q, joint.nq()) / 400;
      if (joint.type == JointType::kFloating) continue;
      EXPECT_LE(size_of(mean), 5 * 0.0907);
    }
}

// There are four kinds of limits for each kind of coordinate.
TEST(RandomConfiguration, KeepsToLimits) {
  const double pi = std::numbers::pi;
  struct Case {
    JointType type;
    double lower, upper, low, high;
  };
  using enum JointType;
  const Case cases[] = {
      {kRevolute, -0.2, 0.5, -0.2, 0.5},
      {kRevolute, 4, kInfinity, 4, 4 + 2 * pi},
      {kRevolute, -kInfinity, -5, -5 - 2 * pi, -5},
      {kRevolute, -kInfinity, kInfinity, -pi, pi},
      {kPrismatic, 3, 3.5, 3, 3.5},
      {kPrismatic, 7, kInfinity, 7, 9},
      {kPrismatic, -kInfinity, -7, -9, -7},
      {kPrismatic, -kInfinity, kInfinity, -1, 1},
      {kPrismatic, 2, 2, 2, 2},
      {kPrismatic, -1.5e308, 1.5e308, -1.5e308, 1.5e308},
  };
  std::mt19937 rng(4);
  for (const Case& c : cases) {
    Model model;
    model.joints.resize(1);
    model.joints[0].type = c.type;
    model.joints[0].lower = VectorXd::Constant(1, c.lower);
    model.joints[0].upper = VectorXd::Constant(1, c.upper);
    finalize(model);
    Scene scene;
    add_robot(scene, "r", std::make_shared<Model>(model));
    double least = kInfinity, most = -kInfinity;
    for (int k = 0; k < 200; ++k) {
      const double x = random_configuration(scene, rng)[0];
      least = std::min(least, x);
      most = std::max(most, x);
    }
    EXPECT_GE(least, c.low);
    EXPECT_LE(most, c.high);
    EXPECT_GE(most / 2 - least / 2, 0.45 * (c.high / 2 - c.low / 2) * 2);  // 200 numbers fill 90 % but with chance 1e-8
  }
}

}  // namespace
}  // namespace manycontact::test
