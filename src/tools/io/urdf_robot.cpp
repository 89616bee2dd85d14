#include "urdf_robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace manycontact::io {
namespace {

Element required_child(const Element& parent, const char* name, const std::string& owner) {
  const auto e = parent.child(name);
  if (!e) parent.fail(owner + " has no <" + name + ">, expected one");
  return *e;
}

// A name that is given, not empty and new.
template <class Known>
std::string check_name(const Element& e, Known& known) {
  const std::string name = e.not_empty("name");
  const auto [at, is_new] = known.emplace(name, typename Known::mapped_type{e.line()});
  if (!is_new)
    e.where("name").fail(e.name() + " " + quote(name) + " exists already on line " + std::to_string(at->second.line) +
                         ", expected names used once");
  return name;
}

void tell(const Element& e, const char* kind, const std::string& name, const std::string& text,
          std::vector<Finding>& findings) {
  findings.push_back({kind, name, text, *e.where().file, e.line()});
}

void add_to(std::string& list, const std::string& item) { list += (list.empty() ? "" : ", ") + item; }

// Missing values are zero, as if the file contained zeros.
void read_link(const Element& link, UrdfRobot& out) {
  const std::string name = check_name(link, out.links);
  const auto inertial = link.child("inertial");
  if (!inertial) return;
  std::string missing;
  const auto number = [&missing](const std::optional<Element>& e, const char* attribute, const char* called) {
    if (e && e->has(attribute)) return e->required_number(attribute);
    if (called) add_to(missing, called);
    return 0.0;
  };
  const SE3<double> at = read_origin(*inertial);
  const double mass = number(inertial->child("mass"), "value", "mass");
  const auto inertia = inertial->child("inertia");
  if (!inertia) add_to(missing, "inertia");
  const auto moment = [&](const char* a) { return number(inertia, a, inertia ? a : nullptr); };
  const double xx = moment("ixx"), xy = moment("ixy"), xz = moment("ixz"), yy = moment("iyy"), yz = moment("iyz"),
               zz = moment("izz");
  Mat3<double> I;
  I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  out.links.at(name).inertia = Inertia<double>::from_com(mass, at.p, at.R * I * at.R.transpose());
  if (!missing.empty()) tell(*inertial, "inertia", name, "<inertial> lacks " + missing + ", taken as 0", out.findings);
}

void read_axis(const Element& joint, UrdfJoint& out, std::vector<Finding>& findings) {
  const auto axis = joint.child("axis");
  if (!axis) return;
  if (!axis->has("xyz"))
    return tell(*axis, "unread", out.name, "<axis> has no xyz, taken as 1 0 0, URDF's default", findings);
  Vec3<double> xyz = Vec3<double>::UnitX();
  (void)axis->read("xyz", xyz);
  if (std::hypot(xyz[0], xyz[1], xyz[2]) < kZeroDirection)
    axis->where("xyz").fail("the axis of joint " + quote(out.name) + " is zero, expected a direction");
  out.axis = xyz / xyz.stableNorm();
}

// Returns the bound of an attribute, or `none` if it bounds nothing; `told` then has the reason.
double sound_limit(const Element& limit, const char* attribute, bool is_sound(double), double none, std::string& told) {
  const double x = limit.number_or_infinity(attribute, none);
  if (limit.has(attribute) && is_sound(x)) return x;
  add_to(told, attribute + (limit.has(attribute) ? " " + std::string(words(limit.required(attribute))[0])
                                                 : std::string(" missing")));
  return none;
}

// Limits that are infinite, negative, crossed or missing bound nothing. If one of lower and upper is missing, it is 0,
// as URDF defines it.
void read_limit(const Element& joint, bool has_range, UrdfJoint& out, std::vector<Finding>& findings) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::string& name = out.name;
  const auto limit = joint.child("limit");
  if (!limit) {
    if (has_range) tell(joint, "limits", name, "no <limit>, taken as no limits", findings);
    return;
  }
  std::string none, zero;
  const auto is_size = [](double x) { return x >= 0 && std::isfinite(x); };
  const auto is_finite = [](double x) { return std::isfinite(x); };
  out.effort = sound_limit(*limit, "effort", is_size, kInfinity, none);
  out.velocity = sound_limit(*limit, "velocity", is_size, kInfinity, none);
  if (has_range) {
    const bool any = limit->has("lower") || limit->has("upper");
    for (const char* a : {"lower", "upper"})
      if (any && !limit->has(a)) add_to(zero, a);
    const auto of = [&](const char* a, double unlimited) {
      return any && !limit->has(a) ? 0 : sound_limit(*limit, a, is_finite, unlimited, none);
    };
    out.lower = of("lower", -kInfinity);
    out.upper = of("upper", kInfinity);
    if (out.lower > out.upper) {
      add_to(none, "lower " + show(out.lower) + " above upper " + show(out.upper));
      out.lower = -kInfinity, out.upper = kInfinity, zero.clear();
    }
  }
  const std::string text = (none.empty() ? "" : "taken as no limit: " + none) +
                           (none.empty() || zero.empty() ? "" : "; ") +
                           (zero.empty() ? "" : "taken as 0, as URDF has it: " + zero + " missing");
  if (!text.empty()) tell(*limit, "limits", name, text, findings);
}

