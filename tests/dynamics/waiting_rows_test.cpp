// A long closed chain: in its elimination order many independent rows have no sound pivot, and three rows depend on the
// others. These rows wait, and the sparse factor solves the chain with the dense reference solver's results.

#include "manycontact/rank/waiting_rows.hpp"

#include <gtest/gtest.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/allocations.hpp"
#include "support/piles.hpp"

namespace manycontact::test {
namespace {

// Boxes on a circle, each joined to the next by a hinge about the circle's axis; the first one is fixed.
Pile closed_chain(int boxes) {
  PileMaker maker;
  const double step = 2 * M_PI / boxes, radius = 1 / step;
  const auto at = [&](double k) { return Vec3<double>(radius * std::cos(k * step), radius * std::sin(k * step), 0); };
  for (int k = 0; k < boxes; ++k) maker.box(at(k).x(), at(k).y(), 0);
  for (int k = 0; k < boxes; ++k) maker.join(ContactType::k5D, k, (k + 1) % boxes, at(k + 0.5));
  maker.join(ContactType::k6D, 0, -1, at(0));
  Pile pile = maker.finish(0);
  pile.scene.gravity = {3, -9, -2};
  return pile;
}

double relative(const Eigen::MatrixXd& x, const Eigen::MatrixXd& truth) {
  return (x - truth).cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff();
}

TEST(WaitingRows, OfLongClosedChainsJoin) {
  for (const int boxes : {20, 61}) {
    SCOPED_TRACE(boxes);
    const Pile pile = closed_chain(boxes);
    SceneData data(pile.scene), reference(pile.scene, {Method::kDense, {}});
    (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
    (void)solve(pile.scene, pile.q, pile.v, pile.u, reference);
    EXPECT_EQ(data.report.status, Status::kRedundant);
    EXPECT_EQ(data.report.islands[0].method, Method::kSparseLdl);
    EXPECT_EQ(data.report.rank, 5 * boxes + 3);
    EXPECT_EQ(data.report.rank, reference.report.rank);
    EXPECT_EQ(data.report.islands[0].dependent_rows.size(), 3u);
    EXPECT_LE(relative(data.a, reference.a), 1e-10);
    EXPECT_LE(relative(data.f, reference.f), 1e-10);
    EXPECT_EQ(allocations([&] { (void)solve(pile.scene, pile.q, pile.v, pile.u, data); }), 0u);
    (void)differentiate(pile.scene, data);
    (void)differentiate(pile.scene, reference);
    const SceneDerivatives d = dense_derivatives(pile.scene, data), truth = dense_derivatives(pile.scene, reference);
    EXPECT_LE(relative(d.da_dq, truth.da_dq), 1e-8);
  }
}

// Bars between the joints of a plane truss of square bays with one diagonal each, whose lower corners are fixed.
Pile truss(int bays) {
  PileMaker maker;
  struct Joint {
    double x, z;
    int first;  // number of the first bar there
  };
  std::vector<Joint> joints;
  for (int k = 0; k <= bays; ++k) joints.push_back({1.0 * k, 0, -1}), joints.push_back({1.0 * k, 1, -1});
  std::vector<std::pair<int, int>> bars;  // between joints: 2k below and 2k + 1 above
  for (int k = 0; k <= bays; ++k) bars.emplace_back(2 * k, 2 * k + 1);
  for (int k = 0; k < 2 * bays; ++k) bars.emplace_back(k, k + 2);
  for (int k = 0; k < bays; ++k) bars.emplace_back(2 * k, 2 * k + 3);
  for (const auto& [a, b] : bars) (void)maker.box((joints[a].x + joints[b].x) / 2, 0, (joints[a].z + joints[b].z) / 2);
  for (int bar = 0; bar < static_cast<int>(bars.size()); ++bar)
    for (int end : {bars[bar].first, bars[bar].second}) {
      Joint& joint = joints[end];
      if (joint.first < 0)
        joint.first = bar;
      else
        maker.join(ContactType::k3D, bar, joint.first, {joint.x, 0, joint.z});
    }
  for (int end : {0, 2 * bays}) maker.join(ContactType::k3D, joints[end].first, -1, {joints[end].x, 0, 0});
  return maker.finish(0);
}

// The pivots of a truss fall with the fourth power of its length, and one of its rows depends on all the others.
TEST(WaitingRows, OfLongTrussesAndChainsAreFew) {
  for (const Pile& pile : {truss(200), closed_chain(400)}) {
    SceneData data(pile.scene);
    (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
    EXPECT_EQ(data.report.status, Status::kRedundant);
    EXPECT_EQ(data.report.islands[0].method, Method::kSparseLdl);
    EXPECT_GE(data.report.rank, data.f.size() - 3);
    EXPECT_LE(data.report.residual_dynamics, 1e-12);
    EXPECT_LE(data.report.residual_contact, 1e-12);
  }
}

}  // namespace
}  // namespace manycontact::test
