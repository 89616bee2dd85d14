// The compiled L D L^T agrees with SuiteSparse's and with the dense matrix, and SIMD batches with doubles, bit for bit.

#include "manycontact/sparse/ldl_schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "sparse/four_lanes.hpp"
#include "sparse/symmetric.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"
#include "support/dense.hpp"
#include "support/pivot_ratio.hpp"

namespace manycontact::test {
namespace {

// Contains either phase's factor of one matrix.
struct ScheduledFactor {
  std::vector<double> L, D, scale;

  explicit ScheduledFactor(const sparse::LdlSymbolic& s) : L(s.nonzeros(), NAN), D(s.n, NAN), scale(s.n, NAN) {}
  Eigen::MatrixXd dense_L(const sparse::LdlSymbolic& s) const {
    Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(s.n, s.n);
    for (int j = 0; j < s.n; ++j)
      for (int k = s.Lp[j]; k < s.Lp[j + 1]; ++k) dense(s.Li[k], j) = L[k];
    return dense;
  }
  Eigen::VectorXd pivots() const { return Eigen::Map<const Eigen::VectorXd>(D.data(), D.size()); }
};

struct Compiled {
  sparse::LdlSymbolic symbolic;
  sparse::LdlSchedule schedule;

  explicit Compiled(const sparse::UpperCsc& A)
      : symbolic(sparse::ldl_analyze(A)), schedule(sparse::compile_ldl(A, symbolic)) {}
  ScheduledFactor factor(const std::vector<double>& x) const {
    ScheduledFactor f(symbolic);
    sparse::ldl_scheduled_factor<double>(schedule, x.data(), f.L.data(), f.D.data(), f.scale.data());
    return f;
  }
  ScheduledFactor suitesparse(const sparse::UpperCsc& A, const std::vector<double>& x) const {
    ScheduledFactor f(symbolic);
    sparse::LdlWorkspace work;
    EXPECT_EQ(sparse::ldl_factor(A, symbolic, x.data(), work, f.L.data(), f.D.data()), A.n);
    sparse::pivot_terms(A, symbolic, x.data(), f.L.data(), f.D.data(), f.scale.data());
    return f;
  }
};

// Both are the exact factors of A + E, |E| <= (n + 1) eps |L| |D| |L|^T (Higham 2002, ch. 10), and entries of order
// E^2 do not count. With F = L^-1 E L^-T the pivots differ by F's diagonal, and L by L times F's lower triangle / D.
void expect_like_suitesparse(const Symmetric& A) {
  const Compiled c(A.pattern);
  ASSERT_TRUE(c.schedule.compiled());
  const ScheduledFactor f = c.factor(A.x), g = c.suitesparse(A.pattern, A.x);
  const int n = A.n();
  if (n == 0) return;
  const Eigen::MatrixXd L = f.dense_L(c.symbolic), size = L.cwiseAbs();
  const Eigen::VectorXd D = f.pivots();
  const Eigen::MatrixXd E = (n + 1) * kEps * size * D.cwiseAbs().asDiagonal() * size.transpose();
  EXPECT_TRUE(((L * D.asDiagonal() * L.transpose() - A.dense).array().abs() <= 2 * E.array()).all());

  const Eigen::MatrixXd inverse =
      L.triangularView<Eigen::UnitLower>().solve(Eigen::MatrixXd::Identity(n, n)).cwiseAbs();
  const Eigen::MatrixXd F = inverse * E * inverse.transpose();
  EXPECT_TRUE(((D - g.pivots()).array().abs() <= 4 * F.diagonal().array()).all());
  Eigen::MatrixXd lower = F * D.cwiseAbs().cwiseInverse().asDiagonal();
  lower.triangularView<Eigen::Upper>().setZero();
  EXPECT_TRUE(((L - g.dense_L(c.symbolic)).array().abs() <= 4 * (size * lower).array()).all());

  std::vector<double> scale(n);
  sparse::pivot_terms(A.pattern, c.symbolic, A.x.data(), f.L.data(), f.D.data(), scale.data());
  for (int k = 0; k < n; ++k) EXPECT_NEAR(f.scale[k], scale[k], 2 * (n + 2) * kEps * scale[k]);
}

// |b - A x| <= c n eps |L| |D| |L|^T |x|, row by row.
void expect_solves(const Symmetric& A, std::mt19937& rng) {
  const Compiled c(A.pattern);
  const ScheduledFactor f = c.factor(A.x);
  const Eigen::VectorXd b = random_matrix(A.n(), 1, rng);
  Eigen::VectorXd x = b;
  sparse::ldl_scheduled_solve<double>(c.schedule, f.L.data(), f.D.data(), x.data());
  const Eigen::MatrixXd size = f.dense_L(c.symbolic).cwiseAbs();
  const Eigen::VectorXd allowed =
      4 * (A.n() + 2) * kEps * (size * (f.pivots().cwiseAbs().asDiagonal() * (size.transpose() * x.cwiseAbs())));
  EXPECT_TRUE(((b - A.dense * x).array().abs() <= allowed.array()).all());
}

void expect_sound(const Symmetric& A, std::mt19937& rng) {
  expect_like_suitesparse(A);
  expect_solves(A, rng);
}

// Returns [H G^T; G -C], H and C positive definite, in a random order.
Symmetric quasi_definite(int n, int m, double density, std::mt19937& rng) {
  Eigen::MatrixXd K(n + m, n + m);
  K.topLeftCorner(n, n) = random_positive(n, density, rng);
  K.bottomRightCorner(m, m) = -random_positive(m, density, rng);
  K.bottomLeftCorner(m, n) = random_symmetric(n + m, density, rng).bottomLeftCorner(m, n);
  K.topRightCorner(n, m) = K.bottomLeftCorner(m, n).transpose();
  Eigen::PermutationMatrix<Eigen::Dynamic> P(n + m);
  P.setIdentity();
  std::shuffle(P.indices().begin(), P.indices().end(), rng);
  return Symmetric(P * K * P.transpose());
}

// Returns the pattern of chains that meet in a base, leaf to root, as in inertia matrices.
Eigen::MatrixXd tree(const std::vector<int>& parent, std::mt19937& rng) {
  const int n = static_cast<int>(parent.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  std::normal_distribution<double> normal;
  for (int i = 0; i < n; ++i)
    for (int j = parent[i]; j >= 0; j = parent[j]) A(i, j) = A(j, i) = normal(rng);
  const Eigen::VectorXd sums = A.cwiseAbs().rowwise().sum();
  A.diagonal() = sums.array() + 1;
  return A;
}

TEST(LdlSchedule, Structures) {
  std::mt19937 rng(71);
  expect_sound(Symmetric(Eigen::MatrixXd(0, 0)), rng);
  expect_sound(Symmetric(Eigen::MatrixXd::Constant(1, 1, -4)), rng);
  expect_sound(Symmetric(Eigen::VectorXd(random_matrix(10, 1, rng)).asDiagonal()), rng);
  Eigen::MatrixXd band = random_positive(40, 1, rng);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i)
      if (std::abs(i - j) > 3) band(i, j) = 0;
  expect_sound(Symmetric(band), rng);
  for (int hub : {0, 6, 11}) {  // an arrow
    SCOPED_TRACE(hub);
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(12, 12);
    A.row(hub) = random_matrix(1, 12, rng);
    A.col(hub) = A.row(hub);
    A.diagonal().setConstant(20);
    expect_sound(Symmetric(A), rng);
  }
  // two arms of nine on a torso of two on a base of six
  std::vector<int> parent(26);
  for (int k = 0; k < 26; ++k) parent[k] = k == 8 ? 18 : k + 1 < 26 ? k + 1 : -1;
  expect_sound(Symmetric(tree(parent, rng)), rng);
}

TEST(LdlSchedule, RandomPositiveDefinite) {
  std::mt19937 rng(72);
  for (int trial = 0; trial < 20; ++trial)
    for (double density : {0.02, 0.1, 0.5}) expect_sound(Symmetric(random_positive(60, density, rng)), rng);
}

TEST(LdlSchedule, QuasiDefiniteInAnyOrder) {
  std::mt19937 rng(73);
  for (int trial = 0; trial < 20; ++trial)
    for (double density : {0.05, 0.3, 1.0}) expect_sound(quasi_definite(20, 13, density, rng), rng);
}

TEST(LdlSchedule, Indefinite) {
  std::mt19937 rng(74);
  for (int trial = 0; trial < 20; ++trial) expect_sound(Symmetric(random_symmetric(14, 0.5, rng)), rng);
}

// A block wider than allowed is cut, and the parts update each other.
TEST(LdlSchedule, DenseBlocksAreCut) {
  std::mt19937 rng(75);
  const int wide = 3 * sparse::LdlSchedule::kWidest + 5;
  const Symmetric A(random_positive(wide, 1, rng));
  expect_sound(A, rng);
  EXPECT_EQ(Compiled(A.pattern).schedule.blocks(), 4);
}

TEST(LdlSchedule, ChainsAreBlocks) {
  std::mt19937 rng(76);
  std::vector<int> parent(12);
  for (int k = 0; k < 12; ++k) parent[k] = k == 4 ? 9 : k + 1 < 12 ? k + 1 : -1;  // chains of 5 and 4 on a base of 3
  const Compiled c(Symmetric(tree(parent, rng)).pattern);
  EXPECT_EQ(c.schedule.block, (std::vector<int>{0, 5, 12}));  // the second chain nests in the base
  EXPECT_EQ(c.schedule.runs.size(), 1u);
  EXPECT_EQ(c.schedule.targets.size(), 1u);
}

// After the first columns alone the Schur complement remains; with its solution the sweeps give the whole.
TEST(LdlSchedule, FirstColumnsAlone) {
  std::mt19937 rng(81);
  for (const int columns : {0, 1, 17, 31, 40}) {
    const int n = 40, left = n - columns;
    const Symmetric A(random_positive(n, 0.2, rng));
    const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(A.pattern);
    const sparse::LdlSchedule schedule = sparse::compile_ldl(A.pattern, symbolic, columns);
    ASSERT_TRUE(schedule.compiled());
    ScheduledFactor f(symbolic);
    sparse::ldl_scheduled_factor<double>(schedule, A.x.data(), f.L.data(), f.D.data(), f.scale.data());
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(left, left);
    S.diagonal() = f.pivots().tail(left);
    for (int j = columns; j < n; ++j)
      for (int k = symbolic.Lp[j]; k < symbolic.Lp[j + 1]; ++k)
        S(symbolic.Li[k] - columns, j - columns) = S(j - columns, symbolic.Li[k] - columns) = f.L[k];
    const Eigen::MatrixXd H = A.dense.topLeftCorner(columns, columns), G = A.dense.bottomLeftCorner(left, columns);
    const Eigen::MatrixXd expected = A.dense.bottomRightCorner(left, left) - G * solved(H, G.transpose());
    EXPECT_LE(difference_of(S, expected), 1e-13 * size_of(A.dense));

    const Eigen::VectorXd b = random_matrix(n, 1, rng), answer = solved(A.dense, b);
    Eigen::VectorXd x = b;
    sparse::ldl_scheduled_forward<double>(schedule, f.L.data(), x.data());
    x.tail(left) = solved(S, x.tail(left));
    sparse::ldl_scheduled_backward(schedule, f.L.data(), f.D.data(), x.data());
    EXPECT_LE(difference_of(x, answer), 1e-12 * size_of(answer));
  }
}

// Returns hubs, each with a row of its own below that prevents nesting, and leaves on half of the hubs each.
Eigen::MatrixXd scattered(int leaves, int hubs, std::mt19937& rng) {
  const int n = leaves + 2 * hubs;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  std::normal_distribution<double> normal;
  std::bernoulli_distribution keep(0.5);
  const auto set = [&](int i, int j) { A(i, j) = A(j, i) = normal(rng); };
  for (int h = 0; h < hubs; ++h) {
    for (int k = 0; k < leaves; ++k)
      if (keep(rng)) set(k, leaves + h);
    for (int other = 0; other < h; ++other) set(leaves + h, leaves + other);
    set(leaves + h, leaves + hubs + h);
  }
  const Eigen::VectorXd sums = A.cwiseAbs().rowwise().sum();
  A.diagonal() = sums.array() + 1;
  return A;
}

TEST(LdlSchedule, ScatteredRows) {
  std::mt19937 rng(77);
  for (int leaves : {0, 1, 8}) expect_sound(Symmetric(scattered(leaves, 24, rng)), rng);
}

TEST(LdlSchedule, NotCompiledWhereListsOutgrowTheFactor) {
  std::mt19937 rng(80);
  const Compiled c(Symmetric(scattered(400, 60, rng)).pattern);
  EXPECT_FALSE(c.schedule.compiled());
  EXPECT_LE(c.schedule.bytes(), 16u * 12u * c.symbolic.nonzeros()) << "and it stops in time";
}

// Small integers make the pivot exactly zero.
TEST(LdlSchedule, ZeroPivotsShow) {
  const Eigen::Matrix3d first{{0, 1, 2}, {1, 4, 0}, {2, 0, 5}}, middle{{1, 2, 1}, {2, 4, 3}, {1, 3, 7}},
      last{{1, 2, 0}, {2, 5, 1}, {0, 1, 1}};
  int k = 0;
  for (const Eigen::Matrix3d& dense : {first, middle, last}) {
    const Symmetric A(dense);
    const ScheduledFactor f = Compiled(A.pattern).factor(A.x);
    EXPECT_EQ(f.D[k], 0) << k;
    for (int i = k + 1; i < 3; ++i) EXPECT_FALSE(std::isfinite(f.D[i])) << i;
    EXPECT_EQ(smallest_pivot_ratio(3, f.D.data(), f.scale.data()), 0) << k;
    ++k;
  }
}

TEST(LdlSchedule, PivotRatioIsThatOfTheFactor) {
  for (double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Symmetric A(Eigen::Matrix2d{{1, 1}, {1, 1 + gap}});
    const ScheduledFactor f = Compiled(A.pattern).factor(A.x);
    EXPECT_NEAR(smallest_pivot_ratio(2, f.D.data(), f.scale.data()) / (gap / (2 + gap)), 1, 2 * kEps / gap);
  }
  const Symmetric nan(Eigen::Matrix2d{{1, NAN}, {NAN, 1}});
  const ScheduledFactor f = Compiled(nan.pattern).factor(nan.x);
  EXPECT_EQ(smallest_pivot_ratio(2, f.D.data(), f.scale.data()), 0);
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// Each of four matrices of one pattern is factorized as if alone, even if another has a zero pivot.
void expect_lanes_are_alone(const Symmetric& A, bool spoil_one, std::mt19937& rng) {
  const Compiled c(A.pattern);
  const int n = A.n(), nnz = c.symbolic.nonzeros();
  std::vector<std::vector<double>> x(4, A.x), b(4, std::vector<double>(n));
  std::vector<FourLanes> X(A.x.size()), L(nnz), D(n), scale(n), y(n);
  for (int lane = 0; lane < 4; ++lane) {
    for (double& a : x[lane]) a *= std::uniform_real_distribution<double>(0.9, 1.1)(rng);
    for (double& k : b[lane]) k = std::normal_distribution<double>()(rng);
  }
  if (spoil_one) x[2][A.pattern.p[1] - 1] = 0;
  for (int lane = 0; lane < 4; ++lane) {
    for (std::size_t k = 0; k < X.size(); ++k) X[k][lane] = x[lane][k];
    for (int k = 0; k < n; ++k) y[k][lane] = b[lane][k];
  }
  sparse::ldl_scheduled_factor(c.schedule, X.data(), L.data(), D.data(), scale.data());
  sparse::ldl_scheduled_solve(c.schedule, L.data(), D.data(), y.data());
  for (int lane = 0; lane < 4; ++lane) {
    if (spoil_one && lane == 2) continue;
    const ScheduledFactor f = c.factor(x[lane]);
    sparse::ldl_scheduled_solve(c.schedule, f.L.data(), f.D.data(), b[lane].data());
    int differ = 0;
    for (int k = 0; k < nnz; ++k) differ += !same_bits(L[k][lane], f.L[k]);
    for (int k = 0; k < n; ++k)
      differ +=
          !same_bits(D[k][lane], f.D[k]) + !same_bits(scale[k][lane], f.scale[k]) + !same_bits(y[k][lane], b[lane][k]);
    EXPECT_EQ(differ, 0) << "lane " << lane;
  }
}

TEST(LdlSchedule, AMatrixInALaneIsAMatrixAlone) {
  std::mt19937 rng(78);
  for (bool spoil_one : {false, true}) {
    for (double density : {0.02, 0.1, 0.5, 1.0})
      expect_lanes_are_alone(Symmetric(random_positive(50, density, rng)), spoil_one, rng);
    expect_lanes_are_alone(quasi_definite(40, 15, 0.1, rng), spoil_one, rng);
  }
}

// b - A x has sums of up to n + 1 terms in another order.
TEST(LdlSchedule, ResidualIsThatOfTheMatrix) {
  std::mt19937 rng(82);
  for (double density : {0.0, 0.1, 1.0}) {
    const Symmetric A(random_symmetric(30, density, rng));
    const int n = A.n();
    std::vector<FourLanes> a(A.x.size()), x(n), b(n), r(n), scale(n);
    for (std::size_t k = 0; k < a.size(); ++k) a[k] = FourLanes(A.x[k]);
    std::vector<double> x1(n), b1(n), r1(n), scale1(n), r2(n), scale2(n);
    for (int k = 0; k < n; ++k) {
      x[k] = FourLanes(x1[k] = std::normal_distribution<double>()(rng));
      b[k] = FourLanes(b1[k] = std::normal_distribution<double>()(rng));
    }
    sparse::residual(A.pattern, A.x.data(), x1.data(), b1.data(), r1.data(), scale1.data());
    sparse::ldl_scheduled_residual(A.pattern, A.x.data(), x1.data(), b1.data(), r2.data(), scale2.data());
    sparse::ldl_scheduled_residual(A.pattern, a.data(), x.data(), b.data(), r.data(), scale.data());
    for (int k = 0; k < n; ++k) {
      EXPECT_NEAR(r2[k], r1[k], 2 * (n + 1) * kEps * scale1[k]);
      EXPECT_NEAR(scale2[k], scale1[k], 2 * (n + 1) * kEps * scale1[k]);
      for (int lane = 0; lane < 4; ++lane)
        EXPECT_TRUE(same_bits(r[k][lane], r2[k]) && same_bits(scale[k][lane], scale2[k]));
    }
  }
}

TEST(LdlSchedule, AllocatesNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc is not ours to count";
  std::mt19937 rng(79);
  const Symmetric A(random_positive(60, 0.1, rng));
  const Compiled c(A.pattern);
  ScheduledFactor f(c.symbolic);
  Eigen::VectorXd x = random_matrix(60, 1, rng);
  const auto count = allocations([&] {
    sparse::ldl_scheduled_factor<double>(c.schedule, A.x.data(), f.L.data(), f.D.data(), f.scale.data());
    sparse::ldl_scheduled_solve<double>(c.schedule, f.L.data(), f.D.data(), x.data());
  });
  EXPECT_EQ(count, 0u);
}

}  // namespace

// Rows whose pivots are no more than `least` of their terms are not eliminated: the others' factor, by which A is
// eliminated in all rows, has no entries in their columns.
TEST(LdlSchedule, RowsMayWait) {
  std::mt19937 rng(77);
  for (int trial = 0; trial < 20; ++trial) {
    const Symmetric A = quasi_definite(20, 12, 0.3, rng);
    const Compiled c(A.pattern);
    const int n = A.n();
    std::vector<double> least(n, 0.0);
    for (double& of : least)
      if (rng() % 4 == 0) of = std::numeric_limits<double>::infinity();
    const auto expect_factor = [&](const ScheduledFactor& f) {
      Eigen::MatrixXd L = f.dense_L(c.symbolic);
      Eigen::VectorXd D = f.pivots(), terms(n);
      for (int k = 0; k < n; ++k) {
        terms[k] = std::abs(A.dense(k, k));
        for (int j = 0; j < k; ++j) terms[k] += L(k, j) * L(k, j) * std::abs(D[j]);
        EXPECT_NEAR(f.scale[k], terms[k], 2 * n * kEps * terms[k]);
        if (least[k] == 0) continue;
        EXPECT_EQ(L.col(k).tail(n - k - 1).cwiseAbs().sum(), 0);
        L(k, k) = 0;
      }
      Eigen::MatrixXd left = A.dense - L * D.asDiagonal() * L.transpose();
      for (int k = 0; k < n; ++k)
        for (int j = 0; j <= k; ++j)
          if (least[j] == 0 || j == k)
            EXPECT_NEAR(left(k, j), least[k] == 0 ? 0 : j == k ? D[k] : 0, 8 * n * kEps * (terms[k] + terms[j]));
    };
    for (const sparse::PanelKernels* level : sparse::panel_levels()) {
      ScheduledFactor f(c.symbolic);
      level->factor(c.schedule, A.x.data(), least.data(), n, f.L.data(), f.D.data(), f.scale.data());
      expect_factor(f);
    }
    ScheduledFactor f(c.symbolic);
    sparse::LdlWorkspace work;
    sparse::ldl_factor_by_rows(A.pattern, c.symbolic, A.x.data(), least.data(), work, f.L.data(), f.D.data(),
                               f.scale.data());
    expect_factor(f);
  }
}

}  // namespace manycontact::test
