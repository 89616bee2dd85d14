#include "manycontact/control/lqr.hpp"

#include <ostream>

#include "linear_quadratic.hpp"

namespace manycontact {

using M = Eigen::MatrixXd;
using V = Eigen::VectorXd;

using DataPtr = std::shared_ptr<ActionDataAbstract>;

namespace {

constexpr const char* kActionModelLQR = "ActionModelLQR";

}  // namespace

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N)
    : ActionModelLQR(A, B, Q, R, N, internal::zeros(A.cols()), internal::zeros(A.cols()), internal::zeros(B.cols())) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const V& f, const V& q,
                               const V& r)
    : ActionModelLQR(A, B, Q, R, N, internal::no_rows(A.cols() + B.cols()), internal::no_rows(A.cols() + B.cols()), f,
                     q, r, internal::zeros(0), internal::zeros(0)) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const M& G, const M& H,
                               const V& f, const V& q, const V& r, const V& g, const V& h)
    : ActionModelAbstract(internal::vectors(A.cols()), B.cols(), 0, G.rows(), H.rows(), G.rows(), H.rows()) {
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
  const Eigen::Index nx = state_->get_nx(), nu = nu_, ng = ng_, nh = nh_;
  const auto check_shape = [](const char* what, const auto& matrix, Eigen::Index rows, Eigen::Index cols) {
    internal::check_shape(kActionModelLQR, what, matrix, rows, cols);
  };
  check_shape("A", A, nx, nx), check_shape("B", B, nx, nu);
  check_shape("Q", Q, nx, nx), check_shape("R", R, nu, nu), check_shape("N", N, nx, nu);
  check_shape("G", G, ng, nx + nu), check_shape("H", H, nh, nx + nu);
  check_shape("f", f, nx, 1), check_shape("q", q, nx, 1), check_shape("r", r, nu, 1);
  check_shape("g", g, ng, 1), check_shape("h", h, nh, 1);
  internal::check_convex(kActionModelLQR, Q, R, N);
  A_ = A, B_ = B, Q_ = Q, R_ = R, N_ = N, G_ = G, H_ = H;
  f_ = f, q_ = q, r_ = r, g_ = g, h_ = h;
}

void ActionModelLQR::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelLQR::calc", x, u);
  calc(data, x);
  data->xnext = f_;
  data->xnext.noalias() += A_ * x;
  data->xnext.noalias() += B_ * u;
  internal::add_linear_quadratic_values(*this, x, u, *data);
}

void ActionModelLQR::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelLQR::calc", x);
  internal::linear_quadratic_values(*this, x, check_data("ActionModelLQR::calc", data));
  data->xnext = x;
}

void ActionModelLQR::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelLQR::calcDiff", x, u);
  calcDiff(data, x);
  data->Fx = A_;
  data->Fu = B_;
  internal::add_linear_quadratic_derivatives(*this, x, u, *data);
}

void ActionModelLQR::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelLQR::calcDiff", x);
  internal::linear_quadratic_derivatives(*this, x, check_data("ActionModelLQR::calcDiff", data));
  data->Fx.setIdentity();
}

void ActionModelLQR::print(std::ostream& os) const {
  os << "ActionModelLQR {nx=" << state_->get_nx() << ", nu=" << nu_ << ", ng=" << ng_ << ", nh=" << nh_ << "}";
}

}  // namespace manycontact
