#pragma once
// Loops over the pieces of a group's vectors, which belong to one block or one coupling each. f is called with the
// first index in the group's vector, the first index in the knot's vector, and the size.

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

template <class F>
void for_each_x(const Problem& problem, const Layout& layout, const Group& g, F&& f) {
  Eigen::Index at = 0;
  for (int i : g.blocks) {
    f(at, layout.x[i], problem.nx[i]);
    at += problem.nx[i];
  }
}

/// Calls f(first index in v_g, is_u, first index in the knot's u or w, size) for each piece, which is of u if is_u,
/// else of w.
template <class F>
void for_each_v(const Problem& problem, const Layout& layout, int k, const Group& g, F&& f) {
  Eigen::Index at = 0;
  if (k < problem.horizon())
    for (int i : g.blocks) {
      f(at, true, layout.u[i], problem.nu[i]);
      at += problem.nu[i];
    }
  for (int b : g.couplings) {
    const int size = problem.knots[k].couplings[b].size;
    f(at, false, layout.w[k][b], size);
    at += size;
  }
}

template <class F>
void for_each_row(const Problem& problem, const Layout& layout, int k, const Group& g, F&& f) {
  Eigen::Index at = 0;
  for (int b : g.couplings) {
    const int rows = problem.knots[k].couplings[b].rows;
    f(at, layout.rows[k][b], rows);
    at += rows;
  }
}

}  // namespace manycontact::lq
