
#include "manycontact/action/state.hpp"

namespace manycontact {

bool same_space(const StateAbstract& a, const StateAbstract& b) {
  if (&a == &b) return true;
  const auto* one = dynamic_cast<const StateMultibody*>(&a);
  const auto* other = dynamic_cast<const StateMultibody*>(&b);
  return one && other && one->get_model() == other->get_model();
}

StateAbstract::StateAbstract(std::size_t nx, std::size_t ndx)
    : nx_(nx), ndx_(ndx), nq_(nx - ndx / 2), nv_(ndx / 2), lb_(nx), ub_(nx) {
  lb_.setConstant(-std::numeric_limits<double>::infinity());
  ub_.setConstant(std::numeric_limits<double>::infinity());
}

Eigen::VectorXd StateAbstract::diff_dx(const ConstVectorRef& x0, const ConstVectorRef& x1) const {
  Eigen::VectorXd dx(ndx_);
  diff(x0, x1, dx);
  return dx;
}

Eigen::VectorXd StateAbstract::integrate_x(const ConstVectorRef& x, const ConstVectorRef& dx) const {
  Eigen::VectorXd out(nx_);
  integrate(x, dx, out);
  return out;
}

namespace {

std::vector<Eigen::MatrixXd> chosen(Eigen::MatrixXd& J1, Eigen::MatrixXd& J2, Jcomponent which) {
  if (which == first) return {std::move(J1)};
  if (which == second) return {std::move(J2)};
  return {std::move(J1), std::move(J2)};
}

}  // namespace

std::vector<Eigen::MatrixXd> StateAbstract::Jdiff_Js(const ConstVectorRef& x0, const ConstVectorRef& x1,
                                                     Jcomponent which) const {
  Eigen::MatrixXd J1(ndx_, ndx_), J2(ndx_, ndx_);
  Jdiff(x0, x1, J1, J2, which);
  return chosen(J1, J2, which);
}

std::vector<Eigen::MatrixXd> StateAbstract::Jintegrate_Js(const ConstVectorRef& x, const ConstVectorRef& dx,
                                                          Jcomponent which) const {
  Eigen::MatrixXd J1(ndx_, ndx_), J2(ndx_, ndx_);
  Jintegrate(x, dx, J1, J2, which, setto);
  return chosen(J1, J2, which);
}

void StateAbstract::set_lb(const Eigen::VectorXd& lb) {
  check_size("StateAbstract::set_lb", "lb", lb.size(), nx_);
  lb_ = lb;
  update_has_limits();
}

void StateAbstract::set_ub(const Eigen::VectorXd& ub) {
  check_size("StateAbstract::set_ub", "ub", ub.size(), nx_);
  ub_ = ub;
  update_has_limits();
}

void StateAbstract::update_has_limits() { has_limits_ = lb_.array().isFinite().any() || ub_.array().isFinite().any(); }

}  // namespace manycontact
