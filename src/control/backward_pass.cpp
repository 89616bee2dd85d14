// The Riccati recursion of SolverDDP, on row-major panels F = [fu fx].

#include <algorithm>
#include <typeinfo>

#include "manycontact/control/ddp.hpp"
#include "manycontact/control/euler.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "wide_joints.hpp"

namespace manycontact {

namespace {

using sparse::panel_kernels;
using Index = Eigen::Index;

void grow(std::vector<double>& panel, std::size_t size) {
  if (panel.size() < size) panel.resize(size);
}

// out, row-major, = A.
template <class Matrix>
void copy_rows(const Matrix& A, double* out, Index ld) {
  constexpr Index kTile = 8;
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

// The upper triangle from the lower one.
void mirror(Eigen::MatrixXd& A) {
  constexpr Index kTile = 8;
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

using Sparse = Eigen::SparseMatrix<double>;

// The upper triangle by rows from `at` on += weight A, for a symmetric A; where it is not, all of its transpose.
void add_by_rows(const Sparse& A, bool symmetric, double weight, double* at, Index ld) {
  for (Index j = 0; j < A.outerSize(); ++j)
    for (Sparse::InnerIterator it(A, j); it; ++it)
      if (!symmetric || it.row() >= j) at[j * ld + it.row()] += weight * it.value();
}
void add_by_rows(const Eigen::MatrixXd& A, bool symmetric, double* at, Index ld) {
  using Row = Eigen::Map<Eigen::VectorXd>;
  for (Index j = 0; j < A.cols(); ++j) {
    const Index first = symmetric ? j : 0;
    Row(at + j * ld + first, A.rows() - first) += A.col(j).tail(A.rows() - first);
  }
}

const IntegratedActionDataEuler* without_matrices(const ActionDataAbstract& data) {
  return data.has_matrices() ? nullptr : dynamic_cast<const IntegratedActionDataEuler*>(&data);
}

// Of the lower triangle and v: finite and below 1e30.
bool is_sound(const Eigen::MatrixXd& V, const Eigen::VectorXd& v) {
  for (Index j = 0; j < V.cols(); ++j)
    if (!(std::abs(v[j]) + V.col(j).tail(V.rows() - j).lpNorm<1>() < 1e30)) return false;
  return true;
}

}  // namespace

void SolverDDP::backwardPass() {
  const ActionDataAbstract& terminal = *problem_->get_terminalData();
  const std::size_t T = problem_->get_T();
  sound_ = true;
  Eigen::MatrixXd& Vxx = value(T);
  if (const auto* euler = without_matrices(terminal)) {
    Vxx.setZero();
    add_by_rows(euler->differential->Lxx_sparse(), false, 1, Vxx.data(), Vxx.cols());
  } else {
    Vxx = terminal.Lxx;
  }
  Vx_[T] = terminal.Lx;
  Vxx.diagonal().array() += preg_;
  addGap(T);
  for (std::size_t t = problem_->get_T(); t-- > 0;) {
    const auto& model = problem_->get_runningModels()[t];
    computeActionValueFunction(t, model, problem_->get_runningDatas()[t]);
    computeGains(t);
    if (!sound_) return;
    computeValueFunction(t, model);
    if (!is_sound(value(t), Vx_[t])) {
      sound_ = false;
      return;
    }
  }
}

// Vx += Vxx fs
void SolverDDP::addGap(std::size_t t) {
  if (is_feasible_) return;
  Vxx_fs_[t].noalias() = value(t) * fs_[t];
  Vx_[t] += Vxx_fs_[t];
}

void SolverDDP::layOutPanels(Index nu) {
  const Index ndx = problem_->get_ndx();
  if (panels_.u == sparse::padded(nu) && panels_.x == ndx) return;
  panels_.u = sparse::padded(nu);
  panels_.x = static_cast<int>(ndx);
  panels_.ld = panels_.u + sparse::padded(ndx);
  const std::size_t ld = panels_.ld, rows = ndx;
  panels_.F.assign(rows * ld, 0);  // the columns between u and x stay zero
  grow(panels_.VF, rows * ld);
  grow(panels_.YF, rows * ld);
  grow(panels_.H, ld * ld);
  grow(panels_.Fv, ld);
  grow(panels_.K, static_cast<std::size_t>(panels_.u) * ld);
  grow(panels_.QuxK, static_cast<std::size_t>(sparse::padded(ndx)) * ld);
}

// Fv = F^T v and H = F^T V F, of which the upper triangle.
void SolverDDP::multiplyDense(const ActionDataAbstract& data, const Eigen::MatrixXd& V, const Eigen::VectorXd& v) {
  const int n = panels_.x, ld = panels_.ld, cols = panels_.u + n;
  copy_rows(data.Fu, panels_.F.data(), ld);
  copy_rows(data.Fx, panels_.F.data() + panels_.u, ld);
  panel_kernels().product(V.data(), n, panels_.F.data(), n, n, cols, ld, panels_.VF.data());
  panel_kernels().product(v.data(), 1, panels_.F.data(), n, 1, cols, ld, panels_.Fv.data());
  panel_kernels().upper_product(panels_.F.data(), panels_.VF.data(), n, cols, ld, panels_.H.data());
}

// Symplectic Euler steps q by the new velocity: with B = dv'/d[u x], the lower half of F, and E = [0 I 0] (dq of x),
//
//     F = G B + [J1; 0] E,    G = [h J2; I],    W = G^T V G,    Y = G^T V [J1; 0]
//     F^T V F = B^T (W B + Y E) + E^T Y^T B + E^T J1^T Vqq J1 E,    F^T v = B^T G^T v + E^T J1^T vq
//
// which takes half the operations.
void SolverDDP::multiplyEuler(const IntegratedActionDataEuler& data, const Eigen::MatrixXd& V,
                              const Eigen::VectorXd& v) {
  const double h = data.step;
  const Index n = panels_.x / 2, ld = panels_.ld;
  const int nv = static_cast<int>(n), cols = panels_.u + panels_.x;
  Eigen::MatrixXd &U = panels_.U, &W = panels_.W, &Y = panels_.Y, &A = panels_.A;
  Eigen::VectorXd &g = panels_.g, &j1v = panels_.j1v;  // G^T v, J1^T vq
  U = h * V.leftCols(n) + V.rightCols(n);              // V G
  A = V.topLeftCorner(n, n);
  internal::each_wide_joint(data, [&](Index q, auto size, const auto& J1, const auto& J2) {
    constexpr int k = size.value;
    U.middleCols<k>(q) = V.middleCols<k>(q).lazyProduct((h * J2).eval()) + V.middleCols<k>(n + q);
    A.middleCols<k>(q) = V.block(0, q, n, k).lazyProduct(J1);
  });
  W = h * U.topRows(n) + U.bottomRows(n);
  Y = U.topRows(n);  // transposed, as the kernels read it by rows
  g = h * v.head(n) + v.tail(n);
  j1v = v.head(n);
  internal::each_wide_joint(data, [&](Index q, auto size, const auto& J1, const auto& J2) {
    constexpr int k = size.value;
    const auto transformed = [](const auto& J, const auto& x) { return (J.transpose() * x).eval(); };
    for (Index j = 0; j < n; ++j) {
      W.col(j).segment<k>(q) = h * transformed(J2, U.col(j).segment<k>(q)) + U.col(j).segment<k>(n + q);
      Y.col(j).segment<k>(q) = transformed(J1, U.col(j).segment<k>(q));
      A.col(j).segment<k>(q) = transformed(J1, A.col(j).segment<k>(q));
    }
    g.segment<k>(q) = h * transformed(J2, v.segment<k>(q)) + v.segment<k>(n + q);
    j1v.segment<k>(q) = transformed(J1, v.segment<k>(q));
  });
  double *F = panels_.F.data(), *VF = panels_.VF.data(), *H = panels_.H.data(), *YF = panels_.YF.data();
  if (data.has_matrices()) {
    copy_rows(data.Fu.bottomRows(n), F, ld);
    copy_rows(data.Fx.bottomRows(n), F + panels_.u, ld);
  } else {
    const PanelView& a = data.panel();
    for (Index i = 0; i < n; ++i) {
      double *row = F + i * ld, *x = row + panels_.u;
      const double *ax = a.data() + i * a.outerStride(), *au = ax + panels_.x;
      for (Index j = 0; j < panels_.x; ++j) x[j] = h * ax[j];
      for (Index j = 0; j < a.cols() - panels_.x; ++j) row[j] = h * au[j];
      x[n + i] += 1;
    }
  }
  panel_kernels().product(W.data(), nv, F, nv, nv, cols, panels_.ld, VF);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) VF[i * ld + panels_.u + j] += Y(j, i);
  panel_kernels().upper_product(F, VF, nv, cols, panels_.ld, H);
  panel_kernels().product(g.data(), 1, F, nv, 1, cols, panels_.ld, panels_.Fv.data());
  for (Index i = 0; i < n; ++i) panels_.Fv[panels_.u + i] += j1v[i];
  panel_kernels().product(Y.data(), nv, F + panels_.u, nv, nv, panels_.x, panels_.ld, YF);
  for (Index i = 0; i < n; ++i) {
    double* row = H + (panels_.u + i) * ld + panels_.u;
    for (Index j = i; j < panels_.x; ++j) row[j] += YF[i * ld + j];
    for (Index j = i; j < n; ++j) row[j] += A(j, i);
  }
}

// H += Lxx, Lxu, Luu
void SolverDDP::addHessian(const ActionDataAbstract& data) {
  double *H = panels_.H.data(), *ux = H + panels_.u, *xx = ux + static_cast<Index>(panels_.u) * panels_.ld;
  if (const auto* euler = without_matrices(data)) {
    const DifferentialActionDataAbstract& cost = *euler->differential;
    add_by_rows(cost.Luu_sparse(), true, euler->step, H, panels_.ld);
    add_by_rows(cost.Lxu_sparse(), false, euler->step, ux, panels_.ld);
    add_by_rows(cost.Lxx_sparse(), true, euler->step, xx, panels_.ld);
  } else {
    add_by_rows(data.Luu, true, H, panels_.ld);
    add_by_rows(data.Lxu, false, ux, panels_.ld);
    add_by_rows(data.Lxx, true, xx, panels_.ld);
  }
}

void SolverDDP::computeActionValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model,
                                           const std::shared_ptr<ActionDataAbstract>& data) {
  require(t < problem_->get_T(), "SolverDDP::computeActionValueFunction", "there is no such node");
  const Index nu = model->get_nu(), ndx = problem_->get_ndx();
  panel_node_ = kNoNode;
  layOutPanels(nu);
  const ActionModelAbstract& m = *model;
  const auto* euler = typeid(m) == typeid(IntegratedActionModelEuler)  // derived ones may give other derivatives
                          ? dynamic_cast<const IntegratedActionDataEuler*>(data.get())
                          : without_matrices(*data);
  if (euler && euler->joints_are_known)
    multiplyEuler(*euler, value(t + 1), Vx_[t + 1]);
  else
    multiplyDense(*data, value(t + 1), Vx_[t + 1]);
  addHessian(*data);
  double* H = panels_.H.data();
  const Index ld = panels_.ld, u = panels_.u;
  for (Index a = 0; a < nu; ++a) H[a * ld + a] += preg_;
  using Row = Eigen::Map<const Eigen::VectorXd>;
  Qx_[t] = data->Lx + Row(panels_.Fv.data() + u, ndx);
  Qu_[t] = data->Lu + Row(panels_.Fv.data(), nu);
  panel_node_ = t;
  if (!keeps_values_) return;
  for (Index i = 0; i < ndx; ++i) Qxx_[t].col(i).tail(ndx - i) = Row(H + (u + i) * ld + u + i, ndx - i);
  for (Index a = 0; a < nu; ++a) {
    Quu_[t].col(a).tail(nu - a) = Row(H + a * ld + a, nu - a);
    Qxu_[t].col(a) = Row(H + a * ld + u, ndx);
  }
  mirror(Qxx_[t]);
  mirror(Quu_[t]);
}

// The lower triangle of Quu: the upper one by rows.
SolverDDP::QuuView SolverDDP::currentQuu(std::size_t t) const {
  const Index nu = Qu_[t].size();
  return QuuView(panels_.H.data(), nu, nu, Eigen::OuterStride<>(panels_.ld));
}

void SolverDDP::computeGains(std::size_t t) {
  require(t == panel_node_, "SolverDDP::computeGains", "computeActionValueFunction of this node is expected first");
  const int nu = static_cast<int>(problem_->get_runningModels()[t]->get_nu()), ndx = panels_.x, ld = panels_.ld;
  if (nu == 0) return;
  Quu_llt_[t].compute(currentQuu(t));
  if (Quu_llt_[t].info() != Eigen::Success) {
    sound_ = false;
    return;
  }
  const double *L = Quu_llt_[t].matrixLLT().data(), *Qux = panels_.H.data() + panels_.u;
  double* K = panels_.K.data();
  for (int a = 0; a < nu; ++a) std::copy_n(Qux + a * ld, ndx, K + a * ld);
  panel_kernels().lower_solve(L, nu, nu, K, ndx, ld);
  panel_kernels().upper_solve(L, nu, nu, K, ndx, ld);
  for (int a = 0; a < nu; ++a) std::copy_n(K + a * ld, ndx, K_[t].row(a).data());
  k_[t] = Qu_[t];
  Quu_llt_[t].solveInPlace(k_[t]);
}

void SolverDDP::computeValueFunction(std::size_t t, const std::shared_ptr<ActionModelAbstract>& model) {
  require(t == panel_node_, "SolverDDP::computeValueFunction",
          "computeActionValueFunction of this node is expected first");
  const int nu = static_cast<int>(model->get_nu()), ndx = panels_.x, ld = panels_.ld;
  const double *Qux = panels_.H.data() + panels_.u, *Qxx = Qux + static_cast<Index>(panels_.u) * ld;
  using Row = Eigen::Map<const Eigen::VectorXd>;
  Eigen::MatrixXd& Vxx = value(t);
  Vx_[t] = Qx_[t];
  if (nu > 0) {
    Quuk_[t].noalias() = currentQuu(t).selfadjointView<Eigen::Lower>() * k_[t];
    Vx_[t].noalias() -= K_[t].transpose() * Qu_[t];
    for (int a = 0; a < nu; ++a) std::copy_n(K_[t].row(a).data(), ndx, panels_.K.data() + a * ld);
    panel_kernels().upper_product(Qux, panels_.K.data(), nu, ndx, ld, panels_.QuxK.data());
  }
  for (int i = 0; i < ndx; ++i) {
    auto column = Vxx.col(i).tail(ndx - i);
    column = Row(Qxx + i * ld + i, ndx - i);
    if (nu > 0) column -= Row(panels_.QuxK.data() + i * ld + i, ndx - i);
  }
  mirror(Vxx);
  Vxx.diagonal().array() += preg_;
  addGap(t);
}

}  // namespace manycontact
