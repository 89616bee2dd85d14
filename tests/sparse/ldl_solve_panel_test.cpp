// Many right-hand sides at once agree with one by one, at every width: kernels of all chunks of columns, with LDL's
// pattern and with a compiled schedule.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "manycontact/sparse/ldl.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {
namespace {

using Panel = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The matrix is so sparse that few rows reach only parts of the elimination tree.
struct PanelFactor {
  Symmetric A;
  sparse::LdlSymbolic symbolic;
  sparse::LdlSchedule schedule;
  std::vector<double> L, D;
  std::vector<int> row;  // rows of the panel, which has one more

  PanelFactor(int n, double density, std::mt19937& rng)
      : A(random_positive(n, density, rng)),
        symbolic(sparse::ldl_analyze(A.pattern)),
        schedule(sparse::compile_ldl(A.pattern, symbolic)),
        row(n) {
    for (int k = 0; k < n / 3; ++k) A.x[A.pattern.p[k + 1] - 1] *= -1;  // pivots of both signs
    sparse::LdlWorkspace work;
    L.resize(symbolic.nonzeros());
    D.resize(n);
    EXPECT_EQ(sparse::ldl_factor(A.pattern, symbolic, A.x.data(), work, L.data(), D.data()), n);
    std::iota(row.begin(), row.end(), 1);
    std::shuffle(row.begin(), row.end(), rng);
  }
  int n() const { return symbolic.n; }

  // Solves columns first ... first+cols-1 one by one.
  Panel one_by_one(const Panel& given, int first, int cols) const {
    Panel X = given;
    std::vector<double> x(n());
    for (int c = first; c < first + cols; ++c) {
      for (int k = 0; k < n(); ++k) x[k] = given(row[k], c);
      sparse::ldl_solve(symbolic, L.data(), D.data(), x.data());
      for (int k = 0; k < n(); ++k) X(row[k], c) = x[k];
    }
    return X;
  }
  // Returns flags after the call: rows of L^-1 B that may be other than zero.
  std::vector<char> reached(std::vector<char> nonzero) const {
    for (int k = 0; k < n(); ++k)
      for (int i = symbolic.parent[k]; nonzero[k] && i >= 0; i = symbolic.parent[i]) nonzero[i] = 1;
    return nonzero;
  }
  // Returns |L^-T| |D^-1| |L^-1| |B|, which rounding is relative to. The scaling by 1 / D, the order of sums of a few
  // terms and the machine's fused multiply-add, if any, make a difference.
  double allowed(const Panel& given) const {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(n(), n());
    for (int j = 0; j < n(); ++j)
      for (int k = symbolic.Lp[j]; k < symbolic.Lp[j + 1]; ++k) dense(symbolic.Li[k], j) = L[k];
    const Eigen::MatrixXd inverse =
        dense.triangularView<Eigen::UnitLower>().solve(Eigen::MatrixXd::Identity(n(), n())).cwiseAbs();
    const Eigen::VectorXd d = Eigen::Map<const Eigen::VectorXd>(D.data(), n()).cwiseAbs().cwiseInverse();
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n());
    return 4 * kEps * size_of(given) * (inverse.transpose() * d.asDiagonal() * inverse * ones).maxCoeff();
  }
};

// Columns next to the panel's are poisoned: reading them would spoil it, writing them would be noticed.
Panel poisoned(int rows, int ld, int first, int cols, std::mt19937& rng) {
  Panel X = Panel::Constant(rows, ld, NAN);
  X.middleCols(first, cols) = random_matrix(rows, cols, rng);
  return X;
}

