#pragma once
// Groups of residual blocks with the same columns. One matrix product per group computes the sum of the Hessians w Rx^T
// Arr Rx, ... of its blocks.

#include <vector>

#include "manycontact/detail/action/cost_derivatives.hpp"
#include "manycontact/detail/action/fwd.hpp"

namespace manycontact {

struct CostDataAbstract;

/// Residual blocks of several costs whose Jacobians have the same columns.
struct CostGroup {
  std::vector<int> xcols, ucols;
  /// One block of the group.
  struct Member {
    const CostDataAbstract* cost;
    std::size_t index, block;  // index of the cost in the stack; number of the block in its residual
  };
  std::vector<Member> members;
  /// Consecutive columns of the group that are consecutive in x or u, too.
  struct Run {
    int first, at, count;  // columns first, first + 1, ... of x or u are columns at, at + 1, ... of the group
  };
  std::vector<Run> xruns, uruns;
  std::size_t xx = 0, xu = 0, uu = 0;  // numbers of the group's blocks in the sparse matrices Lxx, Lxu, Luu
};

/// A residual row that depends on one coordinate only: its Hessian is one diagonal number.
struct CostSquare {
  const CostDataAbstract* cost;
  const RowMajorMatrix* J;  // Jacobian of the row's block, one column; null: the derivative is `constant`
  double constant;
  int at;           // index of the row in its block
  int index;        // number of the cost in the stack
  int row, column;  // row: index in the residual; column: index in x or in u
  bool by_x;
  std::size_t entry;  // number of the row's block in the sparse matrix; after lay_out, index of its value
};

/// A cost of a user-defined class, whose derivatives are whole matrices.
struct OwnCost {
  const CostDataAbstract* cost;
  std::size_t index;                   // index of the cost in the stack
  std::size_t xx = 0, xu = 0, uu = 0;  // the cost's blocks in the sparse matrices
};

/// All groups of a stack of costs.
struct CostGroups {
  /// Groups the blocks of the stack's costs, and sets up the sparse matrices of out, for ndx and nu coordinates.
  void lay_out(const std::vector<const CostDataAbstract*>& costs, int ndx, int nu, CostDerivatives& out);
  /// Adds weighted gradients and Hessians to out; in a terminal node only those with respect to x. weights: one per
  /// cost of the stack, 0 if it is inactive.
  void add(const std::vector<double>& weights, bool terminal, CostDerivatives& out);

  std::vector<CostGroup> groups;
  std::vector<CostSquare> squares;
  std::vector<OwnCost> own;

 private:
  void lay_out_own(int ndx, int nu, CostDerivatives& out);
  void add_own(const std::vector<double>& weights, bool terminal, CostDerivatives& out) const;
  void take_squares(const CostGroup& group);
  void add_squares(const std::vector<double>& weights, bool terminal, CostDerivatives& out) const;
  std::size_t most_ = 0, widest_ = 0;  // largest number of entries of a group's rows, and of its columns
};

}  // namespace manycontact
