// LDL that drops dependent rows, their null space and the projector on it agree with dense decompositions; the judges
// of pivots and of contradictions decide by each of their conditions.

#include "manycontact/rank/dependent_rows.hpp"

#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "manycontact/rank/contradiction.hpp"
#include "manycontact/rank/pivots.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "sparse/saddle_point.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using rank::DependentRows;

struct FactorOfRows {
  Symmetric K;
  double margin;
  int nv;
  std::vector<char> of_M;
  std::vector<double> row_scale;
  sparse::LdlSymbolic symbolic;
  sparse::LdlWorkspace work;
  std::vector<double> L, D;
  DependentRows rows;
  int done = -1;

  explicit FactorOfRows(const SaddlePoint& s, double most_rounding = 1)
      : K(s.dense()),
        margin(most_rounding),
        nv(s.nv()),
        of_M(K.n(), 0),
        row_scale(K.n(), s.J_size()),
        symbolic(sparse::ldl_analyze(K.pattern)) {
    L.assign(symbolic.nonzeros(), NAN);
    D.assign(K.n(), NAN);
    std::fill_n(of_M.begin(), nv, 1);
    factor();
  }
  void factor() {
    done = rank::ldl_factor_dependent(K.pattern, symbolic, K.x.data(), of_M, margin, row_scale.data(), work, L.data(),
                                      D.data(), rows);
    if (done == K.n())
      find_null_space(K.pattern, symbolic, K.x.data(), of_M, row_scale.data(), L.data(), solve_panel, rows);
  }
  // Factorizes without the rows that are to be dropped, whichever they are.
  void factor_others() {
    std::vector<double> x = K.x;
    for (int k : rows.dropped) x[K.pattern.p[k + 1] - 1] = -1e200;
    ASSERT_EQ(sparse::ldl_factor(K.pattern, symbolic, x.data(), work, L.data(), D.data()), K.n());
    for (int k : rows.dropped) D[k] = INFINITY;
    find_null_space(K.pattern, symbolic, K.x.data(), of_M, row_scale.data(), L.data(), solve_panel, rows);
  }
  rank::SolvePanel solve_panel = [this](double* X, int ld, int cols) {
    sparse::ldl_solve_panel(symbolic, L.data(), D.data(), nullptr, X, ld, 0, cols, nullptr);
  };
  void solve(double* x) {
    project_out(rows, x);
    sparse::ldl_solve(symbolic, L.data(), D.data(), x);
    project_out(rows, x);
  }
  // Returns N among the rows of J.
  MatrixXd null_space() const {
    MatrixXd N = MatrixXd::Zero(K.n() - nv, rows.dropped.size());
    for (std::size_t c = 0; c < rows.dropped.size(); ++c)
      for (int p = rows.Np[c]; p < rows.Np[c + 1]; ++p) N(rows.Ni[p] - nv, c) = rows.Nx[p];
    return N;
  }
  // Returns P, column by column, as project_out subtracts it.
  MatrixXd projector() {
    const int nc = K.n() - nv;
    MatrixXd P(nc, nc);
    for (int k = 0; k < nc; ++k) {
      VectorXd y = VectorXd::Zero(K.n());
      y[nv + k] = 1;
      project_out(rows, y.data());
      P.col(k) = VectorXd::Unit(nc, k) - y.tail(nc);
    }
    return P;
  }
};

// The amplification of a projector's error: coefficients of dependence, and retained rows that nearly coincide.
struct Spectrum {
  MatrixXd P;       // on the null space of J^T
  double cond = 1;  // of J: largest by smallest singular value that is not zero

  explicit Spectrum(const MatrixXd& J, double nothing = 1e-9) {
    P.setIdentity(J.rows(), J.rows());
    if (J.size() == 0) return;
    const Svd svd(J);
    const VectorXd& sigma = svd.sigma;
    const auto rank = (sigma.array() > nothing * sigma[0]).count();
    const auto range = svd.U.leftCols(rank);
    P -= range * range.transpose();
    if (rank > 0) cond = sigma[0] / sigma[rank - 1];
  }
};

double allowed(const Spectrum& truth, const DependentRows& rows) {
  return 8 * kEps * truth.cond * (1 + rows.largest_entry * rows.largest_entry);
}

