// Mechanisms with redundant constraints. Hinges are placed by lengths and twists along x (Denavit-Hartenberg).

#include <cmath>
#include <numbers>

#include "case.hpp"

namespace manycontact::attack {

namespace {

struct Hinge {
  double length, twist, angle;  // length and twist to the next axis; angle of the joint
};

Case closed_chain(const std::string& name, const std::vector<Hinge>& hinges, int rows) {
  Case c;
  c.name = name;
  Tree t;
  Link base;
  base.name = "l0";
  t.links.push_back(base);
  t.rpy = {0.3, -0.2, 0.5};  // no axis along gravity
  double length = 0, twist = 0;
  for (std::size_t k = 0; k < hinges.size(); ++k) {
    Link l;
    l.name = "l" + std::to_string(k + 1), l.joint = "j" + std::to_string(k + 1);
    l.parent = static_cast<int>(k);
    l.xyz = {length, 0, 0}, l.rpy = {twist, 0, 0};
    length = hinges[k].length, twist = hinges[k].twist;
    l.mass = 1 + 0.1 * static_cast<double>(k);
    l.com = {length / 2, 0.02, -0.01};
    l.inertia = {0.02, 0, 0, 0.03, 0, 0.04};
    t.links.push_back(l);
    t.q.push_back(hinges[k].angle), t.v.push_back(0), t.u.push_back(k == 0 ? 1 : 0);
  }
  number_coordinates(t);
  c.trees = {t};
  Hold h;
  h.rows = rows;
  h.link = static_cast<int>(hinges.size());
  h.offset = {length, 0, 0};
  h.turned = {std::sin(twist / 2), 0, 0, std::cos(twist / 2)};
  h.place_turned = {0, 0, 0, 1};  // the first hinge's axis, where the chain began
  h.to_tree = 0, h.to_link = 0;
  c.holds = {h};
  return c;
}

}  // namespace

std::vector<Case> published_mechanisms() {
  constexpr double kPi = std::numbers::pi;
  const double a = 0.7;
  std::vector<Case> list;
  list.push_back(closed_chain("four-bar", {{1, 0, a}, {2, 0, kPi - a}, {1, 0, a}, {2, 0, kPi - a}}, 6));
  // Bennett: opposite links are equal, sin(twist) / length too; tan(u/2) tan(v/2) = sin((t+s)/2) / sin((t-s)/2)
  const double s = 0.9, t = 0.5, u = 1.1, ratio = std::sin((t + s) / 2) / std::sin((t - s) / 2);
  const double v = 2 * std::atan(ratio / std::tan(u / 2)), length = std::sin(t) / std::sin(s);
  list.push_back(closed_chain("Bennett", {{1, s, u}, {length, t, v}, {1, s, -u}, {length, t, -v}}, 6));
  std::vector<Hinge> cube;
  for (int k = 0; k < 6; ++k) cube.push_back({1, k % 2 ? kPi / 2 : -kPi / 2, kPi / 2});
  list.push_back(closed_chain("Bricard", cube, 6));
  return list;
}

}  // namespace manycontact::attack
