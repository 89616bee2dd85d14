// Relaxed supernodes give fewer blocks and the same factor.

#include "manycontact/sparse/relaxed_supernodes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "manycontact/sparse/ldl_schedule.hpp"
#include "sparse/symmetric.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

// Returns n coordinates of a limb, then n rows: each coordinate moves the rows that follow it from its own on. The
// factor's column k has one row less than column k + 1.
Symmetric limb_with_rows(int n, std::mt19937& rng) {
  Eigen::MatrixXd A = random_positive(2 * n, 1, rng);
  for (int k = 0; k < n; ++k)
    for (int row = n; row < 2 * n - 1 - k; ++row) A(row, k) = A(k, row) = 0;
  for (int row = n; row < 2 * n; ++row)
    for (int other = n; other < row; ++other) A(row, other) = A(other, row) = 0;
  return Symmetric(A);
}

sparse::LdlSymbolic relaxed(sparse::LdlSymbolic L) {
  sparse::relax_supernodes(L);
  return L;
}

Eigen::MatrixXd dense_L(const sparse::LdlSymbolic& s, const std::vector<double>& L) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(s.n, s.n);
  for (int j = 0; j < s.n; ++j)
    for (int k = s.Lp[j]; k < s.Lp[j + 1]; ++k) dense(s.Li[k], j) = L[k];
  return dense;
}

TEST(RelaxedSupernodes, NearlyNestedColumnsAreJoined) {
  std::mt19937 rng(1);
  const int n = 60;
  const Symmetric A = limb_with_rows(n, rng);
  const sparse::LdlSymbolic L = sparse::ldl_analyze(A.pattern), wide = relaxed(L);
  const auto blocks = [&](const sparse::LdlSymbolic& s) { return sparse::compile_ldl(A.pattern, s).blocks(); };
  EXPECT_GE(blocks(L), n);
  EXPECT_LE(blocks(wide), n / 3);
  EXPECT_GT(wide.nonzeros(), L.nonzeros());
  EXPECT_LE(12 * (wide.nonzeros() - L.nonzeros()), wide.nonzeros());

  // Both phases give the same factor, with zeros where it has none; rows as columns.
  std::vector<double> x(L.nonzeros(), NAN), y(wide.nonzeros(), NAN), z(wide.nonzeros(), NAN), D(A.n()), scale(A.n());
  sparse::LdlWorkspace work;
  ASSERT_EQ(sparse::ldl_factor(A.pattern, L, A.x.data(), work, x.data(), D.data()), A.n());
  ASSERT_EQ(sparse::ldl_factor(A.pattern, wide, A.x.data(), work, y.data(), D.data()), A.n());
  sparse::ldl_scheduled_factor<double>(sparse::compile_ldl(A.pattern, wide), A.x.data(), z.data(), D.data(),
                                       scale.data());
  EXPECT_EQ(dense_L(wide, y), dense_L(L, x));
  EXPECT_LE((dense_L(wide, z) - dense_L(L, x)).cwiseAbs().maxCoeff(), 1e-14);
  for (int row = 0; row < wide.n; ++row)
    for (int k = wide.Rp[row]; k < wide.Rp[row + 1]; ++k) {
      EXPECT_EQ(wide.Li[wide.Rk[k]], row);
      EXPECT_TRUE(wide.Lp[wide.Rj[k]] <= wide.Rk[k] && wide.Rk[k] < wide.Lp[wide.Rj[k] + 1]);
    }
}

TEST(RelaxedSupernodes, OthersAreLeft) {
  std::mt19937 rng(2);
  for (const double density : {1.0, 0.02}) {  // nested; far from nested
    const sparse::LdlSymbolic L = sparse::ldl_analyze(Symmetric(random_symmetric(50, density, rng)).pattern);
    EXPECT_LE(12 * (relaxed(L).nonzeros() - L.nonzeros()), L.nonzeros());
  }
  const sparse::LdlSymbolic small = sparse::ldl_analyze(limb_with_rows(5, rng).pattern);
  EXPECT_EQ(relaxed(small).Li, small.Li);
}

// With a border below, the leading columns are those of the matrix without it.
TEST(RelaxedSupernodes, LeadingColumnsAreThose) {
  std::mt19937 rng(3);
  const int n = 40, border = 7;
  const Symmetric inner = limb_with_rows(n, rng);
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(2 * n + border, 2 * n + border);
  A.topLeftCorner(2 * n, 2 * n) = inner.dense;
  for (int row = 2 * n; row < A.rows(); ++row)
    for (int k = row % 5; k < n; k += 3) A(row, k) = A(k, row) = 1;
  const sparse::LdlSymbolic leading = relaxed(sparse::ldl_analyze(inner.pattern));
  sparse::LdlSymbolic L = sparse::ldl_analyze(Symmetric(A).pattern);
  sparse::relax_supernodes(leading, L);
  for (int k = 0; k < leading.n; ++k) {
    const std::vector<int> rows(leading.Li.begin() + leading.Lp[k], leading.Li.begin() + leading.Lp[k + 1]);
    ASSERT_GE(L.Lp[k + 1] - L.Lp[k], static_cast<int>(rows.size()));
    EXPECT_TRUE(std::equal(rows.begin(), rows.end(), L.Li.begin() + L.Lp[k]));
    EXPECT_TRUE(L.Lp[k] + static_cast<int>(rows.size()) == L.Lp[k + 1] || L.Li[L.Lp[k] + rows.size()] >= leading.n);
  }
}

}  // namespace
}  // namespace manycontact::test
