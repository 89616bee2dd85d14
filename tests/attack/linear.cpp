#include "linear.hpp"

#include <algorithm>
#include <utility>

namespace manycontact::attack {

Column times(const Matrix& A, const Column& x) {
  Column y(A.rows, Quad(0));
  for (int j = 0; j < A.cols; ++j)
    for (int i = 0; i < A.rows; ++i) y[i] += A(i, j) * x[j];
  return y;
}

Column transposed_times(const Matrix& A, const Column& x) {
  Column y(A.cols, Quad(0));
  for (int j = 0; j < A.cols; ++j)
    for (int i = 0; i < A.rows; ++i) y[j] += A(i, j) * x[i];
  return y;
}

double largest(const Column& x) {
  Quad most = 0;
  for (Quad y : x) most = std::max(most, fabsq(y));
  return static_cast<double>(most);
}

namespace {

Matrix transposed(const Matrix& A) {
  Matrix B(A.cols, A.rows);
  for (int i = 0; i < A.rows; ++i)
    for (int j = 0; j < A.cols; ++j) B(j, i) = A(i, j);
  return B;
}

void reflect(const Column& u, Quad* x, int first) {
  Quad s = 0;
  for (std::size_t i = first; i < u.size(); ++i) s += u[i] * x[i];
  for (std::size_t i = first; i < u.size(); ++i) x[i] -= s * u[i];
}

}  // namespace

Qr::Qr(Matrix given, int steps, bool pivot) : A(std::move(given)), order(A.cols) {
  for (int j = 0; j < A.cols; ++j) order[j] = j;
  const auto size2 = [&](int j, int from) {
    Quad s = 0;
    for (int i = from; i < A.rows; ++i) s += A(i, j) * A(i, j);
    return s;
  };
  for (int k = 0; k < std::min({A.rows, A.cols, steps}); ++k) {
    int most = k;
    for (int j = k + 1; pivot && j < A.cols; ++j)
      if (size2(j, k) > size2(most, k)) most = j;
    if (most != k) {
      for (int i = 0; i < A.rows; ++i) std::swap(A(i, k), A(i, most));
      std::swap(order[k], order[most]);
    }
    const Quad size = sqrtq(size2(k, k));
    left.push_back(size);
    Column u(A.rows, Quad(0));
    if (size > 0) {
      for (int i = k; i < A.rows; ++i) u[i] = A(i, k);
      u[k] += u[k] > 0 ? size : -size;
      Quad s = 0;
      for (Quad x : u) s += x * x;
      for (Quad& x : u) x *= sqrtq(2 / s);
      for (int j = k; j < A.cols; ++j) reflect(u, &A(0, j), k);
    }
    mirrors.push_back(std::move(u));
  }
}

void Qr::apply_transposed(Column& x) const {
  for (std::size_t k = 0; k < mirrors.size(); ++k) reflect(mirrors[k], x.data(), static_cast<int>(k));
}
void Qr::apply(Column& x) const {
  for (std::size_t k = mirrors.size(); k-- > 0;) reflect(mirrors[k], x.data(), static_cast<int>(k));
}

Lu::Lu(Matrix given) : A(std::move(given)), order(A.rows) {
  const int n = A.rows;
  // Pivots are relative to the sizes of their own row and column, so that units may mix.
  std::vector<Quad> size(n, Quad(0));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) size[i] = std::max(size[i], fabsq(A(i, j)));
  for (int k = 0; k < n; ++k) order[k] = k;
  for (int k = 0; k < n; ++k) {
    int p = k;
    for (int i = k + 1; i < n; ++i)
      if (size[order[i]] > 0 && fabsq(A(i, k)) * size[order[p]] > fabsq(A(p, k)) * size[order[i]]) p = i;
    std::swap(order[k], order[p]);
    for (int j = 0; j < n; ++j) std::swap(A(k, j), A(p, j));
    if (!(fabsq(A(k, k)) > Quad(1e-26) * size[order[k]])) regular = false;
    if (!regular) return;
    for (int i = k + 1; i < n; ++i) {
      const Quad l = A(i, k) /= A(k, k);
      for (int j = k + 1; j < n; ++j) A(i, j) -= l * A(k, j);
    }
  }
}

Column Lu::solve(const Column& b) const {
  const int n = A.rows;
  Column x(n);
  for (int i = 0; i < n; ++i) {
    x[i] = b[order[i]];
    for (int j = 0; j < i; ++j) x[i] -= A(i, j) * x[j];
  }
  for (int i = n - 1; i >= 0; --i) {
    for (int j = i + 1; j < n; ++j) x[i] -= A(i, j) * x[j];
    x[i] /= A(i, i);
  }
  return x;
}

