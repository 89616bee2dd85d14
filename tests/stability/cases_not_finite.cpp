// Every input in turn is NaN or infinite.

#include <algorithm>
#include <iterator>
#include <limits>

#include "stability/cases.hpp"

namespace manycontact::test {

using enum ContactType;

namespace {

// A box is attached to an arm and on one foot: every kind of input has an effect.
Problem healthy() {
  Problem p = two_robots("arm", false, "box");
  Contact& c = tie(p, k6D, "a", "tool", "b", "face_back");
  c.alpha = 25, c.beta = 10;
  hold(p, k1D, "bottom_4", {0, 0, 0}, ReferenceFrame::kLocalWorldAligned, "b").alpha = 5;
  move(p);
  return p;
}

// Adds a contact again, so that add_contact checks it.
void add_again(Problem& p, const std::function<void(Contact&)>& change) {
  Contact c = p.scene.contacts[0];
  c.name = "again";
  c.type = k3D;
  change(c);
  add_contact(p.scene, c);
}

}  // namespace

void add_not_finite(Cases& cases) {
  struct Input {
    std::string name;
    std::function<void(Problem&, double)> set;
  };
  const auto joint = [](Problem& p, int robot, const std::function<void(Joint&)>& set) {
    edit(
        p, [&](Model& m) { set(m.joints.back()); }, robot);
  };
  const Input inputs[] = {
      {"q of a revolute", [](Problem& p, double x) { p.q[2] = x; }},
      {"q of a floating base's place", [](Problem& p, double x) { p.q[8] = x; }},
      {"q of a floating base's quaternion", [](Problem& p, double x) { p.q[11] = x; }},
      {"v of a revolute", [](Problem& p, double x) { p.v[2] = x; }},
      {"v of a floating base", [](Problem& p, double x) { p.v[8] = x; }},
      {"u", [](Problem& p, double x) { p.u[3] = x; }},
      {"gravity", [](Problem& p, double x) { p.scene.gravity.x() = x; }},
      {"damping", [](Problem& p, double x) { p.scene.damping = x, p.answerable = false; }},
      {"alpha", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.alpha = x; }); }},
      {"beta", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.beta = x; }); }},
      {"axis", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.axis.y() = x; }); }},
      {"offset", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.A.placement.p.y() = x; }); }},
      {"offset's axes", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.A.placement.R(1, 1) = x; }); }},
      {"reference", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.B.placement.p.y() = x; }); }},
      {"reference's axes", [](Problem& p, double x) { add_again(p, [x](Contact& c) { c.B.placement.R(1, 1) = x; }); }},
      {"alpha set later", [](Problem& p, double x) { p.scene.contacts[0].alpha = x; }},
      {"beta set later", [](Problem& p, double x) { p.scene.contacts[0].beta = x; }},
      {"axis set later", [](Problem& p, double x) { p.scene.contacts[1].axis.z() = x; }},
      {"offset set later", [](Problem& p, double x) { p.scene.contacts[1].A.placement.p.x() = x; }},
      {"offset's axes set later", [](Problem& p, double x) { p.scene.contacts[0].A.placement.R(2, 2) = x; }},
      {"reference set later", [](Problem& p, double x) { p.scene.contacts[0].B.placement.p.x() = x; }},
      {"reference's axes set later", [](Problem& p, double x) { p.scene.contacts[0].B.placement.R(0, 0) = x; }},
      {"robot's base", [](Problem& p, double x) { p.scene.robots[0].base.p.z() = x; }},
      {"axes of a robot's base", [](Problem& p, double x) { p.scene.robots[0].base.R(0, 1) = x; }},
      {"armature", [](Problem& p, double x) { edit(p, [x](Model& m) { m.armature[2] = x; }); }},
      {"mass", [=](Problem& p, double x) { joint(p, 0, [x](Joint& j) { j.inertia.m = x; }); }},
      {"mass of a floating base", [=](Problem& p, double x) { joint(p, 1, [x](Joint& j) { j.inertia.m = x; }); }},
      {"first moment", [=](Problem& p, double x) { joint(p, 0, [x](Joint& j) { j.inertia.h.x() = x; }); }},
      {"rotational inertia", [=](Problem& p, double x) { joint(p, 0, [x](Joint& j) { j.inertia.I(0, 0) = x; }); }},
      {"rotational inertia of a floating base",
       [=](Problem& p, double x) { joint(p, 1, [x](Joint& j) { j.inertia.I(1, 1) = x; }); }},
      {"joint's placement", [=](Problem& p, double x) { joint(p, 0, [x](Joint& j) { j.placement.p.x() = x; }); }},
      {"joint's axes",
       [=](Problem& p, double x) {
         joint(p, 0, [x](Joint& j) { j.placement.R(0, 0) = x, j.placement_rotates = true; });
       }},
      {"joint's axis", [=](Problem& p, double x) { joint(p, 0, [x](Joint& j) { j.axis.x() = x, j.axis_kind = 3; }); }},
  };
  const auto finite = [&](const Input& input) {  // the same change to an allowed number
    cases.add(input.name + " 0.5", [=] {
      Problem p = healthy();
      input.set(p, 0.5);
      p.answerable = true;
      return p;
    });
  };
  for (const char* name : {"q of a revolute", "v of a floating base", "u", "gravity", "damping", "alpha set later",
                           "offset set later", "reference set later", "robot's base", "armature", "first moment"})
    finite(*std::find_if(std::begin(inputs), std::end(inputs), [=](const Input& i) { return i.name == name; }));
  const double infinity = std::numeric_limits<double>::infinity();
  const std::pair<const char*, double> values[] = {
      {"NaN", std::numeric_limits<double>::quiet_NaN()}, {"inf", infinity}, {"-inf", -infinity}};
  cases.add("all finite", healthy);
  for (const Input& input : inputs)
    for (const auto& [name, value] : values)
      cases
          .add(input.name + " " + name,
               [=, value = value] {
                 Problem p = healthy();
                 input.set(p, value);
                 return p;
               })
          .bad_input = true;
}

}  // namespace manycontact::test
