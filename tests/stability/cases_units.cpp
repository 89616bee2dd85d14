// The same robots have other units of length and mass: the solution is the same, the numbers are not.

#include <cmath>

#include "stability/cases.hpp"
#include "support/truth.hpp"

namespace manycontact::test {

namespace {

using enum ContactType;

void change_units(Model& m, double length, double mass) {
  for (Joint& joint : m.joints) {
    joint.placement.p *= length;
    joint.inertia.m *= mass;
    joint.inertia.h *= mass * length;
    joint.inertia.I *= mass * length * length;
  }
  for (Frame& frame : m.frames) frame.placement.p *= length;
  m.armature *= mass * length * length;
}

// Changes the units of a problem. All joints must be revolute, except for the floating base.
Problem in_units(Problem p, double length, double mass) {
  const std::vector<char> all(p.scene.contacts.size(), 1);
  const Truth<Quad> truth = solve_truth<Quad>(p.scene, all, p.q.cast<Quad>(), p.v.cast<Quad>(), p.u.cast<Quad>());
  KnownAnswer known{truth.a, truth.f, Eigen::VectorXd::Ones(p.scene.nv), Eigen::VectorXd(truth.f.size())};
  for (int r = 0; r < p.scene.nrobots(); ++r) {
    edit(
        p, [=](Model& m) { change_units(m, length, mass); }, r);
    Robot& robot = p.scene.robots[r];
    robot.base.p *= length;
    if (!robot.model->floating_base) continue;
    p.q.segment<3>(robot.idx_q) *= length;
    p.v.segment<3>(robot.idx_v) *= length;
    known.a_unit.segment<3>(robot.idx_v).setConstant(length);
  }
  p.u *= mass * length * length;
  p.scene.gravity *= length;
  int row = 0;
  for (Contact& c : p.scene.contacts) {
    c.A.placement.p *= length;
    c.B.placement.p *= length;
    for (int k = 0; k < c.rows(); ++k) known.f_unit[row++] = mass * (k < 3 ? length : length * length);
  }
  p.known = known;
  return p;
}

}  // namespace

void add_units(Cases& cases) {
  const std::pair<double, double> units[] = {{1e-6, 1}, {1e-3, 1}, {1e3, 1},    {1e6, 1},    {1, 1e-6},  {1, 1e-3},
                                             {1, 1e3},  {1, 1e6},  {1e-3, 1e3}, {1e3, 1e-3}, {1e3, 1e3}, {1e-3, 1e-3}};
  for (const auto& [length, mass] : units) {
    const std::string in = ", length x " + power(length) + ", mass x " + power(mass);
    const auto add = [&, length = length, mass = mass](const std::string& name, std::function<Problem()> base) {
      cases.add(name + in, [=] { return in_units(base(), length, mass); });
    };
    add("quadruped's feet 3d", [] {
      Problem p = robot("quadruped", true);
      for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot);
      move(p);
      return p;
    });
    add("arm's tool 6d", [] {
      Problem p = robot("arm", false);
      hold(p, k6D, "tool");
      move(p);
      return p;
    });
    add("arm's tool tied to the box 6d, box on a corner 3d", [] {
      Problem p = two_robots("arm", false, "box");
      tie(p, k6D, "a", "tool", "b", "face_back");
      hold(p, k1D, "bottom_4", {0, 0, 0}, ReferenceFrame::kLocal, "b");
      return p;
    });
    add("quadruped's feet 3d twice", [] {
      Problem p = robot("quadruped", true);
      for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot), hold(p, k3D, foot);
      return p;
    });
  }
}

}  // namespace manycontact::test
