#include "manycontact/detail/control/sparse.hpp"

#include "manycontact/control/coupled_direction.hpp"
#include "manycontact/control/riccati_direction.hpp"

namespace manycontact {

SolverSparse::SolverSparse(std::shared_ptr<ShootingProblem> problem, bool limits)
    : SolverFDDP(std::move(problem), limits ? Limits::kKept : Limits::kIgnored, WithoutMatrices{}) {
  SolverSparse::allocateData();
}

std::unique_ptr<Direction> SolverSparse::direction_of(ShootingPart part) const {
  const bool coupled = CoupledDirection::applies_to(*part.problem);
  if (coupled && !keeps_limits()) return std::make_unique<CoupledDirection>(std::move(part), false);
  require(!coupled || part.problem->get_terminalData()->Fx.size() > 0, "SolverSparse",
          "robots in contact have limits and nodes of storage kSparse, storage kDense is expected");
  if (keeps_limits()) return std::make_unique<BoxDirection>(std::move(part), false);
  return std::make_unique<RiccatiDirection>(std::move(part), false, false);
}

void SolverSparse::allocateData() {
  if (nodes_ == problem_->get_runningDatas() && terminal_ == problem_->get_terminalData()) return;
  nodes_.clear();  // set below, when all directions are current; an exception thus repeats this function
  std::vector<ShootingPart> parts = separate(*problem_);
  const auto follows = [](const Direction& own, const ShootingPart& part) {
    return own.part().x == part.x && own.part().dx == part.dx && !dynamic_cast<const CoupledDirection*>(&own) &&
           !CoupledDirection::applies_to(*part.problem);
  };
  if (directions_.size() != parts.size()) directions_.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].problem->set_nthreads(1);
    if (i < directions_.size() && follows(*directions_[i], parts[i])) {
      directions_[i]->follow(std::move(parts[i]));
      continue;
    }
    std::unique_ptr<Direction> made = direction_of(std::move(parts[i]));
    made->set_scale(scale_);
    if (i < directions_.size())
      directions_[i] = std::move(made);
    else
      directions_.push_back(std::move(made));
  }
  SolverFDDP::allocateData();
  nodes_ = problem_->get_runningDatas();
  terminal_ = problem_->get_terminalData();
}

std::vector<int> SolverSparse::blocks() const {
  std::vector<int> out;
  for (const auto& own : directions_) {
    const std::vector<int> of_part = own->blocks();
    out.insert(out.end(), of_part.begin(), of_part.end());
  }
  return out;
}

std::string SolverSparse::direction() const {
  std::string out;
  for (const auto& own : directions_)
    if (out.find(own->name()) == std::string::npos) out += (out.empty() ? "" : ", ") + std::string(own->name());
  return out;
}

}  // namespace manycontact
