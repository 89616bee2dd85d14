#include "manycontact/control/diff_lqr.hpp"

#include <ostream>

#include "linear_quadratic.hpp"

namespace manycontact {

using M = Eigen::MatrixXd;
using V = Eigen::VectorXd;

DifferentialActionModelLQR::DifferentialActionModelLQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R,
                                                       const M& N)
    : DifferentialActionModelLQR(Aq, Av, B, Q, R, N, internal::zeros(Aq.cols()), internal::zeros(2 * Aq.cols()),
                                 internal::zeros(B.cols())) {}

DifferentialActionModelLQR::DifferentialActionModelLQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R,
                                                       const M& N, const V& f, const V& q, const V& r)
    : DifferentialActionModelLQR(Aq, Av, B, Q, R, N, internal::no_rows(2 * Aq.cols() + B.cols()),
                                 internal::no_rows(2 * Aq.cols() + B.cols()), f, q, r, internal::zeros(0),
                                 internal::zeros(0)) {}

DifferentialActionModelLQR::DifferentialActionModelLQR(const M& Aq, const M& Av, const M& B, const M& Q, const M& R,
                                                       const M& N, const M& G, const M& H, const V& f, const V& q,
                                                       const V& r, const V& g, const V& h)
    : NodeWithData(internal::vectors(2 * Aq.cols()), B.cols(), 0, G.rows(), H.rows()) {
  set_LQR(Aq, Av, B, Q, R, N, G, H, f, q, r, g, h);
}

DifferentialActionModelLQR::DifferentialActionModelLQR(std::size_t nq, std::size_t nu, bool drift_free)
    : DifferentialActionModelLQR(M::Identity(nq, nq), M::Identity(nq, nq), M::Identity(nq, nu),
                                 M::Identity(2 * nq, 2 * nq), M::Identity(nu, nu), M::Zero(2 * nq, nu),
                                 drift_free ? V::Zero(nq) : V::Ones(nq), V::Ones(2 * nq), V::Ones(nu)) {}

DifferentialActionModelLQR DifferentialActionModelLQR::Random(std::size_t nq, std::size_t nu, std::size_t ng,
                                                              std::size_t nh) {
  constexpr auto random = internal::random_matrix;
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
  internal::check_shape(kName, "Aq", Aq, nq, nq);
  internal::check_shape(kName, "Av", Av, nq, nq);
  set_terms(*this, kName, nq, B, Q, R, N, G, H, f, q, r, g, h);
  Aq_ = Aq, Av_ = Av;
}

void DifferentialActionModelLQR::evaluate(DifferentialActionDataAbstract& d, const ConstVectorRef& x,
                                          const ConstVectorRef* u) {
  internal::linear_quadratic_values(*this, x, u, d);
  if (!u) return;
  d.xout = f_;
  d.xout.noalias() += Aq_ * x.head(Aq_.cols());
  d.xout.noalias() += Av_ * x.tail(Av_.cols());
  d.xout.noalias() += B_ * *u;
}

void DifferentialActionModelLQR::differentiate(DifferentialActionDataAbstract& d, const ConstVectorRef& x,
                                               const ConstVectorRef* u) {
  internal::linear_quadratic_derivatives(*this, x, u, d);
  if (!u) return;
  d.Fx << Aq_, Av_;
  d.Fu = B_;
}

void DifferentialActionModelLQR::print(std::ostream& os) const {
  os << "DifferentialActionModelLQR {nx=" << state_->get_nx() << ", nu=" << nu_ << "}";
}

}  // namespace manycontact
