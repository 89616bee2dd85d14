#include "manycontact/kkt/bodies/ldl.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

HeldRows held_rows(const BodyPattern& s, const BodyLdl& d, int node) {
  HeldRows out;
  for (int k = s.own_first[s.hold[node]]; k < s.own_first[s.hold[node] + 1]; ++k)
    if (!d.dropped[s.own[k]]) out.row[out.count++] = s.own[k];
  return out;
}

// Computes the factors Q R of the rows that constrain a node, by Gram-Schmidt orthogonalisation.
bool factorize_hold(const BodySystem& system, int node, const int* row, int count, BodyHold& h) {
  h.rows = 0;
  if (system.delta > 0 || count == 0) return false;
  for (int k = 0; k < count; ++k) {
    Vec6<double> G = system.pattern->A[row[k]] == node ? system.GA.col(row[k]) : system.GB.col(row[k]);
    const double length = G.norm();
    for (int j = 0; j < k; ++j) {
      h.R(j, k) = h.Q.col(j).dot(G);
      G -= h.R(j, k) * h.Q.col(j);
    }
    h.R(k, k) = G.norm();
    if (!(h.R(k, k) > tolerance::kHeldApart * length)) return false;
    h.Q.col(k) = G / h.R(k, k);
  }
  h.rows = count;
  return true;
}

Vec6<double> solve_transposed(const BodyHold& h, Vec6<double> x) {
  for (int k = 0; k < h.rows; ++k) {
    for (int j = 0; j < k; ++j) x[k] -= h.R(j, k) * x[j];
    x[k] /= h.R(k, k);
  }
  return x;
}

Vec6<double> forces_of(const BodyHold& h, const Vec6<double>& f) {
  Vec6<double> y;
  y.head(h.rows) = h.Q.leftCols(h.rows).transpose() * f;
  for (int k = h.rows - 1; k >= 0; --k) {
    for (int j = k + 1; j < h.rows; ++j) y[k] -= h.R(k, j) * y[j];
    y[k] /= h.R(k, k);
  }
  return y;
}

}  // namespace manycontact