void expect_solved(const PanelFactor& f, const Panel& given, int first, int cols, const std::vector<char>& nonzero) {
  const int ld = static_cast<int>(given.cols());
  const Panel expected = f.one_by_one(given, first, cols);
  const auto check = [&](const char* how, auto&& solve) {
    SCOPED_TRACE(how);
    Panel X = given;
    std::vector<char> flags = nonzero;
    solve(f.L.data(), f.D.data(), f.row.data(), X.data(), ld, first, cols, flags.data());
    EXPECT_EQ(flags, f.reached(nonzero));
    EXPECT_LE(difference_of(X.middleCols(first, cols), expected.middleCols(first, cols)),
              f.allowed(given.middleCols(first, cols)));
    EXPECT_EQ(X.row(0).middleCols(first, cols), given.row(0).middleCols(first, cols)) << "a row of nobody's";
    EXPECT_TRUE(X.leftCols(first).array().isNaN().all()) << "columns before";
    EXPECT_TRUE(X.rightCols(ld - first - cols).array().isNaN().all()) << "columns behind";
  };
  check("by pattern", [&](auto... panel) { sparse::ldl_solve_panel(f.symbolic, panel...); });
  for (const sparse::PanelKernels* level : sparse::panel_levels()) {
    std::vector<double> work(level->work_size(f.schedule), NAN);
    check(level->name, [&](auto... panel) { level->solve(f.schedule, panel..., work.data()); });
  }
}

TEST(LdlSolvePanel, EveryWidthEqualsColumnByColumn) {
  std::mt19937 rng(61);
  const PanelFactor f(40, 0.06, rng);
  for (int cols = 0; cols <= 70; ++cols)
    for (const auto& [first, behind] : {std::pair{0, 0}, {1, 0}, {3, 5}, {16, 1}}) {
      SCOPED_TRACE(testing::Message() << cols << " columns from " << first << ", " << behind << " behind");
      const Panel given = poisoned(f.n() + 1, first + cols + behind, first, cols, rng);
      expect_solved(f, given, first, cols, std::vector<char>(f.n(), 1));
    }
}

TEST(LdlSolvePanel, ZeroRowsMayBeLeftOut) {
  std::mt19937 rng(62);
  for (double density : {0.02, 0.1, 0.5}) {
    const PanelFactor f(40, density, rng);
    for (int cols : {1, 8, 16, 27, 70})
      for (double kept : {0.0, 0.05, 0.3, 1.0}) {
        SCOPED_TRACE(testing::Message() << cols << " columns, " << kept << " of the rows");
        Panel given = poisoned(f.n() + 1, cols + 4, 2, cols, rng);
        std::vector<char> nonzero(f.n());
        for (int k = 0; k < f.n(); ++k) {
          nonzero[k] = std::bernoulli_distribution(kept)(rng);
          if (!nonzero[k]) given.row(f.row[k]).segment(2, cols).setZero();
        }
        expect_solved(f, given, 2, cols, nonzero);
      }
  }
}

// L has no entries at all, and its array may be null.
TEST(LdlSolvePanel, OfADiagonal) {
  std::mt19937 rng(67);
  for (int n : {1, 2, 7}) {
    const PanelFactor f(n, 0, rng);
    ASSERT_TRUE(f.L.empty());
    for (int cols : {1, 5, 8, 32, 70}) {
      SCOPED_TRACE(testing::Message() << n << " rows, " << cols << " columns");
      expect_solved(f, poisoned(n + 1, cols + 1, 1, cols, rng), 1, cols, std::vector<char>(n, 1));
    }
  }
}

// The factor is not quite A's: X + F^-1 (B - A X), X = F^-1 B, has the bits of the same steps one after the other.
TEST(LdlSolvePanel, RefinedIsSolveResidualSolve) {
  std::mt19937 rng(65);
  PanelFactor f(40, 0.1, rng);
  for (double& l : f.L) l *= 1 + 1e-6 * random_matrix(1, 1, rng)(0);
  for (int cols : {1, 8, 27, 70}) {
    Panel given = poisoned(f.n() + 1, cols + 3, 2, cols, rng);
    std::vector<char> nonzero(f.n());
    for (int k = 0; k < f.n(); ++k) {
      nonzero[k] = std::bernoulli_distribution(0.3)(rng);
      if (!nonzero[k]) given.row(f.row[k]).segment(2, cols).setZero();
    }
    for (const sparse::PanelKernels* level : sparse::panel_levels()) {
      const int ld = cols + 3;
      Panel X = given, R = given, refined = given;
      std::vector<double> work(level->work_size(f.schedule), NAN);
      const auto solve = [&](Panel& panel, std::vector<char> flags) {
        level->solve(f.schedule, f.L.data(), f.D.data(), f.row.data(), panel.data(), ld, 2, cols, flags.data(),
                     work.data());
      };
      solve(X, nonzero);
      level->residual(f.A.pattern, f.A.x.data(), f.row.data(), X.data() + 2, R.data() + 2, ld, cols);
      EXPECT_GT(size_of(R.middleCols(2, cols)), 1e-9);
      solve(R, std::vector<char>(f.n(), 1));
      std::vector<char> flags = nonzero;
      level->solve_refined(f.schedule, f.A.pattern, f.A.x.data(), f.L.data(), f.D.data(), f.row.data(), refined.data(),
                           ld, 2, cols, flags.data(), work.data());
      for (int k = 0; k < f.n(); ++k)
        EXPECT_EQ(refined.row(f.row[k]).segment(2, cols), (X + R).row(f.row[k]).segment(2, cols)) << level->name;
      EXPECT_TRUE(refined.leftCols(2).array().isNaN().all());
      EXPECT_TRUE(refined.rightCols(1).array().isNaN().all());
    }
  }
}

