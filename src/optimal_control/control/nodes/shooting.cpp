#include "manycontact/control/shooting.hpp"

#include <algorithm>
#include <ostream>

#include "nodes.hpp"

namespace manycontact {

namespace {

constexpr const char* kShootingProblem = "ShootingProblem";

std::shared_ptr<ActionDataAbstract> data_of(const std::shared_ptr<ActionModelAbstract>& model) {
  require(model != nullptr, kShootingProblem, "an action model is a null pointer");
  return model->createData();
}

ShootingProblem::Datas datas_of(const ShootingProblem::Models& models) {
  ShootingProblem::Datas datas;
  for (const auto& model : models) datas.push_back(data_of(model));
  return datas;
}

const ActionModelAbstract& first_of(const ShootingProblem::Models& models) {
  require(!models.empty() && models[0] != nullptr, kShootingProblem,
          "there is no running model, at least one running model is expected");
  return *models[0];
}

}  // namespace

ShootingProblem::ShootingProblem(const Eigen::VectorXd& x0, const Models& running_models, ModelPtr terminal_model)
    : ShootingProblem(x0, running_models, terminal_model, datas_of(running_models), data_of(terminal_model)) {}

ShootingProblem::ShootingProblem(const Eigen::VectorXd& x0, const Models& running_models, ModelPtr terminal_model,
                                 const Datas& running_datas, DataPtr terminal_data)
    : x0_(x0),
      terminal_model_(std::move(terminal_model)),
      terminal_data_(std::move(terminal_data)),
      running_models_(running_models),
      running_datas_(running_datas),
      nx_(first_of(running_models).get_state()->get_nx()),
      ndx_(first_of(running_models).get_state()->get_ndx()) {
  check_size(kShootingProblem, "x0", x0.size(), nx_);
  require(running_datas_.size() == running_models_.size(), kShootingProblem,
          std::to_string(running_datas_.size()) + " running data were given, " +
              std::to_string(running_models_.size()) + " are expected, the number of running models");
  for (std::size_t t = 0; t < get_T(); ++t) check_data(kShootingProblem, running_models_[t], running_datas_[t]);
  check_data(kShootingProblem, terminal_model_, terminal_data_);
  set_nthreads(0);
}

void ShootingProblem::check_node(const char* where, const ModelPtr& model) const {
  require(model != nullptr, where, "an action model is a null pointer");
  const StateAbstract& state = *model->get_state();
  require(state.get_nx() == nx_ && state.get_ndx() == ndx_, where,
          "the state of an action model has another nx or ndx than the other nodes, equal numbers are expected");
}

void ShootingProblem::check_data(const char* where, const ModelPtr& model, const DataPtr& data) const {
  check_node(where, model);
  require(model->checkData(data), where,
          "action data belong to another model, data of the model's createData() are expected");
}

void ShootingProblem::check_sizes(const char* where, std::size_t xs, std::size_t expected_xs, std::size_t us) const {
  require(xs == expected_xs, where,
          "the number of states differs from the number of nodes, equal numbers are expected");
  require(us == get_T(), where,
          "the number of controls differs from the number of running nodes, equal numbers are expected");
}

double ShootingProblem::total_cost() const {
  double cost = 0;
  for (const auto& data : running_datas_) cost += data->cost;
  return cost + terminal_data_->cost;
}

void ShootingProblem::calc_node(std::size_t t, const Vectors& xs, const Vectors& us) {
  if (by_state_alone(t))
    model(t)->calc(data(t), xs[t]);
  else
    model(t)->calc(data(t), xs[t], us[t]);
}

void ShootingProblem::calcDiff_node(std::size_t t, const Vectors& xs, const Vectors& us) {
  if (by_state_alone(t))
    model(t)->calcDiff(data(t), xs[t]);
  else
    model(t)->calcDiff(data(t), xs[t], us[t]);
}

double ShootingProblem::calc(const Vectors& xs, const Vectors& us) {
  check_sizes("ShootingProblem::calc", xs.size(), get_T() + 1, us.size());
  internal::each_node(nthreads_, get_T() + 1, calc_time_, [&](std::size_t t) { calc_node(t, xs, us); });
  return total_cost();
}

double ShootingProblem::calcDiff(const Vectors& xs, const Vectors& us) {
  check_sizes("ShootingProblem::calcDiff", xs.size(), get_T() + 1, us.size());
  internal::each_node(nthreads_, get_T() + 1, calcDiff_time_, [&](std::size_t t) { calcDiff_node(t, xs, us); });
  return total_cost();
}

void ShootingProblem::rollout(const Vectors& us, Vectors& xs) {
  check_sizes("ShootingProblem::rollout", xs.size(), get_T() + 1, us.size());
  xs[0] = x0_;
  for (std::size_t t = 0; t <= get_T(); ++t) {
    calc_node(t, xs, us);
    if (t < get_T()) xs[t + 1] = data(t)->xnext;
  }
}

std::vector<Eigen::VectorXd> ShootingProblem::rollout_us(const Vectors& us) {
  std::vector<Eigen::VectorXd> xs(get_T() + 1);
  rollout(us, xs);
  return xs;
}

void ShootingProblem::quasiStatic(Vectors& us, const Vectors& xs) {
  check_sizes("ShootingProblem::quasiStatic", xs.size(), get_T(), us.size());
  internal::each_node(nthreads_, get_T(), [&](std::size_t t) {
    us[t].setZero(running_models_[t]->get_nu());
    running_models_[t]->quasiStatic(running_datas_[t], us[t], xs[t]);
  });
}

std::vector<Eigen::VectorXd> ShootingProblem::quasiStatic_xs(const Vectors& xs) {
  std::vector<Eigen::VectorXd> us(get_T());
  quasiStatic(us, xs);
  return us;
}

void ShootingProblem::circularAppend(ModelPtr model, DataPtr data) {
  check_data("ShootingProblem::circularAppend", model, data);
  std::rotate(running_models_.begin(), running_models_.begin() + 1, running_models_.end());
  std::rotate(running_datas_.begin(), running_datas_.begin() + 1, running_datas_.end());
  running_models_.back() = std::move(model);
  running_datas_.back() = std::move(data);
  is_updated_ = true;
}

void ShootingProblem::circularAppend(ModelPtr model) {
  check_node("ShootingProblem::circularAppend", model);
  circularAppend(model, model->createData());
}

void ShootingProblem::updateNode(std::size_t i, ModelPtr model, DataPtr data) {
  require(i <= get_T(), "ShootingProblem::updateNode", "the node does not exist, a number from 0 to T is expected");
  check_data("ShootingProblem::updateNode", model, data);
  (i == get_T() ? terminal_model_ : running_models_[i]) = std::move(model);
  (i == get_T() ? terminal_data_ : running_datas_[i]) = std::move(data);
  is_updated_ = true;
}

void ShootingProblem::updateModel(std::size_t i, ModelPtr model) {
  check_node("ShootingProblem::updateModel", model);
  updateNode(i, model, model->createData());
}

std::size_t ShootingProblem::get_nu_max() const {
  std::size_t nu = 0;
  for (const auto& model : running_models_) nu = std::max(nu, model->get_nu());
  return nu;
}

void ShootingProblem::set_x0(const Eigen::VectorXd& x0) {
  check_size("ShootingProblem::set_x0", "x0", x0.size(), nx_);
  x0_ = x0;
}

void ShootingProblem::set_runningModels(const Models& models) {
  (void)first_of(models);
  for (const auto& model : models) check_node("ShootingProblem::set_runningModels", model);
  running_datas_ = datas_of(models);
  running_models_ = models;
  is_updated_ = true;
}

void ShootingProblem::set_nthreads(int nthreads) { nthreads_ = nthreads < 1 ? internal::default_threads() : nthreads; }

std::ostream& operator<<(std::ostream& os, const ShootingProblem& problem) {
  os << "ShootingProblem (T=" << problem.get_T() << ", nx=" << problem.get_nx() << ", ndx=" << problem.get_ndx()
     << ")\n  Models:\n";
  for (std::size_t t = 0; t <= problem.get_T(); ++t) os << (t ? "\n" : "") << "    " << t << ": " << *problem.model(t);
  return os;
}

}  // namespace manycontact
