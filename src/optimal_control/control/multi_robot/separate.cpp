// Separates a shooting problem into its subproblems.

#include "manycontact/detail/control/parts.hpp"

namespace manycontact {

namespace {

constexpr const char* kSeparate = "separate";

std::vector<int> all(std::size_t count) { return internal::range(0, static_cast<int>(count)); }

const ActionModelParts* as_parts(const std::shared_ptr<ActionModelAbstract>& model) {
  const auto* parts = dynamic_cast<const ActionModelParts*>(model.get());
  return parts && !parts->get_couplings() ? parts : nullptr;
}

const ActionModelParts& parts_of(const ShootingProblem& problem, std::size_t t) {
  const auto* model = as_parts(problem.model(t));
  require(model != nullptr, kSeparate, "some nodes are ActionModelParts and others are not, all are expected");
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
