#pragma once
// Limited-memory BFGS about a given inverse Hessian H0: the product r = H g by two loops over the last pairs of steps s
// and changes y of the gradient (Nocedal & Wright, Numerical Optimization, algorithm 7.4),
//
//     q = g;     a_i = s_i^T q / s_i^T y_i,   q <- q - a_i y_i      newest pair first
//     r = H0 q;  b_i = y_i^T r / s_i^T y_i,   r <- r + (a_i - b_i) s_i    oldest pair first
//
// H is positive definite as H0 is, since pairs without positive curvature are not taken.

#include <Eigen/Core>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact {

class LimitedBfgs {  // inverse Hessians learnt from gradients
 public:
  using Vectors = std::vector<Eigen::VectorXd>;  // a number for each variable, by node

  /// most: pairs that are kept, > 0.
  explicit LimitedBfgs(std::size_t most = 20) : most_(most) {}

  /// Takes the memory of vectors of these sizes.
  void reserve(const Vectors& sizes);
  void forget() { count_ = 0; }
  /// s = step * direction, y = g_next - g. Without positive curvature nothing is added.
  void add(double step, const Vectors& direction, const Vectors& g, const Vectors& g_next);
  /// The first loop: q, which is g before. Then H0 is the caller's to apply, and `finish` the second loop on r.
  void begin(Vectors& q);
  void finish(Vectors& r) const;

  std::size_t pairs() const { return count_; }

 private:
  struct Pair {
    Vectors s, y;
    double curvature = 0, a = 0;  // s^T y; of the first loop
  };
  Pair& newest(std::size_t i) { return pairs_[(next_ + pairs_.size() - 1 - i) % pairs_.size()]; }
  const Pair& newest(std::size_t i) const { return pairs_[(next_ + pairs_.size() - 1 - i) % pairs_.size()]; }
  std::size_t most_, count_ = 0, next_ = 0;
  std::vector<Pair> pairs_;
};

/// Sum over the nodes of a_t^T b_t.
double dot(const std::vector<Eigen::VectorXd>& a, const std::vector<Eigen::VectorXd>& b);

}  // namespace manycontact
