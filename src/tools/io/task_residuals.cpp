// Names of residuals and of their attributes.

#include <array>
#include <cstring>

#include "task_parts.hpp"

namespace manycontact {

namespace {

struct Kind {
  const char* name;
  const char* alias;  // the name of the class in module action in lower case, if different; or null
  std::vector<const char*> attributes;
};

const std::array<Kind, 16>& kinds() {
  static const std::array<Kind, 16> list{{
      {"state", nullptr, {"robot", "reference"}},
      {"control", nullptr, {"robot", "reference"}},
      {"joint_effort", nullptr, {"robot", "reference"}},
      {"joint_acceleration", nullptr, {"robot", "reference"}},
      {"com", "com_position", {"robot", "reference"}},
      {"centroidal_momentum", nullptr, {"robot", "reference"}},
      {"frame_placement", nullptr, {"frame", "xyz", "quat_xyzw"}},
      {"frame_translation", nullptr, {"frame", "xyz"}},
      {"frame_rotation", nullptr, {"frame", "quat_xyzw"}},
      {"frame_velocity", nullptr, {"frame", "reference_frame", "twist"}},
      {"contact_force", nullptr, {"contact", "reference"}},
      {"friction_cone", "contact_friction_cone", {"contact", "mu", "normal"}},
      {"wrench_cone", "contact_wrench_cone", {"contact", "mu", "normal", "box"}},
      {"cop", "contact_cop_position", {"contact", "normal", "box"}},
      {"control_grav", nullptr, {}},
      {"contact_control_grav", nullptr, {}},
  }};
  return list;
}

}  // namespace

const char* to_string(TaskResidual residual) { return kinds()[static_cast<std::size_t>(residual)].name; }

namespace io {

TaskResidual read_residual(const Element& e) {
  const std::string text = e.required("type");
  std::vector<std::string> known;
  for (std::size_t i = 0; i < kinds().size(); ++i) {
    const Kind& kind = kinds()[i];
    if (text == kind.name || (kind.alias && text == kind.alias)) return static_cast<TaskResidual>(i);
    known.push_back(kind.name);
  }
  e.where("type").fail(e.label("type") + " is " + quote(text) + ", " + suggestion(text, known));
}

void check_attributes(const Element& e, TaskResidual residual) {
  const Kind& own = kinds()[static_cast<std::size_t>(residual)];
  const auto has = [](const Kind& kind, const char* name) {
    for (const char* a : kind.attributes)
      if (std::strcmp(a, name) == 0) return true;
    return false;
  };
  for (const Kind& kind : kinds())
    for (const char* name : kind.attributes) {
      if (!e.has(name) || has(own, name)) continue;
      std::string expected = own.attributes.empty() ? "none" : "";
      for (const char* a : own.attributes) expected += (expected.empty() ? "" : ", ") + std::string(a);
      e.where(name).fail(e.label(name) + " does not go with type " + own.name + ", expected of such: " + expected);
    }
}

}  // namespace io

}  // namespace manycontact
