#include "manycontact/control/box_qp.hpp"

#include "step_lengths.hpp"

namespace manycontact {

BoxQP::BoxQP(std::size_t nx, std::size_t maxiter, double th_acceptstep, double th_grad, double reg)
    : maxiter_(maxiter), alphas_(internal::default_alphas()) {
  set_th_acceptstep(th_acceptstep);
  set_th_grad(th_grad);
  set_reg(reg);
  set_nx(nx);
}

void BoxQP::set_nx(std::size_t nx) {
  nx_ = nx;
  for (Eigen::VectorXd* x : {&x_, &xnew_, &g_, &dx_, &Hx_, &qf_, &dxf_, &solution_.x}) x->setZero(nx);
  L_.setZero(nx, nx);
  inverse_.setZero(nx, nx);
  solution_.free_idx.clear();
  solution_.clamped_idx.clear();
  solution_.free_idx.reserve(nx);
  solution_.clamped_idx.reserve(nx);
}

// Lists the free components and the clamped components, which are at a bound that the descent direction would exceed.
void BoxQP::sort_components(const Eigen::VectorXd& lb, const Eigen::VectorXd& ub) {
  solution_.free_idx.clear();
  solution_.clamped_idx.clear();
  for (std::size_t j = 0; j < nx_; ++j) {
    const bool clamped = (x_[j] == lb[j] && g_[j] > 0) || (x_[j] == ub[j] && g_[j] < 0);
    (clamped ? solution_.clamped_idx : solution_.free_idx).push_back(j);
  }
}

// Computes dx = - Hff^-1 (qf + Hff xf + Hfc xc) (f: free, c: clamped). `gradient`: largest entry of the bracket.
bool BoxQP::newton_step(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, double& gradient) {
  const std::vector<std::size_t>& free = solution_.free_idx;
  const Eigen::Index nf = static_cast<Eigen::Index>(free.size());
  auto Hff = L_.topLeftCorner(nf, nf);
  auto qf = qf_.head(nf), dxf = dxf_.head(nf);
  for (Eigen::Index i = 0; i < nf; ++i) {
    for (Eigen::Index j = 0; j < nf; ++j) Hff(i, j) = H(free[i], free[j]);
    Hff(i, i) += reg_;
    qf[i] = q[free[i]] + Hx_[free[i]] + reg_ * x_[free[i]];
  }
  gradient = nf == 0 ? 0 : qf.lpNorm<Eigen::Infinity>();
  Eigen::Ref<Eigen::MatrixXd> in_place(Hff);
  if (nf > 0 && Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() != Eigen::Success) return false;
  dxf = -qf;
  Hff.triangularView<Eigen::Lower>().solveInPlace(dxf);
  Hff.triangularView<Eigen::Lower>().transpose().solveInPlace(dxf);
  dx_.setZero();
  for (Eigen::Index i = 0; i < nf; ++i) {
    dx_[free[i]] = dxf[i];
    g_[free[i]] = -qf[i];
  }
  return true;
}

// Takes the longest accepted step, clamped to the bounds. Returns false if no step is accepted. As in Crocoddyl, a step
// may increase the objective by th_acceptstep times its expected reduction.
bool BoxQP::search(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                   const Eigen::VectorXd& ub) {
  const double old = 0.5 * x_.dot(Hx_) + q.dot(x_);
  for (double alpha : alphas_) {
    xnew_ = (x_ + alpha * dx_).cwiseMin(ub).cwiseMax(lb);
    Hx_.noalias() = H * xnew_;
    const double fnew = 0.5 * xnew_.dot(Hx_) + q.dot(xnew_);
    if (old - fnew > th_acceptstep_ * (g_.dot(x_) - g_.dot(xnew_))) {
      x_ = xnew_;
      return true;
    }
  }
  return false;
}

bool BoxQP::minimise(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                     const Eigen::VectorXd& ub, const Eigen::VectorXd& xinit) {
  check_size("BoxQP::solve", "a row of H", H.cols(), nx_);
  check_size("BoxQP::solve", "a column of H", H.rows(), nx_);
  check_size("BoxQP::solve", "q", q.size(), nx_);
  check_size("BoxQP::solve", "lb", lb.size(), nx_);
  check_size("BoxQP::solve", "ub", ub.size(), nx_);
  check_size("BoxQP::solve", "xinit", xinit.size(), nx_);
  x_ = xinit.cwiseMin(ub).cwiseMax(lb);
  sound_ = true;
  double gradient = 0;
  for (iter_ = 0; iter_ < maxiter_;) {
    Hx_.noalias() = H * x_;
    g_ = q + Hx_;
    sort_components(lb, ub);
    sound_ = newton_step(H, q, gradient);
    if (!sound_) return false;
    ++iter_;
    if (!search(H, q, lb, ub) || gradient <= th_grad_) break;
  }
  solution_.x = x_;
  return true;
}

void BoxQP::free_inverse(Eigen::MatrixXd& inverse) {
  const std::vector<std::size_t>& free = solution_.free_idx;
  const Eigen::Index nf = static_cast<Eigen::Index>(free.size());
  auto Hinv = inverse_.topLeftCorner(nf, nf);
  const auto L = L_.topLeftCorner(nf, nf).triangularView<Eigen::Lower>();
  Hinv.setIdentity();
  L.solveInPlace(Hinv);
  L.transpose().solveInPlace(Hinv);
  inverse.setZero(nx_, nx_);
  for (Eigen::Index j = 0; j < nf; ++j)
    for (Eigen::Index i = 0; i < nf; ++i) inverse(free[i], free[j]) = Hinv(i, j);
}

const BoxQPSolution& BoxQP::solve(const Eigen::MatrixXd& H, const Eigen::VectorXd& q, const Eigen::VectorXd& lb,
                                  const Eigen::VectorXd& ub, const Eigen::VectorXd& xinit) {
  if (!minimise(H, q, lb, ub, xinit)) return solution_;
  Eigen::MatrixXd all(nx_, nx_);
  free_inverse(all);
  const Eigen::Index nf = static_cast<Eigen::Index>(solution_.free_idx.size());
  solution_.Hff_inv = inverse_.topLeftCorner(nf, nf);
  return solution_;
}

void BoxQP::set_th_acceptstep(double th_acceptstep) {
  require(th_acceptstep > 0 && th_acceptstep < 0.5, "BoxQP::set_th_acceptstep", "a number in (0, 0.5) is expected");
  th_acceptstep_ = th_acceptstep;
}
void BoxQP::set_alphas(const std::vector<double>& alphas) {
  internal::check_alphas("BoxQP::set_alphas", alphas);
  alphas_ = alphas;
}

}  // namespace manycontact
