#include "manycontact/action/cost.hpp"

#include <ostream>
#include <stdexcept>
#include <typeinfo>

#include "../by_node.hpp"
#include "../named.hpp"

namespace manycontact {

namespace {

// The residual of a user-defined cost constructed without one. Its calc does nothing, as the cost may write r itself.
class OwnResidual final : public ResidualModelAbstract {
 public:
  using ResidualModelAbstract::ResidualModelAbstract;
  void calc(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&, const ConstVectorRef&) override {}
  void calc(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&) override {}
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&, const ConstVectorRef&) override {}
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>&, const ConstVectorRef&) override {}
  void print(std::ostream& os) const override { os << "nr=" << nr_; }
};

std::shared_ptr<ResidualModelAbstract> own_residual(const std::shared_ptr<StateAbstract>& state, std::size_t nr,
                                                    std::size_t nu) {
  const std::size_t nv = internal::given("CostModelAbstract", state, "a state")->get_nv();
  return std::make_shared<OwnResidual>(state, nr, nu == kDefaultNu ? nv : nu);
}

std::size_t nr_of(const std::shared_ptr<ActivationModelAbstract>& activation) {
  return internal::given("CostModelAbstract", activation, "an activation")->get_nr();
}

// Computes the cost's derivatives from the residual's blocks, with Gauss-Newton Hessians.
CostDerivatives by_residual(const CostDataAbstract& d) {
  const Eigen::MatrixXd Rx = d.residual->whole_Rx(), Ru = d.residual->whole_Ru();
  const auto& Arr = d.activation->Arr;
  CostDerivatives out;
  out.Lx = Rx.transpose() * d.activation->Ar;
  out.Lu = Ru.transpose() * d.activation->Ar;
  out.Lxx = Rx.transpose() * Arr * Rx;
  out.Lxu = Rx.transpose() * Arr * Ru;
  out.Luu = Ru.transpose() * Arr * Ru;
  return out;
}

}  // namespace

CostDataAbstract::CostDataAbstract(CostModelAbstract* model, DataCollector* s)
    : shared(s),
      of_residual(model->get_residual()),
      of_activation(model->get_activation()),
      activation(model->get_activation()->createData()),
      residual(model->get_residual()->createData(s)),
      own(typeid(*model) != typeid(CostModelResidual)) {
  if (!own && !(shared && shared->whole)) return;
  const auto ndx = static_cast<Eigen::Index>(model->get_state()->get_ndx());
  const auto nu = static_cast<Eigen::Index>(model->get_nu());
  if (residual->Rx.rows() != residual->r.size() || residual->Rx.cols() != ndx) {
    residual->Rx.setZero(residual->r.size(), ndx);
    residual->Ru.setZero(residual->r.size(), nu);
  }
  Lx.setZero(ndx);
  Lu.setZero(nu);
  Lxx.setZero(ndx, ndx);
  Lxu.setZero(ndx, nu);
  Luu.setZero(nu, nu);
}

CostDerivatives CostDataAbstract::whole_derivatives() const {
  if (!own) return by_residual(*this);
  CostDerivatives out;
  out.Lx = Lx, out.Lu = Lu;
  out.Lxx = Lxx, out.Lxu = Lxu, out.Luu = Luu;
  return out;
}

CostModelAbstract::CostModelAbstract(std::shared_ptr<StateAbstract> state,
                                     std::shared_ptr<ActivationModelAbstract> activation,
                                     std::shared_ptr<ResidualModelAbstract> residual)
    : state_(std::move(state)), activation_(std::move(activation)), residual_(std::move(residual)) {
  require(state_ && activation_ && residual_, "CostModelResidual",
          "a null pointer was given, a state, an activation and a residual are expected");
  require(same_space(*residual_->get_state(), *state_), "CostModelResidual",
          "the residual belongs to another state, the cost's state is expected");
  require(activation_->get_nr() == residual_->get_nr(), "CostModelResidual",
          "the activation has nr = " + std::to_string(activation_->get_nr()) +
              ", the residual's nr = " + std::to_string(residual_->get_nr()) + " is expected");
  unone_ = Eigen::VectorXd::Zero(get_nu());
}

CostModelAbstract::CostModelAbstract(std::shared_ptr<StateAbstract> state,
                                     std::shared_ptr<ActivationModelAbstract> activation, std::size_t nu)
    : CostModelAbstract(state, activation, own_residual(state, nr_of(activation), nu)) {}

void CostModelAbstract::calcDiff(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) {
  throw std::logic_error(
      "CostModelAbstract::calcDiff: the cost has no derivatives, define calcDiff in the class of the cost");
}

void CostModelAbstract::print(std::ostream& os) const {
  os << "CostModelAbstract {" << *residual_ << ", " << *activation_ << "}";
}

void CostModelResidual::print(std::ostream& os) const {
  os << "CostModelResidual {" << *residual_ << ", " << *activation_ << "}";
}

void CostModelResidual::check(const char* where, const DataPtr& data) const {
  const CostDataAbstract& d = check_data(where, data);
  require(d.of_residual == residual_ && d.of_activation == activation_, where,
          "the data were created by another cost, data of this cost's createData() are expected");
}

void CostModelResidual::evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  check("CostModelResidual::calc", data);
  internal::calc(*residual_, data->residual, x, u);
  activation_->calc(data->activation, data->residual->r);
  data->cost = data->activation->a_value;
}

