#include "manycontact/control/diff_lqr.hpp"

#include <ostream>

#include "linear_quadratic.hpp"
#include "manycontact/control/state_vector.hpp"

namespace manycontact {

using M = Eigen::MatrixXd;
using V = Eigen::VectorXd;

namespace {

constexpr const char* kDifferentialActionModelLQR = "DifferentialActionModelLQR";

}  // namespace

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
    : DifferentialActionModelAbstract(internal::vectors(2 * Aq.cols()), B.cols(), 0, G.rows(), H.rows()) {
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
  const Eigen::Index nq = state_->get_nv(), nx = 2 * nq, nu = nu_, ng = ng_, nh = nh_;
  const auto check_shape = [](const char* what, const auto& matrix, Eigen::Index rows, Eigen::Index cols) {
    internal::check_shape(kDifferentialActionModelLQR, what, matrix, rows, cols);
  };
  check_shape("Aq", Aq, nq, nq), check_shape("Av", Av, nq, nq), check_shape("B", B, nq, nu);
  check_shape("Q", Q, nx, nx), check_shape("R", R, nu, nu), check_shape("N", N, nx, nu);
  check_shape("G", G, ng, nx + nu), check_shape("H", H, nh, nx + nu);
  check_shape("f", f, nq, 1), check_shape("q", q, nx, 1), check_shape("r", r, nu, 1);
  check_shape("g", g, ng, 1), check_shape("h", h, nh, 1);
  internal::check_convex(kDifferentialActionModelLQR, Q, R, N);
  Aq_ = Aq, Av_ = Av, B_ = B, Q_ = Q, R_ = R, N_ = N, G_ = G, H_ = H;
  f_ = f, q_ = q, r_ = r, g_ = g, h_ = h;
}

void DifferentialActionModelLQR::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check_size("DifferentialActionModelLQR::calc", "u", u.size(), nu_);
  calc(data, x);
  data->xout = f_;
  data->xout.noalias() += Aq_ * x.head(Aq_.cols());
  data->xout.noalias() += Av_ * x.tail(Av_.cols());
  data->xout.noalias() += B_ * u;
  internal::add_linear_quadratic_values(*this, x, u, *data);
}

void DifferentialActionModelLQR::calc(const DataPtr& data, const ConstVectorRef& x) {
  check_size("DifferentialActionModelLQR::calc", "x", x.size(), state_->get_nx());
  internal::linear_quadratic_values(*this, x, check_data("DifferentialActionModelLQR::calc", data));
}

void DifferentialActionModelLQR::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check_size("DifferentialActionModelLQR::calcDiff", "u", u.size(), nu_);
  calcDiff(data, x);
  data->Fx << Aq_, Av_;
  data->Fu = B_;
  internal::add_linear_quadratic_derivatives(*this, x, u, *data);
}

void DifferentialActionModelLQR::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check_size("DifferentialActionModelLQR::calcDiff", "x", x.size(), state_->get_nx());
  internal::linear_quadratic_derivatives(*this, x, check_data("DifferentialActionModelLQR::calcDiff", data));
}

void DifferentialActionModelLQR::print(std::ostream& os) const {
  os << "DifferentialActionModelLQR {nx=" << state_->get_nx() << ", nu=" << nu_ << "}";
}

}  // namespace manycontact
