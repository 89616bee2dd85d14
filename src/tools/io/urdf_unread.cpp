// Reports elements of a URDF that are not read and may affect the motion, unlike shapes, sensors and controllers.

#include <map>
#include <set>
#include <vector>

#include "urdf_check.hpp"

namespace manycontact::io {
namespace {

using Names = std::set<std::string, std::less<>>;

// Returns a name without its namespace, such as "gear_ratio" for "drake:gear_ratio".
std::string local_name(const std::string& name) { return name.substr(name.rfind(':') + 1); }

// Calls visit(element) for every descendant of e.
template <class Visit>
void each_inside(const Element& e, const Visit& visit) {
  for (const Element& inside : e.children()) {
    visit(inside);
    each_inside(inside, visit);
  }
}

class Unread {  // combines findings of similar elements into one finding, reported at the first of these elements
 public:
  explicit Unread(std::vector<Finding>& findings) : findings_(findings) {}

  void tell(const Element& e, const std::string& name, const std::string& text) {
    findings_.push_back({"unread", name, text, *e.where().file, e.line()});
  }

  // Counts an ignored element or attribute, described by `what`. The finding has the first line and the number of them.
  void count(const Element& e, const std::string& name, const std::string& what, const std::string& because = "") {
    const auto [at, is_first] = counted_.emplace(what, Counted{findings_.size(), 0, because});
    if (is_first) tell(e, name, {});
    ++at->second.times;
  }

  void finish() {
    for (const auto& [what, c] : counted_)
      findings_[c.finding].text =
          what + (c.times > 1 ? ", here and in " + std::to_string(c.times - 1) + " more places," : "") + " is ignored" +
          c.because;
  }

