#include "manycontact/task/augmented.hpp"

#include "manycontact/control/parts.hpp"

namespace manycontact {

namespace {

using internal::own_data;
constexpr const char* kWho = "ActionModelAugmented";

const ActionModelAbstract& given(const std::shared_ptr<ActionModelAbstract>& inner) {
  require(inner != nullptr, kWho, "a model is expected, not a null pointer");
  return *inner;
}

// The derivatives of the cost and the dynamics.
void copy_derivatives(const ActionDataAbstract& from, ActionDataAbstract& to) {
  to.Fx = from.Fx;
  to.Fu = from.Fu;
  to.Lx = from.Lx;
  to.Lu = from.Lu;
  to.Lxx = from.Lxx;
  to.Lxu = from.Lxu;
  to.Luu = from.Luu;
}

}  // namespace

ActionModelAugmented::ActionModelAugmented(std::shared_ptr<ActionModelAbstract> inner, bool terminal)
    : ActionModelAbstract(given(inner).get_state(), inner->get_nu()), inner_(std::move(inner)) {
  set_u_lb(inner_->get_u_lb());
  set_u_ub(inner_->get_u_ub());
  const Eigen::Index ng = static_cast<Eigen::Index>(terminal ? inner_->get_ng_T() : inner_->get_ng());
  const Eigen::Index nh = static_cast<Eigen::Index>(terminal ? inner_->get_nh_T() : inner_->get_nh());
  lower_.setZero(ng + nh);
  upper_.setZero(ng + nh);
  multipliers_.setZero(ng + nh);
  lower_.head(ng) = (terminal ? inner_->get_g_lb_T() : inner_->get_g_lb()).head(ng);
  upper_.head(ng) = (terminal ? inner_->get_g_ub_T() : inner_->get_g_ub()).head(ng);
}

ActionDataAugmented::ActionDataAugmented(ActionModelAugmented* model)
    : ActionDataAbstract(model), inner(model->get_inner()->createData()) {
  const Eigen::Index nc = model->get_multipliers().size();
  c.setZero(nc);
  outside.setZero(nc);
  Cx.setZero(nc, Fx.cols());
  Cu.setZero(nc, Fu.cols());
}

std::shared_ptr<ActionDataAbstract> ActionModelAugmented::createData() {
  return std::make_shared<ActionDataAugmented>(this);
}

void ActionModelAugmented::calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                                const ConstVectorRef& u) {
  ActionDataAugmented& d = own_data<ActionDataAugmented>(kWho, data);
  inner_->calc(d.inner, x, u);
  add_cost(d);
}

void ActionModelAugmented::calc(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) {
  ActionDataAugmented& d = own_data<ActionDataAugmented>(kWho, data);
  inner_->calc(d.inner, x);
  add_cost(d);
}

void ActionModelAugmented::add_cost(ActionDataAbstract& data) const {
  auto& d = static_cast<ActionDataAugmented&>(data);
  d.xnext = d.inner->xnext;
  d.cost = d.inner->cost;
  if (d.c.size() == 0) return;
  d.c.head(d.inner->g.size()) = d.inner->g;
  d.c.tail(d.inner->h.size()) = d.inner->h;
  d.outside = penalty_ * d.c + multipliers_;  // rho z
  d.outside -= d.outside.cwiseMax(penalty_ * lower_).cwiseMin(penalty_ * upper_);
  d.cost += (d.outside.squaredNorm() - multipliers_.squaredNorm()) / (2 * penalty_);
}

void ActionModelAugmented::calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x,
                                    const ConstVectorRef& u) {
  ActionDataAugmented& d = own_data<ActionDataAugmented>(kWho, data);
  inner_->calcDiff(d.inner, x, u);
  copy_derivatives(*d.inner, d);
  add_derivatives(d, true);
}

void ActionModelAugmented::calcDiff(const std::shared_ptr<ActionDataAbstract>& data, const ConstVectorRef& x) {
  ActionDataAugmented& d = own_data<ActionDataAugmented>(kWho, data);
  inner_->calcDiff(d.inner, x);
  copy_derivatives(*d.inner, d);
  add_derivatives(d, false);
}

void ActionModelAugmented::add_derivatives(ActionDataAbstract& data, bool with_u) const {
  auto& d = static_cast<ActionDataAugmented&>(data);
  if (d.c.size() == 0) return;
  const Eigen::Index ng = d.inner->g.size(), nh = d.inner->h.size();
  d.Cx.topRows(ng) = d.inner->Gx;
  d.Cx.bottomRows(nh) = d.inner->Hx;
  if (with_u) {
    d.Cu.topRows(ng) = d.inner->Gu;
    d.Cu.bottomRows(nh) = d.inner->Hu;
  }
  for (Eigen::Index i = 0; i < ng; ++i)  // an equality is always outside
    if (d.outside[i] == 0) d.Cx.row(i).setZero(), d.Cu.row(i).setZero();
  d.Lx.noalias() += d.Cx.transpose() * d.outside;
  d.Lxx.noalias() += penalty_ * d.Cx.transpose() * d.Cx;
  if (!with_u) return;
  d.Lu.noalias() += d.Cu.transpose() * d.outside;
  d.Lxu.noalias() += penalty_ * d.Cx.transpose() * d.Cu;
  d.Luu.noalias() += penalty_ * d.Cu.transpose() * d.Cu;
}

double ActionModelAugmented::violation(const ActionDataAbstract& data) const {
  const auto& d = static_cast<const ActionDataAugmented&>(data);
  if (d.c.size() == 0) return 0;
  return (d.c - d.c.cwiseMax(lower_).cwiseMin(upper_)).lpNorm<Eigen::Infinity>();
}

void ActionModelAugmented::update_multipliers(const ActionDataAbstract& data) {
  multipliers_ = static_cast<const ActionDataAugmented&>(data).outside;
}

namespace {

// Of a node of parts, each part.
std::shared_ptr<ActionModelAbstract> augmented_node(const std::shared_ptr<ActionModelAbstract>& model, bool terminal) {
  const auto* whole = dynamic_cast<const ActionModelParts*>(model.get());
  if (!whole) return std::make_shared<ActionModelAugmented>(model, terminal);
  std::vector<ActionPart> parts = whole->get_parts();
  for (ActionPart& part : parts) part.model = augmented_node(part.model, terminal);
  auto out = std::make_shared<ActionModelParts>(whole->get_state(), whole->get_nu(), std::move(parts));
  out->set_storage(whole->get_storage());
  return out;
}

}  // namespace

std::shared_ptr<ShootingProblem> augmented(const ShootingProblem& problem) {
  std::vector<std::shared_ptr<ActionModelAbstract>> running;
  for (const auto& model : problem.get_runningModels()) running.push_back(augmented_node(model, false));
  return std::make_shared<ShootingProblem>(problem.get_x0(), running,
                                           augmented_node(problem.get_terminalModel(), true));
}

}  // namespace manycontact
