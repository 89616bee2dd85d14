#include "urdf_check.hpp"

#include <cmath>
#include <cstring>
#include <set>
#include <vector>

namespace manycontact::io {
namespace {

void check_number(const Element& e, const char* attribute) { (void)e.required_number(attribute); }

void check_optional_numbers(const Element& parent, const char* child, std::initializer_list<const char*> attributes) {
  if (const auto e = parent.child(child))
    for (const char* a : attributes) (void)e->number(a, 0);
}

void check_origin(const Element& parent) {
  if (const auto origin = parent.child("origin")) {
    (void)origin->numbers<3>("xyz");
    (void)origin->numbers<3>("rpy");
  }
}

Element required_child(const Element& parent, const char* name, const std::string& owner) {
  const auto e = parent.child(name);
  if (!e) parent.fail(owner + " has no <" + name + ">, expected one");
  return *e;
}

// A name that is given, not empty and new.
std::string check_name(const Element& e, std::unordered_map<std::string, int>& lines) {
  const std::string name = e.required("name");
  if (name.empty()) e.where("name").fail(e.label("name") + " is empty, expected a name");
  const auto [at, is_new] = lines.emplace(name, e.line());
  if (!is_new)
    e.where("name").fail(e.name() + " " + quote(name) + " exists already on line " + std::to_string(at->second) +
                         ", expected names used once");
  return name;
}

void check_link(const Element& link, UrdfLines& lines) {
  const std::string owner = "<inertial> of link " + quote(check_name(link, lines.link));
  const auto inertial = link.child("inertial");
  if (!inertial) return;
  check_origin(*inertial);
  check_number(required_child(*inertial, "mass", owner), "value");
  const Element inertia = required_child(*inertial, "inertia", owner);
  for (const char* a : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) check_number(inertia, a);
}

void check_axis(const Element& joint) {
  const auto axis = joint.child("axis");
  if (!axis) return;
  if (!axis->has("xyz")) axis->fail("<axis> has no attribute 'xyz', expected one");
  const auto xyz = *axis->numbers<3>("xyz");
  if (std::hypot(xyz[0], xyz[1], xyz[2]) < kZeroDirection)
    axis->where("xyz").fail("the axis of joint " + quote(joint.required("name")) + " is zero, expected a direction");
}

// Of a joint with a range, which needs its limits; what the file leaves out is 0. urdfdom takes any numbers.
void check_limit(const Element& joint, bool has_range) {
  const std::string owner = "joint " + quote(joint.required("name"));
  if (has_range) (void)required_child(joint, "limit", owner);
  const auto limit = joint.child("limit");
  if (!limit) return;
  for (const char* a : {"effort", "velocity"})
    if (const double most = limit->required_number(a); most < 0)
      limit->where(a).fail("the " + std::string(a) + " limit of " + owner + " is " + show(most) +
                           ", expected 0 or more");
  const double lower = limit->number("lower", 0), upper = limit->number("upper", 0);
  if (has_range && lower > upper)
    limit->where("lower").fail("the limits of " + owner + " are lower " + show(lower) + ", upper " + show(upper) +
                               ", expected lower <= upper");
}

std::string check_end(const Element& joint, const char* end, const UrdfLines& lines) {
  const std::string owner = "joint " + quote(joint.required("name"));
  const Element e = required_child(joint, end, owner);
  const std::string link = e.required("link");
  if (!lines.link.count(link)) {
    std::vector<std::string> known;
    for (const auto& [name, line] : lines.link) known.push_back(name);
    std::sort(known.begin(), known.end());
    e.where("link").fail("the " + std::string(end) + " of " + owner + " is an unknown link " + quote(link) + ", " +
                         suggestion(link, known));
  }
  return link;
}

struct Edge {
  std::string parent, child, joint;
  int line;
};

Edge check_joint(const Element& joint, UrdfLines& lines) {
  const std::string name = check_name(joint, lines.joint);
  enum { kRevolute, kPrismatic, kContinuous, kPlanar, kFixed, kFloating };
  const int type = joint.choice("type", {"revolute", "prismatic", "continuous", "planar", "fixed", "floating"}, -1);
  check_origin(joint);
  if (type <= kPlanar) check_axis(joint);
  if (type <= kContinuous) check_limit(joint, type != kContinuous);
  check_optional_numbers(joint, "dynamics", {"damping", "friction"});
  check_optional_numbers(joint, "mimic", {"multiplier", "offset"});
  if (const auto mimic = joint.child("mimic")) (void)mimic->required("joint");
  const std::string parent = check_end(joint, "parent", lines);
  return {parent, check_end(joint, "child", lines), name, joint.line()};
}

// One root, one parent for every other link, no cycle.
void check_tree(const Element& robot, const UrdfLines& lines, const std::vector<Edge>& edges) {
  std::unordered_map<std::string, const Edge*> above;  // by child link
  for (const Edge& e : edges) {
    const auto [at, is_new] = above.emplace(e.child, &e);
    Where here = robot.where();
    here.line = e.line;
    if (!is_new)
      here.fail("link " + quote(e.child) + " is the child of joint " + quote(e.joint) + " and of joint " +
                quote(at->second->joint) + ", expected a tree");
  }
  std::unordered_map<std::string, int> seen;  // link: number of the walk that met it first
  std::string root;
  int walk = 0;
  for (auto link = robot.child("link"); link; link = link->next("link")) {
    std::string at = link->required("name");
    ++walk;
    while (seen.emplace(at, walk).second) {
      const auto up = above.find(at);
      if (up == above.end()) {
        Where here = robot.where();
        here.line = lines.link.at(at);
        if (!root.empty())
          here.fail("link " + quote(at) + " has no parent, nor has link " + quote(root) + ", expected one root");
        root = at;
        break;
      }
      at = up->second->parent;
      if (const auto met = seen.find(at); met != seen.end() && met->second == walk) {
        Where here = robot.where();
        here.line = up->second->line;
        here.fail("joint " + quote(up->second->joint) + " closes a cycle through link " + quote(at) +
                  ", expected a tree");
      }
    }
  }
}

}  // namespace

UrdfLines check_urdf(const Element& robot) {
  UrdfLines lines;
  lines.robot = robot.line();
  (void)robot.required("name");
  for (auto link = robot.child("link"); link; link = link->next("link")) check_link(*link, lines);
  if (lines.link.empty()) robot.fail("the robot has no <link>, expected at least one");
  std::vector<Edge> edges;
  for (auto joint = robot.child("joint"); joint; joint = joint->next("joint"))
    edges.push_back(check_joint(*joint, lines));
  check_tree(robot, lines, edges);
  return lines;
}

namespace {

void keep(tinyxml2::XMLNode& node, const std::set<std::string>& wanted) {
  for (auto* c = node.FirstChild(); c;) {
    auto* next = c->NextSibling();
    if (!c->ToElement() || !wanted.count(c->Value())) node.DeleteChild(c);
    c = next;
  }
}

// urdfdom splits at single spaces only: a tab or a line break between numbers makes it fail.
void tidy_numbers(tinyxml2::XMLElement& e) {
  std::vector<std::pair<std::string, std::string>> tidied;
  for (const auto* a = e.FirstAttribute(); a; a = a->Next()) {
    std::string value;
    for (const auto word : words(a->Value())) value += (value.empty() ? "" : " ") + std::string(word);
    tidied.emplace_back(a->Name(), value);
  }
  for (const auto& [name, value] : tidied) e.SetAttribute(name.c_str(), value.c_str());
}

void tidy_link(tinyxml2::XMLElement& link) {
  keep(link, {"inertial"});
  for (auto* i = link.FirstChildElement(); i; i = i->NextSiblingElement()) {
    keep(*i, {"origin", "mass", "inertia"});
    for (auto* e = i->FirstChildElement(); e; e = e->NextSiblingElement()) tidy_numbers(*e);
  }
}

void tidy_joint(tinyxml2::XMLElement& joint) {
  const std::string type = joint.Attribute("type");
  if (type == "fixed" || type == "floating")
    keep(joint, {"origin", "parent", "child"});
  else if (type == "planar")
    keep(joint, {"origin", "parent", "child", "axis"});
  else
    keep(joint, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"});
  for (auto* e = joint.FirstChildElement(); e;) {
    auto* next = e->NextSiblingElement();
    const std::string name = e->Value();
    if (name == "mimic") {
      e->DeleteAttribute("multiplier");
      e->DeleteAttribute("offset");
    } else if (name == "dynamics" && !e->Attribute("damping") && !e->Attribute("friction")) {
      joint.DeleteChild(e);  // which urdfdom refuses
    } else if (name != "parent" && name != "child") {
      tidy_numbers(*e);
    }
    e = next;
  }
}

}  // namespace

std::string text_for_urdfdom(XmlFile& file) {
  tinyxml2::XMLElement& robot = *file.document().RootElement();
  keep(robot, {"link", "joint"});
  for (auto* e = robot.FirstChildElement(); e; e = e->NextSiblingElement())
    std::strcmp(e->Value(), "link") == 0 ? tidy_link(*e) : tidy_joint(*e);
  tinyxml2::XMLPrinter printer(nullptr, true);
  file.document().Print(&printer);
  return printer.CStr();
}

}  // namespace manycontact::io