void CostModelResidual::differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  check("CostModelResidual::calcDiff", data);
  internal::calc_diff(*residual_, data->residual, x, u);
  residual_->take_whole(*data->residual);
  activation_->calcDiff(data->activation, data->residual->r);
  if (data->Lx.size() == 0) return;
  CostDerivatives d = by_residual(*data);
  data->Lx.swap(d.Lx);
  data->Lxx.swap(d.Lxx);
  if (!u) return;
  data->Lu.swap(d.Lu);
  data->Lxu.swap(d.Lxu);
  data->Luu.swap(d.Luu);
}

// ---- sum of costs

namespace {
bool is_active(const CostItem& item) { return item.active; }
std::size_t nr_of(const CostItem& item) { return item.cost->get_residual()->get_nr(); }

// Sets all derivatives to zero. In a terminal node these are only Lx and Lxx.
template <class Derivatives>
void set_zero(Derivatives& d, bool terminal) {
  d.Lx.setZero();
  d.Lxx.setZero();
  if (terminal) return;
  d.Lu.setZero();
  d.Lxu.setZero();
  d.Luu.setZero();
}
}  // namespace

static std::ostream& operator<<(std::ostream& os, const CostItem& item) {
  return os << "{w=" << item.weight << ", " << *item.cost << "}";
}

template class NamedParts<StateAbstract, CostItem>;

CostModelSum::CostModelSum(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : NamedParts("CostModelSum", "cost", std::move(state), nu) {}

// Adds a cost and updates the number of rows. Counting the rows of all costs again would make many additions slow.
void CostModelSum::addCost(const std::string& name, std::shared_ptr<CostModelAbstract> cost, double weight,
                           bool active) {
  internal::check_part(name_, name, cost, state_, nu_);
  const CostItem item{name, cost, weight, active};
  add(item);
  nr_total_ += nr_of(item);
  if (active) nr_ += nr_of(item);
}

void CostModelSum::removeCost(const std::string& name) {
  const std::size_t nr = nr_of(part(name));
  nr_total_ -= nr;
  if (active_set_.contains(name)) nr_ -= nr;
  remove(name);
}

void CostModelSum::changeCostStatus(const std::string& name, bool active) {
  const bool counted = active_set_.contains(name);
  if (!change_status(name, active) || counted == active) return;
  nr_ = active ? nr_ + nr_of(part(name)) : nr_ - nr_of(part(name));
}

void CostModelSum::check(const char* where, const DataPtr& data, const ConstVectorRef& x,
                         const ConstVectorRef* u) const {
  const CostDataSum& d = check_data(where, data);
  check_size(where, "x", x.size(), state_->get_nx());
  require(d.version == version_ && d.costs.size() == parts_.size(), where,
          "costs were added or removed since the data were created, new data are expected");
  if (u) check_size(where, "u", u->size(), nu_);
}

void CostModelSum::evaluate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  check("CostModelSum::calc", data, x, u);
  data->cost = 0;
  internal::for_each_part(parts_, data->costs, is_active, [&](const CostItem& item, const auto& d) {
    internal::calc(*item.cost, d, x, u);
    data->cost += item.weight * d->cost;
  });
}

void CostModelSum::differentiate(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  check("CostModelSum::calcDiff", data, x, u);
  internal::for_each_part(parts_, data->costs, is_active,
                          [&](const CostItem& item, const auto& d) { internal::calc_diff(*item.cost, d, x, u); });
  add_up(*data, !u);
}

// Sums the derivatives of all costs in standalone evaluation, in which each cost has complete Lx, ..., Luu.
void CostModelSum::add_up_by_hand(CostDataSum& data, bool terminal) const {
  set_zero(data, terminal);
  internal::for_each_part(parts_, data.costs, is_active, [&](const CostItem& item, const auto& d) {
    data.Lx += item.weight * d->Lx;
    data.Lxx += item.weight * d->Lxx;
    if (terminal) return;
    data.Lu += item.weight * d->Lu;
    data.Lxu += item.weight * d->Lxu;
    data.Luu += item.weight * d->Luu;
  });
}

void CostModelSum::add_up(CostDataSum& data, bool terminal) const {
  if (data.shared && data.shared->whole) return add_up_by_hand(data, terminal);
  CostDerivatives& out = *data.derivatives;
  set_zero(out, terminal);
  out.Lxx_blocks.set_zero();
  if (!terminal) {
    out.Lxu_blocks.set_zero();
    out.Luu_blocks.set_zero();
  }
  std::size_t k = 0;
  for (const auto& [name, item] : parts_) data.weights[k++] = item->active ? item->weight : 0;
  data.groups.add(data.weights, terminal, out);
}

std::shared_ptr<CostDataSum> CostModelSum::createData(DataCollector* shared, CostDerivatives* out) {
  auto data = std::make_shared<CostDataSum>();
  data->shared = shared;
  data->version = version_;
  for (const auto& [name, item] : parts_) {
    data->costs[name] = item->cost->createData(shared);
    check_data("CostModelSum::createData", data->costs[name]);
  }
  if (out)
    data->derivatives = out;
  else
    data->own.resize(state_->get_ndx(), nu_, MatrixStorage::kBoth);
  lay_out(*data);
  data->shareMemory(data->derivatives);
  return data;
}

void CostModelSum::lay_out(CostDataSum& data) const {
  CostDerivatives& out = *data.derivatives;
  std::vector<const CostDataAbstract*> parts;
  for (const auto& [name, d] : data.costs) {
    parts_.at(name)->cost->get_residual()->lay_out(*d->residual);
    parts.push_back(d.get());
  }
  data.weights.assign(parts.size(), 0);
  data.groups.lay_out(parts, static_cast<int>(state_->get_ndx()), static_cast<int>(nu_), out);
}

}  // namespace manycontact