// Every column's residual, in longer numbers, is below the bound that the factor gives beforehand. The bound is needed
// where pivots are small: there residuals exceed the level of a sound factor.
TEST(LdlSolvePanel, ErrorsAreBoundedByTheFactor) {
  std::mt19937 rng(66);
  for (double pivot : {1.0, 1e-3, 1e-6}) {
    const int n = 40, cols = 16;
    Eigen::MatrixXd A = random_positive(n, 0.1, rng);
    for (int k = 0; k < n; k += 5) A(k, k) = pivot;
    const Symmetric K(A);
    const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(K.pattern);
    const sparse::LdlSchedule schedule = sparse::compile_ldl(K.pattern, symbolic);
    std::vector<double> L(symbolic.nonzeros()), D(n), scale(n), of_factor(n), of_A(n);
    sparse::ldl_scheduled_factor(schedule, K.x.data(), L.data(), D.data(), scale.data());
    Eigen::MatrixXd dense_L = Eigen::MatrixXd::Identity(n, n);
    for (int j = 0; j < n; ++j)
      for (int k = symbolic.Lp[j]; k < symbolic.Lp[j + 1]; ++k) dense_L(symbolic.Li[k], j) = L[k];
    const Eigen::VectorXd pivots = Eigen::Map<const Eigen::VectorXd>(D.data(), n).cwiseAbs();
    const Eigen::MatrixXd product = dense_L.cwiseAbs() * pivots.asDiagonal() * dense_L.cwiseAbs().transpose();

    sparse::ldl_row_sums(K.pattern, K.x.data(), symbolic, L.data(), D.data(), of_factor.data(), of_A.data());
    const auto sums = [](const std::vector<double>& x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), n); };
    EXPECT_LE(difference_of(sums(of_A), A.cwiseAbs().rowwise().sum().eval()), n * kEps * sums(of_A).maxCoeff());
    EXPECT_LE(difference_of(sums(of_factor), product.rowwise().sum().eval()),
              3 * n * kEps * sums(of_factor).maxCoeff());

    const double rounding = sparse::ldl_rounding(symbolic);
    using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    std::vector<int> row(n);
    std::iota(row.begin(), row.end(), 0);
    const Panel B = random_matrix(n, cols, rng);
    for (const sparse::PanelKernels* level : sparse::panel_levels()) {
      std::vector<double> work(level->work_size(schedule), NAN);
      std::vector<char> flags(n, 1);
      Panel X = B;
      level->solve(schedule, L.data(), D.data(), row.data(), X.data(), cols, 0, cols, flags.data(), work.data());
      const Long residual = B.cast<long double>() - A.cast<long double>() * X.cast<long double>();
      const Eigen::MatrixXd size = residual.cwiseAbs().cast<double>(), bound = rounding * (product * X.cwiseAbs());
      EXPECT_TRUE((size.array() <= bound.array()).all()) << level->name << ", pivot " << pivot;
      if (pivot == 1e-6) {
        EXPECT_GT(size.maxCoeff(), rounding * (A.cwiseAbs() * X.cwiseAbs()).maxCoeff());
      }
    }
  }
}

