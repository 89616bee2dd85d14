#pragma once
// S = L D L^T of a sparse symmetric matrix of dense blocks, with D = +-I of signs given beforehand: Cholesky of each
// diagonal block or of its negative. It exists in every order when S is quasi-definite (Vanderbei 1995): the part with
// positive signs positive definite, the part with negative ones negative definite.

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "manycontact/abi.hpp"

namespace manycontact::lq {

class BlockCholesky {
 public:
  struct Vertex {
    int size;
    double sign;  // +1 or -1
  };

  /// Vertices in the order of elimination; edges (u, v): blocks off the diagonal that are not zero.
  void analyse(std::vector<Vertex> vertices, const std::vector<std::pair<int, int>>& edges);

  void set_zero();
  /// Adds M to S at row i of vertex u and column j of vertex v, and M^T at the mirrored place if that is another one
  /// (M on the diagonal is symmetric).
  void add(int u, int i, int v, int j, const Eigen::Ref<const Eigen::MatrixXd>& M);
  void add_diagonal(int v, double a) { columns_[v].diagonal.diagonal().array() += a; }  // a: to vertex v's diagonal

  /// Adds `relative` times the largest entry of each vertex's rows to its diagonal, by its sign: S is quasi-definite
  /// then if it was semidefinite.
  void add_proximal_term(double relative);

  /// The vertex whose pivots keep less than `least` of their terms (wrong sign included); -1 where all do.
  [[nodiscard]] int factorize(double least);
  void solve(Eigen::VectorXd& x) const;  // x <- S^-1 x, x by vertex

  int size() const { return start_.empty() ? 0 : start_.back(); }
  int start(int v) const { return start_[v]; }
  int vertices() const { return static_cast<int>(vertices_.size()); }
  bool finite() const;

 private:
  struct Below {
    int vertex, row;  // row: first row of the vertex in the panel
  };
  struct Column {
    Eigen::MatrixXd diagonal;  // lower triangle
    Eigen::MatrixXd panel;     // blocks below the diagonal, one under the other
    std::vector<Below> below;  // ascending
  };
  Eigen::Ref<Eigen::MatrixXd> block(int u, int v);  // u > v

  std::vector<Vertex> vertices_;
  std::vector<int> start_;
  std::vector<Column> columns_;
  Eigen::VectorXd largest_;  // scratch
};

/// Operations of factorize.
double block_cholesky_flops(const std::vector<BlockCholesky::Vertex>& vertices,
                            const std::vector<std::pair<int, int>>& edges);

}  // namespace manycontact::lq
