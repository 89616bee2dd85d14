// Names of residuals and of their attributes.

#include <algorithm>
#include <array>
#include <cstring>

#include "task_parts.hpp"

namespace manycontact {

namespace {

struct Kind {
  const char* name;
  const char* alias;  // lower-case name of the residual's class in module action, or null if it equals `name`
  bool of_state;      // whether the residual depends only on the state, not on controls, accelerations or forces
  int rows;           // number of rows, or 0 if it depends on the robot or the contact
  std::vector<const char*> attributes;
};

const std::array<Kind, 16>& kinds() {
  static const std::array<Kind, 16> list{{
      {"state", nullptr, true, 0, {"robot", "reference"}},
      {"control", nullptr, false, 0, {"robot", "reference"}},
      {"joint_effort", nullptr, false, 0, {"robot", "reference"}},
      {"joint_acceleration", nullptr, false, 0, {"robot", "reference"}},
      {"com", "com_position", true, 3, {"robot", "reference"}},
      {"centroidal_momentum", nullptr, true, 6, {"robot", "reference"}},
      {"frame_placement", nullptr, true, 6, {"frame", "xyz", "quat_xyzw"}},
      {"frame_translation", nullptr, true, 3, {"frame", "xyz"}},
      {"frame_rotation", nullptr, true, 3, {"frame", "quat_xyzw"}},
      {"frame_velocity", nullptr, true, 6, {"frame", "reference_frame", "twist"}},
      {"contact_force", nullptr, false, 0, {"contact", "reference"}},
      {"friction_cone", "contact_friction_cone", false, 5, {"contact", "mu", "normal"}},
      {"wrench_cone", "contact_wrench_cone", false, 17, {"contact", "mu", "normal", "box"}},
      {"cop", "contact_cop_position", false, 4, {"contact", "normal", "box"}},
      {"control_grav", nullptr, false, 0, {}},
      {"contact_control_grav", nullptr, false, 0, {}},
  }};
  return list;
}

const Kind& kind_of(TaskResidual residual) { return kinds()[static_cast<std::size_t>(residual)]; }

}  // namespace

const char* to_string(TaskResidual residual) { return kind_of(residual).name; }

bool of_state_alone(TaskResidual residual) { return kind_of(residual).of_state; }

namespace io {

int fixed_rows(TaskResidual residual) { return kind_of(residual).rows; }

bool takes(TaskResidual residual, const char* attribute) {
  const std::vector<const char*>& all = kind_of(residual).attributes;
  return std::ranges::any_of(all, [&](const char* a) { return std::strcmp(a, attribute) == 0; });
}

TaskResidual read_residual(const Element& e) {
  const std::string text = e.required("type");
  std::vector<std::string> known;
  for (std::size_t i = 0; i < kinds().size(); ++i) {
    const Kind& kind = kinds()[i];
    if (text == kind.name || (kind.alias && text == kind.alias)) return static_cast<TaskResidual>(i);
    known.push_back(kind.name);
  }
  e.refuse("type", " is " + quote(text) + ", " + suggestion(text, known));
}

void check_attributes(const Element& e, TaskResidual residual) {
  const Kind& own = kind_of(residual);
  for (const Kind& kind : kinds())
    for (const char* name : kind.attributes) {
      if (!e.has(name) || takes(residual, name)) continue;
      std::string expected = own.attributes.empty() ? "no such attribute" : "";
      for (const char* a : own.attributes) expected += (expected.empty() ? "" : ", ") + std::string(a);
      e.refuse(name, std::string(" cannot be combined with type ") + own.name + ", expected " + expected);
    }
}

}  // namespace io

}  // namespace manycontact