namespace {

// Returns C^T of J^T P = Q [C; 0].
Matrix rows_kept(const Qr& qr, int rank) {
  Matrix Ct(qr.A.cols, rank);
  for (int i = 0; i < rank; ++i)
    for (int j = i; j < qr.A.cols; ++j) Ct(j, i) = qr.A(i, j);
  return Ct;
}

Matrix null_space(const Qr& qr, int rank) {
  const int n = qr.A.rows;
  Matrix N(n, n - rank);
  for (int j = 0; j < n - rank; ++j) {
    Column e(n, Quad(0));
    e[rank + j] = 1;
    qr.apply(e);
    std::copy(e.begin(), e.end(), N.x.begin() + static_cast<std::ptrdiff_t>(j) * n);
  }
  return N;
}

Matrix reduced(const Matrix& M, const Matrix& N) {
  Matrix A(N.cols, N.cols);
  for (int j = 0; j < N.cols; ++j) {
    const Column n(N.x.begin() + static_cast<std::ptrdiff_t>(j) * N.rows,
                   N.x.begin() + static_cast<std::ptrdiff_t>(j + 1) * N.rows);
    const Column r = transposed_times(N, times(M, n));
    std::copy(r.begin(), r.end(), A.x.begin() + static_cast<std::ptrdiff_t>(j) * A.rows);
  }
  return A;
}

Matrix whole(const Matrix& M, const Matrix& J, Quad delta) {
  const int nv = M.rows, n = nv + J.rows;
  Matrix K(n, n);
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nv; ++i) K(i, j) = M(i, j);
    for (int i = 0; i < J.rows; ++i) K(nv + i, j) = K(j, nv + i) = J(i, j);
  }
  for (int i = nv; i < n; ++i) K(i, i) = -delta;
  return K;
}

Column stacked(const Column& x, const Column& y) {
  Column z = x;
  z.insert(z.end(), y.begin(), y.end());
  return z;
}

}  // namespace

SaddlePoint::SaddlePoint(Matrix M, Matrix J, Quad delta, int rank)
    : M_(std::move(M)),
      J_(std::move(J)),
      delta_(delta),
      rank_(delta > 0 ? J_.rows : rank),
      of_Jt_(transposed(J_), delta > 0 ? 0 : rank, true),
      of_C_(rows_kept(of_Jt_, delta > 0 ? 0 : rank), rank, false),
      lu_(Matrix()) {
  if (delta == 0) N_ = null_space(of_Jt_, rank);
  lu_ = Lu(delta > 0 ? whole(M_, J_, delta) : reduced(M_, N_));
}

// Solves T z = U^T P^T b; a = Q [z; 0].
Column SaddlePoint::least_motion(const Column& b) const {
  Column y(J_.rows), a(M_.rows, Quad(0));
  for (int i = 0; i < J_.rows; ++i) y[i] = b[of_Jt_.order[i]];
  of_C_.apply_transposed(y);
  for (int i = rank_ - 1; i >= 0; --i) {
    a[i] = y[i];
    for (int j = i + 1; j < rank_; ++j) a[i] -= of_C_.A(i, j) * a[j];
    a[i] /= of_C_.A(i, i);
  }
  of_Jt_.apply(a);
  return a;
}

// Solves T^T y = (Q^T g)(0:rank); f = P U [y; 0].
Column SaddlePoint::least_force(const Column& g) const {
  Column z = g, y(J_.rows, Quad(0)), f(J_.rows);
  of_Jt_.apply_transposed(z);
  for (int i = 0; i < rank_; ++i) {
    y[i] = z[i];
    for (int j = 0; j < i; ++j) y[i] -= of_C_.A(j, i) * y[j];
    y[i] /= of_C_.A(i, i);
  }
  of_C_.apply(y);
  for (int i = 0; i < J_.rows; ++i) f[of_Jt_.order[i]] = y[i];
  return f;
}

Column SaddlePoint::off_range(const Column& y) const {
  Column z(J_.rows), left(J_.rows);
  for (int i = 0; i < J_.rows; ++i) z[i] = y[of_Jt_.order[i]];
  of_C_.apply_transposed(z);
  std::fill(z.begin(), z.begin() + rank_, Quad(0));
  of_C_.apply(z);
  for (int i = 0; i < J_.rows; ++i) left[of_Jt_.order[i]] = z[i];
  return left;
}

// Returns a + N (N^T M N)^-1 N^T (b1 - M a).
Column SaddlePoint::within_constraints(Column a, const Column& b1) const {
  Column r = times(M_, a);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = b1[i] - r[i];
  const Column more = times(N_, lu_.solve(transposed_times(N_, r)));
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += more[i];
  return a;
}

void SaddlePoint::solve(const Column& b1, const Column& b2, Column& a, Column& f) const {
  if (delta_ > 0) {
    const Column x = lu_.solve(stacked(b1, b2));
    a.assign(x.begin(), x.begin() + M_.rows);
    f.assign(x.begin() + M_.rows, x.end());
    for (Quad& y : f) y = -y;
    return;
  }
  a = within_constraints(least_motion(b2), b1);
  Column g = times(M_, a);
  for (std::size_t i = 0; i < g.size(); ++i) g[i] -= b1[i];
  f = least_force(g);
}

Quad SaddlePoint::condition() const {
  const int nv = M_.rows, n = nv + J_.rows;
  const auto sum = [](const Column& x) {
    Quad s = 0;
    for (Quad y : x) s += fabsq(y);
    return s;
  };
  const Matrix K = whole(M_, J_, delta_);
  Quad norm = 0, inverse = 0;
  for (int j = 0; j < n; ++j) {
    Column b1(nv, Quad(0)), b2(J_.rows, Quad(0)), a, f;
    (j < nv ? b1[j] : b2[j - nv]) = 1;
    solve(b1, b2, a, f);
    inverse = std::max(inverse, sum(a) + sum(f));
    norm = std::max(norm, sum(Column(K.x.begin() + static_cast<std::ptrdiff_t>(j) * n,
                                     K.x.begin() + static_cast<std::ptrdiff_t>(j + 1) * n)));
  }
  return norm * inverse;
}

}  // namespace manycontact::attack
