// The proximal factor is tested where rows depend on each other across many bodies.

#include <gtest/gtest.h>

#include "kkt/island_numbers.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/kkt/factor/refined.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/piles.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Case {
  std::string name;
  Pile pile;
};
Case case_of(int number) {
  switch (number) {
    case 0:
      return {"pyramid", pyramid(4)};
    case 1:
      return {"wall", grid(4, ContactType::k3D, true)};
    case 2:
      return {"grid", grid(4, ContactType::k6D, false)};
    case 3:
      return {"uneven", uneven_wall(7)};
    default:
      return {"tower", tower(12)};
  }
}

class Proximal : public testing::TestWithParam<int> {
 protected:
  Proximal()
      : case_(case_of(GetParam())),
        numbers_(case_.pile, whole_scene(case_.pile.scene, active_flags(case_.pile.scene))) {
    K_.reset(numbers_.shape.pattern(Order::kLeafToRoot));
    take(numbers_.J);
  }
  // Replaces the island's J.
  void take(const MatrixXd& J) {
    assemble(numbers_.M_spans, numbers_.J_spans, 0, K_);
    K_.row_scale = numbers_.J.cwiseAbs().maxCoeff();
    const KktPattern& p = *K_.pattern;
    for (int i = 0; i < p.nc; ++i)
      for (int j = 0; j < p.nv; ++j) {
        const auto [a, b] = std::minmax(p.iperm[p.nv + i], p.iperm[j]);
        if (const int slot = p.K.slot(a, b); slot >= 0) K_.values[slot] = J(i, j);
      }
  }
  VectorXd in_order(const VectorXd& x) const {
    VectorXd out(x.size());
    for (int k = 0; k < x.size(); ++k) out[K_.pattern->iperm[k]] = x[k];
    return out;
  }

  Case case_;
  IslandNumbers numbers_;
  KktMatrix K_;
  FactorScratch scratch_;
};
INSTANTIATE_TEST_SUITE_P(Pile, Proximal, testing::Range(0, 5),
                         [](const auto& info) { return case_of(info.param).name; });

TEST_P(Proximal, GivesTheOraclesAnswers) {
  const auto factor = make_proximal_factor(), oracle = make_dense_factor();
  ASSERT_EQ(factor->factorize(K_, scratch_), Reason::kNone);
  ASSERT_EQ(oracle->factorize(K_, scratch_), Reason::kNone);
  EXPECT_EQ(factor->rank(), oracle->rank());
  std::vector<int> dependent;
  factor->dependent_rows(dependent);
  EXPECT_EQ(static_cast<int>(dependent.size()), K_.nc() - factor->rank());
  std::mt19937 rng(1);
  const VectorXd b = random_vector(K_.size(), rng);
  VectorXd x = b, truth = b;
  factor->solve(x.data());
  oracle->solve(truth.data());
  EXPECT_LE((x - truth).cwiseAbs().maxCoeff(), 1e-11 * truth.cwiseAbs().maxCoeff());
  RowMajor X = RowMajor::NullaryExpr(K_.size(), 24, [&] { return uniform(rng, -1, 1); }), truths = X;
  std::vector<char> nonzero(K_.size(), 1);
  factor->solve_panel(X.data(), 24, 0, 24, nonzero.data());
  oracle->solve_panel(truths.data(), 24, 0, 24, nonzero.data());
  EXPECT_LE((X - truths).cwiseAbs().maxCoeff(), 1e-11 * truths.cwiseAbs().maxCoeff());
}

TEST_P(Proximal, ProjectsOnTheNullSpace) {
  const auto factor = make_proximal_factor(), oracle = make_dense_factor();
  ASSERT_EQ(factor->factorize(K_, scratch_), Reason::kNone);
  ASSERT_EQ(oracle->factorize(K_, scratch_), Reason::kNone);
  std::mt19937 rng(2);
  VectorXd y = random_vector(K_.size(), rng), truth = y, of_null = VectorXd::Zero(K_.size()), true_null = of_null;
  factor->project_out(y.data(), of_null.data());
  oracle->project_out(truth.data(), true_null.data());
  EXPECT_LE((y - truth).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((of_null - true_null).cwiseAbs().maxCoeff(), 1e-12);
  RowMajor X = RowMajor::NullaryExpr(K_.size(), 8, [&] { return uniform(rng, -1, 1); }), truths = X;
  factor->project_out_panel(X.data(), 8, 8);
  oracle->project_out_panel(truths.data(), 8, 8);
  EXPECT_LE((X - truths).cwiseAbs().maxCoeff(), 1e-12);
  std::vector<char> rows(K_.nc());
  factor->null_space_rows(rows);
  for (int k = 0; k < K_.nc(); ++k)
    if (!rows[k]) EXPECT_LE(std::abs(true_null[K_.pattern->iperm[K_.nv() + k]]), 1e-10) << k;
}

// A row that depends on others up to a millionth, a ten-millionth ... of its length is not dependent: it is refused, or
// found with its rank.
TEST_P(Proximal, RefusesRowsThatNearlyDepend) {
  std::mt19937 rng(3);
  const auto factor = make_proximal_factor(), oracle = make_dense_factor();
  const int rank = [&] {
    (void)oracle->factorize(K_, scratch_);
    return oracle->rank();
  }();
  if (rank == K_.nc()) GTEST_SKIP() << "no row depends";
  for (const double size : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9}) {
    SCOPED_TRACE(size);
    MatrixXd J = numbers_.J;
    for (int i = 0; i < J.rows(); ++i)
      for (int j = 0; j < J.cols(); ++j)
        if (J(i, j) != 0) J(i, j) += size * uniform(rng, -1, 1);
    take(J);
    ASSERT_EQ(oracle->factorize(K_, scratch_), Reason::kNone);
    if (factor->factorize(K_, scratch_) == Reason::kNone) EXPECT_EQ(factor->rank(), oracle->rank());
  }
}

TEST_P(Proximal, AllocatesNothingAgain) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const auto factor = make_proximal_factor();
  std::mt19937 rng(4);
  KktVectors v;
  v.resize(K_.size());
  const VectorXd b = random_vector(K_.size(), rng);
  std::vector<int> dependent;
  const auto solve_once = [&] {
    ASSERT_EQ(factor->factorize(K_, scratch_), Reason::kNone);
    std::copy(b.begin(), b.end(), v.b.begin());
    (void)factor->solve_refined(K_, v, 5);
    factor->dependent_rows(dependent);
  };
  solve_once();
  EXPECT_EQ(allocations(solve_once), 0u);
}

}  // namespace
}  // namespace manycontact::test
