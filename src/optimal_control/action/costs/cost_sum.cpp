#include "../named.hpp"
#include "manycontact/action/cost.hpp"

namespace manycontact {

namespace {
bool is_active(const CostItem& item) { return item.active; }
std::size_t nr_of(const CostItem& item) { return item.cost->get_residual()->get_nr(); }
}  // namespace

static std::ostream& operator<<(std::ostream& os, const CostItem& item) {
  return os << "{w=" << item.weight << ", " << *item.cost << "}";
}

template class NamedParts<StateAbstract, CostItem>;

CostModelSum::CostModelSum(std::shared_ptr<StateAbstract> state, std::size_t nu)
    : NamedParts("CostModelSum", "cost", std::move(state), nu) {}

// Numbers of rows change one by one, since sums may have many costs.
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

void CostModelSum::check(const char* where, const CostDataSum& data, const ConstVectorRef& x) const {
  check_size(where, "x", x.size(), state_->get_nx());
  require(data.version == version_ && data.costs.size() == parts_.size(), where,
          "costs were added or removed since the data were created, new data are expected");
}

void CostModelSum::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("CostModelSum::calc", check_data("CostModelSum::calc", data), x);
  check_size("CostModelSum::calc", "u", u.size(), nu_);
  data->cost = 0;
  internal::for_each_part(parts_, data->costs, is_active, [&](const CostItem& item, const auto& d) {
    item.cost->calc(d, x, u);
    data->cost += item.weight * d->cost;
  });
}

void CostModelSum::calc(const DataPtr& data, const ConstVectorRef& x) {
  check("CostModelSum::calc", check_data("CostModelSum::calc", data), x);
  data->cost = 0;
  internal::for_each_part(parts_, data->costs, is_active, [&](const CostItem& item, const auto& d) {
    item.cost->calc(d, x);
    data->cost += item.weight * d->cost;
  });
}

void CostModelSum::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("CostModelSum::calcDiff", check_data("CostModelSum::calcDiff", data), x);
  check_size("CostModelSum::calcDiff", "u", u.size(), nu_);
  internal::for_each_part(parts_, data->costs, is_active,
                          [&](const CostItem& item, const auto& d) { item.cost->calcDiff(d, x, u); });
  add_up(*data, false);
}

void CostModelSum::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  check("CostModelSum::calcDiff", check_data("CostModelSum::calcDiff", data), x);
  internal::for_each_part(parts_, data->costs, is_active,
                          [&](const CostItem& item, const auto& d) { item.cost->calcDiff(d, x); });
  add_up(*data, true);
}

// Sums the derivatives of the costs themselves, which data in standalone use have.
void CostModelSum::add_up_by_hand(CostDataSum& data, bool terminal) const {
  data.Lx.setZero();
  data.Lxx.setZero();
  if (!terminal) {
    data.Lu.setZero();
    data.Lxu.setZero();
    data.Luu.setZero();
  }
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
  out.Lx.setZero();
  out.Lxx.setZero();
  out.Lxx_blocks.set_zero();
  if (!terminal) {
    out.Lu.setZero();
    out.Lxu.setZero();
    out.Luu.setZero();
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
