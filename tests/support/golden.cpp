#include "support/golden.hpp"

#include <filesystem>
#include <fstream>

namespace manycontact::test {

namespace {

Eigen::VectorXd to_vector(const nlohmann::json& list) {
  const auto values = list.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::optional<Eigen::VectorXd> maybe_vector(const nlohmann::json& json, const char* key) {
  if (!json.contains(key)) return std::nullopt;
  return to_vector(json[key]);
}

}  // namespace

Golden load_golden(const std::string& scene_path) {
  Golden g;
  g.json = nlohmann::json::parse(std::ifstream(std::filesystem::path(scene_path).replace_extension(".json")));
  g.acceleration = to_vector(g.json.at("acceleration"));
  g.forces = maybe_vector(g.json, "forces");
  g.quasi_static_u = maybe_vector(g.json, "quasi_static_u");
  g.velocity_names = g.json.at("velocity_names").get<std::vector<std::string>>();
  g.nv = g.json.at("nv");
  g.nc = g.json.at("nc");
  g.appended = g.json.at("source").get<std::string>().starts_with("Terms");
  return g;
}

std::shared_ptr<const Model> as_appended_by_pinocchio_3_7(const Model& model) {
  auto copy = std::make_shared<Model>(model);
  for (const Frame& frame : model.frames) {
    if (!frame.merged || frame.joint < 0) continue;
    Inertia<double> taken = frame.inertia;
    taken.m = -taken.m, taken.h = -taken.h, taken.I = -taken.I;
    copy->joints[frame.joint].inertia += frame.inertia.transformed(frame.placement);
    copy->joints[frame.joint].inertia += taken;
  }
  return copy;
}

Scene as_appended_by_pinocchio_3_7(Scene scene) {
  for (int appended = 0; appended < scene.nrobots(); ++appended)
    for (int r = 0; r <= appended; ++r) scene.robots[r].model = as_appended_by_pinocchio_3_7(*scene.robots[r].model);
  return scene;
}

}  // namespace manycontact::test
