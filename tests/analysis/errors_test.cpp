// Deviations of one solution from another are compared with numbers worked out by hand.

#include "manycontact/analysis/errors.hpp"

#include <gtest/gtest.h>

#include "manycontact/dynamics/data.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// Boxes are a (v 0 ... 5), b (6 ... 11) and c. The forces are one of a from the world (0 ... 2), one between a and b (3
// ... 5), and one that is not active.
struct Boxes {
  SceneFile file = load_text(R"(<scene><robot name="a" urdf="box.urdf" base="floating"/>
    <robot name="b" urdf="box.urdf" base="floating"/> <robot name="c" urdf="box.urdf" base="floating"/>
    <contact name="w" type="3d" frame="a/top_1"/> <contact name="off" type="6d" frame="b/top_1" active="false"/>
    <contact name="ab" type="3d" frame="a/top_2" to="b/top_2"/></scene>)");
  SceneData data{file.scene};
};

TEST(Deviations, OfAccelerationsArePerRobot) {
  const Boxes s;
  VectorXd truth = VectorXd::Zero(18), a = VectorXd::Zero(18);
  truth[0] = -8, a[0] = -8;
  a[1] = 2;
  truth[7] = 4, a[7] = 3;
  const std::vector<Deviation> d = acceleration_deviations<double>(s.file.scene, a, truth);
  ASSERT_EQ(d.size(), 3u);
  EXPECT_EQ(d[0].absolute, 2);
  EXPECT_EQ(d[0].relative, 0.25);
  EXPECT_EQ(d[1].absolute, 1);
  EXPECT_EQ(d[1].relative, 0.25);
  EXPECT_EQ(d[2].absolute, 0);
  EXPECT_EQ(d[2].relative, 0);  // zero in both
  EXPECT_EQ(worst(d).absolute, 2);

  VectorXd at_least = VectorXd::Zero(18);
  at_least[11] = -10;
  const std::vector<Deviation> scaled = acceleration_deviations<double>(s.file.scene, a, truth, at_least);
  EXPECT_EQ(scaled[0].relative, 0.25);
  EXPECT_EQ(scaled[1].relative, 0.1);
}

TEST(Deviations, OfForcesAreThoseOfAllContactsOnARobot) {
  const Boxes s;
  ASSERT_EQ(s.data.f_offset, (std::vector<int>{0, -1, 3}));
  VectorXd truth(6), f(6);
  truth << 0, 0, 100, 0, 0, -10;
  f << 0, 1, 100, 0, 0, -12;
  EXPECT_EQ(largest_forces<double>(s.file.scene, s.data.f_offset, truth), (std::vector<double>{100, 10, 0}));
  const std::vector<Deviation> d = force_deviations<double>(s.file.scene, s.data.f_offset, f, truth);
  EXPECT_EQ(d[0].absolute, 2);
  EXPECT_EQ(d[0].relative, 0.02);
  EXPECT_EQ(d[1].absolute, 2);
  EXPECT_EQ(d[1].relative, 0.2);
  EXPECT_EQ(d[2].relative, 0);
}

TEST(Deviations, WhatIsNoNumberIsNoAnswer) {
  const Boxes s;
  const VectorXd truth = VectorXd::Ones(18);
  VectorXd a = truth;
  a[9] = kNaN;
  for (const auto& d : {acceleration_deviations<double>(s.file.scene, a, truth),
                        acceleration_deviations<double>(s.file.scene, truth, a)}) {
    EXPECT_EQ(d[0].relative, 0);
    EXPECT_TRUE(std::isnan(d[1].absolute));
    EXPECT_TRUE(std::isnan(worst(d).absolute));
    EXPECT_TRUE(std::isnan(worst(d).relative));
  }
}

// The difference is computed in the truth's precision.
TEST(Deviations, FromATruthInQuadruplePrecision) {
  const Boxes s;
  const VectorXd a = VectorXd::Ones(18);
  VecX<Quad> truth = a.cast<Quad>();
  truth[3] += Quad(1e-25);
  const Deviation d = worst(acceleration_deviations<Quad>(s.file.scene, a, truth));
  EXPECT_NEAR(d.absolute, 1e-25, 1e-32);  // Quad's own error is 1e-34
  EXPECT_NEAR(d.relative, 1e-25, 1e-32);
}

}  // namespace
}  // namespace manycontact::test
