#pragma once
// Limited-memory BFGS, an estimate H of the inverse Hessian, from a given initial inverse Hessian H0. The product r = H
// g of the gradient g takes two loops over the last pairs of steps s_i and gradient changes y_i (Nocedal & Wright,
// Numerical Optimization, algorithm 7.4),
//
//     q = g;     a_i = s_i^T q / s_i^T y_i,   q <- q - a_i y_i      newest pair first
//     r = H0 q;  b_i = y_i^T r / s_i^T y_i,   r <- r + (a_i - b_i) s_i    oldest pair first
//
// H is positive definite if H0 is, since only pairs with positive curvature s^T y are stored.

#include <Eigen/Core>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact {

class LimitedBfgs {  // An inverse Hessian H estimated from gradients.
 public:
  using Vectors = std::vector<Eigen::VectorXd>;  // one vector per node

  explicit LimitedBfgs(std::size_t most = 20) : most_(most) {}  // most: largest number of pairs, above 0

  void reserve(const Vectors& sizes);  // allocates the memory for vectors of these sizes
  void forget() { count_ = 0; }        // removes all pairs
  /// Adds the pair s = step * direction, y = g_next - g. Pairs without positive curvature s^T y are not added.
  void add(double step, const Vectors& direction, const Vectors& g, const Vectors& g_next);

  /// begin runs the first loop, from q = g. The caller then applies H0, and finish runs the second loop on r = H0 q.
  void begin(Vectors& q);
  void finish(Vectors& r) const;

  std::size_t pairs() const { return count_; }  // the number of stored pairs

 private:
  struct Pair {
    Vectors s, y;
    double curvature = 0, a = 0;  // s^T y; coefficient a_i of the first loop
  };
  Pair& newest(std::size_t i) { return pairs_[(next_ + pairs_.size() - 1 - i) % pairs_.size()]; }
  const Pair& newest(std::size_t i) const { return pairs_[(next_ + pairs_.size() - 1 - i) % pairs_.size()]; }
  std::size_t most_, count_ = 0, next_ = 0;
  std::vector<Pair> pairs_;
};

/// Returns the sum of a_t^T b_t over the nodes t.
double dot(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b);

}  // namespace manycontact
