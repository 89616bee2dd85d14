#include "manycontact/control/action_model.hpp"

#include <algorithm>
#include <stdexcept>

#include "manycontact/rank/least_norm.hpp"

namespace manycontact {

ActionDataAbstract::ActionDataAbstract(const ActionModelAbstract* model, WithoutMatrices) {
  xnext.setZero(model->get_state()->get_nx());
  r.setZero(model->get_nr());
  g.setZero(std::max(model->get_ng(), model->get_ng_T()));
  h.setZero(std::max(model->get_nh(), model->get_nh_T()));
}

ActionDataAbstract::ActionDataAbstract(const ActionModelAbstract* model)
    : ActionDataAbstract(model, WithoutMatrices{}) {
  allocate_matrices(model);
}

void ActionDataAbstract::allocate_matrices(const ActionModelAbstract* model) {
  const Eigen::Index ndx = model->get_state()->get_ndx(), nu = model->get_nu();
  Fx.setZero(ndx, ndx), Fu.setZero(ndx, nu);
  Lx.setZero(ndx), Lu.setZero(nu);
  Lxx.setZero(ndx, ndx), Lxu.setZero(ndx, nu), Luu.setZero(nu, nu);
  Gx.setZero(g.size(), ndx), Gu.setZero(g.size(), nu);
  Hx.setZero(h.size(), ndx), Hu.setZero(h.size(), nu);
}

static void expect_matrices(const ActionDataAbstract& d) {
  if (!d.has_matrices())
    throw std::logic_error("ActionDataAbstract: the data have no matrices, use the data of the parts");
}

void ActionDataAbstract::pull_back(const Eigen::VectorXd& p, VectorRef gx, VectorRef gu) const {
  expect_matrices(*this);
  gx.noalias() = Fx.transpose() * p;
  gu.noalias() = Fu.transpose() * p;
}

void ActionDataAbstract::dynamics(Eigen::MatrixXd& fx, Eigen::MatrixXd& fu) const {
  expect_matrices(*this);
  fx = Fx, fu = Fu;
}

void ActionModelAbstract::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter,
                                      double tol) {
  check_size("quasiStatic", "x", x.size(), state_->get_nx());
  check_size("quasiStatic", "u", u.size(), nu_);
  if (nu_ == 0) return;
  Eigen::VectorXd dx(state_->get_ndx());
  for (std::size_t k = 0; k < maxiter; ++k) {
    calc(data, x, u);
    calcDiff(data, x, u);
    state_->diff(x, data->xnext, dx);
    const Eigen::VectorXd du = rank::least_norm_solution(data->Fu, dx);
    u -= du;
    if (du.norm() <= tol) break;
  }
}

}  // namespace manycontact
