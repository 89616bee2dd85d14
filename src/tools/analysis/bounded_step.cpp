#include "bounded_step.hpp"

#include <limits>

#include "manycontact/sparse/ordering.hpp"

namespace manycontact::internal {

namespace {

// Calls act(column, a, b) for each pair of positions b <= a of nonzeros in the same column of J.
template <class Act>
void each_pair(const Eigen::SparseMatrix<double>& J, Act&& act) {
  for (Eigen::Index j = 0; j < J.outerSize(); ++j)
    for (int a = J.outerIndexPtr()[j]; a < J.outerIndexPtr()[j + 1]; ++a)
      for (int b = J.outerIndexPtr()[j]; b <= a; ++b) act(j, a, b);
}

}  // namespace

NormalMatrix::NormalMatrix(const Eigen::SparseMatrix<double>& J) {
  const int n = static_cast<int>(J.rows());
  const int* row = J.innerIndexPtr();
  std::vector<std::pair<int, int>> entries;
  each_pair(J, [&](Eigen::Index, int a, int b) { entries.emplace_back(row[a], row[b]); });
  const sparse::UpperCsc natural = sparse::make_pattern(n, std::move(entries));
  iperm_ = sparse::inverse(sparse::camd_order(natural, {}));
  pattern_ = sparse::permute(natural, iperm_);
  symbolic_ = sparse::ldl_analyze(pattern_);
  work_.reserve(symbolic_);
  const auto slot = [&](int i, int k) {
    return pattern_.slot(std::min(iperm_[i], iperm_[k]), std::max(iperm_[i], iperm_[k]));
  };
  each_pair(J, [&](Eigen::Index, int a, int b) { slot_.push_back(slot(row[a], row[b])); });
  for (int i = 0; i < n; ++i) diagonal_.push_back(slot(i, i));
  A_.resize(static_cast<std::size_t>(pattern_.nonzeros()));
  L_.resize(static_cast<std::size_t>(symbolic_.nonzeros()));
  D_.resize(static_cast<std::size_t>(n));
  permuted_.resize(n);
}

void NormalMatrix::factorize(const Eigen::SparseMatrix<double>& J, const std::vector<char>& counts, double mu) {
  std::ranges::fill(A_, 0.0);
  const double* x = J.valuePtr();
  std::size_t k = 0;
  each_pair(J, [&](Eigen::Index j, int a, int b) {
    const int at = slot_[k++];
    if (counts[j]) A_[at] += x[a] * x[b];
  });
  for (const int at : diagonal_) A_[at] += mu;
  (void)sparse::ldl_factor(pattern_, symbolic_, A_.data(), work_, L_.data(), D_.data());  // A > 0: cannot fail
}

void NormalMatrix::solve(Eigen::VectorXd& y) {
  for (Eigen::Index i = 0; i < y.size(); ++i) permuted_[iperm_[i]] = y[i];
  sparse::ldl_solve(symbolic_, L_.data(), D_.data(), permuted_.data());
  for (Eigen::Index i = 0; i < y.size(); ++i) y[i] = permuted_[iperm_[i]];
}

// Coordinates of x that are not at a bound are free: x_free = -J_free^T y with y = (J_free J_free^T + mu 1)^-1 (e +
// J_fixed x_fixed). The others are fixed. Half the gradient with respect to them is mu (J^T y + x), because
// J x + e = mu y.
void BoundedStep::solve(const Eigen::SparseMatrix<double>& J, const Eigen::VectorXd& e, double mu,
                        const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, Eigen::VectorXd& x) {
  constexpr int kFullExchanges = 3;  // rounds without progress after which only one wrong bound is exchanged at a time
  constexpr int kMostRounds = 200;
  const Eigen::Index n = J.cols();
  std::vector<char> free(static_cast<std::size_t>(n), 1);
  std::vector<Eigen::Index> wrong;
  Eigen::VectorXd held = Eigen::VectorXd::Zero(n), y, gradient;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  int patience = kFullExchanges;
  for (int round = 0; round < kMostRounds; ++round) {
    normal_.factorize(J, free, mu);
    y = e + J * held;
    normal_.solve(y);
    gradient = J.transpose() * y;
    x = held;
    wrong.clear();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (free[i]) {
        x[i] = -gradient[i];
        if (x[i] < lower[i] || x[i] > upper[i]) wrong.push_back(i);
      } else {
        const double slope = gradient[i] + x[i];
        if (held[i] == upper[i] && held[i] == lower[i]) continue;
        if (held[i] == upper[i] ? slope > 0 : slope < 0) wrong.push_back(i);
      }
    }
    if (wrong.empty()) break;
    if (wrong.size() < fewest)
      fewest = wrong.size(), patience = kFullExchanges;
    else
      --patience;
    if (patience < 0) wrong = {wrong.back()};  // Murty's rule, with which the iteration terminates
    for (const Eigen::Index i : wrong) {
      if (free[i]) held[i] = x[i] < lower[i] ? lower[i] : upper[i];
      if (!free[i]) held[i] = 0;
      free[i] = !free[i];
    }
  }
  x = x.cwiseMax(lower).cwiseMin(upper);
}

}  // namespace manycontact::internal
