#pragma once
// Figures of Crocoddyl and Pinocchio for scenes of ../shared/golden (its README describes how they were computed).

#include <nlohmann/json.hpp>
#include <optional>

#include "support/scenes.hpp"

namespace manycontact::test {

struct Golden {
  nlohmann::json json;
  Eigen::VectorXd acceleration;                           // nv
  std::optional<Eigen::VectorXd> forces, quasi_static_u;  // nc, nu: not every file has them
  std::vector<std::string> velocity_names;
  int nv = 0, nc = 0;
  bool appended = false;  // on models combined by Pinocchio's appendModel, see as_appended_by_pinocchio_3_7
};
/// Returns the figures next to a scene file.
Golden load_golden(const std::string& scene_path);

/// Returns the model as Pinocchio 3.7.0's appendModel passes it on, which is wrong: for each frame with an inertia
/// (links behind fixed joints, already part of their joint's inertia) it subtracts that inertia as if it were at the
/// joint's origin and adds it at its own place. So each such link counts once too often at its place and once too
/// little at the origin. Masses stay right; rotational inertias may even become negative. The figures whose `source`
/// begins with "Terms" were computed with such models.
std::shared_ptr<const Model> as_appended_by_pinocchio_3_7(const Model& model);
/// Returns the scene after its robots are appended one after the other: each call passes on all robots so far with the
/// error again, so that the last of n robots has it once and the first n times.
Scene as_appended_by_pinocchio_3_7(Scene scene);

}  // namespace manycontact::test
