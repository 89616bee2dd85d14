// Prepares the text of a URDF file for urdfdom.

#include <cstring>
#include <set>
#include <vector>

#include "urdf_check.hpp"

namespace manycontact::io {
namespace {

void keep(tinyxml2::XMLNode& node, const std::set<std::string>& wanted) {
  for (auto* c = node.FirstChild(); c;) {
    auto* next = c->NextSibling();
    if (!c->ToElement() || !wanted.count(c->Value())) node.DeleteChild(c);
    c = next;
  }
}

// Puts single blanks between the numbers of attributes, because urdfdom fails on tabs, line breaks or several blanks.
void tidy_numbers(tinyxml2::XMLElement& e) {
  std::vector<std::pair<std::string, std::string>> tidied;
  for (const auto* a = e.FirstAttribute(); a; a = a->Next()) {
    std::string value;
    for (const auto word : words(a->Value())) value += (value.empty() ? "" : " ") + std::string(word);
    tidied.emplace_back(a->Name(), value);
  }
  for (const auto& [name, value] : tidied) e.SetAttribute(name.c_str(), value.c_str());
}

// Returns the first child called `name`, and creates it if there is none.
tinyxml2::XMLElement& first_child(tinyxml2::XMLElement& parent, const char* name) {
  if (auto* found = parent.FirstChildElement(name)) return *found;
  return *parent.InsertNewChildElement(name);
}

void tidy_link(tinyxml2::XMLElement& link) {
  keep(link, {"inertial"});
  tinyxml2::XMLElement* inertial = link.FirstChildElement();
  if (!inertial) return;
  keep(*inertial, {"origin", "mass", "inertia"});
  const auto zero_where_missing = [](tinyxml2::XMLElement& e, const char* attribute) {
    if (!e.Attribute(attribute)) e.SetAttribute(attribute, "0");
  };
  zero_where_missing(first_child(*inertial, "mass"), "value");
  for (const char* a : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
    zero_where_missing(first_child(*inertial, "inertia"), a);
  for (auto* e = inertial->FirstChildElement(); e; e = e->NextSiblingElement()) tidy_numbers(*e);
}

void tidy_joint(tinyxml2::XMLElement& joint) {
  const std::string type = joint.Attribute("type");
  if (type == "fixed" || type == "floating")
    keep(joint, {"origin", "parent", "child"});
  else if (type == "planar")
    keep(joint, {"origin", "parent", "child", "axis"});
  else
    keep(joint, {"origin", "parent", "child", "axis", "mimic"});
  for (auto* e = joint.FirstChildElement(); e;) {
    auto* next = e->NextSiblingElement();
    const std::string name = e->Value();
    if (name == "mimic") {
      e->DeleteAttribute("multiplier");
      e->DeleteAttribute("offset");
    } else if (name == "axis" && !e->Attribute("xyz")) {
      joint.DeleteChild(e);  // urdfdom reads an axis without xyz as a zero axis
    } else if (name != "parent" && name != "child") {
      tidy_numbers(*e);
    }
    e = next;
  }
  if (type != "revolute" && type != "prismatic") return;  // urdfdom refuses these joints without limits
  tinyxml2::XMLElement& limit = first_child(joint, "limit");
  for (const char* a : {"effort", "velocity"}) limit.SetAttribute(a, "0");
}

}  // namespace

std::string text_for_urdfdom(XmlFile& file) {
  tinyxml2::XMLElement& robot = *file.document().RootElement();
  keep(robot, {"link", "joint"});
  for (auto* e = robot.FirstChildElement(); e; e = e->NextSiblingElement())
    std::strcmp(e->Value(), "link") == 0 ? tidy_link(*e) : tidy_joint(*e);
  tinyxml2::XMLPrinter printer(nullptr, true);
  robot.Accept(&printer);  // omits the XML declaration, whose encoding would be wrong for this UTF-8 text
  return printer.CStr();
}

}  // namespace manycontact::io
