#include "case.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace manycontact::attack {

int Case::nv() const {
  int n = 0;
  for (const Tree& t : trees) n += t.nv;
  return n;
}

int Case::rows() const {
  int n = 0;
  for (const Hold& h : holds) n += h.rows;
  return n;
}

void number_coordinates(Tree& tree) {
  tree.nq = tree.nv = 0;
  const auto visit = [&](const auto& self, int i) -> void {
    Link& link = tree.links[i];
    if (i == 0) link.kind = tree.floating ? Kind::kFloating : Kind::kFixed;
    link.iq = link.iv = -1;
    if (link.moves()) {
      link.iq = tree.nq, link.iv = tree.nv;
      tree.nq += nq_of(link.kind), tree.nv += nv_of(link.kind);
    }
    std::vector<int> children;
    for (int k = 0; k < static_cast<int>(tree.links.size()); ++k)
      if (tree.links[k].parent == i) children.push_back(k);
    std::sort(children.begin(), children.end(),
              [&](int a, int b) { return tree.links[a].joint < tree.links[b].joint; });
    for (int k : children) self(self, k);
  };
  visit(visit, 0);
}

int moving_link(const Tree& tree, int link) {
  while (link >= 0 && !tree.links[link].moves()) link = tree.links[link].parent;
  return link;
}

void drop_refused(Case& c) {
  std::erase_if(c.holds, [&](const Hold& h) {
    const int a = moving_link(c.trees[h.tree], h.link);
    const int b = h.to_tree < 0 ? -1 : moving_link(c.trees[h.to_tree], h.to_link);
    return (a < 0 && b < 0) || (h.tree == h.to_tree && a == b);
  });
  std::erase_if(c.wrenches, [&](const ExternalWrench& p) { return moving_link(c.trees[p.tree], p.link) < 0; });
  std::erase_if(c.springs, [&](const Spring& s) {
    const int a = moving_link(c.trees[s.tree], s.link);
    return a < 0 || (s.tree == s.to_tree && a == moving_link(c.trees[s.tree], s.to_link));
  });
}

namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}
template <class List>
std::string numbers(const List& list) {
  std::string text;
  for (double x : list) text += (text.empty() ? "" : " ") + number(x);
  return text;
}

const char* type_of(Kind k) {
  switch (k) {
    case Kind::kRevolute:
      return "continuous";
    case Kind::kPrismatic:
      return "prismatic";
    case Kind::kFloating:
      return "floating";
    case Kind::kPlanar:
      return "planar";
    case Kind::kFixed:
      break;
  }
  return "fixed";
}

// Returns the first tree whose file has the same text.
int first_alike(const Case& c, int k) {
  const std::string text = urdf_text(c.trees[k]);
  int first = 0;
  while (!c.trees[first].urdf.empty() || urdf_text(c.trees[first]) != text) ++first;
  return first;
}

std::string robot_element(const Case& c, int k) {
  const Tree& t = c.trees[k];
  const std::string name = "r" + std::to_string(k);
  std::string text = "<robot name=\"" + name + "\" urdf=\"" +
                     (t.urdf.empty() ? "r" + std::to_string(first_alike(c, k)) + ".urdf" : t.urdf) + "\" base=\"" +
                     (t.floating ? "floating\"" : "fixed\"");
  if (std::any_of(t.links.begin(), t.links.end(), [](const Link& l) { return l.reversed; }))
    text += " root=\"" + t.links[0].name + "\"";
  if (!t.floating) text += " xyz=\"" + numbers(t.xyz) + "\" rpy=\"" + numbers(t.rpy) + "\"";
  text += ">\n";
  for (std::size_t i = 1; i < t.links.size(); ++i) {
    const Link& l = t.links[i];
    if (l.locked)
      text += "<lock joint=\"" + l.joint + "\" at=\"" + number(*l.locked) + "\"/>\n";
    else if (l.moves() && (l.armature != 0 || l.stiffness != 0 || l.damping != 0))
      text += "<joint name=\"" + l.joint + "\"" + (l.armature != 0 ? " armature=\"" + number(l.armature) + "\"" : "") +
              (l.stiffness != 0 ? " stiffness=\"" + number(l.stiffness) + "\" rest=\"" + number(l.rest) + "\"" : "") +
              (l.damping != 0 ? " damping=\"" + number(l.damping) + "\"" : "") + "/>\n";
  }
  if (t.nv > 0) text += "<q>" + numbers(t.q) + "</q>\n<v>" + numbers(t.v) + "</v>\n";
  if (t.nv > t.free()) text += "<u>" + numbers(t.u) + "</u>\n";
  return text + "</robot>\n";
}

std::string frame_of(const Case& c, int tree, int link) {
  return "r" + std::to_string(tree) + "/" + c.trees[tree].links[link].name;
}

