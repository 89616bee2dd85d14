#pragma once

#include "manycontact/kkt/factor/factor.hpp"

namespace manycontact::internal {

/// Extracts M (nv x nv, both triangles) and J (nc x nv) from K, in the island's order.
inline void expand(const KktMatrix& K, Eigen::MatrixXd& M, Eigen::MatrixXd& J) {
  const KktPattern& p = *K.pattern;
  M.setZero(p.nv, p.nv);
  J.setZero(p.nc, p.nv);
  for (int j = 0; j < p.size(); ++j)
    for (int k = p.K.p[j]; k < p.K.p[j + 1]; ++k) {
      const auto [low, high] = std::minmax(p.perm[p.K.i[k]], p.perm[j]);
      if (high < p.nv)
        M(low, high) = M(high, low) = K.values[k];
      else if (low < p.nv)
        J(high - p.nv, low) = K.values[k];
    }
}

/// Copies x, in K's elimination order, to its parts a (nv) and y (nc), in the island's order. `join` does the reverse.
template <class X, class A, class Y>
void split(const KktPattern& p, const X& x, A&& a, Y&& y) {
  for (int k = 0; k < p.nv; ++k) a[k] = x[p.iperm[k]];
  for (int k = 0; k < p.nc; ++k) y[k] = x[p.iperm[p.nv + k]];
}
template <class X, class A, class Y>
void join(const KktPattern& p, const A& a, const Y& y, X&& x) {
  for (int k = 0; k < p.nv; ++k) x[p.iperm[k]] = a[k];
  for (int k = 0; k < p.nc; ++k) x[p.iperm[p.nv + k]] = y[k];
}

}  // namespace manycontact::internal
