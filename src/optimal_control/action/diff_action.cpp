#include "manycontact/action/diff_action.hpp"

#include <algorithm>
#include <ostream>

#include "manycontact/rank/least_norm.hpp"

namespace manycontact {

DifferentialActionDataAbstract::DifferentialActionDataAbstract(const DifferentialActionModelAbstract* model) {
  const Eigen::Index ndx = model->get_state()->get_ndx(), nv = model->get_state()->get_nv(), nu = model->get_nu();
  const Eigen::Index ng = model->get_ng(), nh = model->get_nh();
  resize(ndx, nu, model->get_storage());
  const bool dense = has_dense(storage);
  xout.setZero(nv);
  Fx.setZero(dense ? nv : 0, dense ? ndx : 0);
  Fu.setZero(dense ? nv : 0, dense ? nu : 0);
  r.setZero(model->get_nr());
  g.setZero(ng);
  h.setZero(nh);
  Gx.setZero(dense ? ng : 0, dense ? ndx : 0);
  Gu.setZero(dense ? ng : 0, dense ? nu : 0);
  Hx.setZero(dense ? nh : 0, dense ? ndx : 0);
  Hu.setZero(dense ? nh : 0, dense ? nu : 0);
}

NodeAbstract::NodeAbstract(const char* kind, std::shared_ptr<StateAbstract> state, std::size_t nu, std::size_t nr,
                           std::size_t ng, std::size_t nh, std::size_t ng_T, std::size_t nh_T)
    : kind_(kind),
      nu_(nu),
      nr_(nr),
      ng_(ng),
      nh_(nh),
      ng_T_(ng_T),
      nh_T_(nh_T),
      state_(std::move(state)),
      unone_(Eigen::VectorXd::Zero(nu)) {
  require(state_ != nullptr, kind, "a state is expected, not a null pointer");
  const double infinity = std::numeric_limits<double>::infinity();
  g_lb_.setConstant(std::max(ng, ng_T), -infinity);
  g_ub_.setConstant(std::max(ng, ng_T), infinity);
  u_lb_.setConstant(nu, -infinity);
  u_ub_.setConstant(nu, infinity);
}

void NodeAbstract::print(std::ostream& os) const {
  os << kind_ << " {nx=" << state_->get_nx() << ", nu=" << nu_ << "}";
}

void NodeAbstract::check_sizes(const char* name, const char* function, const ConstVectorRef& x,
                               const ConstVectorRef* u) const {
  const auto is = [](const ConstVectorRef& v, std::size_t n) { return v.size() == static_cast<Eigen::Index>(n); };
  if (is(x, state_->get_nx()) && (!u || is(*u, nu_))) return;
  const std::string where = std::string(name) + "::" + function;
  check_size(where.c_str(), "x", x.size(), state_->get_nx());
  if (u) check_size(where.c_str(), "u", u->size(), nu_);
}

void NodeAbstract::set_g_lb(const Eigen::VectorXd& g_lb) {
  check_size("set_g_lb", "g_lb", g_lb.size(), std::max(get_ng(), get_ng_T()));
  g_lb_ = g_lb;
}
void NodeAbstract::set_g_ub(const Eigen::VectorXd& g_ub) {
  check_size("set_g_ub", "g_ub", g_ub.size(), std::max(get_ng(), get_ng_T()));
  g_ub_ = g_ub;
}
void NodeAbstract::set_u_lb(const Eigen::VectorXd& u_lb) {
  check_size("set_u_lb", "u_lb", u_lb.size(), nu_);
  u_lb_ = u_lb;
  update_has_control_limits();
}
void NodeAbstract::set_u_ub(const Eigen::VectorXd& u_ub) {
  check_size("set_u_ub", "u_ub", u_ub.size(), nu_);
  u_ub_ = u_ub;
  update_has_control_limits();
}

void NodeAbstract::update_has_control_limits() {
  has_control_limits_ = u_lb_.array().isFinite().any() && u_ub_.array().isFinite().any();
}

void DifferentialActionModelAbstract::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x,
                                                  std::size_t maxiter, double tol) {
  check_size("quasiStatic", "u", u.size(), nu_);
  check_size("quasiStatic", "x", x.size(), state_->get_nx());
  require(x.tail(state_->get_nv()).isZero(0), "quasiStatic", "the velocity is not zero, a state at rest is expected");
  u.setZero();
  for (std::size_t k = 0; k < maxiter; ++k) {
    calc(data, x, u);
    calcDiff(data, x, u);
    const Eigen::VectorXd du = rank::least_norm_solution(data->Fu, data->xout);
    u -= du;
    if (du.norm() <= tol) break;
  }
}

}  // namespace manycontact
