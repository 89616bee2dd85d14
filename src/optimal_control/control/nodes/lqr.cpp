#include "manycontact/control/lqr.hpp"

#include <Eigen/Eigenvalues>
#include <random>

#include "manycontact/control/diff_lqr.hpp"

namespace manycontact {

using M = Eigen::MatrixXd;
using V = Eigen::VectorXd;

namespace {

// Computes cost and constraints, in discrete or continuous time. A terminal node has u = null and no terms in u.
template <class Data>
void linear_quadratic_values(const LinearQuadraticTerms& m, const ConstVectorRef& x, const ConstVectorRef* u, Data& d) {
  d.Lx = m.get_q();  // q + Q x / 2
  d.Lx.noalias() += 0.5 * (m.get_Q() * x);
  d.cost = d.Lx.dot(x);
  d.g = m.get_g();
  d.g.noalias() += m.get_G().leftCols(x.size()) * x;
  d.h = m.get_h();
  d.h.noalias() += m.get_H().leftCols(x.size()) * x;
  if (!u) return;
  d.Lu = m.get_r();  // r + N^T x + R u / 2
  d.Lu.noalias() += m.get_N().transpose() * x;
  d.Lu.noalias() += 0.5 * (m.get_R() * *u);
  d.cost += d.Lu.dot(*u);
  d.g.noalias() += m.get_G().rightCols(u->size()) * *u;
  d.h.noalias() += m.get_H().rightCols(u->size()) * *u;
}

template <class Data>
void linear_quadratic_derivatives(const LinearQuadraticTerms& m, const ConstVectorRef& x, const ConstVectorRef* u,
                                  Data& d) {
  d.Lx = m.get_q();
  d.Lx.noalias() += m.get_Q() * x;
  d.Lxx = m.get_Q();
  d.Gx = m.get_G().leftCols(x.size());
  d.Hx = m.get_H().leftCols(x.size());
  if (!u) return;
  d.Lx.noalias() += m.get_N() * *u;
  d.Lu = m.get_r();
  d.Lu.noalias() += m.get_N().transpose() * x;
  d.Lu.noalias() += m.get_R() * *u;
  d.Lxu = m.get_N();
  d.Luu = m.get_R();
  d.Gu = m.get_G().rightCols(u->size());
  d.Hu = m.get_H().rightCols(u->size());
}

template <class Matrix>
void check_shape(const char* who, const char* what, const Matrix& matrix, Eigen::Index rows, Eigen::Index cols) {
  require(matrix.rows() == rows && matrix.cols() == cols, who,
          std::string(what) + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ", " +
              std::to_string(rows) + " x " + std::to_string(cols) + " is expected");
}

std::shared_ptr<StateVector> vectors(Eigen::Index nx) { return std::make_shared<StateVector>(nx); }
Eigen::MatrixXd no_rows(Eigen::Index cols) { return Eigen::MatrixXd::Zero(0, cols); }
Eigen::VectorXd zeros(Eigen::Index n) { return Eigen::VectorXd::Zero(n); }

Eigen::MatrixXd random_matrix(std::size_t rows, std::size_t cols) {
  thread_local std::mt19937 rng(1);
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [] { return std::uniform_real_distribution<double>(-1, 1)(rng); });
}

}  // namespace

void LinearQuadraticTerms::set_terms(const NodeAbstract& node, const char* name, Eigen::Index rows, const M& B,
                                     const M& Q, const M& R, const M& N, const M& G, const M& H, const V& f, const V& q,
                                     const V& r, const V& g, const V& h) {
  const Eigen::Index nx = node.get_state()->get_nx(), nu = node.get_nu(), ng = node.get_ng(), nh = node.get_nh();
  const auto check = [name](const char* what, const auto& matrix, Eigen::Index n, Eigen::Index cols) {
    check_shape(name, what, matrix, n, cols);
  };
  check("B", B, rows, nu), check("Q", Q, nx, nx), check("R", R, nu, nu), check("N", N, nx, nu);
  check("G", G, ng, nx + nu), check("H", H, nh, nx + nu);
  check("f", f, rows, 1), check("q", q, nx, 1), check("r", r, nu, 1), check("g", g, ng, 1), check("h", h, nh, 1);
  M L(nx + nu, nx + nu);
  L << Q, N, N.transpose(), R;
  // Rounding errors make zero eigenvalues as small as -1e-12 of the largest.
  const V values = Eigen::SelfAdjointEigenSolver<M>(L, Eigen::EigenvaluesOnly).eigenvalues();
  require(values.size() == 0 || values.minCoeff() >= -1e-12 * values.cwiseAbs().maxCoeff(), name,
          "[Q N; N^T R] has a negative eigenvalue, a convex cost is expected");
  B_ = B, Q_ = Q, R_ = R, N_ = N, G_ = G, H_ = H;
  f_ = f, q_ = q, r_ = r, g_ = g, h_ = h;
}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N)
    : ActionModelLQR(A, B, Q, R, N, zeros(A.cols()), zeros(A.cols()), zeros(B.cols())) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const V& f, const V& q,
                               const V& r)
    : ActionModelLQR(A, B, Q, R, N, no_rows(A.cols() + B.cols()), no_rows(A.cols() + B.cols()), f, q, r, zeros(0),
                     zeros(0)) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const M& G, const M& H,
                               const V& f, const V& q, const V& r, const V& g, const V& h)
    : NodeWithData(vectors(A.cols()), B.cols(), 0, G.rows(), H.rows(), G.rows(), H.rows()) {
  set_LQR(A, B, Q, R, N, G, H, f, q, r, g, h);
}