void read_dynamics(const Element& joint, bool is_modelled, UrdfJoint& out, std::vector<Finding>& findings) {
  const auto dynamics = joint.child("dynamics");
  if (!dynamics) return;
  const double damping = dynamics->number_or_infinity("damping", 0);
  const double friction = dynamics->number_or_infinity("friction", 0);
  if (is_modelled)
    out.damping = damping, out.friction = friction;
  else if (damping != 0 || friction != 0)
    tell(*dynamics, "dynamics", out.name, "damping and friction are read of joints with one coordinate", findings);
}

std::string read_end(const Element& joint, const char* end, const UrdfRobot& robot) {
  const std::string owner = "joint " + quote(joint.required("name"));
  const Element e = required_child(joint, end, owner);
  const std::string link = e.required("link");
  if (!robot.links.count(link)) {
    std::vector<std::string> known;
    for (const auto& [name, line] : robot.links) known.push_back(name);
    e.where("link").fail("the " + std::string(end) + " of " + owner + " is an unknown link " + quote(link) + ", " +
                         suggestion(link, known));
  }
  return link;
}

void read_joint(const Element& joint, UrdfRobot& out) {
  const std::string name = check_name(joint, out.joints);
  UrdfJoint& own = out.joints.at(name);
  own.name = name;
  own.type = static_cast<UrdfJoint::Type>(
      joint.choice("type", {"revolute", "prismatic", "continuous", "planar", "fixed", "floating"}, -1));
  const bool single = own.type <= UrdfJoint::kContinuous;  // one coordinate
  own.placement = read_origin(joint);
  if (own.type <= UrdfJoint::kPlanar) read_axis(joint, own, out.findings);
  if (single) read_limit(joint, own.type != UrdfJoint::kContinuous, own, out.findings);
  if (own.type != UrdfJoint::kFixed) read_dynamics(joint, single, own, out.findings);
  if (const auto mimic = joint.child("mimic"))
    if (std::string other = mimic->required("joint"); single) own.mimic = std::move(other);
  own.parent = read_end(joint, "parent", out);
  own.child = read_end(joint, "child", out);
}

// Joins links by joints, and checks that there is one root, one parent for every other link, and no cycle. joints: in
// the order of the file.
void join(const Element& robot, const std::vector<const UrdfJoint*>& joints, UrdfRobot& out) {
  const auto fail = [&](int line, const std::string& message) { Where{robot.where().file, line}.fail(message); };
  for (const UrdfJoint* joint : joints) {
    UrdfLink& child = out.links.at(joint->child);
    if (child.above)
      fail(joint->line, "link " + quote(joint->child) + " is the child of joint " + quote(joint->name) +
                            " and of joint " + quote(child.above->name) + ", expected a tree");
    child.above = joint;
    out.links.at(joint->parent).below.push_back(joint);
  }
  std::map<std::string, int> seen;  // link: number of the walk that met it first
  int walk = 0;
  for (auto link = robot.child("link"); link; link = link->next("link")) {
    std::string at = link->required("name");
    ++walk;
    while (seen.emplace(at, walk).second) {
      const UrdfJoint* up = out.links.at(at).above;
      if (!up) {
        if (!out.root.empty())
          fail(out.links.at(at).line,
               "link " + quote(at) + " has no parent, nor has link " + quote(out.root) + ", expected one root");
        out.root = at;
        break;
      }
      at = up->parent;
      if (const auto met = seen.find(at); met != seen.end() && met->second == walk)
        fail(up->line, "joint " + quote(up->name) + " closes a cycle through link " + quote(at) + ", expected a tree");
    }
  }
}

}  // namespace

// By the quaternion of the rotation.
SE3<double> read_origin(const Element& parent) {
  SE3<double> at;
  const auto origin = parent.child("origin");
  if (!origin) return at;
  (void)origin->read("xyz", at.p);
  if (const auto rpy = origin->numbers<3>("rpy")) {
    const double sr = std::sin((*rpy)[0] / 2), cr = std::cos((*rpy)[0] / 2), sp = std::sin((*rpy)[1] / 2),
                 cp = std::cos((*rpy)[1] / 2), sy = std::sin((*rpy)[2] / 2), cy = std::cos((*rpy)[2] / 2);
    const double x = sr * cp * cy - cr * sp * sy, y = cr * sp * cy + sr * cp * sy, z = cr * cp * sy - sr * sp * cy,
                 w = cr * cp * cy + sr * sp * sy, norm = std::sqrt(x * x + y * y + z * z + w * w);
    at.R = rotation_of_quaternion(x / norm, y / norm, z / norm, w / norm);
  }
  return at;
}

UrdfRobot read_urdf(const Element& robot) {
  refuse_xacro(robot);
  UrdfRobot out;
  out.line = robot.line();
  out.name = robot.required("name");
  if (const std::string version = robot.optional("version", "1.0"); version != "1.0")
    robot.refuse("version", " is " + quote(version) + ", expected URDF 1.0");
  for (auto link = robot.child("link"); link; link = link->next("link")) read_link(*link, out);
  if (out.links.empty()) robot.fail("the robot has no <link>, expected at least one");
  std::vector<const UrdfJoint*> joints;
  for (auto joint = robot.child("joint"); joint; joint = joint->next("joint")) {
    read_joint(*joint, out);
    joints.push_back(&out.joints.at(joint->required("name")));
  }
  join(robot, joints, out);
  tell_unread(robot, out.findings);
  return out;
}

}  // namespace manycontact::io
