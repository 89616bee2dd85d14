#include "manycontact/control/lqr.hpp"

#include <Eigen/Eigenvalues>
#include <ostream>

#include "linear_quadratic.hpp"

namespace manycontact {

using M = Eigen::MatrixXd;
using V = Eigen::VectorXd;

void LinearQuadraticTerms::set_terms(const NodeAbstract& node, const char* name, Eigen::Index rows, const M& B,
                                     const M& Q, const M& R, const M& N, const M& G, const M& H, const V& f, const V& q,
                                     const V& r, const V& g, const V& h) {
  const Eigen::Index nx = node.get_state()->get_nx(), nu = node.get_nu(), ng = node.get_ng(), nh = node.get_nh();
  const auto check = [name](const char* what, const auto& matrix, Eigen::Index n, Eigen::Index cols) {
    internal::check_shape(name, what, matrix, n, cols);
  };
  check("B", B, rows, nu), check("Q", Q, nx, nx), check("R", R, nu, nu), check("N", N, nx, nu);
  check("G", G, ng, nx + nu), check("H", H, nh, nx + nu);
  check("f", f, rows, 1), check("q", q, nx, 1), check("r", r, nu, 1), check("g", g, ng, 1), check("h", h, nh, 1);
  M L(nx + nu, nx + nu);
  L << Q, N, N.transpose(), R;
  // Rounding makes eigenvalues of zero as small as -1e-12 of the largest.
  const V values = Eigen::SelfAdjointEigenSolver<M>(L, Eigen::EigenvaluesOnly).eigenvalues();
  require(values.size() == 0 || values.minCoeff() >= -1e-12 * values.cwiseAbs().maxCoeff(), name,
          "[Q N; N^T R] has a negative eigenvalue, a convex cost is expected");
  B_ = B, Q_ = Q, R_ = R, N_ = N, G_ = G, H_ = H;
  f_ = f, q_ = q, r_ = r, g_ = g, h_ = h;
}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N)
    : ActionModelLQR(A, B, Q, R, N, internal::zeros(A.cols()), internal::zeros(A.cols()), internal::zeros(B.cols())) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const V& f, const V& q,
                               const V& r)
    : ActionModelLQR(A, B, Q, R, N, internal::no_rows(A.cols() + B.cols()), internal::no_rows(A.cols() + B.cols()), f,
                     q, r, internal::zeros(0), internal::zeros(0)) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const M& G, const M& H,
                               const V& f, const V& q, const V& r, const V& g, const V& h)
    : NodeWithData(internal::vectors(A.cols()), B.cols(), 0, G.rows(), H.rows(), G.rows(), H.rows()) {
  set_LQR(A, B, Q, R, N, G, H, f, q, r, g, h);
}

ActionModelLQR::ActionModelLQR(std::size_t nx, std::size_t nu, bool drift_free)
    : ActionModelLQR(M::Identity(nx, nx), M::Identity(nx, nu), M::Identity(nx, nx), M::Identity(nu, nu),
                     M::Zero(nx, nu), drift_free ? V::Zero(nx) : V::Ones(nx), V::Ones(nx), V::Ones(nu)) {}

ActionModelLQR ActionModelLQR::Random(std::size_t nx, std::size_t nu, std::size_t ng, std::size_t nh) {
  constexpr auto random = internal::random_matrix;
  const M A = random(nx, nx), B = random(nx, nu), root = random(nx + nu, nx + nu), L = root.transpose() * root;
  const M G = random(ng, nx + nu), H = random(nh, nx + nu);
  const V f = random(nx, 1), q = random(nx, 1), r = random(nu, 1), g = random(ng, 1), h = random(nh, 1);
  return ActionModelLQR(A, B, L.topLeftCorner(nx, nx), L.bottomRightCorner(nu, nu), L.topRightCorner(nx, nu), G, H, f,
                        q, r, g, h);
}

void ActionModelLQR::set_LQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const M& G, const M& H,
                             const V& f, const V& q, const V& r, const V& g, const V& h) {
  internal::check_shape(kName, "A", A, state_->get_nx(), state_->get_nx());
  set_terms(*this, kName, A.rows(), B, Q, R, N, G, H, f, q, r, g, h);
  A_ = A;
}

void ActionModelLQR::evaluate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  internal::linear_quadratic_values(*this, x, u, d);
  d.xnext = x;
  if (!u) return;
  d.xnext = f_;
  d.xnext.noalias() += A_ * x;
  d.xnext.noalias() += B_ * *u;
}

void ActionModelLQR::differentiate(ActionDataAbstract& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  internal::linear_quadratic_derivatives(*this, x, u, d);
  d.Fx.setIdentity();
  if (!u) return;
  d.Fx = A_;
  d.Fu = B_;
}

void ActionModelLQR::print(std::ostream& os) const {
  os << "ActionModelLQR {nx=" << state_->get_nx() << ", nu=" << nu_ << ", ng=" << ng_ << ", nh=" << nh_ << "}";
}

}  // namespace manycontact