// Dropped rows of dependent_rows.hpp have an infinite pivot, which gives zero.
TEST(LdlSolvePanel, InfinitePivotsGiveZero) {
  std::mt19937 rng(63);
  PanelFactor f(12, 0, rng);
  f.D[5] = INFINITY;
  for (int cols : {1, 8, 16, 64}) {
    Panel X = random_matrix(f.n() + 1, cols, rng);
    std::vector<char> nonzero(f.n(), 1);
    sparse::ldl_solve_panel(f.symbolic, f.L.data(), f.D.data(), f.row.data(), X.data(), cols, 0, cols, nonzero.data());
    EXPECT_EQ(size_of(X.row(f.row[5])), 0);
  }
}

TEST(LdlSolvePanel, OfNothing) {
  const sparse::LdlSymbolic none = sparse::ldl_analyze(sparse::make_pattern(0, {}));
  sparse::ldl_solve_panel(none, nullptr, nullptr, nullptr, nullptr, 5, 0, 5, nullptr);
}

// b - K X of a panel agrees with the dense product.
TEST(ResidualPanel, EqualsTheDenseOne) {
  std::mt19937 rng(64);
  const PanelFactor f(30, 0.1, rng);
  Eigen::MatrixXd A = f.A.dense;
  for (int k = 0; k < f.n(); ++k) A(k, k) = f.A.x[f.A.pattern.p[k + 1] - 1];
  for (const auto& [cols, behind] : {std::pair{1, 0}, {7, 2}, {64, 0}, {33, 3}}) {
    const Panel X = poisoned(f.n() + 1, cols + behind, 0, cols, rng);
    const Panel given = poisoned(f.n() + 1, cols + behind, 0, cols, rng);
    for (const sparse::PanelKernels* level : sparse::panel_levels()) {
      Panel B = given;
      level->residual(f.A.pattern, f.A.x.data(), f.row.data(), X.data(), B.data(), cols + behind, cols);
      Eigen::MatrixXd x(f.n(), cols), b(f.n(), cols), r(f.n(), cols);
      for (int k = 0; k < f.n(); ++k) {
        x.row(k) = X.row(f.row[k]).head(cols);
        b.row(k) = given.row(f.row[k]).head(cols);
        r.row(k) = B.row(f.row[k]).head(cols);
      }
      const Eigen::MatrixXd scale = b.cwiseAbs() + A.cwiseAbs() * x.cwiseAbs();
      EXPECT_LE(size_of(((r - (b - A * x)).array() / scale.array()).matrix().eval()), 16 * kEps);
      EXPECT_EQ(B.row(0).head(cols), given.row(0).head(cols));
      EXPECT_TRUE(B.rightCols(behind).array().isNaN().all());
    }
  }
}

// Computes L^T R above its diagonal, whatever H contained and the padding columns contain.
TEST(UpperProduct, EqualsTheDenseOne) {
  std::mt19937 rng(65);
  for (int cols : {1, 2, 7, 8, 9, 23, 24, 25, 47, 64, 109})
    for (int depth : {1, 3, 50}) {
      const int filled = (cols + 7) / 8 * 8, ld = filled + 8;
      const Panel L = poisoned(depth, ld, 0, cols, rng), R = poisoned(depth, ld, 0, cols, rng);
      const Eigen::MatrixXd l = L.leftCols(cols), r = R.leftCols(cols);
      const Eigen::ArrayXXd exact = l.transpose() * r, scale = l.cwiseAbs().transpose() * r.cwiseAbs();
      for (const sparse::PanelKernels* level : sparse::panel_levels()) {
        SCOPED_TRACE(testing::Message() << level->name << ", " << depth << " by " << cols);
        Panel H = Panel::Constant(ld, ld, NAN);
        level->upper_product(L.data(), R.data(), depth, cols, ld, H.data());
        for (int j = 0; j < cols; ++j)
          for (int i = 0; i <= j; ++i) ASSERT_LE(std::abs(H(i, j) - exact(i, j)), depth * kEps * scale(i, j));
        EXPECT_TRUE(H.rightCols(8).array().isNaN().all()) << "columns behind";
        EXPECT_TRUE(H.bottomRows(8).array().isNaN().all()) << "rows below";
      }
    }
}

}  // namespace
}  // namespace manycontact::test
