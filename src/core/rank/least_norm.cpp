#include "manycontact/rank/least_norm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "manycontact/rank/dependent_rows.hpp"
#include "manycontact/sparse/ordering.hpp"
#include "manycontact/sparse/refine.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/sparse/union_find.hpp"

namespace manycontact::rank {

namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

// Returns the pattern of K = [I A^T; A 0] in CAMD's order, the rows of I first, and that order as iperm.
sparse::UpperCsc augmented_pattern(int rows, int cols, const Entries& A, std::vector<int>& iperm) {
  std::vector<std::pair<int, int>> entries;
  for (const auto& a : A) entries.emplace_back(cols + a.row(), a.col());
  const sparse::UpperCsc K = sparse::make_pattern(cols + rows, std::move(entries));
  std::vector<int> set(cols + rows, 0);
  std::fill(set.begin() + cols, set.end(), 1);
  iperm = sparse::inverse(sparse::camd_order(K, set));
  return sparse::permute(K, iperm);
}

std::vector<double> augmented_values(const sparse::UpperCsc& K, int cols, const Entries& A,
                                     const std::vector<int>& iperm) {
  std::vector<double> Kx(K.nonzeros(), 0.0);
  for (int k = 0; k < cols; ++k) Kx[K.slot(iperm[k], iperm[k])] = 1;
  for (const auto& a : A) Kx[K.slot(iperm[a.col()], iperm[cols + a.row()])] += a.value();
  return Kx;
}

// Refines z by z += K^-1 (b - K z). Returns whether the componentwise backward error is at most kConverged.
template <class Solve>
bool refine_solution(const sparse::UpperCsc& K, const std::vector<double>& Kx, const Solve& solve,
                     const std::vector<double>& b, std::vector<double>& z) {
  std::vector<double> r(K.n), scale(K.n);
  const sparse::Refinement refinement = sparse::refine(
      tolerance::kRefinementSteps, tolerance::kRefined,
      [&] {
        sparse::residual(K, Kx.data(), z.data(), b.data(), r.data(), scale.data());
        return sparse::componentwise_backward_error(r, scale);
      },
      [&] {
        solve(r.data());
        for (int k = 0; k < K.n; ++k) z[k] += r[k];
      });
  return refinement.backward_error <= tolerance::kConverged;
}

// least_norm_solution by L D L^T of K = [I A^T; A 0]; std::nullopt if rounding errors hide the rank of A.
std::optional<Eigen::VectorXd> by_ldl(int rows, int cols, const Entries& A, const Eigen::VectorXd& b) {
  std::vector<int> iperm;
  const sparse::UpperCsc K = augmented_pattern(rows, cols, A, iperm);
  const std::vector<double> Kx = augmented_values(K, cols, A, iperm);
  const sparse::LdlSymbolic symbolic = sparse::ldl_analyze(K);
  std::vector<double> Lx(symbolic.nonzeros()), D(K.n);
  sparse::LdlWorkspace work;
  DependentRows dependent;
  double size = 0;
  for (double x : Kx) size = std::max(size, std::abs(x));
  const std::vector<double> row_scale(K.n, size);
  std::vector<char> of_M(K.n, 0);
  std::fill_n(of_M.begin(), cols, 1);
  const auto solve = [&](double* X, int ld, int cols) {
    sparse::ldl_solve_panel(symbolic, Lx.data(), D.data(), nullptr, X, ld, 0, cols, nullptr);
  };
  if (ldl_factor_dependent(K, symbolic, Kx.data(), of_M, tolerance::kWaits, row_scale.data(), work, Lx.data(), D.data(),
                           dependent) != K.n ||
      !find_dependence(K, symbolic, Kx.data(), of_M, row_scale.data(), Lx.data(), D.data(), solve, dependent))
    return std::nullopt;
  const auto solve_rows_kept = [&](double* x) { solve_kept(dependent, x, 1, 1, solve); };

  std::vector<double> rhs(K.n, 0.0);
  for (int k = 0; k < rows; ++k) rhs[iperm[cols + k]] = b[k];
  project_out(dependent, rhs.data());
  std::vector<double> z = rhs;
  solve_rows_kept(z.data());
  if (!refine_solution(K, Kx, solve_rows_kept, rhs, z)) return std::nullopt;
  Eigen::VectorXd x(cols);
  for (int k = 0; k < cols; ++k) x[k] = z[iperm[k]];
  return x;
}

Eigen::VectorXd by_decomposition(int rows, int cols, const Entries& A, const Eigen::VectorXd& b) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows, cols);
  for (const auto& a : A) dense(a.row(), a.col()) += a.value();
  return least_norm_solution(dense, b);
}

// A block of A that has no rows or columns in common with other blocks.
struct Block {
  std::vector<int> rows, cols;
  Entries entries;  // rows and columns are numbered within the block
};

std::vector<Block> blocks_of(int rows, int cols, const Entries& A) {
  std::vector<int> memory(rows + cols);
  sparse::UnionFind sets(memory);
  for (const auto& a : A) sets.join(a.row(), rows + a.col());
  std::vector<int> block_of(rows + cols, -1), place(rows + cols);
  std::vector<Block> blocks;
  for (int k = 0; k < rows + cols; ++k) {
    int& block = block_of[sets.root(k)];
    if (block < 0) {
      block = static_cast<int>(blocks.size());
      blocks.emplace_back();
    }
    std::vector<int>& list = k < rows ? blocks[block].rows : blocks[block].cols;
    place[k] = static_cast<int>(list.size());
    list.push_back(k < rows ? k : k - rows);
  }
  for (const auto& a : A)
    blocks[block_of[sets.root(a.row())]].entries.emplace_back(place[a.row()], place[rows + a.col()], a.value());
  return blocks;
}

}  // namespace

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

Eigen::VectorXd least_norm_solution(int rows, int cols, const Entries& A, const Eigen::VectorXd& b) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(cols);
  for (const Block& block : blocks_of(rows, cols, A)) {
    if (block.entries.empty()) continue;
    const int m = static_cast<int>(block.rows.size()), n = static_cast<int>(block.cols.size());
    const Eigen::VectorXd part = b(block.rows);
    const auto finite = [](const auto& a) { return std::isfinite(a.value()); };
    if (!part.allFinite() || !std::all_of(block.entries.begin(), block.entries.end(), finite)) {
      x(block.cols).setConstant(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto solution = by_ldl(m, n, block.entries, part);
    x(block.cols) = solution ? *solution : by_decomposition(m, n, block.entries, part);
  }
  return x;
}

}  // namespace manycontact::rank
