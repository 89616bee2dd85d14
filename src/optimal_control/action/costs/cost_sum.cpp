#include "../named.hpp"
#include "manycontact/action/cost.hpp"

namespace manycontact {

namespace {
constexpr const char* kCostModelSum = "CostModelSum";
bool is_active(const CostItem& item) { return item.active; }
}  // namespace

CostModelSum::CostModelSum(std::shared_ptr<StateAbstract> state, std::size_t nu) : state_(std::move(state)), nu_(nu) {
  require(state_ != nullptr, kCostModelSum, "a state is expected, not a null pointer");
}

CostModelSum::CostModelSum(std::shared_ptr<StateAbstract> state) : CostModelSum(state, state ? state->get_nv() : 0) {}

void CostModelSum::addCost(const std::string& name, std::shared_ptr<CostModelAbstract> cost, double weight,
                           bool active) {
  internal::check_part(kCostModelSum, name, cost, state_, nu_);
  internal::check_new(kCostModelSum, "cost", costs_, name);
  const auto item = std::make_shared<CostItem>(CostItem{name, cost, weight, active});
  costs_[name] = item;
  ++version_;
  nr_total_ += cost->get_residual()->get_nr();
  count(*item);
}

void CostModelSum::removeCost(const std::string& name) {
  const auto at = internal::find_named(kCostModelSum, "cost", costs_, name);
  const std::size_t nr = at->second->cost->get_residual()->get_nr();
  nr_total_ -= nr;
  if (active_set_.erase(name) > 0) nr_ -= nr;
  inactive_set_.erase(name);
  costs_.erase(at);
  ++version_;
}

void CostModelSum::changeCostStatus(const std::string& name, bool active) {
  CostItem& item = *internal::find_named(kCostModelSum, "cost", costs_, name)->second;
  if (item.active == active) return;
  item.active = active;
  count(item);
}

// One that was added or switched: sums of many costs are made one by one.
void CostModelSum::count(const CostItem& item) {
  const std::size_t nr = item.cost->get_residual()->get_nr();
  const bool counted = active_set_.contains(item.name);
  internal::sort_name(item.name, item.active, active_set_, inactive_set_);
  if (item.active && !counted) nr_ += nr;
  if (!item.active && counted) nr_ -= nr;
}

bool CostModelSum::getCostStatus(const std::string& name) const {
  return internal::find_named(kCostModelSum, "cost", costs_, name)->second->active;
}

void CostModelSum::check(const char* where, const CostDataSum& data, const ConstVectorRef& x) const {
  check_size(where, "x", x.size(), state_->get_nx());
  require(data.version == version_ && data.costs.size() == costs_.size(), where,
          "costs were added or removed since the data were created, new data are expected");
}

void CostModelSum::calc(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  check("CostModelSum::calc", check_data("CostModelSum::calc", data), x);
  check_size("CostModelSum::calc", "u", u.size(), nu_);
  data->cost = 0;
  internal::for_each_part(costs_, data->costs, is_active, [&](const CostItem& item, const auto& d) {
    item.cost->calc(d, x, u);
    data->cost += item.weight * d->cost;
  });
}

void CostModelSum::calc(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x) {
  check("CostModelSum::calc", check_data("CostModelSum::calc", data), x);
  data->cost = 0;
  internal::for_each_part(costs_, data->costs, is_active, [&](const CostItem& item, const auto& d) {
    item.cost->calc(d, x);
    data->cost += item.weight * d->cost;
  });
}

void CostModelSum::calcDiff(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x,
                            const ConstVectorRef& u) {
  check("CostModelSum::calcDiff", check_data("CostModelSum::calcDiff", data), x);
  check_size("CostModelSum::calcDiff", "u", u.size(), nu_);
  internal::for_each_part(costs_, data->costs, is_active,
                          [&](const CostItem& item, const auto& d) { item.cost->calcDiff(d, x, u); });
  add_up(*data, false);
}

void CostModelSum::calcDiff(const std::shared_ptr<CostDataSum>& data, const ConstVectorRef& x) {
  check("CostModelSum::calcDiff", check_data("CostModelSum::calcDiff", data), x);
  internal::for_each_part(costs_, data->costs, is_active,
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
  internal::for_each_part(costs_, data.costs, is_active, [&](const CostItem& item, const auto& d) {
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
  for (const auto& [name, item] : costs_) data.weights[k++] = item->active ? item->weight : 0;
  data.groups.add(data.weights, terminal, out);
}

std::shared_ptr<CostDataSum> CostModelSum::createData(DataCollector* shared, CostDerivatives* out) {
  auto data = std::make_shared<CostDataSum>();
  data->shared = shared;
  data->version = version_;
  for (const auto& [name, item] : costs_) {
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
    costs_.at(name)->cost->get_residual()->lay_out(*d->residual);
    parts.push_back(d.get());
  }
  data.weights.assign(parts.size(), 0);
  data.groups.lay_out(parts, static_cast<int>(state_->get_ndx()), static_cast<int>(nu_), out);
}

void CostModelSum::print(std::ostream& os) const {
  internal::print_parts(os, kCostModelSum, costs_, [](std::ostream& out, const CostItem& item) {
    out << "{w=" << item.weight << ", " << *item.cost << "}";
  });
}

std::ostream& operator<<(std::ostream& os, const CostModelSum& model) {
  model.print(os);
  return os;
}

}  // namespace manycontact
