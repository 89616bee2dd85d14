#include "manycontact/control/lqr.hpp"

#include <Eigen/Eigenvalues>
#include <ostream>
#include <random>

namespace manycontact {

using DataPtr = std::shared_ptr<ActionDataAbstract>;
using M = Eigen::MatrixXd;
using V = Eigen::VectorXd;

namespace {

constexpr const char* kWho = "ActionModelLQR";

std::shared_ptr<StateVector> vectors(Eigen::Index nx) { return std::make_shared<StateVector>(nx); }
M none(const M& A, const M& B) { return M::Zero(0, A.cols() + B.cols()); }
V zeros(Eigen::Index n) { return V::Zero(n); }

}  // namespace

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N)
    : ActionModelLQR(A, B, Q, R, N, zeros(A.cols()), zeros(A.cols()), zeros(B.cols())) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const V& f, const V& q,
                               const V& r)
    : ActionModelLQR(A, B, Q, R, N, none(A, B), none(A, B), f, q, r, zeros(0), zeros(0)) {}

ActionModelLQR::ActionModelLQR(const M& A, const M& B, const M& Q, const M& R, const M& N, const M& G, const M& H,
                               const V& f, const V& q, const V& r, const V& g, const V& h)
    : ActionModelAbstract(vectors(A.cols()), B.cols(), 0, G.rows(), H.rows(), G.rows(), H.rows()) {
  set_LQR(A, B, Q, R, N, G, H, f, q, r, g, h);
}

ActionModelLQR::ActionModelLQR(std::size_t nx, std::size_t nu, bool drift_free)
    : ActionModelLQR(M::Identity(nx, nx), M::Identity(nx, nu), M::Identity(nx, nx), M::Identity(nu, nu),
                     M::Zero(nx, nu), drift_free ? V::Zero(nx) : V::Ones(nx), V::Ones(nx), V::Ones(nu)) {}

ActionModelLQR ActionModelLQR::Random(std::size_t nx, std::size_t nu, std::size_t ng, std::size_t nh) {
  thread_local std::mt19937 rng(1);
  const auto random = [](std::size_t rows, std::size_t cols) {
    return M(M::NullaryExpr(rows, cols, [] { return std::uniform_real_distribution<double>(-1, 1)(rng); }));
  };
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
    require(matrix.rows() == rows && matrix.cols() == cols, kWho,
            std::string(what) + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ", " +
                std::to_string(rows) + " x " + std::to_string(cols) + " is expected");
  };
  check_shape("A", A, nx, nx), check_shape("B", B, nx, nu);
  check_shape("Q", Q, nx, nx), check_shape("R", R, nu, nu), check_shape("N", N, nx, nu);
  check_shape("G", G, ng, nx + nu), check_shape("H", H, nh, nx + nu);
  check_shape("f", f, nx, 1), check_shape("q", q, nx, 1), check_shape("r", r, nu, 1);
  check_shape("g", g, ng, 1), check_shape("h", h, nh, 1);
  M L(nx + nu, nx + nu);
  L << Q, N, N.transpose(), R;
  require(Eigen::SelfAdjointEigenSolver<M>(L, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() >= -1e-12, kWho,
          "[Q N; N^T R] has a negative eigenvalue, a convex cost is expected");
  A_ = A, B_ = B, Q_ = Q, R_ = R, N_ = N, G_ = G, H_ = H;
  f_ = f, q_ = q, r_ = r, g_ = g, h_ = h;
}

void ActionModelLQR::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelLQR::calc", x, u);
  ActionDataAbstract& d = check_data("ActionModelLQR::calc", data);
  calc(data, x);
  d.xnext = f_;
  d.xnext.noalias() += A_ * x;
  d.xnext.noalias() += B_ * u;
  d.Lu = r_;  // r + N^T x + R u / 2
  d.Lu.noalias() += N_.transpose() * x;
  d.Lu.noalias() += 0.5 * (R_ * u);
  d.cost += d.Lu.dot(u);
  d.g.noalias() += G_.rightCols(nu_) * u;
  d.h.noalias() += H_.rightCols(nu_) * u;
}

void ActionModelLQR::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelLQR::calc", x);
  ActionDataAbstract& d = check_data("ActionModelLQR::calc", data);
  d.xnext = x;
  d.Lx = q_;  // q + Q x / 2
  d.Lx.noalias() += 0.5 * (Q_ * x);
  d.cost = d.Lx.dot(x);
  d.g = g_;
  d.g.noalias() += G_.leftCols(x.size()) * x;
  d.h = h_;
  d.h.noalias() += H_.leftCols(x.size()) * x;
}

void ActionModelLQR::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelLQR::calcDiff", x, u);
  calcDiff(data, x);
  data->Fx = A_, data->Fu = B_;
  data->Lx.noalias() += N_ * u;
  data->Lu = r_;
  data->Lu.noalias() += N_.transpose() * x;
  data->Lu.noalias() += R_ * u;
  data->Lxu = N_, data->Luu = R_;
  data->Gu = G_.rightCols(nu_), data->Hu = H_.rightCols(nu_);
}

void ActionModelLQR::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelLQR::calcDiff", x);
  ActionDataAbstract& d = check_data("ActionModelLQR::calcDiff", data);
  d.Fx.setIdentity();
  d.Lx = q_;
  d.Lx.noalias() += Q_ * x;
  d.Lxx = Q_;
  d.Gx = G_.leftCols(x.size()), d.Hx = H_.leftCols(x.size());
}

void ActionModelLQR::print(std::ostream& os) const {
  os << "ActionModelLQR {nx=" << state_->get_nx() << ", nu=" << nu_ << ", ng=" << ng_ << ", nh=" << nh_ << "}";
}

}  // namespace manycontact
