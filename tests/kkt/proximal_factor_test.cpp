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

// Contacts leave one body alone, until one row that depends on others moves it by ever less. That row is independent:
// it is found so, or refused where its pivot is about as large as delta, or where J^T leaves too much of null vectors.
TEST_P(Proximal, RefusesARowThatNearlyDepends) {
  const auto factor = make_proximal_factor(), oracle = make_dense_factor();
  MatrixXd J = numbers_.J;
  J.rightCols(6).setZero();
  take(J);
  ASSERT_EQ(factor->factorize(K_, scratch_), Reason::kNone);
  std::vector<int> dependent;
  factor->dependent_rows(dependent);
  const auto moves_it = [&](int k) { return !numbers_.J.row(k).tail(6).isZero(); };
  const auto row = std::find_if(dependent.begin(), dependent.end(), moves_it);
  if (row == dependent.end()) GTEST_SKIP() << "no row that depends would";
  const int rank = factor->rank();
  int found = 0, refused = 0;
  for (double size = 1e-3; size > 1e-9; size /= 4) {
    SCOPED_TRACE(size);
    J.row(*row).tail(6) = size * numbers_.J.row(*row).tail(6);
    take(J);
    ASSERT_EQ(oracle->factorize(K_, scratch_), Reason::kNone);
    EXPECT_EQ(oracle->rank(), rank + 1);
    const bool sound = factor->factorize(K_, scratch_) == Reason::kNone;
    ++(sound ? found : refused);
    if (sound) EXPECT_EQ(factor->rank(), rank + 1);
  }
  EXPECT_GT(found, 0);
  EXPECT_GT(refused, 0);
}

TEST_P(Proximal, RefusesWhatIsNotSound) {
  const auto factor = make_proximal_factor();
  const KktPattern& p = *K_.pattern;
  const auto entry = [&](int i, int j) -> double& {
    const auto [a, b] = std::minmax(p.iperm[i], p.iperm[j]);
    return K_.values[p.K.slot(a, b)];
  };
  const auto judged = [&](const MatrixXd& J, auto&& spoil) {
    take(J);
    spoil();
    return factor->factorize(K_, scratch_);
  };
  const MatrixXd& J = numbers_.J;
  const int last = p.nv - 1;
  const double mean = std::sqrt(numbers_.M(last, last) * numbers_.M(last - 1, last - 1));
  EXPECT_EQ(judged(J, [] {}), Reason::kNone);
  EXPECT_EQ(judged(0 * J, [] {}), Reason::kZeroPivot) << "no row moves anything";
  EXPECT_EQ(judged(J, [&] { entry(last, last) = NAN; }), Reason::kZeroPivot);
  EXPECT_EQ(judged(J, [&] { entry(last - 1, last) = 2 * mean; }), Reason::kSingularInertia) << "indefinite";
  EXPECT_EQ(judged(J, [&] { entry(last - 1, last) = (1 - 1e-13) * mean; }), Reason::kSingularInertia) << "singular";
  EXPECT_EQ(judged(1e6 * J, [] {}), Reason::kSmallPivot) << "terms beside which M's are lost";
  for (int row = 0; row < p.nc; ++row) {
    int column = 0;
    while (J(row, column) == 0) ++column;
    for (const double bad : {static_cast<double>(NAN), static_cast<double>(INFINITY)})
      EXPECT_NE(judged(J, [&] { entry(p.nv + row, column) = bad; }), Reason::kNone) << row;
    if (row == 20) break;
  }
  EXPECT_EQ(judged(J, [] {}), Reason::kNone);
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
