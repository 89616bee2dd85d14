#include <algorithm>

#include "../text/table.hpp"
#include "inspect.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/names.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/detail/simulation/invariants.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostElements = 24;

std::string three_numbers(const Vec3<double>& x) { return decimal(x[0]) + " " + decimal(x[1]) + " " + decimal(x[2]); }

// Returns the normal of a contact with friction as text. If no normal is given, this is the default of model/scene.hpp.
std::string normal_of(const Contact& contact) {
  if (contact.normal) return three_numbers(*contact.normal);
  if (!contact.mu) return "";
  return contact.type == ContactType::k6D ? "A's z" : "world z";
}

struct Off {  // the largest position and velocity errors of a contact and its copies
  double position = 0, angle = 0, linear = 0, angular = 0;
};

// Returns a contact's errors as text, such as "0.1 m, 0.02 rad, 0.5 m/s", or "0" if it is in place and at rest.
std::string off_by(const Off& off) {
  std::string text;
  const auto add = [&text](double size, double least, const char* unit) {
    if (size >= least) text += (text.empty() ? "" : ", ") + number(size) + " " + unit;
  };
  add(off.position, kPlacementError, "m");
  add(off.angle, kPlacementError, "rad");
  add(off.linear, kVelocityError, "m/s");
  add(off.angular, kVelocityError, "rad/s");
  return text.empty() ? "0" : text;
}

}  // namespace

void print_contacts(std::ostream& out, const SceneFile& file) {
  const Scene& scene = file.scene;
  const std::vector<char> all(scene.contacts.size(), 1);
  std::vector<PlacementError> errors(scene.contacts.size());
  for (const PlacementError& error : placement_errors(scene, file.q, all)) errors[error.contact] = error;
  std::vector<VelocityError> velocities(scene.contacts.size());
  for (const VelocityError& error : velocity_errors(scene, file.q, file.v, all)) velocities[error.contact] = error;
  InvariantsData room(scene);
  (void)invariants(scene, all, file.q, file.v, room);

  Table table("contact<24|type, axes<|frame A<24|to B'<20|A at [m]|gains|mu|normal|off by<|<", kMostElements,
              "elements of the file");
  for (const ContactGroup& group : file.contact_groups) {
    if (group.count == 0) continue;
    const Contact& contact = scene.contacts[group.first];
    const Contact& last = scene.contacts[group.first + group.count - 1];
    const Robot& robot = scene.robots[contact.A.robot];
    const SE3<double> oMA =
        frame_placement<double>(room.kin[contact.A.robot], robot.base, contact.A.joint, contact.A.placement);
    Off off;
    for (int c = group.first; c < group.first + group.count; ++c) {
      off.position = std::max(off.position, errors[c].position);
      off.angle = std::max(off.angle, errors[c].angle);
      off.linear = std::max(off.linear, velocities[c].linear);
      off.angular = std::max(off.angular, velocities[c].angular);
    }
    table.add({contact.name + (group.count > 1 ? " .. " + last.name : ""),
               to_string(contact.type) + (contact.reference_frame == ReferenceFrame::kLocal ? " local" : " world"),
               place_name(scene, {&contact.A}), place_name(scene, {&contact.B}), three_numbers(oMA.p),
               number(contact.alpha) + " " + number(contact.beta), contact.mu ? number(*contact.mu) : "",
               normal_of(contact), off_by(off), contact.active ? "" : "not active"});
  }
  if (table.empty()) return;
  out << "\n"
         "Contacts: frame A is constrained to B'; gains: alpha [1/s^2] and beta [1/s]; off by: placement and\n"
         "velocity error of A. For copies the first contact and the largest errors are shown\n";
  table.print(out);
}

}  // namespace manycontact::cli
