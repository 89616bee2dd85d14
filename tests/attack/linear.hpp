#pragma once
// Dense linear algebra in quadruple precision, for the reference alone. [M J^T; J -delta I] is solved with a complete
// orthogonal decomposition of J^T at a given rank, so that one place decides the rank (reference.cpp).

#include <vector>

#include "quad.hpp"

namespace manycontact::attack {

using Column = std::vector<Quad>;

struct Matrix {
  int rows = 0, cols = 0;
  std::vector<Quad> x;  // by columns
  Matrix() = default;
  Matrix(int r, int c) : rows(r), cols(c), x(static_cast<std::size_t>(r) * c, Quad(0)) {}
  Quad& operator()(int i, int j) { return x[static_cast<std::size_t>(j) * rows + i]; }
  Quad operator()(int i, int j) const { return x[static_cast<std::size_t>(j) * rows + i]; }
};
Column times(const Matrix& A, const Column& x);             // A x
Column transposed_times(const Matrix& A, const Column& x);  // A^T x
double largest(const Column& x);

/// A P = Q R with Householder reflections, the column with the largest residual first.
struct Qr {
  Matrix A;                   // R above the diagonal
  std::vector<Column> mirrors;  // of length sqrt 2, or empty: nothing to reflect
  std::vector<int> order;     // columns of A in the order of R
  std::vector<Quad> left;     // |R_kk|: residual of the chosen column

  /// Makes at most `steps` steps; without `pivot` the columns keep their order.
  Qr(Matrix given, int steps, bool pivot);
  void apply_transposed(Column& x) const;  // Q^T x
  void apply(Column& x) const;             // Q x
};

/// P A = L U with partial pivoting.
struct Lu {
  Matrix A;
  std::vector<int> order;
  bool regular = true;  // whether no pivot is a rounding error of quadruple precision
  explicit Lu(Matrix given);
  Column solve(const Column& b) const;
};

class SaddlePoint {  // M a - J^T f = b1, J a + delta f = b2
 public:
  /// rank: that of J, used if delta is 0; the rest of J's decomposition is dropped.
  SaddlePoint(Matrix M, Matrix J, Quad delta, int rank);
  bool regular() const { return lu_.regular; }
  /// Finds the a of least M-norm among those of least |J a - b2|, and the f of least norm.
  void solve(const Column& b1, const Column& b2, Column& a, Column& f) const;
  Column least_force(const Column& g) const;   // f of least norm with J^T f = g
  Column least_motion(const Column& b) const;  // a of least norm among those of least |J a - b|
  Column off_range(const Column& y) const;     // y - J J^+ y
  Quad condition() const;                      // of K, or of its generalised inverse, 1-norm

 private:
  Column within_constraints(Column a, const Column& b1) const;
  Matrix M_, J_, N_;  // N: orthonormal basis of J's null space
  Quad delta_;
  int rank_;
  Qr of_Jt_, of_C_;  // J^T P = Q [C; 0], C^T = U T
  Lu lu_;            // factor of N^T M N, or of K with delta
};

}  // namespace manycontact::attack
