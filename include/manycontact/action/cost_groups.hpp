#pragma once
// Blocks of residuals that touch the same columns: their Gauss-Newton Hessians sum w Rx^T Arr Rx, ... are one product.

#include <vector>

#include "manycontact/action/cost_derivatives.hpp"
#include "manycontact/action/fwd.hpp"

namespace manycontact {

struct CostDataAbstract;

struct CostGroup {
  std::vector<int> xcols, ucols;
  struct Member {
    const CostDataAbstract* cost;
    std::size_t index, block;  // of the cost in the stack, of the block in its residual
  };
  std::vector<Member> members;
  struct Run {
    int first, at, count;  // columns first, first + 1, ... are the group's at, at + 1, ...
  };
  std::vector<Run> xruns, uruns;
  std::size_t xx = 0, xu = 0, uu = 0;  // its blocks in the sparse matrices
};

/// A row that depends on one coordinate alone.
struct CostSquare {
  const CostDataAbstract* cost;
  const RowMajorMatrix* J;  // of the block, one column; null where the row's is `constant`
  double constant;
  int at;           // the row in the block
  int index;        // of the cost in the stack
  int row, column;  // in the residual; in x or in u
  bool by_x;
  std::size_t entry;  // its block, then its entry, in the sparse matrix
};

/// A cost of a class of a user's own, whose derivatives are whole matrices.
struct OwnCost {
  const CostDataAbstract* cost;
  std::size_t index;               // of the cost in the stack
  std::size_t xx = 0, xu = 0, uu = 0;  // its blocks in the sparse matrices
};

struct CostGroups {
  /// Groups the blocks of the stack's costs, and lays out's sparse matrices out, of ndx and nu columns.
  void lay_out(const std::vector<const CostDataAbstract*>& costs, int ndx, int nu, CostDerivatives& out);
  /// Adds weighted gradients and Hessians to out; of a terminal node those by x alone. weights: per cost of the stack,
  /// 0 where it is inactive.
  void add(const std::vector<double>& weights, bool terminal, CostDerivatives& out);

  std::vector<CostGroup> groups;
  std::vector<CostSquare> squares;
  std::vector<OwnCost> own;

 private:
  void lay_out_own(int ndx, int nu, CostDerivatives& out);
  void add_own(const std::vector<double>& weights, bool terminal, CostDerivatives& out) const;
  void take_squares(const CostGroup& group);
  void add_squares(const std::vector<double>& weights, bool terminal, CostDerivatives& out) const;
  std::size_t most_ = 0, widest_ = 0;  // numbers of the largest group's rows; its columns
};

}  // namespace manycontact