class DependentRowsOf : public testing::TestWithParam<SaddlePoint> {};
INSTANTIATE_TEST_SUITE_P(Sparse, DependentRowsOf, testing::ValuesIn(saddle_points()), [](const auto& info) {
  std::string name = info.param.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST_P(DependentRowsOf, AreThosePlanted) {
  const SaddlePoint& s = GetParam();
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  std::vector<int> expected;
  for (int k : s.dropped) expected.push_back(s.nv() + k);
  ASSERT_EQ(f.rows.dropped, expected);
  EXPECT_EQ(static_cast<int>(f.rows.clusters.size()), s.clusters);
  for (int k = 0; k < s.n(); ++k) {
    const bool dropped = std::count(expected.begin(), expected.end(), k);
    EXPECT_EQ(f.D[k] == INFINITY, dropped) << k;
    if (!dropped) {
      EXPECT_EQ(f.D[k] > 0, k < s.nv()) << k;
    }
  }

  const MatrixXd N = f.null_space();
  double largest = 0;
  for (std::size_t c = 0; c < s.dropped.size(); ++c) {
    EXPECT_EQ(N(s.dropped[c], c), 1);
    EXPECT_EQ(f.rows.Ni[f.rows.Np[c]], s.nv() + s.dropped[c]) << "the dropped row stands first";
    for (int k = 0; k < s.nc(); ++k) {
      const bool another = k != s.dropped[c] && std::count(s.dropped.begin(), s.dropped.end(), k);
      if (another) {
        EXPECT_EQ(N(k, c), 0) << "a row dropped explains no other";
      }
    }
  }
  if (N.size() > 0) largest = size_of(N);
  EXPECT_EQ(f.rows.largest_entry, largest);
  if (N.size() == 0) return;
  const double left = size_of(MatrixXd(s.J.transpose() * N));
  EXPECT_LE(left, 1e-14 * std::max(1.0, largest) * s.J_size());
  EXPECT_LE(f.rows.largest_residual, tolerance::kRowLeft);
  EXPECT_TRUE(f.rows.accepted());
}

TEST_P(DependentRowsOf, ProjectorIsTheDenseOne) {
  const SaddlePoint& s = GetParam();
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  if (s.nc() == 0) return;
  const MatrixXd P = f.projector();
  const Spectrum truth(s.J);
  const double tolerance = allowed(truth, f.rows);
  EXPECT_LE(difference_of(P, truth.P), tolerance);
  EXPECT_LE(difference_of(MatrixXd(P * P), P), tolerance);
  EXPECT_LE(difference_of(MatrixXd(P.transpose()), P), tolerance);
  EXPECT_LE(size_of(MatrixXd(s.J.transpose() * P)), tolerance * s.J_size());
}

TEST_P(DependentRowsOf, ProjectOutGivesThePartThatItTakes) {
  const SaddlePoint& s = GetParam();
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  std::mt19937 rng(42);
  const VectorXd given = random_matrix(s.n(), 1, rng), before = random_matrix(s.n(), 1, rng);
  VectorXd y = given, null_component = before;
  project_out(f.rows, y.data(), null_component.data());
  EXPECT_EQ(y.head(s.nv()), given.head(s.nv())) << "rows of M are not its business";
  EXPECT_EQ(null_component.head(s.nv()), before.head(s.nv()));
  if (s.nc() == 0) return;
  const Spectrum truth(s.J);
  const double tolerance = allowed(truth, f.rows) * size_of(given);
  EXPECT_LE(difference_of(y.tail(s.nc()), VectorXd(given.tail(s.nc()) - truth.P * given.tail(s.nc()))), tolerance);
  EXPECT_LE(difference_of((null_component - before).tail(s.nc()).eval(), VectorXd(truth.P * given.tail(s.nc()))),
            tolerance)
      << "P y is added to what is there";
}

// Columns first ... first+cols-1 of a panel have their rows in another order; all else is left unchanged.
TEST_P(DependentRowsOf, PanelEqualsColumns) {
  using Panel = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const SaddlePoint& s = GetParam();
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  std::mt19937 rng(43);
  std::vector<int> row(s.n());
  for (int k = 0; k < s.n(); ++k) row[k] = k + 1;  // row 0 of the panel is not used
  std::shuffle(row.begin(), row.end(), rng);
  for (const auto& [ld, first, cols] : {std::array{1, 0, 1}, {9, 2, 5}, {40, 3, 37}, {6, 6, 0}, {70, 0, 70}}) {
    const Panel given = random_matrix(s.n() + 1, ld, rng);
    Panel X = given;
    project_out_panel(f.rows, row.data(), X.data(), ld, first, cols);
    Panel expected = given;
    for (int c = first; c < first + cols; ++c) {
      VectorXd y(s.n());
      for (int k = 0; k < s.n(); ++k) y[k] = given(row[k], c);
      project_out(f.rows, y.data());
      for (int k = 0; k < s.n(); ++k) expected(row[k], c) = y[k];
    }
    const double tolerance = 8 * kEps * size_of(given) * (1 + f.rows.largest_entry * f.rows.largest_entry);
    EXPECT_LE(difference_of(X, expected), tolerance) << ld << " " << first << " " << cols;
    X.middleCols(first, cols) = given.middleCols(first, cols);
    EXPECT_EQ(X, given) << "columns outside were touched";
  }
}

// [a; y] of least squares and least norm agrees with the dense decomposition of K, for consistent right-hand sides.
TEST_P(DependentRowsOf, AnswerIsTheDenseDecompositions) {
  const SaddlePoint& s = GetParam();
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  std::mt19937 rng(44);
  const Spectrum of_J(s.J), of_K(s.dense(), 1e-13);  // in K the smallest of J are squared
  for (int trial = 0; trial < 3; ++trial) {
    VectorXd b = random_matrix(s.n(), 1, rng);  // b2 is inconsistent
    VectorXd x = b;
    f.solve(x.data());
    if (s.nc() > 0) b.tail(s.nc()) -= of_J.P * b.tail(s.nc());
    const VectorXd expected = least_norm(s.dense(), b, 1e-13);
    const double z = f.rows.largest_entry;
    EXPECT_LE(difference_of(x, expected), 8 * kEps * (1 + z * z) * of_K.cond * size_of(expected));
    if (s.nc() == 0) continue;
    const VectorXd left = s.J * x.head(s.nv()) - b.tail(s.nc());
    EXPECT_LE(size_of(VectorXd(s.J.transpose() * left)),
              8 * kEps * (1 + z * z) * s.n() * s.J_size() * s.J_size() * size_of(x))
        << "least squares";
    EXPECT_LE(size_of(VectorXd(of_J.P * x.tail(s.nc()))), allowed(of_J, f.rows) * size_of(x)) << "least norm";
  }
}

TEST_P(DependentRowsOf, AllocateNothingAgain) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  const SaddlePoint& s = GetParam();
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  const MatrixXd N = f.null_space(), P = f.projector();
  std::vector<int> row(s.n());
  for (int k = 0; k < s.n(); ++k) row[k] = k;
  MatrixXd X = MatrixXd::Ones(8, s.n());
  const auto work = [&] {
    f.factor();
    f.solve(X.data());
    project_out_panel(f.rows, row.data(), X.data(), 8, 0, 8);
  };
  work();
  EXPECT_EQ(allocations(work), 0u);
  EXPECT_EQ(f.null_space(), N) << "nothing of an earlier factor may stay";
  EXPECT_EQ(f.projector(), P);
}

// The dropped rows that share others may change from one matrix of a pattern to the next.
TEST(DependentRows, ClustersThatMergeAllocateNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  std::mt19937 rng(52);
  SaddlePoint s{"merging", random_positive(9, 0.4, rng), random_matrix(4, 9, rng)};
  s.J.row(2) = s.J.row(0);
  s.J.row(3) = s.J.row(1);
  FactorOfRows f(s);
  ASSERT_EQ(f.rows.clusters.size(), 2u);
  s.J.row(3) = s.J.row(0);
  const FactorOfRows merged(s);
  ASSERT_EQ(merged.rows.clusters.size(), 1u);
  f.K.x = merged.K.x;
  EXPECT_EQ(allocations([&] { f.factor(); }), 0u);
  EXPECT_EQ(f.null_space(), merged.null_space());
}

// Scratch memory is the caller's, and other factorizations may have left anything in it.
TEST(DependentRows, ScratchMayHoldAnything) {
  const SaddlePoint s = saddle_points()[4];
  const FactorOfRows fresh(s);
  FactorOfRows used(s);
  std::fill(used.work.Y.begin(), used.work.Y.end(), NAN);
  for (std::vector<double>* scratch : {&used.rows.terms, &used.rows.x, &used.rows.residual, &used.rows.t})
    std::fill(scratch->begin(), scratch->end(), NAN);
  used.factor();
  EXPECT_EQ(used.rows.dropped, fresh.rows.dropped);
  EXPECT_EQ(used.null_space(), fresh.null_space());
  EXPECT_EQ(used.L, fresh.L);
}

TEST(DependentRows, StorageIsReusedForOtherMatrices) {
  FactorOfRows f(saddle_points()[4]);
  for (const SaddlePoint& s : saddle_points()) {
    SCOPED_TRACE(s.name);
    FactorOfRows fresh(s), used(s);
    used.rows = f.rows;
    used.factor();
    EXPECT_EQ(used.rows.dropped, fresh.rows.dropped);
    EXPECT_EQ(used.null_space(), fresh.null_space());
    EXPECT_EQ(used.projector(), fresh.projector());
    f.rows = used.rows;
  }
}

// Between dependent and independent, rounding decides on the rows: the rows themselves confirm it.
TEST(DependentRows, AreNotBelievedWhereTheyOnlyNearlyDepend) {
  std::mt19937 rng(45);
  SaddlePoint s{"nearly", random_positive(9, 0.4, rng), random_matrix(5, 9, rng)};
  const Eigen::RowVectorXd other = s.J.row(3);
  for (double apart : {1e-6, 1e-8, 1e-11}) {
    s.J.row(3) = s.J.row(0) - s.J.row(1) + apart * other;
    FactorOfRows f(s);
    ASSERT_EQ(f.done, s.n());
    ASSERT_EQ(f.rows.dropped, std::vector<int>{12}) << apart;
    EXPECT_FALSE(f.rows.accepted()) << apart;
    EXPECT_GE(f.rows.largest_residual, 0.1 * apart) << "refinement may not hide that";
    EXPECT_LE(f.rows.largest_residual, 10 * apart);
  }
  s.J.row(3) = s.J.row(0) - s.J.row(1) + 1e-4 * other;
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  EXPECT_TRUE(f.rows.dropped.empty()) << "1e-8 of its pivot is left";
}

TEST(DependentRows, AreNotBelievedWhereOneOfSeveralOnlyNearlyDepends) {
  std::mt19937 rng(53);
  for (int bad : {3, 4, 5}) {
    SaddlePoint s{"one of three", random_positive(9, 0.4, rng), random_matrix(6, 9, rng)};
    const Eigen::RowVectorXd other = s.J.row(bad);
    for (int k : {3, 4, 5}) s.J.row(k) = s.J.row(k - 3) - s.J.row((k - 2) % 3);
    s.J.row(bad) += 1e-8 * other;
    const FactorOfRows f(s);
    ASSERT_EQ(f.rows.dropped, (std::vector<int>{12, 13, 14}));
    EXPECT_GE(f.rows.largest_residual, 1e-9) << bad;
    EXPECT_FALSE(f.rows.accepted()) << bad;
  }
}

// Nearly coincident retained rows make l_k inaccurate: refinement is needed. If it fails, the factor reports it.
TEST(DependentRows, AreRefinedWherePivotsKeptAreSmall) {
  std::mt19937 rng(46);
  for (int trial = 0; trial < 20; ++trial) {
    SaddlePoint s{"refined", random_positive(12, 0.4, rng), random_matrix(6, 12, rng)};
    s.J.row(2) = s.J.row(0) + 3e-5 * s.J.row(2);
    s.J.row(3) = s.J.row(1) + 3e-5 * s.J.row(3);
    s.J.row(5) = s.J.row(0) + s.J.row(1) + s.J.row(2) - s.J.row(3) + s.J.row(4);
    FactorOfRows f(s);
    ASSERT_EQ(f.done, s.n());
    ASSERT_EQ(f.rows.dropped, std::vector<int>{17});
    EXPECT_LE(f.rows.largest_residual, tolerance::kNullColumn);
    EXPECT_LE(size_of(MatrixXd(s.J.transpose() * f.null_space())), tolerance::kNullColumn * s.J_size());
  }
}

// Columns of N with large entries are made orthonormal: the projector is as accurate as with small ones.
TEST(DependentRows, ProjectWhereCoefficientsAreLarge) {
  std::mt19937 rng(47);
  SaddlePoint s{"small row first", random_positive(9, 0.4, rng), random_matrix(5, 9, rng)};
  s.J.row(0) *= 1e-2;
  for (double large : {29.0, 31.0, 1e4}) {
    s.J.row(3) = large * s.J.row(0);
    FactorOfRows f(s);
    ASSERT_EQ(f.rows.dropped, std::vector<int>{12});
    EXPECT_NEAR(f.rows.largest_entry, large, 1e-9 * large);
    EXPECT_EQ(f.rows.largest_projected > 0, large < tolerance::kLargestEntry);
    EXPECT_TRUE(f.rows.accepted());
    const Spectrum truth(s.J, 1e-12);
    EXPECT_LE(difference_of(f.projector(), truth.P), 8 * kEps * truth.cond);
  }
}

// One of two clusters has rows that are too small, and then a dropped row depends on one after it.
TEST(DependentRows, TakeTurnsUntilNoCoefficientIsLarge) {
  std::mt19937 rng(54);
  for (int trial = 0; trial < 20; ++trial) {
    SaddlePoint s{"turns", random_positive(14, 0.4, rng), random_matrix(9, 14, rng)};
    s.J.row(0) *= 1e-3;
    s.J.row(1) *= 1e-2;
    s.J.row(3) = 1e3 * s.J.row(0) + s.J.row(2);
    s.J.row(5) = s.J.row(4);
    s.J.row(7) = s.J.row(2) - 1e2 * s.J.row(1) + s.J.row(3) + s.J.row(6);
    FactorOfRows f(s);
    ASSERT_EQ(f.rows.dropped, (std::vector<int>{17, 19, 21}));
    ASSERT_GT(f.rows.largest_entry, tolerance::kLargestEntry);
    ASSERT_TRUE(exchange_rows(f.rows));
    ASSERT_EQ(f.rows.dropped.size(), 3u);
    EXPECT_TRUE(std::is_sorted(f.rows.dropped.begin(), f.rows.dropped.end()));
    EXPECT_TRUE(std::count(f.rows.dropped.begin(), f.rows.dropped.end(), 19)) << "the other cluster's";
    EXPECT_LT(f.rows.dropped[0], 17) << "a small row";
    f.factor_others();
    EXPECT_TRUE(f.rows.accepted());
    EXPECT_LE(f.rows.largest_entry, tolerance::kExchanged * (1 + 1e-9));
    EXPECT_FALSE(exchange_rows(f.rows));
    const MatrixXd N = f.null_space();
    EXPECT_LE(size_of(MatrixXd(s.J.transpose() * N)), 1e-14 * s.J_size());
    const Spectrum truth(s.J);
    EXPECT_LE(difference_of(f.projector(), truth.P), allowed(truth, f.rows));
    f.factor();  // no effect of that remains
    EXPECT_EQ(f.rows.dropped, (std::vector<int>{17, 19, 21}));
    EXPECT_EQ(f.null_space(), FactorOfRows(s).null_space());
  }
}

TEST(DependentRows, RowsBelowNothingAreDroppedWhateverTheirDirection) {
  std::mt19937 rng(48);
  SaddlePoint s{"tiny", random_positive(9, 0.4, rng), random_matrix(4, 9, rng)};
  s.J.row(2) *= 1e-13;
  FactorOfRows f(s);
  ASSERT_EQ(f.done, s.n());
  EXPECT_EQ(f.rows.dropped, std::vector<int>{11});
  s.J.row(2) *= 1e3;  // 1e-10 of the others: small, but an independent direction
  FactorOfRows g(s);
  ASSERT_EQ(g.done, s.n());
  EXPECT_TRUE(g.rows.dropped.empty());
}

// Rows of M are never dropped: the first faulty one is returned.
TEST(DependentRows, ARowOfMWithoutPivotIsReturned) {
  std::mt19937 rng(49);
  SaddlePoint s{"singular M", random_positive(6, 1, rng), random_matrix(3, 6, rng)};
  s.M.row(4).setZero(), s.M.col(4).setZero();
  EXPECT_EQ(FactorOfRows(s).done, 4) << "zero";
  s.M = random_positive(6, 1, rng);
  s.M(4, 4) *= -1;
  EXPECT_EQ(FactorOfRows(s).done, 4) << "negative";
  const MatrixXd half = random_matrix(6, 5, rng);
  s.M = half * half.transpose();
  EXPECT_EQ(FactorOfRows(s).done, 5) << "only rounding is left of the last";
}

TEST(DependentRows, ARowOfJWithAPivotOfTheWrongSignIsReturned) {
  std::mt19937 rng(50);
  const SaddlePoint s{"wrong sign", random_positive(6, 1, rng), random_matrix(3, 6, rng)};
  FactorOfRows f(s);
  f.K.x[f.K.pattern.slot(7, 7)] = 100;
  f.factor();
  EXPECT_EQ(f.done, 7);
}

TEST(DependentRows, WhatIsNotANumberIsReturned) {
  std::mt19937 rng(51);
  const SaddlePoint s{"not finite", random_positive(6, 1, rng), random_matrix(3, 6, rng)};
  for (double bad : {static_cast<double>(NAN), static_cast<double>(INFINITY)})
    for (const auto& [row, col] : {std::pair{2, 2}, {1, 4}, {3, 7}}) {
      FactorOfRows f(s);
      f.K.x[f.K.pattern.slot(row, col)] = bad;
      f.factor();
      EXPECT_LE(f.done, std::max(col, 7)) << bad << " at " << row << ", " << col;
      EXPECT_GE(f.done, col);
    }
}

// Two bodies are each followed by their own rows, then by rows that couple them: rows of M after rows of J. One row of
// the first body depends on its others, a coupling row on both bodies' rows, and another on the other coupling rows.
TEST(DependentRows, AmongRowsOfMAfterThem) {
  std::mt19937 rng(8);
  const int m = 4;
  MatrixXd J1 = random_matrix(3, m, rng), J2 = random_matrix(2, m, rng);
  J1.row(2) = J1.row(0) - 0.5 * J1.row(1);
  MatrixXd G = random_matrix(3, 2 * m, rng);
  G.row(1) << 0.5 * J1.row(1), J2.row(0) - J2.row(1);
  G.row(2) = 0.5 * G.row(0) + 0.25 * G.row(1);
  // M1, J1, M2, J2, G
  const int first[] = {0, m, m + 3, 2 * m + 3, 2 * m + 5}, n = 2 * m + 8;
  MatrixXd A = MatrixXd::Zero(n, n);
  std::vector<char> of_M(n, 0);
  for (int at : {first[0], first[2]}) {
    A.block(at, at, m, m) = random_positive(m, 0.4, rng);
    std::fill_n(of_M.begin() + at, m, 1);
  }
  MatrixXd J = MatrixXd::Zero(8, 2 * m);  // rows of J, columns of M
  J.topLeftCorner(3, m) = J1, J.block(3, m, 2, m) = J2, J.bottomRows(3) = G;
  std::vector<int> rows, columns;
  for (int k = 0; k < n; ++k) (of_M[k] ? columns : rows).push_back(k);
  for (int r = 0; r < 8; ++r)
    for (int c = 0; c < 2 * m; ++c) A(rows[r], columns[c]) = A(columns[c], rows[r]) = J(r, c);
  const Symmetric K(A);
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(K.pattern);
  std::vector<double> L(symbolic.nonzeros()), D(n), row_scale(n, J.cwiseAbs().maxCoeff());
  sparse::LdlWorkspace work;
  DependentRows found;
  const auto solve = [&](double* X, int ld, int cols) {
    sparse::ldl_solve_panel(symbolic, L.data(), D.data(), nullptr, X, ld, 0, cols, nullptr);
  };
  ASSERT_EQ(rank::ldl_factor_dependent(K.pattern, symbolic, K.x.data(), of_M, tolerance::kWaits, row_scale.data(), work,
                                       L.data(), D.data(), found),
            n);
  EXPECT_EQ(found.dropped, (std::vector<int>{first[1] + 2, first[4] + 1, first[4] + 2}));
  find_null_space(K.pattern, symbolic, K.x.data(), of_M, row_scale.data(), L.data(), solve, found);
  EXPECT_TRUE(found.accepted());
  EXPECT_FALSE(found.M_first);
  MatrixXd N = MatrixXd::Zero(n, 3);
  for (int c = 0; c < 3; ++c)
    for (int p = found.Np[c]; p < found.Np[c + 1]; ++p) N(found.Ni[p], c) = found.Nx[p];
  EXPECT_LE((J.transpose() * N(rows, Eigen::all)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(N(columns, Eigen::all).cwiseAbs().maxCoeff(), 0);
}

// J's second row is nearly the first, and depends on the first and the third: it waits, since its small pivot would
// pass an enlarged error on to the third.
TEST(DependentRows, WaitBeforeSmallPivotsPassTheirErrorsOn) {
  for (double small : {1e-4, 3e-5, 1e-5}) {
    SaddlePoint s{"passed on", MatrixXd::Identity(2, 2) / 3, MatrixXd(3, 2)};
    s.J << 1, 0, 1, small, 0, 1;
    FactorOfRows f(s, tolerance::kWaits);
    ASSERT_EQ(f.done, s.n()) << small;
    EXPECT_TRUE(find_dependence(f.K.pattern, f.symbolic, f.K.x.data(), f.of_M, f.row_scale.data(), f.L.data(),
                                f.D.data(), f.solve_panel, f.rows))
        << small;
    EXPECT_EQ(f.rows.dropped, std::vector<int>{3}) << small;
  }
}

// The same numbers in M, which is definite: what is left of its last pivot counts.
TEST(DependentRows, PivotsOfMPassNothingOnAmongThemselves) {
  MatrixXd M(3, 3);
  M << 1, 1, 0, 1, 1 + 1e-8, 1e-4, 0, 1e-4, 1 + 1e-6;
  const FactorOfRows f({"definite", M, MatrixXd::Ones(1, 3)});
  EXPECT_EQ(f.done, 4);
  EXPECT_TRUE(f.rows.dropped.empty());
}

// A row of M has a pivot from the row of J before it alone, which buries its own entry.
TEST(DependentRows, ARowOfMThatRowsOfJBuryIsReturned) {
  const Symmetric K(MatrixXd{{1, 1, 0}, {1, 0, 1}, {0, 1, 1e-14}});
  const std::vector<char> of_M{1, 0, 1};
  const double row_size[] = {1, 1, 1};
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(K.pattern);
  std::vector<double> L(symbolic.nonzeros()), D(3);
  sparse::LdlWorkspace work;
  DependentRows found;
  EXPECT_EQ(
      rank::ldl_factor_dependent(K.pattern, symbolic, K.x.data(), of_M, 1, row_size, work, L.data(), D.data(), found),
      2);
}

// The judges of pivots: each condition decides by itself.
TEST(Pivots, AreLeftWhereEachConditionHolds) {
  using Judged = rank::Pivot<double>;
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(rank::is_left(Judged{true, 1e-10, 1, 1}));
  EXPECT_FALSE(rank::is_left(Judged{true, 1e-12, 1, 1})) << "the pivot";
  EXPECT_FALSE(rank::is_left(Judged{true, 1, 1, 1e-12})) << "M's own entry";
  EXPECT_TRUE(rank::is_left(Judged{false, -1e-10, 1, 1, 1}));
  EXPECT_FALSE(rank::is_left(Judged{false, -1e-12, 1, 1, 1})) << "the pivot";
  EXPECT_FALSE(rank::is_left(Judged{false, -1, 1, 1e-12, 1})) << "J's row";
  EXPECT_TRUE(rank::is_left(Judged{false, -1, 1, 0})) << "a row that is judged elsewhere";
  EXPECT_FALSE(rank::is_left(Judged{true, 1e-10, 1, 1}, 100)) << "the margin";
  for (const double bad : {inf, std::nan("")}) {
    EXPECT_FALSE(rank::is_left(Judged{true, 1, bad, 1}));
    EXPECT_FALSE(rank::is_left(Judged{false, -bad, bad, 1, 1}));
  }
  EXPECT_TRUE(rank::has_its_sign(Judged{true, 1, 1, 1}));
  EXPECT_FALSE(rank::has_its_sign(Judged{true, -1, 1, 1}));
  EXPECT_TRUE(rank::has_its_sign(Judged{false, -1, 1, 1}));
  EXPECT_FALSE(rank::has_its_sign(Judged{false, 1, 1, 1}));
}

TEST(Pivots, TwoInTurnMayNotBothBeSmallUnlessBothAreOfM) {
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      rank::PassedOn<double> passed_on;
      EXPECT_TRUE(passed_on.accepts(first, 1e-7));
      EXPECT_EQ(passed_on.accepts(second, 1e-7), first && second) << first << second;
    }
}

// Two leaves of a tree hand nothing to each other, and both to the root.
TEST(Pivots, PassErrorsOnAlongTheTree) {
  const Symmetric A(MatrixXd{{1, 0, 1}, {0, 1, 1}, {1, 1, 1}});
  std::vector<rank::PassedOn<double>> memory;
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(A.pattern);
  rank::PassedOnInTree passed_on(symbolic, memory);
  EXPECT_TRUE(passed_on.accepts(0, false, 1e-7));
  EXPECT_TRUE(passed_on.accepts(1, false, 1e-7));
  EXPECT_FALSE(passed_on.accepts(2, false, 1e-7));
}

TEST(Pivots, AreRoundingWhereTheirOwnOrWhatWasPassedOnIsMore) {
  const Symmetric A(MatrixXd{{1, 1}, {1, 1}});
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(A.pattern);
  const auto rounding = [&](double l, std::array<double, 2> D, std::array<double, 2> terms, int of_M,
                            double margin = 1) {
    double noise[2];
    return rank::any_pivot_is_rounding(
        symbolic, &l, D.data(), terms.data(), margin, [=](int k) { return k < of_M; }, noise);
  };
  EXPECT_FALSE(rounding(1, {1, -1}, {1, 1}, 1));
  EXPECT_TRUE(rounding(1, {1e-14, -1}, {1, 1}, 1)) << "its own terms";
  EXPECT_TRUE(rounding(1, {1, -1e-6}, {1, 1e8}, 1)) << "its own terms beside what was passed on";
  EXPECT_TRUE(rounding(1e3, {1, -1e-8}, {1, 1e-8}, 1)) << "passed on to a row of J";
  EXPECT_TRUE(rounding(1e3, {-1, 1e-8}, {1, 1e-8}, 0)) << "passed on among rows of J";
  EXPECT_FALSE(rounding(1e3, {1, 1e-8}, {1, 1e-8}, 2)) << "among rows of M";
  EXPECT_FALSE(rounding(1e3, {1, -1e-6}, {1, 1e-6}, 1));
  EXPECT_TRUE(rounding(1e3, {1, -1e-6}, {1, 1e-6}, 1, 100)) << "the margin";
  EXPECT_FALSE(rounding(0, {INFINITY, -1}, {0, 1}, 0)) << "a row without pivot";
}

using Rows = std::vector<rank::RowOfContradiction<double>>;
rank::Contradiction<double> contradiction_of(const Rows& rows, double Ja = 0, double a0 = 1) {
  rank::Contradiction<double> out;
  out.add_products(Ja, a0);
  out.add_rows([&](auto&& use) {
    for (const auto& row : rows) use(row);
  });
  return out;
}

// Rows: size, terms, what is left.
TEST(Contradiction, IsMoreThanEachBoundAllows) {
  EXPECT_TRUE(contradiction_of({{1, 1, 1e-6}}).contradicts());
  EXPECT_FALSE(contradiction_of({{1, 1, 1e-9}}, 0, 1).contradicts()) << "a0";
  EXPECT_FALSE(contradiction_of({{1, 1, 1e-9}}, 1, 0).contradicts()) << "J a";
  EXPECT_TRUE(contradiction_of({{1, 1, 1e-9}}, 0, 0.01).contradicts());
  EXPECT_FALSE(contradiction_of({{1, 1e8, 1e-6}}).contradicts()) << "rounding of its own terms";
  EXPECT_TRUE(contradiction_of({{1, 1, NAN}}).contradicts());
  EXPECT_TRUE(contradiction_of({{1, 1, 1e-14}}).exceeds_rounding());
  EXPECT_FALSE(contradiction_of({{1, 1, 1e-15}}).exceeds_rounding());
  EXPECT_FALSE(contradiction_of({{1, 0, 0}}).exceeds_rounding()) << "nothing of nothing";
}

TEST(Contradiction, RoundingOfOtherRowsIsBoundedThreeTimes) {
  const auto contradicts = [](Rows rows) {
    rows.push_back({1, 1, 1e-6});
    return contradiction_of(rows).contradicts();
  };
  EXPECT_FALSE(contradicts({{1, 1e8, 0}})) << "another's terms";
  EXPECT_TRUE(contradicts({{1e6, 1e8, 0}})) << "of a large row";
  EXPECT_TRUE(contradicts({{1e-6, 1e8, 0}})) << "of a small row";
  EXPECT_TRUE(contradicts({{1e-6, 1e2, 0}, {1e6, 1e2, 0}})) << "no more than the largest terms";
  EXPECT_TRUE(contradicts({{1e6, 1e8, 0}, {0, 1, 0}})) << "a row of zeros has no lever";
  EXPECT_TRUE(contradiction_of({{0, 1e8, 0}, {0, 1, 1e-6}}).contradicts()) << "and takes no other's";
  EXPECT_FALSE(contradiction_of({{0, 1e8, 1e-6}}).contradicts()) << "but its own";
}

TEST(Contradiction, OfRowsOfVeryDifferentSizeIsLeftToTheDenseSolver) {
  EXPECT_TRUE(contradiction_of({{1, 1, 1e-6}, {1e-5, 1, 0}}).needs_dense());
  EXPECT_FALSE(contradiction_of({{1, 1, 1e-6}, {1e-3, 1, 0}}).needs_dense()) << "sizes";
  EXPECT_FALSE(contradiction_of({{1, 1, 1e-9}, {1e-5, 1, 0}}).needs_dense()) << "they agree";
  EXPECT_FALSE(contradiction_of({{1, 1, 1e-6}, {0, 1, 0}}).needs_dense()) << "no row";
}

// The sizes that rows are compared with: each motion is set alone, and counts.
class RowSizes : public testing::Test {
 protected:
  using Terms = internal::RowTerms<double>;

  RowSizes() : data_(contact_, {}) {
    contact_.A = {0, 0, SE3<double>::Identity()};
    contact_.B.robot = -1;
    for (Joint& joint : model_.joints) joint.inertia = Inertia<double>::from_com(1, {}, Mat3<double>::Identity());
    finalize(model_);
    kin_.emplace(model_);
    for (auto* motions : {&kin_->v, &kin_->a}) motions->assign(2, Vec6<double>::Zero());
    for (Vec6<double>* motion : {&data_.vA, &data_.vB, &data_.aA, &data_.aB}) motion->setZero();
    for (Vec3<double>* p : {&data_.aMA.p, &data_.bMA.p, &data_.on_A, &data_.on_B}) p->setZero();
  }
  Terms terms(double origin = 0) const { return internal::row_terms<double>(contact_, data_, origin); }
  Terms drift(const Vec3<double>& place = Vec3<double>::Zero()) const {
    return internal::bias_acceleration_terms<double>(contact_, data_, model_, *kin_, model_, *kin_, place);
  }
  static void expect(const Terms& found, double linear, double angular) {
    EXPECT_EQ(found.linear, linear);
    EXPECT_EQ(found.angular, angular);
  }

  Contact contact_;
  ContactData<double> data_;
  Model model_ = [] {
    Model model;
    model.joints.resize(2);
    model.joints[1].parent = 0;
    return model;
  }();
  std::optional<Kinematics<double>> kin_;
};

TEST_F(RowSizes, OfRotationsAreRadians) {
  data_.Jl.setZero(6, 1);
  data_.Jl(1, 0) = 2, data_.Jl(4, 0) = 3;
  data_.joint_lever = 0;
  EXPECT_EQ(row_size<double>(contact_, data_, 2), 2);
  EXPECT_EQ(row_size<double>(contact_, data_, 3), 3);
}

TEST_F(RowSizes, OfAccelerations) {
  data_.aA[1] = 5, data_.aA[4] = 2, data_.aB[0] = -7, data_.aB[5] = -1;
  expect(terms(), 12, 3);
}

TEST_F(RowSizes, OfVelocities) {
  data_.vA[3] = -2, data_.vB[2] = 3;
  expect(terms(), 6, 4);
  contact_.beta = -5;
  expect(terms(), 6 + 15, 4 + 10);
}

TEST_F(RowSizes, OfPlacements) {
  contact_.alpha = -2;
  expect(terms(), 0, 2);
  expect(terms(7), 14, 2);
  for (Vec3<double>* p : {&data_.aMA.p, &data_.bMA.p, &data_.on_B}) {
    (*p)[1] = -3;
    expect(terms(), 6, 2);
    p->setZero();
  }
  expect(drift({0, -9, 0}), 18, 2);
  contact_.B = {0, 1, SE3<double>::Identity()};
  expect(drift({0, -9, 0}), 0, 2);
}

TEST_F(RowSizes, OfBodiesAsTheTreeHasThem) {
  kin_->v[0] << 0, 3, 0, 2, 0, 0;
  expect(drift(), 6, 4);
  kin_->v[0] << 0, 0, 0, 2, 0, 0;
  data_.aMA.p[2] = -10;
  expect(drift(), 40, 4);
  kin_->v[0].setZero();
  kin_->a[0] << 0, 7, 0, 0, 0, 0;
  expect(drift(), 7, 0);
  kin_->a[0] << 0, 0, 0, 0, 5, 0;
  expect(drift(), 50, 5);
}

TEST_F(RowSizes, OfOriginsThatRoundingMoves) {
  model_.trees.resize(1), model_.tree_of = {0, 0};
  kin_->origins.resize(1);
  kin_->origins[0].p = {0, 0, -4};
  const auto off = [&](std::vector<int> path) {
    model_.trees[0].path = std::move(path);
    return internal::origin_rounding<double>(model_, *kin_, 0);
  };
  model_.joints[1].type = JointType::kPrismatic;
  EXPECT_EQ(off({1, 1}), 0) << "a sum along axes as given";
  EXPECT_EQ(off({1, 0}), 0) << "the last joint turns what follows alone";
  EXPECT_EQ(off({0, 1}), 4);
  model_.joints[1].placement_rotates = true;
  EXPECT_EQ(off({1}), 4);
  model_.floating_base = true;
  EXPECT_EQ(off({0, 1}), 0);
}

}  // namespace
}  // namespace manycontact::test