ActionModelLQR::ActionModelLQR(std::size_t nx, std::size_t nu, bool drift_free)
    : ActionModelLQR(M::Identity(nx, nx), M::Identity(nx, nu), M::Identity(nx, nx), M::Identity(nu, nu),
                     M::Zero(nx, nu), drift_free ? V::Zero(nx) : V::Ones(nx), V::Ones(nx), V::Ones(nu)) {}

ActionModelLQR ActionModelLQR::Random(std::size_t nx, std::size_t nu, std::size_t ng, std::size_t nh) {
  constexpr auto random = random_matrix;
  const M A = random(nx, nx), B = random(nx, nu), root = random(nx + nu, nx + nu), L = root.transpose() * root;
  const M G = random(ng, nx + nu), H = random(nh, nx + nu);
  const V f = random(nx, 1), q = random(nx, 1), r = random(nu, 1), g = random(ng, 1), h = random(nh, 1);
  return ActionModelLQR(A, B, L.topLeftCorner(nx, nx), L.bottomRightCorner(nu, nu), L.topRightCorner(nx, nu), G, H, f,
                        q, r, g, h);
}

void ActionModelLQR::set_LQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const M& G, const M& H,
                             const V& f, const V& q, const V& r, const V& g, const V& h) {
  check_shape(kName, "A", A, state_->get_nx(), state_->get_nx());
  set_terms(*this, kName, A.rows(), B, Q, R, N, G, H, f, q, r, g, h);
  A_ = A;
}

void ActionModelLQR::evaluate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  linear_quadratic_values(*this, x, u, d);
  d.xnext = x;
  if (!u) return;
  d.xnext = f_;
  d.xnext.noalias() += A_ * x;
  d.xnext.noalias() += B_ * *u;
}

void ActionModelLQR::differentiate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  linear_quadratic_derivatives(*this, x, u, d);
  d.Fx.setIdentity();
  if (!u) return;
  d.Fx = A_;
  d.Fu = B_;
}

DifferentialActionModelLQR::DifferentialActionModelLQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R,
                                                       const M& N)
    : DifferentialActionModelLQR(Aq, Av, B, Q, R, N, zeros(Aq.cols()), zeros(2 * Aq.cols()), zeros(B.cols())) {}

DifferentialActionModelLQR::DifferentialActionModelLQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R,
                                                       const M& N, const V& f, const V& q, const V& r)
    : DifferentialActionModelLQR(Aq, Av, B, Q, R, N, no_rows(2 * Aq.cols() + B.cols()),
                                 no_rows(2 * Aq.cols() + B.cols()), f, q, r, zeros(0), zeros(0)) {}

DifferentialActionModelLQR::DifferentialActionModelLQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R,
                                                       const M& N, const M& G, const M& H, const V& f, const V& q,
                                                       const V& r, const V& g, const V& h)
    : NodeWithData(vectors(2 * Aq.cols()), B.cols(), 0, G.rows(), H.rows()) {
  set_LQR(Aq, Av, B, Q, R, N, G, H, f, q, r, g, h);
}

DifferentialActionModelLQR::DifferentialActionModelLQR(std::size_t nq, std::size_t nu, bool drift_free)
    : DifferentialActionModelLQR(M::Identity(nq, nq), M::Identity(nq, nq), M::Identity(nq, nu),
                                 M::Identity(2 * nq, 2 * nq), M::Identity(nu, nu), M::Zero(2 * nq, nu),
                                 drift_free ? V::Zero(nq) : V::Ones(nq), V::Ones(2 * nq), V::Ones(nu)) {}

DifferentialActionModelLQR DifferentialActionModelLQR::Random(std::size_t nq, std::size_t nu, std::size_t ng,
                                                              std::size_t nh) {
  constexpr auto random = random_matrix;
  const std::size_t nx = 2 * nq;
  const M Aq = random(nq, nq), Av = random(nq, nq), B = random(nq, nu), root = random(nx + nu, nx + nu);
  const M L = root.transpose() * root, G = random(ng, nx + nu), H = random(nh, nx + nu);
  const V f = random(nq, 1), q = random(nx, 1), r = random(nu, 1), g = random(ng, 1), h = random(nh, 1);
  return DifferentialActionModelLQR(Aq, Av, B, L.topLeftCorner(nx, nx), L.bottomRightCorner(nu, nu),
                                    L.topRightCorner(nx, nu), G, H, f, q, r, g, h);
}

void DifferentialActionModelLQR::set_LQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R, const M& N,
                                         const M& G, const M& H, const V& f, const V& q, const V& r, const V& g,
                                         const V& h) {
  const Eigen::Index nq = state_->get_nv();
  check_shape(kName, "Aq", Aq, nq, nq);
  check_shape(kName, "Av", Av, nq, nq);
  set_terms(*this, kName, nq, B, Q, R, N, G, H, f, q, r, g, h);
  Aq_ = Aq, Av_ = Av;
}

void DifferentialActionModelLQR::evaluate(DifferentialActionDataAbstract& d, const ConstVectorRef& x,
                                          const ConstVectorRef* u) {
  linear_quadratic_values(*this, x, u, d);
  if (!u) return;
  d.xout = f_;
  d.xout.noalias() += Aq_ * x.head(Aq_.cols());
  d.xout.noalias() += Av_ * x.tail(Av_.cols());
  d.xout.noalias() += B_ * *u;
}

void DifferentialActionModelLQR::differentiate(DifferentialActionDataAbstract& d, const ConstVectorRef& x,
                                               const ConstVectorRef* u) {
  linear_quadratic_derivatives(*this, x, u, d);
  if (!u) return;
  d.Fx << Aq_, Av_;
  d.Fu = B_;
}

}  // namespace manycontact