std::string contact_element(const Case& c, const Hold& h, int k) {
  std::string text = "<contact name=\"c" + std::to_string(k) + "\" type=\"" + std::to_string(h.rows) + "d\" frame=\"" +
                     frame_of(c, h.tree, h.link) + "\" offset=\"" + numbers(h.offset) + "\" offset_quat_xyzw=\"" +
                     numbers(h.turned) + "\"";
  const bool to = h.to_tree >= 0;
  if (to) text += " to=\"" + frame_of(c, h.to_tree, h.to_link) + "\"";
  text += std::string(to ? " to_offset=\"" : " xyz=\"") + numbers(h.place) + "\"" +
          (to ? " to_offset_quat_xyzw=\"" : " quat_xyzw=\"") + numbers(h.place_turned) + "\"";
  if (h.rows != 5) text += " reference_frame=\"" + h.frame + "\"";
  if (h.rows == 1 || h.rows == 5) text += " axis=\"" + numbers(h.axis) + "\"";
  if (h.alpha != 0 || h.beta != 0) text += " gains=\"" + number(h.alpha) + " " + number(h.beta) + "\"";
  return text + "/>\n";
}

std::string push_element(const Case& c, const ExternalWrench& p, int k) {
  return "<push name=\"p" + std::to_string(k) + "\" frame=\"" + frame_of(c, p.tree, p.link) + "\" offset=\"" +
         numbers(p.offset) + "\" force=\"" + numbers(p.force) + "\" torque=\"" + numbers(p.torque) +
         "\" reference_frame=\"" + (p.world ? "world" : "local") + "\"/>\n";
}

std::string spring_element(const Case& c, const Spring& s, int k) {
  const std::string to = s.to_tree < 0 ? " xyz=\"" : " to=\"" + frame_of(c, s.to_tree, s.to_link) + "\" to_offset=\"";
  return "<spring name=\"s" + std::to_string(k) + "\" frame=\"" + frame_of(c, s.tree, s.link) + "\" offset=\"" +
         numbers(s.offset) + "\"" + to + numbers(s.place) + "\" stiffness=\"" + number(s.stiffness) + "\" length=\"" +
         number(s.length) + "\" damping=\"" + number(s.damping) + "\"/>\n";
}

}  // namespace

std::string urdf_text(const Tree& tree) {
  std::string text = "<robot name=\"r\">\n";
  for (const Link& l : tree.links) {
    text += "<link name=\"" + l.name + "\">";
    const bool nothing =
        l.mass == 0 && std::all_of(l.inertia.begin(), l.inertia.end(), [](double x) { return x == 0; });
    if (!nothing) {
      constexpr const char* kNames[] = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
      text += "<inertial><origin xyz=\"" + numbers(l.com) + "\" rpy=\"" + numbers(l.com_rpy) + "\"/><mass value=\"" +
              number(l.mass) + "\"/><inertia";
      for (int i = 0; i < 6; ++i) text += std::string(" ") + kNames[i] + "=\"" + number(l.inertia[i]) + "\"";
      text += "/></inertial>";
    }
    text += "</link>\n";
  }
  for (std::size_t i = 1; i < tree.links.size(); ++i) {
    const Link& l = tree.links[i];
    const std::string &above = tree.links[l.parent].name, &below = l.name;
    text += "<joint name=\"" + l.joint + "\" type=\"" + type_of(l.kind) + "\"><parent link=\"" +
            (l.reversed ? below : above) + "\"/><child link=\"" + (l.reversed ? above : below) + "\"/><origin xyz=\"" +
            numbers(l.xyz) + "\" rpy=\"" + numbers(l.rpy) + "\"/><axis xyz=\"" + numbers(l.axis) + "\"/>";
    if (l.kind == Kind::kPrismatic) text += "<limit lower=\"-1e30\" upper=\"1e30\" effort=\"1e30\" velocity=\"1e30\"/>";
    text += "</joint>\n";
  }
  return text + "</robot>\n";
}

std::string scene_text(const Case& c) {
  std::string text =
      "<scene name=\"attack\" gravity=\"" + numbers(c.gravity) + "\" damping=\"" + number(c.damping) + "\">\n";
  for (std::size_t k = 0; k < c.trees.size(); ++k) text += robot_element(c, static_cast<int>(k));
  for (std::size_t k = 0; k < c.holds.size(); ++k) text += contact_element(c, c.holds[k], static_cast<int>(k));
  for (std::size_t k = 0; k < c.wrenches.size(); ++k) text += push_element(c, c.wrenches[k], static_cast<int>(k));
  for (std::size_t k = 0; k < c.springs.size(); ++k) text += spring_element(c, c.springs[k], static_cast<int>(k));
  return text + "</scene>\n";
}

std::string write_case(const Case& c, const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (std::size_t k = 0; k < c.trees.size(); ++k)
    if (c.trees[k].urdf.empty()) std::ofstream(folder + "/r" + std::to_string(k) + ".urdf") << urdf_text(c.trees[k]);
  std::ofstream(folder + "/scene.xml") << scene_text(c);
  return folder + "/scene.xml";
}

}  // namespace manycontact::attack
