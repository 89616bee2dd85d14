#include "manycontact/detail/control/parts.hpp"

#include <ostream>

#include "coordinates.hpp"
#include "manycontact/detail/control/couplings.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::put;
using internal::take;
using internal::total;

namespace {

// Stacks the matrices get(i) of the subproblems by rows. Each matrix has the columns of its subproblem.
template <class Get>
void stack(const std::vector<ActionPart>& parts, std::vector<int> ActionPart::*columns, Get get, MatrixXd& out) {
  Index row = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) row += get(i).rows();
  out.setZero(row, out.cols());
  row = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const MatrixXd& part = get(i);
    const std::vector<int>& cols = parts[i].*columns;
    for (std::size_t j = 0; j < cols.size(); ++j)
      out.col(cols[j]).segment(row, part.rows()) = part.col(static_cast<Index>(j));
    row += part.rows();
  }
}

}  // namespace

void gather(const VectorXd& whole, const std::vector<int>& index, VectorXd& part) {
  part.resize(index.size());
  take(whole, index, part);
}
void scatter(const VectorXd& part, const std::vector<int>& index, VectorXd& whole) { put(part, index, whole); }

ActionModelParts::ActionModelParts(std::shared_ptr<StateAbstract> state, std::size_t nu, std::vector<ActionPart> parts)
    : NodeWithData(std::move(state), nu, 0, total(kName, parts, &ActionModelAbstract::get_ng),
                   total(kName, parts, &ActionModelAbstract::get_nh),
                   total(kName, parts, &ActionModelAbstract::get_ng_T),
                   total(kName, parts, &ActionModelAbstract::get_nh_T)),
      parts_(std::move(parts)) {
  check_parts();
  for (const ActionPart& part : parts_) {
    check_size(kName, "a part's u", part.u.size(), part.model->get_nu());
    put(part.model->get_u_lb(), part.u, u_lb_);
    put(part.model->get_u_ub(), part.u, u_ub_);
  }
  update_has_control_limits();
}

ActionModelParts::ActionModelParts(std::shared_ptr<StateMultibody> state, Scene scene, std::vector<ActionPart> parts)
    : NodeWithData(state, static_cast<std::size_t>(scene.nu), 0, total(kName, parts, &ActionModelAbstract::get_ng),
                   total(kName, parts, &ActionModelAbstract::get_nh),
                   total(kName, parts, &ActionModelAbstract::get_ng_T),
                   total(kName, parts, &ActionModelAbstract::get_nh_T)),
      parts_(std::move(parts)),
      couplings_(std::make_shared<Couplings>(std::move(scene), parts_)) {
  const Scene& own = couplings_->scene();
  check_size(kName, "the scene's q and v", own.nq + own.nv, state_->get_nx());
  check_parts();
  const VectorXd& effort = state->get_model()->effortLimit;
  for (const Robot& robot : own.robots)
    for (int k = 0; k < robot.model->nu(); ++k) u_ub_[robot.idx_u + k] = effort[robot.idx_v + robot.model->actuated[k]];
  u_lb_ = -u_ub_;
  update_has_control_limits();
}

void ActionModelParts::check_parts() {
  require(!parts_.empty(), kName, "there is no part, at least one part is expected");
  internal::check_cover(kName, "x", state_->get_nx(), parts_, &ActionPart::x);
  internal::check_cover(kName, "dx", state_->get_ndx(), parts_, &ActionPart::dx);
  internal::check_cover(kName, "u", nu_, parts_, &ActionPart::u);
  for (const ActionPart& part : parts_) {
    check_size(kName, "a part's x", part.x.size(), part.model->get_state()->get_nx());
    check_size(kName, "a part's dx", part.dx.size(), part.model->get_state()->get_ndx());
  }
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_lb, g_lb_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_ub, g_ub_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_lb_T, g_lb_T_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_ub_T, g_ub_T_);
}

std::shared_ptr<ActionModelParts> ActionModelParts::with_models(std::vector<ActionPart> parts) const {
  auto out = couplings_ ? std::make_shared<ActionModelParts>(std::static_pointer_cast<StateMultibody>(state_),
                                                             couplings_->scene(), std::move(parts))
                        : std::make_shared<ActionModelParts>(state_, nu_, std::move(parts));
  out->set_u_lb(u_lb_);
  out->set_u_ub(u_ub_);
  out->set_storage(storage_);
  return out;
}

