#include "manycontact/lq/riccati_step.hpp"

#include <algorithm>

#include "dense.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact::lq {

using sparse::panel_kernels;

namespace {

using Row = Eigen::Map<VectorXd>;

void grow(std::vector<double>& panel, std::ptrdiff_t size) {
  if (panel.size() < static_cast<std::size_t>(size)) panel.resize(static_cast<std::size_t>(size));
}

constexpr Index kTile = 8;  // size of transposed tiles, one cache line

void copy_rows(const Eigen::Ref<const MatrixXd>& A, double* out, Index ld) {
  const Index rows = A.rows(), cols = A.cols(), stride = A.outerStride();
  for (Index j = 0; j < cols; j += kTile)
    for (Index i = 0; i < rows; i += kTile) {
      const double* from = A.data() + j * stride + i;
      double* to = out + i * ld + j;
      if (i + kTile <= rows && j + kTile <= cols) {
        for (Index a = 0; a < kTile; ++a)
          for (Index b = 0; b < kTile; ++b) to[a * ld + b] = from[b * stride + a];
      } else {
        for (Index a = 0; a < std::min(kTile, rows - i); ++a)
          for (Index b = 0; b < std::min(kTile, cols - j); ++b) to[a * ld + b] = from[b * stride + a];
      }
    }
}

void mirror(MatrixXd& A) {
  const Index n = A.rows();
  for (Index j = 0; j < n; j += kTile)
    for (Index i = j; i < n; i += kTile) {
      double *from = A.data() + j * n + i, *to = A.data() + i * n + j;
      if (i > j && i + kTile <= n) {
        for (Index a = 0; a < kTile; ++a)
          for (Index b = 0; b < kTile; ++b) to[a * n + b] = from[b * n + a];
      } else {
        for (Index b = 0; b < std::min(kTile, n - j); ++b)
          for (Index a = i == j ? b + 1 : 0; a < std::min(kTile, n - i); ++a) to[a * n + b] = from[b * n + a];
      }
    }
}

}  // namespace

void RiccatiStep::lay_out(int nv, int nx) {
  const bool same = nv == nv_ && nx == nx_;
  nv_ = nv;
  nx_ = nx;
  u_ = sparse::padded(nv);
  ld_ = u_ + sparse::padded(nx);
  if (same) return;
  const std::ptrdiff_t ld = ld_, rows = nx;
  F_.assign(static_cast<std::size_t>(rows * ld + kTile), 0);  // entries between the columns of v and x stay zero
  grow(PF_, sparse::padded(nx) * ld);
  grow(H_, ld * ld);
  grow(qs_, ld);
  grow(K_, u_ * ld);
  grow(Z_, std::max(nx, u_) * ld);
  grow(halves_, rows * (nx / 2) + 4 * (nx / 2) * static_cast<std::ptrdiff_t>(nx / 2));
}

void RiccatiStep::set_A(ConstMatrix A, int row, int column) { copy_rows(A, this->row(row) + u_ + column, ld_); }
void RiccatiStep::set_B(ConstMatrix B, int row, int column) { copy_rows(B, this->row(row) + column, ld_); }

void RiccatiStep::set_zero() { std::fill_n(H_.data(), static_cast<std::ptrdiff_t>(ld_) * ld_, 0.0); }

void RiccatiStep::multiply(ConstMatrix P) {
  const int cols = u_ + nx_;
  panel_kernels().product(P.data(), static_cast<int>(P.outerStride()), F_.data(), nx_, nx_, cols, ld_, PF_.data());
  panel_kernels().upper_product(F_.data(), PF_.data(), nx_, cols, ld_, H_.data());
}

