#pragma once
// Factorizes a sparse symmetric matrix of dense blocks as S = L D L^T. D is diagonal with the given sign (+1 or -1) of
// each diagonal block. The factor exists in every order of elimination if S is quasi-definite (Vanderbei 1995):
// positive definite for sign +1, negative definite for sign -1.

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::lq {

class BlockCholesky {
 public:
  struct Vertex {
    int size;
    double sign;  // +1 or -1, the sign of this vertex's part of D
  };

  /// vertices: the diagonal blocks in the order of elimination. edges (u, v): nonzero blocks off the diagonal.
  void analyse(std::vector<Vertex> vertices, const std::vector<std::pair<int, int>>& edges);

  void set_zero();
  /// Adds M to S at row i of vertex u and column j of vertex v, and M^T at the transposed place. A symmetric M on the
  /// diagonal is added only once.
  void add(int u, int i, int v, int j, const Eigen::Ref<const Eigen::MatrixXd>& M);
  void add_diagonal(int v, double a) { columns_[v].diagonal.diagonal().array() += a; }  // adds a I to vertex v

  /// Adds sign * relative * (largest entry of the vertex's rows) to each vertex's diagonal, to make S quasi-definite.
  void add_proximal_term(double relative);

  /// Factorizes S. Returns -1, or the first vertex with a pivot of wrong sign, or one smaller than `least` times the
  /// diagonal entry from which the vertex's Cholesky factorization computes it.
  [[nodiscard]] int factorize(double least);
  void solve(Eigen::VectorXd& x) const;  // replaces x by S^-1 x, where x is ordered by vertex

  int size() const { return start_.empty() ? 0 : start_.back(); }
  int start(int v) const { return start_[v]; }
  int vertices() const { return static_cast<int>(vertices_.size()); }
  bool finite() const;

 private:
  struct Below {
    int vertex, row;  // the vertex of a block below the diagonal, and the first row of this block in the panel
  };
  struct Column {
    Eigen::MatrixXd diagonal;  // the diagonal block, of which only the lower triangle is used
    Eigen::MatrixXd panel;     // all blocks below the diagonal, stacked by rows
    std::vector<Below> below;  // the blocks of `panel`, by ascending vertex
  };
  Eigen::Ref<Eigen::MatrixXd> block(int u, int v);  // the block of rows u and columns v, u > v

  std::vector<Vertex> vertices_;
  std::vector<int> start_;
  std::vector<Column> columns_;
  Eigen::VectorXd largest_;  // workspace
};

double block_cholesky_flops(const std::vector<BlockCholesky::Vertex>& vertices,
                            const std::vector<std::pair<int, int>>& edges);

}  // namespace manycontact::lq
