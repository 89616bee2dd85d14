#pragma once
// Figures of Crocoddyl and Pinocchio for scenes of ../shared/golden (its README says how they were made).

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
  bool appended = false;  // on models joined by Pinocchio's appendModel, see as_appended_by_pinocchio_3_7
};
/// The figures beside a scene file.
Golden load_golden(const std::string& scene_path);

/// The model as Pinocchio 3.7.0's appendModel hands it on, which is wrong: for each frame that carries an inertia (the
/// links behind fixed joints, already part of their joint's inertia) it takes that inertia off the joint as if it stood
/// at the joint's origin and puts it back where it stands, so that each such link counts once too often where it is
/// and once too little at the origin. Masses stay right; rotational inertias may even turn negative. The figures whose
/// `source` begins with "Terms" were made with such models.
std::shared_ptr<const Model> as_appended_by_pinocchio_3_7(const Model& model);
/// The scene as it comes out when its robots are appended one after the other: each call passes on all robots so far,
/// with the error once more, so that the last of n robots has it once and the first n times.
Scene as_appended_by_pinocchio_3_7(Scene scene);

}  // namespace manycontact::test