// Computes H = F^T P F from W = [G; 1]^T P [G; 1], Y = J^T [P_yy G + P_yz], and E = [0 1 0] with columns for v, y, z,
// where the state x is [y; z]:
//
//     F^T P F = F_z^T (W F_z + Y^T E) + E^T Y F_z + E^T J^T P_yy J E
void RiccatiStep::multiply(ConstMatrix P, const SymplecticStructure& steps) {
  const int half = nx_ / 2, cols = u_ + nx_;
  double* at = halves_.data();
  const auto take = [&](Index rows) {
    const Eigen::Map<MatrixXd> M(at, rows, half);
    at += rows * half;
    return M;
  };
  auto U = take(nx_), W = take(half), Y = take(half), PJ = take(half), JPJ = take(half);
  U = P.rightCols(half);  // P [G; 1]
  add_XD(U, 1, P.leftCols(half), steps.G);
  W = U.bottomRows(half);
  add_DtX(W, 1, steps.G, U.topRows(half));
  add_DtX(Y, 0, steps.J, U.topRows(half));
  add_XD(PJ, 0, P.topLeftCorner(half, half), steps.J);
  add_DtX(JPJ, 0, steps.J, PJ);

  double *F = F_.data(), *PF = PF_.data(), *H = H_.data(), *YF = Z_.data();
  panel_kernels().product(W.data(), half, F, half, half, cols, ld_, PF);
  Matrix(PF + u_, half, half, Eigen::OuterStride<>(ld_)) += Y;  // row-major: adds Y^T E
  panel_kernels().upper_product(F, PF, half, cols, ld_, H);
  panel_kernels().product(Y.data(), half, F + u_, half, half, nx_, ld_, YF);
  Matrix Hxx = Qxx();
  for (Index i = 0; i < half; ++i) {
    Hxx.col(i).tail(nx_ - i) += Row(YF + i * ld_ + i, nx_ - i);
    Hxx.col(i).segment(i, half - i) += JPJ.col(i).tail(half - i);
  }
}

void RiccatiStep::multiply(ConstMatrix P, const std::vector<Member>& members) {
  if (members.size() == 1) return multiply(P);
  const std::ptrdiff_t ld = ld_;
  double *PF = PF_.data(), *Z = Z_.data();
  std::fill_n(PF, nx_ * ld, 0.0);
  set_zero();
  // calls use(first column, number of columns) for the pieces of the member
  const auto each_piece = [&](const Member& m, auto&& use) {
    for (const Piece& a : m.v) use(a.to, a.size);
    use(u_ + m.x, m.nx);
  };
  for (const Member& m : members)
    each_piece(m, [&](int first, int size) {  // P F
      if (size == 0) return;
      panel_kernels().product(P.data() + m.x * P.outerStride(), static_cast<int>(P.outerStride()), row(m.x) + first,
                              m.nx, nx_, size, ld_, Z);
      Matrix(PF + first, size, nx_, Eigen::OuterStride<>(ld)) += Matrix(Z, size, nx_, Eigen::OuterStride<>(ld));
    });
  for (const Member& m : members)
    each_piece(m, [&](int first, int size) {  // upper triangle of F^T P F
      if (size == 0) return;
      const int from = first / 8 * 8, cols = u_ + nx_ - from;
      panel_kernels().product(row(m.x) + first, ld_, PF + m.x * ld + from, m.nx, size, cols, ld_, Z);
      Matrix(H_.data() + first * ld + from, cols, size, Eigen::OuterStride<>(ld)) +=
          Matrix(Z, cols, size, Eigen::OuterStride<>(ld));
    });
}

void RiccatiStep::multiply_vector(const VectorXd& t, const SymplecticStructure* steps, Eigen::Ref<VectorXd> qv,
                                  Eigen::Ref<VectorXd> qx) {
  const int half = nx_ / 2, cols = u_ + nx_, rows = steps ? half : nx_;
  const double* of_rows = t.data();
  if (steps) {  // F_z^T (G^T t_y + t_z) + E^T J^T t_y
    j_ = t.head(half);
    g_ = t.head(half);
    multiply_Dt(steps->J, j_);
    multiply_Dt(steps->G, g_);
    g_ += t.tail(half);
    of_rows = g_.data();
  }
  panel_kernels().product(of_rows, 1, F_.data(), rows, 1, cols, ld_, qs_.data());
  qv = Row(qs_.data(), nv_);
  qx = Row(qs_.data() + u_, nx_);
  if (steps) qx.head(half) += j_;
}

bool RiccatiStep::eliminate(MatrixXd& L, double least) {
  if (nv_ == 0) return true;
  L = Qvv();
  if (!cholesky(L, least)) return false;
  Kt() = Qxv();
  panel_kernels().lower_solve(L.data(), nv_, nv_, K_.data(), nx_, ld_);
  panel_kernels().upper_solve(L.data(), nv_, nv_, K_.data(), nx_, ld_);
  return true;
}

void RiccatiStep::value(MatrixXd& P) {
  const Matrix Q = Qxx();
  if (nv_ > 0) panel_kernels().upper_product(H_.data() + u_, K_.data(), nv_, nx_, ld_, PF_.data());
  for (Index i = 0; i < nx_; ++i) {
    auto column = P.col(i).tail(nx_ - i);
    column = Q.col(i).tail(nx_ - i);
    if (nv_ > 0) column -= Row(PF_.data() + i * ld_ + i, nx_ - i);
  }
  mirror(P);
}

}  // namespace manycontact::lq