void ActionModelParts::set_storage(MatrixStorage storage) {
  require(storage == MatrixStorage::kDense || storage == MatrixStorage::kSparse, "ActionModelParts::set_storage",
          "kDense or kSparse is expected");
  storage_ = storage;
}

DataPtr ActionModelParts::createData() {
  std::vector<DataPtr> parts;
  for (const ActionPart& part : parts_) parts.push_back(part.model->createData());
  return createData(std::move(parts));
}

DataPtr ActionModelParts::createData(std::vector<DataPtr> parts) {
  check_size("ActionModelParts::createData", "the parts' data", parts.size(), parts_.size());
  const bool without = storage_ == MatrixStorage::kSparse && !couplings_;
  for (const DataPtr& part : parts)
    require(without || check_data("ActionModelParts::createData", part).has_matrices(), "ActionModelParts::createData",
            "the data of a part have no matrices: storage kSparse and no couplings are expected");
  auto data = storage_ == MatrixStorage::kDense ? std::make_shared<ActionDataParts>(this)
                                                : std::make_shared<ActionDataParts>(this, WithoutMatrices{});
  data->parts = std::move(parts);
  for (const ActionPart& part : parts_) {
    data->x.emplace_back(VectorXd::Zero(part.x.size()));
    data->u.emplace_back(VectorXd::Zero(part.model->get_nu()));
  }
  if (couplings_) data->couplings = std::make_shared<CouplingData>(*couplings_, parts_);
  return data;
}

bool ActionModelParts::checkData(const DataPtr& data) {
  const auto* own = dynamic_cast<const ActionDataParts*>(data.get());
  if (!own || own->parts.size() != parts_.size() || !own->couplings != !couplings_) return false;
  if (couplings_ && own->couplings->couplings.size() != couplings_->couplings().size()) return false;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (!parts_[i].model->checkData(own->parts[i])) return false;
  return true;
}

// Copies each subproblem's share of x and u. Couplings::solve sets the wrenches, which follow a subproblem's controls.
void ActionModelParts::take_values(const ConstVectorRef& x, const ConstVectorRef* u, ActionDataParts& d) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    take(x, parts_[i].x, d.x[i]);
    if (u) take(*u, parts_[i].u, d.u[i].head(parts_[i].u.size()));
  }
}

void ActionModelParts::evaluate(ActionDataParts& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  take_values(x, u, d);
  if (u && couplings_) couplings_->solve(parts_, x, *u, d);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    u ? parts_[i].model->calc(d.parts[i], d.x[i], d.u[i]) : parts_[i].model->calc(d.parts[i], d.x[i]);
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelParts::collect(const DataPtr& data) const {
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::collect", data);
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelParts::differentiate(ActionDataParts& d, const ConstVectorRef& x, const ConstVectorRef* u) {
  take_values(x, u, d);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    u ? parts_[i].model->calcDiff(d.parts[i], d.x[i], d.u[i]) : parts_[i].model->calcDiff(d.parts[i], d.x[i]);
  internal::collect_values(parts_, d.parts, d);
  const bool coupled = u && couplings_ && !couplings_->couplings().empty();
  if (coupled) couplings_->differentiate(parts_, d);
  if (d.Fx.size() == 0) return;
  coupled ? couplings_->condense(parts_, d) : collect_derivatives(d);
}

// Copies the subproblems' derivatives into the node's matrices, whose other blocks are zero from createData.
void ActionModelParts::collect_derivatives(ActionDataParts& d) const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const ActionPart& p = parts_[i];
    const ActionDataAbstract& from = *d.parts[i];
    put(from.Fx, p.dx, p.dx, d.Fx);
    put(from.Fu, p.dx, p.u, d.Fu);
    put(from.Lx, p.dx, d.Lx);
    put(from.Lu, p.u, d.Lu);
    put(from.Lxx, p.dx, p.dx, d.Lxx);
    put(from.Lxu, p.dx, p.u, d.Lxu);
    put(from.Luu, p.u, p.u, d.Luu);
  }
  const auto data = [&](std::size_t i) -> const ActionDataAbstract& { return *d.parts[i]; };
  stack(
      parts_, &ActionPart::dx, [&](std::size_t i) -> const MatrixXd& { return data(i).Gx; }, d.Gx);
  stack(
      parts_, &ActionPart::u, [&](std::size_t i) -> const MatrixXd& { return data(i).Gu; }, d.Gu);
  stack(
      parts_, &ActionPart::dx, [&](std::size_t i) -> const MatrixXd& { return data(i).Hx; }, d.Hx);
  stack(
      parts_, &ActionPart::u, [&](std::size_t i) -> const MatrixXd& { return data(i).Hu; }, d.Hu);
}

