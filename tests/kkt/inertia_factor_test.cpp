// The tree-sparse factor of M agrees with dense algebra.

#include "manycontact/algorithm/inertia_factor.hpp"

#include <gtest/gtest.h>

#include "kkt/island_numbers.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class InertiaFactor : public testing::TestWithParam<unsigned> {
 protected:
  RandomScene s = kkt_scene(GetParam());
  std::deque<IslandNumbers> islands = islands_of(s);
  std::mt19937 rng{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Seed, InertiaFactor, testing::Range(1u, 9u));

MatrixXd dense_L(const Model& model, const double* packed) {
  MatrixXd L = MatrixXd::Identity(model.nv, model.nv);
  for (int i = 0; i < model.nv; ++i) {
    const double* row = packed + model.M_begin[i] + 1;
    for (int j = model.dof_parent[i]; j >= 0; j = model.dof_parent[j]) L(i, j) = *row++;
  }
  return L;
}

TEST_P(InertiaFactor, OfTheInertiaAndItsSolves) {
  for (const IslandNumbers& n : islands)
    for (std::size_t r = 0; r < n.island.robots.size(); ++r) {
      const Model& model = *s.scene.robots[n.island.robots[r]].model;
      const MatrixXd M = n.M.block(n.island.dof_offset[r], n.island.dof_offset[r], model.nv, model.nv);
      std::vector<double> packed = n.packed[r], scratch(model.nv, NAN);
      ASSERT_TRUE(factorize_inertia(model, packed.data(), scratch.data(), tolerance::kPivotLeft).empty());
      const MatrixXd L = dense_L(model, packed.data());
      VectorXd D(model.nv);
      for (int i = 0; i < model.nv; ++i) D[i] = packed[model.M_begin[i]];
      EXPECT_GT(D.minCoeff(), 0);
      EXPECT_LE(error_of(MatrixXd(L.transpose() * D.asDiagonal() * L), M), 16 * kEps);

      const VectorXd truth = random_vector(model.nv, rng);
      VectorXd x = L.transpose() * truth, y = L * truth, z = M * truth;
      solve_inertia_transposed(model, packed.data(), 1, x.data());
      solve_inertia_unit(model, packed.data(), 1, y.data());
      EXPECT_LE(error_of(x, truth), kEps * condition_1(L));
      EXPECT_LE(error_of(y, truth), kEps * condition_1(L));
      solve_inertia_transposed(model, packed.data(), 1, z.data());  // M^-1 = L^-1 D^-1 L^-T
      z.array() /= D.array();
      solve_inertia_unit(model, packed.data(), 1, z.data());
      EXPECT_LE(error_of(z, truth), 4 * kEps * condition_1(M));
    }
}

TEST_P(InertiaFactor, RefusesWhatIsNotPositive) {
  const Model& model = *s.scene.robots[0].model;
  const IslandNumbers& n = islands[0];
  std::vector<double> scratch(model.nv);
  for (int bad : {0, model.nv / 2, model.nv - 1}) {
    for (double value : {-1.0, 0.0, static_cast<double>(NAN)}) {
      std::vector<double> packed = n.packed[0];
      packed[model.M_begin[bad]] = value;
      EXPECT_FALSE(factorize_inertia(model, packed.data(), scratch.data(), tolerance::kPivotLeft).empty())
          << bad << ' ' << value;
    }
  }
}

// The matrix is [1 1; 1 1 + gap]: the second pivot is rounding error if the gap is below a few eps.
TEST(InertiaFactorOfTwo, RefusesAPivotLostInCancellation) {
  std::mt19937 rng(1);
  const Model model = random_model(rng, {.njoints = 2, .types = {JointType::kRevolute}, .branching = 0});
  double scratch[2];
  for (double gap : {1e-6, 0.0, 4 * kEps}) {
    double packed[] = {1, 1 + gap, 1};  // rows: M00; M11 M10
    EXPECT_EQ(factorize_inertia(model, packed, scratch, tolerance::kPivotLeft).empty(), gap > 1e-10) << gap;
  }
}

}  // namespace
}  // namespace manycontact::test
