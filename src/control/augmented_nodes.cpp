// The problem's nodes within the augmented Lagrangian, and their multipliers.

#include <algorithm>
#include <numeric>

#include "constraint_rows.hpp"
#include "coordinates.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/control/parts.hpp"

namespace manycontact {

using AL = SolverAugmentedLagrangian;
using Multipliers = std::vector<Eigen::VectorXd>;
using internal::rows_at;

namespace {

constexpr const char* kAugmentedNodes = "SolverAugmentedLagrangian";

std::vector<int> all_rows(Eigen::Index count) {
  std::vector<int> out(static_cast<std::size_t>(count));
  std::iota(out.begin(), out.end(), 0);
  return out;
}

}  // namespace

AL::Augmented AL::augment(const std::shared_ptr<ActionModelAbstract>& model,
                          const std::shared_ptr<ActionDataAbstract>& data, std::vector<int> rows,
                          const Eigen::VectorXd& multipliers) const {
  Augmented out;
  out.model = std::make_shared<ActionModelAugmentedLagrangian>(model);
  out.model->set_penalty(rho_);
  Eigen::VectorXd own;
  gather(multipliers, rows, own);
  out.model->set_multipliers(own);
  out.data = std::static_pointer_cast<ActionDataAugmentedLagrangian>(out.model->createData(data));
  out.rows = std::move(rows);
  return out;
}

// Nodes without constraints are the problem's own. Of ActionModelParts each part is taken on its own.
AL::Node AL::decorated(std::size_t t, const Eigen::VectorXd& multipliers) const {
  Node out{problem_->model(t), problem_->model(t), problem_->data(t), problem_->data(t), {}};
  if (multipliers.size() == 0) return out;
  const auto* whole = dynamic_cast<const ActionModelParts*>(out.model.get());
  if (!whole) {
    out.augmented.push_back(augment(out.model, out.data, all_rows(multipliers.size()), multipliers));
    out.augmented_model = out.augmented.back().model;
    out.augmented_data = out.augmented.back().data;
    return out;
  }
  std::vector<ActionPart> parts = whole->get_parts();
  auto datas = internal::own_data<ActionDataParts>(kAugmentedNodes, out.data).parts;
  const std::vector<std::vector<int>> rows = constraint_rows(*whole, problem_->by_state_alone(t));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (rows[i].empty()) continue;
    out.augmented.push_back(augment(parts[i].model, datas[i], rows[i], multipliers));
    parts[i].model = out.augmented.back().model;
    datas[i] = out.augmented.back().data;
  }
  const auto model = std::make_shared<ActionModelParts>(whole->get_state(), whole->get_nu(), std::move(parts));
  model->set_storage(whole->get_storage());
  out.augmented_model = model;
  out.augmented_data = model->createData(std::move(datas));
  return out;
}

// Whether augmented_ is still that of the problem's nodes.
bool AL::is_decorated() const {
  const std::size_t T = problem_->get_T();
  if (augmented_->get_T() != T) return false;
  for (std::size_t t = 0; t <= T; ++t) {
    const Node& node = nodes_[t];
    if (node.model != problem_->model(t) || node.data != problem_->data(t)) return false;
    if (node.augmented_model != augmented_->model(t) || node.augmented_data != augmented_->data(t)) return false;
    if (y_next_[t].size() != rows_at(*problem_, t).size()) return false;
    for (const Augmented& own : node.augmented) {
      const internal::ConstraintRows rows(*own.model->get_model(), problem_->by_state_alone(t));
      const Eigen::Index count = static_cast<Eigen::Index>(own.rows.size());
      if (rows.size() != count || own.model->get_multipliers().size() != count) return false;
    }
  }
  return true;
}

// Multipliers stay where node t has as many constraints as before.
void AL::decorate() {
  const std::size_t T = problem_->get_T();
  const Multipliers multipliers = get_multipliers();
  nodes_.clear();
  y_next_.resize(T + 1);
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  for (std::size_t t = 0; t <= T; ++t) {
    y_next_[t].setZero(rows_at(*problem_, t).size());
    const bool kept = t < multipliers.size() && multipliers[t].size() == y_next_[t].size();
    nodes_.push_back(decorated(t, kept ? multipliers[t] : y_next_[t]));
    models.push_back(nodes_[t].augmented_model);
    datas.push_back(nodes_[t].augmented_data);
  }
  models.pop_back();
  datas.pop_back();
  ShootingProblem problem(problem_->get_x0(), models, nodes_[T].augmented_model, datas, nodes_[T].augmented_data);
  if (augmented_ == nullptr)
    augmented_ = std::make_shared<ShootingProblem>(std::move(problem));
  else
    *augmented_ = std::move(problem);
  gap_.setZero(static_cast<Eigen::Index>(problem_->get_ndx()));
}

void AL::resizeData() {
  SolverAbstract::resizeData();
  if (!is_decorated()) decorate();
  inner_->resizeData();
}

void AL::circularAppend(std::shared_ptr<ActionModelAbstract> model) {
  internal::given(kAugmentedNodes, model);
  circularAppend(model, model->createData());
}

void AL::circularAppend(std::shared_ptr<ActionModelAbstract> model, std::shared_ptr<ActionDataAbstract> data) {
  resizeData();
  problem_->circularAppend(std::move(model), std::move(data));
  const std::size_t last = problem_->get_T() - 1;
  std::rotate(nodes_.begin(), nodes_.begin() + 1, nodes_.end() - 1);
  std::rotate(y_next_.begin(), y_next_.begin() + 1, y_next_.end() - 1);
  y_next_[last].setZero(rows_at(*problem_, last).size());
  nodes_[last] = decorated(last, y_next_[last]);
  augmented_->circularAppend(nodes_[last].augmented_model, nodes_[last].augmented_data);
}

std::vector<Eigen::VectorXd> AL::get_multipliers() const {
  Multipliers out(nodes_.size());
  for (std::size_t t = 0; t < nodes_.size(); ++t) {
    Eigen::Index rows = 0;
    for (const Augmented& own : nodes_[t].augmented) rows += own.model->get_multipliers().size();
    out[t].setZero(rows);
    for (const Augmented& own : nodes_[t].augmented) internal::put(own.model->get_multipliers(), own.rows, out[t]);
  }
  return out;
}

void AL::set_multipliers(const Multipliers& multipliers) {
  resizeData();
  require(multipliers.size() == nodes_.size(), kAugmentedNodes, "the number of multipliers is not T + 1");
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    check_size(kAugmentedNodes, "multipliers of a node", multipliers[t].size(),
               static_cast<std::size_t>(y_next_[t].size()));
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (const Augmented& own : nodes_[t].augmented) {
      Eigen::VectorXd y;
      gather(multipliers[t], own.rows, y);
      own.model->set_multipliers(y);
    }
}

void AL::reset() {
  resizeData();
  set_penalty(rho_init_);
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (const Augmented& own : nodes_[t].augmented)
      own.model->set_multipliers(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(own.rows.size())));
}

// Values of nodes whose parts were evaluated on their own.
void AL::collectParts() {
  for (const Node& node : nodes_)
    if (const auto* parts = dynamic_cast<const ActionModelParts*>(node.model.get())) parts->collect(node.data);
}

}  // namespace manycontact
