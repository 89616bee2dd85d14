// Makes the nodes of the augmented Lagrangian from the nodes of the problem, and reads or sets their multipliers.

#include <algorithm>

#include "../multi_robot/coordinates.hpp"
#include "constraint_rows.hpp"
#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/detail/control/parts.hpp"

namespace manycontact {

using AL = SolverAugmentedLagrangian;
using Multipliers = std::vector<Eigen::VectorXd>;
using internal::rows_at;

constexpr const char* kAugmentedNodes = "SolverAugmentedLagrangian";

AL::Copy AL::augment_leaf(const Copy& of, const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                          std::vector<Augmented>& out) const {
  const auto model = std::make_shared<ActionModelAugmentedLagrangian>(of.model);
  model->set_penalty(rho_);
  Eigen::VectorXd own;
  gather(multipliers, rows, own);
  model->set_multipliers(own);
  const auto data = model->createData(of.data);
  out.push_back({model, std::static_pointer_cast<ActionDataAugmentedLagrangian>(data), rows});
  return {model, data};
}

// Copies a node of several subproblems. In the copy, augmented Lagrangians replace subproblems with constraint rows.
AL::Copy AL::augment_parts(const ActionModelParts& whole, const ActionDataParts& data, bool terminal,
                           const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                           std::vector<Augmented>& out) const {
  auto parts = whole.get_parts();
  auto datas = data.parts;
  const std::vector<std::vector<int>> of_parts = internal::constraint_rows(parts, terminal);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::vector<int> own;
    for (const int k : of_parts[i]) own.push_back(rows[k]);
    const Copy part = augment({parts[i].model, datas[i]}, terminal, own, multipliers, out);
    parts[i].model = part.model;
    datas[i] = part.data;
  }
  const auto model = whole.with_models(std::move(parts));
  return {model, model->createData(std::move(datas))};
}

// Returns the augmented Lagrangian of a node or subproblem `of`. Without constraint rows, returns `of` itself, unless
// augments_all_ is set and `of` has dense matrices. rows: indices of its constraint rows in the problem's node.
AL::Copy AL::augment(const Copy& of, bool terminal, const std::vector<int>& rows, const Eigen::VectorXd& multipliers,
                     std::vector<Augmented>& out) const {
  const auto* whole = dynamic_cast<const ActionModelParts*>(of.model.get());
  if (rows.empty() && (!augments_all_ || (of.data->Fx.size() == 0 && !whole))) return of;
  if (whole)
    return augment_parts(*whole, internal::own_data<ActionDataParts>(kAugmentedNodes, of.data), terminal, rows,
                         multipliers, out);
  return augment_leaf(of, rows, multipliers, out);
}

AL::Node AL::decorated(std::size_t t, const Eigen::VectorXd& multipliers) const {
  Node out{{problem_->model(t), problem_->data(t)}, {}, {}, multipliers.size()};
  out.copy = augment(out.own, problem_->by_state_alone(t), internal::range(0, static_cast<int>(multipliers.size())),
                     multipliers, out.augmented);
  return out;
}

bool AL::is_decorated() const {
  const std::size_t T = problem_->get_T();
  if (augmented_->get_T() != T) return false;
  for (std::size_t t = 0; t <= T; ++t) {
    const Node& node = nodes_[t];
    if (node.own.model != problem_->model(t) || node.own.data != problem_->data(t)) return false;
    if (node.copy.model != augmented_->model(t) || node.copy.data != augmented_->data(t)) return false;
    if (node.rows != rows_at(*problem_, t).size()) return false;
    for (const Augmented& own : node.augmented) {
      const internal::ConstraintRows rows(*own.model->get_model(), problem_->by_state_alone(t));
      const Eigen::Index count = static_cast<Eigen::Index>(own.rows.size());
      if (rows.size() != count || own.model->get_multipliers().size() != count) return false;
    }
  }
  return true;
}

// Makes the augmented Lagrangians of all nodes, and the shooting problem augmented_ of these. Node t keeps its
// multipliers if its number of constraints has not changed.
void AL::decorate() {
  const std::size_t T = problem_->get_T();
  const Multipliers multipliers = get_multipliers();
  nodes_.clear();
  ShootingProblem::Models models;
  ShootingProblem::Datas datas;
  for (std::size_t t = 0; t <= T; ++t) {
    const Eigen::Index rows = rows_at(*problem_, t).size();
    const bool kept = t < multipliers.size() && multipliers[t].size() == rows;
    nodes_.push_back(decorated(t, kept ? multipliers[t] : Eigen::VectorXd::Zero(rows)));
    models.push_back(nodes_[t].copy.model);
    datas.push_back(nodes_[t].copy.data);
  }
  models.pop_back();
  datas.pop_back();
  ShootingProblem problem(problem_->get_x0(), models, nodes_[T].copy.model, datas, nodes_[T].copy.data);
  if (augmented_ == nullptr)
    augmented_ = std::make_shared<ShootingProblem>(std::move(problem));
  else
    *augmented_ = std::move(problem);
  work_.setZero(static_cast<Eigen::Index>(2 * problem_->get_ndx() + problem_->get_nu_max()));
}

void AL::resizeData() {
  SolverAbstract::resizeData();
  if (!is_decorated()) decorate();
  inner_->resizeData();
  inner_->allocateDescent();
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
  nodes_[last] = decorated(last, Eigen::VectorXd::Zero(rows_at(*problem_, last).size()));
  augmented_->circularAppend(nodes_[last].copy.model, nodes_[last].copy.data);
}

std::vector<Eigen::VectorXd> AL::get_multipliers() const {
  Multipliers out(nodes_.size());
  for (std::size_t t = 0; t < nodes_.size(); ++t) {
    out[t].setZero(nodes_[t].rows);
    for (const Augmented& own : nodes_[t].augmented) internal::put(own.model->get_multipliers(), own.rows, out[t]);
  }
  return out;
}

void AL::set_multipliers(const Multipliers& multipliers) {
  resizeData();
  require(multipliers.size() == nodes_.size(), kAugmentedNodes, "the number of multipliers is not T + 1");
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    check_size(kAugmentedNodes, "multipliers of a node", multipliers[t].size(),
               static_cast<std::size_t>(nodes_[t].rows));
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (const Augmented& own : nodes_[t].augmented) {
      Eigen::VectorXd y;
      gather(multipliers[t], own.rows, y);
      own.model->set_multipliers(y);
    }
}

void AL::reset() {
  resizeData();
  set_penalty(rho_init_ * scale_);
  for (std::size_t t = 0; t < nodes_.size(); ++t)
    for (const Augmented& own : nodes_[t].augmented) own.model->set_multipliers(Eigen::VectorXd::Zero(own.rows.size()));
}

namespace {

void collect_values_of(const ActionModelAbstract& model, const std::shared_ptr<ActionDataAbstract>& data) {
  const auto* whole = dynamic_cast<const ActionModelParts*>(&model);
  if (!whole) return;
  const auto& parts = static_cast<const ActionDataParts&>(*data).parts;
  for (std::size_t i = 0; i < parts.size(); ++i) collect_values_of(*whole->get_parts()[i].model, parts[i]);
  whole->collect(data);
}

}  // namespace

// Collects cost, xnext, g, h of the problem's nodes from the subproblems that the augmented nodes have evaluated.
void AL::collectParts() {
  for (const Node& node : nodes_) collect_values_of(*node.own.model, node.own.data);
}

}  // namespace manycontact
