#include "urdf_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace manycontact::io {
namespace {

void check_origin(const Element& parent) {
  if (const auto origin = parent.child("origin")) {
    (void)origin->numbers<3>("xyz");
    (void)origin->numbers<3>("rpy");
  }
}

Element required_child(const Element& parent, const char* name, const std::string& owner) {
  const auto e = parent.child(name);
  if (!e) parent.fail(owner + " has no <" + name + ">, expected exactly one");
  return *e;
}

int line_of(int line) { return line; }
int line_of(const UrdfJoint& joint) { return joint.line; }

// Returns the required name of an element. Throws InputError for an empty or duplicate name.
template <class Known>
std::string check_name(const Element& e, Known& known) {
  const std::string name = e.not_empty("name");
  const auto [at, is_new] = known.emplace(name, typename Known::mapped_type{e.line()});
  if (!is_new)
    e.where("name").fail(e.name() + " " + quote(name) + " exists already on line " +
                         std::to_string(line_of(at->second)) + ", expected names used once");
  return name;
}

void tell(const Element& e, const char* kind, const std::string& name, const std::string& text,
          std::vector<Finding>& findings) {
  findings.push_back({kind, name, text, *e.where().file, e.line()});
}

void add_to(std::string& list, const std::string& item) { list += (list.empty() ? "" : ", ") + item; }

// Checks a link. Missing numbers of its inertia are reported and become zeros.
void check_link(const Element& link, UrdfDetails& details) {
  const std::string name = check_name(link, details.link);
  const auto inertial = link.child("inertial");
  if (!inertial) return;
  check_origin(*inertial);
  std::string missing;
  const auto check = [&missing](const std::optional<Element>& e, const char* attribute, const char* called) {
    if (e && e->has(attribute))
      (void)e->required_number(attribute);
    else
      add_to(missing, called);
  };
  check(inertial->child("mass"), "value", "mass");
  const auto inertia = inertial->child("inertia");
  if (!inertia) add_to(missing, "inertia");
  for (const char* a : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
    if (inertia) check(inertia, a, a);
  if (!missing.empty())
    tell(*inertial, "inertia", name, "<inertial> lacks " + missing + "; missing values are taken as 0",
         details.findings);
}

void check_axis(const Element& joint, UrdfDetails& details) {
  const auto axis = joint.child("axis");
  if (!axis) return;
  const std::string name = joint.required("name");
  if (!axis->has("xyz"))
    return tell(*axis, "unread", name, "<axis> has no xyz; URDF's default 1 0 0 is used", details.findings);
  const auto xyz = *axis->numbers<3>("xyz");
  if (std::hypot(xyz[0], xyz[1], xyz[2]) < kZeroDirection)
    axis->where("xyz").fail("the axis of joint " + quote(name) + " is zero, expected a direction");
}

// Returns the limit in an attribute. If it is missing or is_sound is false, returns `none` and adds a reason to `told`.
double sound_limit(const Element& limit, const char* attribute, bool is_sound(double), double none, std::string& told) {
  const double x = limit.number_or_infinity(attribute, none);
  if (limit.has(attribute) && is_sound(x)) return x;
  add_to(told, limit.has(attribute) ? attribute + (" " + std::string(words(limit.required(attribute))[0]))
                                    : std::string("no ") + attribute);
  return none;
}

// Reads limits. Infinite, negative, crossed or missing limits are reported and ignored, where only effort and velocity
// can be negative. If only one of lower and upper is given, the other is 0, as in URDF.
void check_limit(const Element& joint, bool has_range, UrdfJoint& out, std::vector<Finding>& findings) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::string name = joint.required("name");
  const auto limit = joint.child("limit");
  if (!limit) {
    if (has_range) tell(joint, "limits", name, "the joint has no <limit> and is taken as unlimited", findings);
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
  const std::string text = (none.empty() ? "" : "<limit> has " + none + ", where the joint is taken as unlimited") +
                           (none.empty() || zero.empty() ? "" : "; ") +
                           (zero.empty() ? "" : "<limit> lacks " + zero + ", which is 0 by URDF's default");
  if (!text.empty()) tell(*limit, "limits", name, text, findings);
}

void check_dynamics(const Element& joint, bool is_modelled, UrdfJoint& out, std::vector<Finding>& findings) {
  const auto dynamics = joint.child("dynamics");
  if (!dynamics) return;
  const double damping = dynamics->number_or_infinity("damping", 0);
  const double friction = dynamics->number_or_infinity("friction", 0);
  if (is_modelled)
    out.damping = damping, out.friction = friction;
  else if (damping != 0 || friction != 0)
    tell(*dynamics, "dynamics", joint.required("name"),
         "damping and friction are read only for joints with one coordinate", findings);
}

std::string check_end(const Element& joint, const char* end, const UrdfDetails& details) {
  const std::string owner = "joint " + quote(joint.required("name"));
  const Element e = required_child(joint, end, owner);
  const std::string link = e.required("link");
  if (!details.link.count(link)) {
    std::vector<std::string> known;
    for (const auto& [name, line] : details.link) known.push_back(name);
    std::ranges::sort(known);
    e.where("link").fail("the " + std::string(end) + " of " + owner + " is an unknown link " + quote(link) + ", " +
                         suggestion(link, known));
  }
  return link;
}

struct Edge {
  std::string parent, child, joint;
  int line;
};

Edge check_joint(const Element& joint, UrdfDetails& details) {
  const std::string name = check_name(joint, details.joint);
  UrdfJoint& own = details.joint.at(name);
  enum { kRevolute, kPrismatic, kContinuous, kPlanar, kFixed, kFloating };
  const int type = joint.choice("type", {"revolute", "prismatic", "continuous", "planar", "fixed", "floating"}, -1);
  check_origin(joint);
  if (type <= kPlanar) check_axis(joint, details);
  if (type <= kContinuous) check_limit(joint, type != kContinuous, own, details.findings);
  if (type != kFixed) check_dynamics(joint, type <= kContinuous, own, details.findings);
  if (const auto mimic = joint.child("mimic")) (void)mimic->required("joint");
  const std::string parent = check_end(joint, "parent", details);
  return {parent, check_end(joint, "child", details), name, joint.line()};
}

// Checks that there is one root, one parent for every other link, and no cycle.
void check_tree(const Element& robot, const UrdfDetails& details, const std::vector<Edge>& edges) {
  const auto at_line = [&robot](int line) { return Where{robot.where().file, line}; };
  std::unordered_map<std::string, const Edge*> above;  // key: name of the child link; value: the joint above it
  for (const Edge& e : edges) {
    const auto [at, is_new] = above.emplace(e.child, &e);
    if (!is_new)
      at_line(e.line).fail("link " + quote(e.child) + " is the child of joint " + quote(e.joint) + " and of joint " +
                           quote(at->second->joint) + ", expected a tree");
  }
  std::unordered_map<std::string, int> seen;  // key: link; value: number of the path from which it was first reached
  std::string root;
  int walk = 0;
  for (const Element& link : robot.children("link")) {
    std::string at = link.required("name");
    ++walk;
    while (seen.emplace(at, walk).second) {
      const auto up = above.find(at);
      if (up == above.end()) {
        if (!root.empty())
          at_line(details.link.at(at))
              .fail("link " + quote(at) + " has no parent, and link " + quote(root) +
                    " has no parent either, expected one root");
        root = at;
        break;
      }
      at = up->second->parent;
      if (const auto met = seen.find(at); met != seen.end() && met->second == walk)
        at_line(up->second->line)
            .fail("joint " + quote(up->second->joint) + " closes a cycle through link " + quote(at) +
                  ", expected a tree");
    }
  }
}

}  // namespace

UrdfDetails check_urdf(const Element& robot) {
  refuse_xacro(robot);
  UrdfDetails details;
  details.robot = robot.line();
  (void)robot.required("name");
  for (const Element& link : robot.children("link")) check_link(link, details);
  if (details.link.empty()) robot.fail("the robot has no <link>, expected at least one");
  std::vector<Edge> edges;
  for (const Element& joint : robot.children("joint")) edges.push_back(check_joint(joint, details));
  check_tree(robot, details, edges);
  tell_unread(robot, details.findings);
  return details;
}

}  // namespace manycontact::io
