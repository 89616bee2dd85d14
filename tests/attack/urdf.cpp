// Reads a URDF independently, as far as the attack needs it.

#include <tinyxml2.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <sstream>
#include <stdexcept>

#include "case.hpp"

namespace manycontact::attack {

namespace {

using Element = tinyxml2::XMLElement;

const Element* child(const Element* e, const char* name) { return e ? e->FirstChildElement(name) : nullptr; }

void read_numbers(const Element* e, const char* attribute, Numbers& to) {
  if (const char* text = e ? e->Attribute(attribute) : nullptr) std::istringstream(text) >> to[0] >> to[1] >> to[2];
}

Kind kind_of(const std::string& type) {
  if (type == "fixed") return Kind::kFixed;
  if (type == "prismatic") return Kind::kPrismatic;
  if (type == "floating") return Kind::kFloating;
  if (type == "planar") return Kind::kPlanar;
  return Kind::kRevolute;
}

void read_inertial(const Element* inertial, Link& l) {
  if (!inertial) return;
  read_numbers(child(inertial, "origin"), "xyz", l.com);
  read_numbers(child(inertial, "origin"), "rpy", l.com_rpy);
  l.mass = child(inertial, "mass")->DoubleAttribute("value");
  constexpr const char* kNames[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
  for (int i = 0; i < 6; ++i) l.inertia[i] = child(inertial, "inertia")->DoubleAttribute(kNames[i]);
}

}  // namespace

Tree read_tree(const std::string& urdf, bool floating) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(urdf.c_str()) != tinyxml2::XML_SUCCESS) throw std::runtime_error("cannot read " + urdf);
  const Element* robot = document.FirstChildElement("robot");
  std::map<std::string, Link> links;
  for (const Element* e = child(robot, "link"); e; e = e->NextSiblingElement("link")) {
    Link& l = links[e->Attribute("name")];
    l.name = e->Attribute("name");
    read_inertial(child(e, "inertial"), l);
  }
  std::multimap<std::string, std::string> children;
  std::map<std::string, bool> carried;
  for (const Element* e = child(robot, "joint"); e; e = e->NextSiblingElement("joint")) {
    if (!child(e, "parent")) continue;  // a transmission's joint
    const std::string parent = child(e, "parent")->Attribute("link"), name = child(e, "child")->Attribute("link");
    Link& l = links.at(name);
    l.joint = e->Attribute("name");
    l.kind = kind_of(e->Attribute("type"));
    l.axis = {1, 0, 0};  // URDF's default
    read_numbers(child(e, "origin"), "xyz", l.xyz);
    read_numbers(child(e, "origin"), "rpy", l.rpy);
    read_numbers(child(e, "axis"), "xyz", l.axis);
    children.emplace(parent, name);
    carried[name] = true;
  }
  Tree t;
  t.urdf = urdf;
  t.floating = floating;
  const auto take = [&](const auto& self, const std::string& name, int parent) -> void {
    t.links.push_back(links.at(name));
    t.links.back().parent = parent;
    const int number = static_cast<int>(t.links.size()) - 1;
    for (auto [it, end] = children.equal_range(name); it != end; ++it) self(self, it->second, number);
  };
  for (const auto& [name, link] : links)
    if (!carried[name]) take(take, name, -1);
  number_coordinates(t);
  t.q.assign(t.nq, 0), t.v.assign(t.nv, 0), t.u.assign(t.nv - t.free(), 0);
  for (const Link& l : t.links)
    if (l.moves() && l.kind == Kind::kFloating) t.q[l.iq + 6] = 1;
  return t;
}

}  // namespace manycontact::attack
