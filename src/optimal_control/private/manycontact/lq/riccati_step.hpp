#pragma once
// One step of the Riccati recursion on dense matrices. v: controls, x: states, P+: P of the next knot, t = p+ + P+ f.
//
//     [ Qvv  Qvx ]   [ R  S^T ]                                [ qv ]
//     [ Qxv  Qxx ] = [ S  Q   ] + F^T P+ F,    F = [B  A],     [ qx ] += F^T t
//
//     K = Qvv^-1 Qvx by Qvv = L L^T,    P = Qxx - Qxv K
//
// H is the matrix on the left. F and H are row-major. They have columns of v, then of x, both beginning at multiples of
// eight (sparse/panel_kernels.hpp). Only the upper triangle of H is computed, which in column-major order is the lower.

#include "manycontact/lq/plan.hpp"

namespace manycontact::lq {

class RiccatiStep {
 public:
  using Matrix = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  using ConstMatrix = const Eigen::Ref<const Eigen::MatrixXd>&;

  /// Resizes the workspace for nv columns of v and nx of x. Allocates only if the workspace was smaller before.
  void lay_out(int nv, int nx);

  /// Copy A or B into F = [B A], from the given row and column on. With SymplecticStructure, only their lower halves.
  void set_A(ConstMatrix A, int row = 0, int column = 0);
  void set_B(ConstMatrix B, int row = 0, int column = 0);
  /// Returns row i of F. It has nv numbers of B, and from x_start() on nx numbers of A.
  double* row(int i) { return F_.data() + static_cast<std::ptrdiff_t>(i) * ld_; }
  int x_start() const { return u_; }

  void multiply(ConstMatrix P);  // H = F^T P F
  /// Computes H in half the operations for the structure of `steps`. F contains the lower halves of A and B.
  void multiply(ConstMatrix P, const SymplecticStructure& steps);
  /// Computes H of a cluster of several groups (members), whose rows of F have nonzeros only in their own columns.
  void multiply(ConstMatrix P, const std::vector<Member>& members);
  void set_zero();  // sets H = 0 in a terminal knot

  /// Return the blocks of H. Only the lower triangles of Qvv and Qxx are set.
  Matrix Qvv() { return {H_.data(), nv_, nv_, Eigen::OuterStride<>(ld_)}; }
  Matrix Qxv() { return {H_.data() + u_, nx_, nv_, Eigen::OuterStride<>(ld_)}; }
  Matrix Qxx() { return {H_.data() + static_cast<std::ptrdiff_t>(u_) * ld_ + u_, nx_, nx_, Eigen::OuterStride<>(ld_)}; }

  /// Computes qv = B^T t and qx = A^T t from F = [B A]. steps: as in the last call of multiply.
  void multiply_vector(const Eigen::VectorXd& t, const SymplecticStructure* steps, Eigen::Ref<Eigen::VectorXd> qv,
                       Eigen::Ref<Eigen::VectorXd> qx);

  /// Computes L L^T = Qvv and K = Qvv^-1 Qvx. Returns false if a pivot is below `least` times its diagonal entry.
  [[nodiscard]] bool eliminate(Eigen::MatrixXd& L, double least);
  /// Returns K^T (nx x nv), which eliminate computes or the caller sets.
  Matrix Kt() { return {K_.data(), nx_, nv_, Eigen::OuterStride<>(ld_)}; }
  void value(Eigen::MatrixXd& P);  // computes both triangles of P = Qxx - Qxv K

 private:
  int nv_ = 0, nx_ = 0, u_ = 0, ld_ = 0;  // u_: first column of x; ld_: allocated columns of a row
  std::vector<double> F_, PF_, H_, K_;    // row-major matrices of nx, nx, u_ + nx and nv rows
  std::vector<double> Z_, qs_, halves_;   // workspace
  Eigen::VectorXd g_, j_;
};

}  // namespace manycontact::lq
