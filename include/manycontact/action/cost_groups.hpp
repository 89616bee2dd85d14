#pragma once
// Blocks of residuals that touch the same columns: their Gauss-Newton Hessians sum w Rx^T Arr Rx, ... are one product.

#include <vector>

#include "manycontact/action/cost_derivatives.hpp"

namespace manycontact {

struct CostDataResidual;

struct CostGroup {
  std::vector<int> xcols, ucols;
  struct Member {
    const CostDataResidual* cost;
    std::size_t index, block;  // of the cost in the stack, of the block in its residual
  };
  std::vector<Member> members;
  struct Run {
    int first, at, count;  // columns first, first + 1, ... are the group's at, at + 1, ...
  };
  std::vector<Run> xruns, uruns;
  std::size_t xx = 0, xu = 0, uu = 0;  // its blocks in the sparse matrices
};

struct CostGroups {
  /// Groups the blocks of the stack's costs, and plans the groups' blocks in out's sparse matrices.
  void lay_out(const std::vector<const CostDataResidual*>& costs, CostDerivatives& out);
  /// Adds weighted gradients and Hessians to out; of a terminal node those by x alone. weights: per cost of the stack,
  /// 0 where it is inactive.
  void add(const std::vector<double>& weights, bool terminal, CostDerivatives& out);

  std::vector<CostGroup> groups;

 private:
  int gather(const CostGroup& group, const std::vector<double>& weights, int nx, int nu, int ld);
  std::vector<double> L, R;  // scratch, row-major: rows [Rx Ru], and of each w Arr Rx, w Arr Ru, w Ar
  std::vector<double> H;     // scratch: L^T R; its last column is the gradient
};

}  // namespace manycontact
