#include "manycontact/control/parts.hpp"

#include <ostream>

#include "coordinates.hpp"

namespace manycontact {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::put;
using internal::take;
using internal::total;

namespace {

constexpr const char* kActionModelParts = "ActionModelParts";

// The parts' matrices on the rows one after the other, each on its own columns.
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
  part.resize(static_cast<Index>(index.size()));
  take(whole, index, part);
}
void scatter(const VectorXd& part, const std::vector<int>& index, VectorXd& whole) { put(part, index, whole); }

ActionModelParts::ActionModelParts(std::shared_ptr<StateAbstract> state, std::size_t nu, std::vector<ActionPart> parts)
    : ActionModelAbstract(std::move(state), nu, 0, total(kActionModelParts, parts, &ActionModelAbstract::get_ng),
                          total(kActionModelParts, parts, &ActionModelAbstract::get_nh),
                          total(kActionModelParts, parts, &ActionModelAbstract::get_ng_T),
                          total(kActionModelParts, parts, &ActionModelAbstract::get_nh_T)),
      parts_(std::move(parts)) {
  require(!parts_.empty(), kActionModelParts, "there is no part, one at least is expected");
  internal::check_cover(kActionModelParts, "x", state_->get_nx(), parts_, &ActionPart::x);
  internal::check_cover(kActionModelParts, "dx", state_->get_ndx(), parts_, &ActionPart::dx);
  internal::check_cover(kActionModelParts, "u", nu, parts_, &ActionPart::u);
  for (const ActionPart& part : parts_) {
    const ActionModelAbstract& model = *part.model;
    check_size(kActionModelParts, "a part's x", part.x.size(), model.get_state()->get_nx());
    check_size(kActionModelParts, "a part's dx", part.dx.size(), model.get_state()->get_ndx());
    check_size(kActionModelParts, "a part's u", part.u.size(), model.get_nu());
    put(model.get_u_lb(), part.u, u_lb_);
    put(model.get_u_ub(), part.u, u_ub_);
  }
  update_has_control_limits();
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_lb, g_lb_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_ub, g_ub_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_lb_T, g_lb_T_);
  internal::stack_bounds(parts_, &ActionModelAbstract::get_g_ub_T, g_ub_T_);
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
  for (const DataPtr& part : parts)
    require(storage_ == MatrixStorage::kSparse || check_data("ActionModelParts::createData", part).has_matrices(),
            "ActionModelParts::createData", "a part's data have no matrices, storage kSparse is expected");
  auto data = storage_ == MatrixStorage::kDense ? std::make_shared<ActionDataParts>(this)
                                                : std::make_shared<ActionDataParts>(this, WithoutMatrices{});
  data->parts = std::move(parts);
  for (const ActionPart& part : parts_) {
    data->x.emplace_back(VectorXd::Zero(static_cast<Index>(part.x.size())));
    data->u.emplace_back(VectorXd::Zero(static_cast<Index>(part.u.size())));
  }
  return data;
}

bool ActionModelParts::checkData(const DataPtr& data) {
  const auto* own = dynamic_cast<const ActionDataParts*>(data.get());
  if (!own || own->parts.size() != parts_.size()) return false;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (!parts_[i].model->checkData(own->parts[i])) return false;
  return true;
}

void ActionModelParts::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelParts::calc", x, u);
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::calc", data);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    take(x, parts_[i].x, d.x[i]);
    take(u, parts_[i].u, d.u[i]);
    parts_[i].model->calc(d.parts[i], d.x[i], d.u[i]);
  }
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelParts::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelParts::calc", x);
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::calc", data);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    take(x, parts_[i].x, d.x[i]);
    parts_[i].model->calc(d.parts[i], d.x[i]);
  }
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelParts::collect(const DataPtr& data) const {
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::collect", data);
  internal::collect_values(parts_, d.parts, d);
}

void ActionModelParts::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("ActionModelParts::calcDiff", x, u);
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::calcDiff", data);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    take(x, parts_[i].x, d.x[i]);
    take(u, parts_[i].u, d.u[i]);
    parts_[i].model->calcDiff(d.parts[i], d.x[i], d.u[i]);
  }
  internal::collect_values(parts_, d.parts, d);
  if (d.Fx.size() > 0) collect_derivatives(d);
}

void ActionModelParts::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("ActionModelParts::calcDiff", x);
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::calcDiff", data);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    take(x, parts_[i].x, d.x[i]);
    parts_[i].model->calcDiff(d.parts[i], d.x[i]);
  }
  internal::collect_values(parts_, d.parts, d);
  if (d.Fx.size() > 0) collect_derivatives(d);
}

// What stands between parts is zero since createData.
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
  check("ActionModelParts::quasiStatic", x, u);
  auto& d = internal::own_data<ActionDataParts>("ActionModelParts::quasiStatic", data);
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
  for (std::size_t i = 0; i < parts_.size(); ++i) os << (i ? ", " : "") << *parts_[i].model;
  os << "}";
}

}  // namespace manycontact