void ActionModelParts::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter,
                                   double tol) {
  if (couplings_) return ActionModelAbstract::quasiStatic(data, u, x, maxiter, tol);
  const ConstVectorRef given = u;
  ActionDataParts& d = own("quasiStatic", data, x, &given);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    if (parts_[i].u.empty()) continue;
    take(x, parts_[i].x, d.x[i]);
    take(u, parts_[i].u, d.u[i]);
    parts_[i].model->quasiStatic(d.parts[i], d.u[i], d.x[i], maxiter, tol);
    put(d.u[i], parts_[i].u, u);
  }
}

void ActionModelParts::print(std::ostream& os) const {
  os << "ActionModelParts {";
  if (couplings_) os << "couplings=" << couplings_->couplings().size() << ", ";
  for (std::size_t i = 0; i < parts_.size(); ++i) os << (i ? ", " : "") << *parts_[i].model;
  os << "}";
}

namespace {

constexpr const char* kSeparate = "separate";

std::vector<int> all(std::size_t count) { return internal::range(0, static_cast<int>(count)); }

const ActionModelParts* as_parts(const std::shared_ptr<ActionModelAbstract>& model) {
  const auto* parts = dynamic_cast<const ActionModelParts*>(model.get());
  return parts && !parts->get_couplings() ? parts : nullptr;
}

const ActionModelParts& parts_of(const ShootingProblem& problem, std::size_t t) {
  const auto* model = as_parts(problem.model(t));
  require(model != nullptr, kSeparate,
          "some nodes are ActionModelParts and others are not: ActionModelParts at all nodes are expected");
  return *model;
}

std::shared_ptr<ActionDataAbstract> data_of(const std::shared_ptr<ActionDataAbstract>& data, std::size_t part) {
  return internal::own_data<ActionDataParts>(kSeparate, data).parts[part];
}

ShootingPart whole(const ShootingProblem& problem) {
  ShootingPart out;
  out.problem = std::make_shared<ShootingProblem>(problem);
  out.x = all(problem.get_nx());
  out.dx = all(problem.get_ndx());
  for (const auto& model : problem.get_runningModels()) out.u.push_back(all(model->get_nu()));
  return out;
}

ShootingPart part_of(const ShootingProblem& problem, std::size_t i) {
  const std::size_t T = problem.get_T();
  ShootingPart out;
  const ActionPart& last = parts_of(problem, T).get_parts()[i];
  out.x = last.x;
  out.dx = last.dx;
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  for (std::size_t t = 0; t < T; ++t) {
    const std::vector<ActionPart>& parts = parts_of(problem, t).get_parts();
    require(parts.size() == parts_of(problem, T).get_parts().size() && parts[i].x == out.x && parts[i].dx == out.dx,
            kSeparate, "the nodes' parts differ, the same coordinates of x and dx at every node are expected");
    models.push_back(parts[i].model);
    datas.push_back(data_of(problem.get_runningDatas()[t], i));
    out.u.push_back(parts[i].u);
  }
  Eigen::VectorXd x0;
  gather(problem.get_x0(), out.x, x0);
  out.problem =
      std::make_shared<ShootingProblem>(x0, models, last.model, datas, data_of(problem.get_terminalData(), i));
  return out;
}

}  // namespace

std::vector<ShootingPart> separate(const ShootingProblem& problem) {
  bool any = false;
  for (std::size_t t = 0; t <= problem.get_T(); ++t) any |= as_parts(problem.model(t)) != nullptr;
  if (!any) return {whole(problem)};
  std::vector<ShootingPart> out;
  for (std::size_t i = 0; i < parts_of(problem, problem.get_T()).get_parts().size(); ++i)
    out.push_back(part_of(problem, i));
  return out;
}

}  // namespace manycontact
