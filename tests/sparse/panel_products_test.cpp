// Products of panels and solves with a Cholesky factor are tested at every level of instructions.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <numeric>

#include "manycontact/detail/dynamics/aligned_panel.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Panel = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Returns random numbers in the first columns, NaN behind them.
Panel poisoned(int rows, int ld, int cols, std::mt19937& rng) {
  Panel out = Panel::Constant(rows, ld, NAN);
  for (int i = 0; i < rows; ++i) out.row(i).head(cols) = random_vector(cols, rng).transpose();
  return out;
}

TEST(Product, EqualsTheDenseOne) {
  std::mt19937 rng(66);
  for (int rows : {1, 3, 4, 7, 8, 9, 38})
    for (int cols : {1, 7, 8, 25, 47, 109})
      for (int depth : {1, 40}) {
        const int filled = (cols + 7) / 8 * 8, ld = filled + 8, ldl = rows + 1;
        const Panel L = poisoned(depth, ldl, rows, rng), R = poisoned(depth, ld, cols, rng);
        const Eigen::MatrixXd l = L.leftCols(rows), r = R.leftCols(cols);
        const Eigen::MatrixXd exact = l.transpose() * r, scale = l.cwiseAbs().transpose() * r.cwiseAbs();
        for (const sparse::PanelKernels* level : sparse::panel_levels()) {
          SCOPED_TRACE(testing::Message() << level->name << ", " << rows << " by " << cols);
          Panel H = Panel::Constant(rows + 1, ld, NAN);
          level->product(L.data(), ldl, R.data(), depth, rows, cols, ld, H.data());
          EXPECT_TRUE(((H.topLeftCorner(rows, cols) - exact).array().abs() <= depth * kEps * scale.array()).all());
          EXPECT_TRUE(H.rightCols(8).array().isNaN().all()) << "columns behind";
          EXPECT_TRUE(H.row(rows).array().isNaN().all()) << "the row below";
        }
      }
}

// Rows of one panel are anywhere, in no order; entries next to them stay.
TEST(ProductOfRows, EqualsTheDenseOne) {
  std::mt19937 rng(68);
  for (int rows : {1, 3, 8, 15, 50})
    for (int cols : {8, 24, 40, 192}) {
      constexpr int kDepth = 12, kFirst = 16;
      const int ld = cols + 40, ldl = rows + 1;
      std::vector<int> place(rows + kDepth + 5);
      std::iota(place.begin(), place.end(), 0);
      std::shuffle(place.begin(), place.end(), rng);
      const int *from = place.data(), *to = from + kDepth;
      const Panel L = poisoned(kDepth, ldl, rows, rng);
      Panel given = Panel::Constant(static_cast<Eigen::Index>(place.size()), ld, NAN), r(kDepth, cols);
      for (int k = 0; k < kDepth; ++k) {
        r.row(k) = random_vector(cols, rng).transpose();
        given.row(from[k]).segment(kFirst, cols) = r.row(k);
      }
      const Eigen::MatrixXd l = L.leftCols(rows), exact = l.transpose() * r;
      const Eigen::MatrixXd scale = l.cwiseAbs().transpose() * r.cwiseAbs();
      for (const sparse::PanelKernels* level : sparse::panel_levels())
        for (const bool non_temporal : {false, true}) {
          SCOPED_TRACE(testing::Message() << level->name << ", " << rows << " by " << cols << ", " << non_temporal);
          AlignedPanel X;
          X.resize(given.rows(), ld);
          static_cast<AlignedPanel::View&>(X) = given;
          double* x = X.data() + kFirst;
          level->product_of_rows(L.data(), ldl, x, from, kDepth, x, to, rows, cols, ld, non_temporal);
          for (int i = 0; i < rows; ++i) {
            EXPECT_TRUE(((X.row(to[i]).segment(kFirst, cols) - exact.row(i)).array().abs() <=
                         kDepth * kEps * scale.row(i).array())
                            .all());
            X.row(to[i]).segment(kFirst, cols).setConstant(NAN);
          }
          for (int k = 0; k < kDepth; ++k) {
            EXPECT_TRUE(X.row(from[k]).segment(kFirst, cols) == r.row(k));
            X.row(from[k]).segment(kFirst, cols).setConstant(NAN);
          }
          EXPECT_TRUE(X.array().isNaN().all());
        }
    }
}

// |L x - b| <= n eps |L| |x|, Higham, Accuracy and Stability of Numerical Algorithms, theorem 8.5.
TEST(CholeskySolves, LeaveSmallResiduals) {
  std::mt19937 rng(67);
  for (int n : {1, 5, 32})
    for (int cols : {1, 8, 33, 76}) {
      const int ld = (cols + 7) / 8 * 8 + 8, ldl = n + 2;
      Eigen::MatrixXd L = Eigen::MatrixXd::Constant(ldl, n, NAN);  // entries above the diagonal are not read
      for (int j = 0; j < n; ++j) {
        L.col(j).segment(j, n - j) = random_vector(n - j, rng, 0.3);
        L(j, j) = 1 + std::abs(L(j, j));
      }
      const Eigen::MatrixXd lower = Eigen::MatrixXd(L.topRows(n).triangularView<Eigen::Lower>());
      const Panel B = poisoned(n, ld, cols, rng);
      for (const sparse::PanelKernels* level : sparse::panel_levels())
        for (const bool transposed : {false, true}) {
          SCOPED_TRACE(testing::Message() << level->name << ", " << n << " by " << cols);
          Panel X = B;
          (transposed ? level->upper_solve : level->lower_solve)(L.data(), ldl, n, X.data(), cols, ld);
          const Eigen::MatrixXd A = transposed ? Eigen::MatrixXd(lower.transpose()) : lower, x = X.leftCols(cols);
          const Eigen::MatrixXd scale = A.cwiseAbs() * x.cwiseAbs();
          EXPECT_TRUE(((A * x - B.leftCols(cols)).array().abs() <= (2 * n + 2) * kEps * scale.array()).all());
          EXPECT_TRUE(X.rightCols(8).array().isNaN().all()) << "columns behind";
        }
    }
}

}  // namespace
}  // namespace manycontact::test