 private:
  struct Counted {
    std::size_t finding;
    int times;
    std::string because;
  };
  std::vector<Finding>& findings_;
  std::map<std::string, Counted> counted_;
};

std::string name_of(const Element& e) {
  const std::string name = e.optional("name", e.optional("reference", ""));
  return name.empty() ? e.name() : name;
}

bool constrains(const std::string& name) {
  for (const char* word : {"joint", "constraint", "loop", "gear", "coupl", "weld", "closure", "equality", "bushing",
                           "spring", "tendon", "cable"})
    if (name.find(word) != std::string::npos) return true;
  return false;
}

void tell_constraint(const Element& e, Unread& unread) {
  unread.tell(e, name_of(e),
              "<" + e.name() + "> influences the motion and is ignored: " +
                  "the connected links move freely, unless a contact of the scene constrains these links");
}

void look_into_gazebo(const Element& gazebo, Unread& unread) {
  each_inside(gazebo, [&](const Element& e) {
    const std::string name = local_name(e.name());
    if (name == "joint" && e.has("type"))
      tell_constraint(e, unread);  // <joint> of SDF, which closes a loop
    else if (name == "springStiffness" || name == "spring_stiffness" || name == "springReference")
      unread.count(e, name_of(gazebo), "<" + e.name() + ">", ": the joint is modelled without a spring");
  });
}

bool is_one(const Element& e) {
  std::string text;
  if (!e.child()) text = e.has("value") ? e.required("value") : e.text();
  const auto parts = words(text);
  return parts.size() == 1 && (parts[0] == "1" || parts[0] == "1.0" || parts[0] == "+1");
}

void look_into_transmission(const Element& transmission, Unread& unread) {
  each_inside(transmission, [&](const Element& e) {
    const std::string name = local_name(e.name());
    if ((name == "mechanicalReduction" || name == "gear_ratio" || name == "rotor_inertia") && !is_one(e))
      unread.count(e, name_of(transmission), "<" + e.name() + ">", ": use `armature` for rotor inertia");
  });
}

// Reports children of `parent` that are neither read nor harmless, and repetitions of children of which one is read.
void look_at_children(const Element& parent, const std::string& owner, const Names& read, const Names& harmless,
                      Unread& unread) {
  Names seen;
  for (const Element& e : parent.children()) {
    const std::string name = e.name();
    if (read.count(name)) {
      if (!seen.insert(name).second) unread.count(e, owner, "a second <" + name + "> in <" + parent.name() + ">");
    } else if (!harmless.count(local_name(name))) {
      unread.count(e, owner, "<" + name + "> in <" + parent.name() + ">");
    }
  }
}

void look_at_attributes(const Element& parent, const char* child, const std::string& owner, const Names& read,
                        Unread& unread) {
  const auto e = parent.child(child);
  if (!e) return;
  for (const std::string& attribute : e->attributes())
    if (!read.count(attribute)) unread.count(*e, owner, attribute + " of <" + child + ">");
}

void look_at_link(const Element& link, Unread& unread) {
  static const Names harmless = {"visual",       "collision", "contact", "sensor",   "self_collision_checking",
                                 "self_collide", "material",  "gravity", "kinematic"};
  const std::string owner = link.required("name");
  look_at_children(link, owner, {"inertial"}, harmless, unread);
  const auto inertial = link.child("inertial");
  if (!inertial) return;
  look_at_children(*inertial, owner, {"origin", "mass", "inertia"}, {}, unread);
  look_at_attributes(*inertial, "origin", owner, {"xyz", "rpy"}, unread);
  look_at_attributes(*inertial, "mass", owner, {"value"}, unread);
  look_at_attributes(*inertial, "inertia", owner, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, unread);
}

void look_at_joint(const Element& joint, Unread& unread) {
  static const Names read = {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"};
  static const Names harmless = {"safety_controller", "calibration", "controller_gains", "traits",   "sensor",
                                 "hardwareInterface", "motor",       "visual",           "collision"};
  const std::string owner = joint.required("name");
  look_at_children(joint, owner, read, harmless, unread);
  look_at_attributes(joint, "origin", owner, {"xyz", "rpy"}, unread);
  if (joint.optional("type", "") == "fixed") return;
  look_at_attributes(joint, "axis", owner, {"xyz"}, unread);
  look_at_attributes(joint, "dynamics", owner, {"damping", "friction"}, unread);
  const std::string type = joint.optional("type", "");
  if ((type == "floating" || type == "planar") && joint.child("limit"))
    unread.count(*joint.child("limit"), owner, "<limit> of a " + type + " joint");
}

// Returns the prefixes that the file declares for the namespace of xacro.
Names xacro_prefixes(const Element& robot) {
  Names prefixes = {"xacro"};
  for (const std::string& attribute : robot.attributes())
    if (attribute.starts_with("xmlns:") && robot.required(attribute.c_str()).find("xacro") != std::string::npos)
      prefixes.insert(attribute.substr(6));
  return prefixes;
}

// Returns whether an element belongs to xacro, which should have replaced it.
bool is_xacro(const Element& e, const Names& prefixes) {
  const std::string name = e.name();
  const std::size_t colon = name.find(':');
  return colon != std::string::npos && prefixes.count(name.substr(0, colon)) > 0;
}

// Returns whether an element is a shape or a colour, which do not affect the motion.
bool is_only_seen(const Element& e) {
  const std::string name = e.name();
  return name == "visual" || name == "collision" || name == "material";
}

void tell_leftovers(const Element& of, const Names& prefixes, Unread& unread) {
  for (const Element& e : of.children()) {
    if (!is_only_seen(e)) {
      tell_leftovers(e, prefixes, unread);
      continue;
    }
    each_inside(e, [&](const Element& inside) {
      if (is_xacro(inside, prefixes))
        unread.count(inside, name_of(e), "<" + inside.name() + ">", ": xacro did not replace this element");
    });
  }
}

void refuse_xacro_inside(const Element& of, const Names& prefixes) {
  for (const Element& e : of.children()) {
    if (is_xacro(e, prefixes))
      e.fail("<" + e.name() +
             "> is an element of xacro, expected a URDF without xacro: " + "run `xacro ROBOT.urdf.xacro > ROBOT.urdf`");
    if (!is_only_seen(e)) refuse_xacro_inside(e, prefixes);
  }
}

}  // namespace

void tell_unread(const Element& robot, std::vector<Finding>& findings) {
  static const Names harmless = {
      "material",    "sensor",       "mujoco",        "frame",         "collision_filter_group", "group",
      "group_state", "end_effector", "virtual_joint", "passive_joint", "disable_collisions",     "ros2_control",
      "author",      "license",      "texture",       "kinematics"};
  Unread unread(findings);
  tell_leftovers(robot, xacro_prefixes(robot), unread);
  for (const Element& e : robot.children()) {
    const std::string name = e.name();
    if (name == "link")
      look_at_link(e, unread);
    else if (name == "joint")
      look_at_joint(e, unread);
    else if (name == "gazebo")
      look_into_gazebo(e, unread);
    else if (name == "transmission")
      look_into_transmission(e, unread);
    else if (harmless.count(local_name(name)))
      continue;
    else if (constrains(name))
      tell_constraint(e, unread);
    else
      unread.count(e, name_of(e), "<" + name + ">");
  }
  unread.finish();
}

void refuse_xacro(const Element& robot) { refuse_xacro_inside(robot, xacro_prefixes(robot)); }

}  // namespace manycontact::io
