// Masses are far apart, or zero.

#include <cmath>

#include "stability/cases.hpp"

namespace manycontact::test {

namespace {

using enum ContactType;

std::string ratio(int exponent) { return "1e" + std::to_string(exponent); }

void add_each_ratio(Cases& cases, int exponent) {
  const double k = std::pow(10.0, exponent);
  const std::string at = ", " + ratio(exponent);
  cases.add("chain of 6, tip's mass" + at, [=] {
    Problem p = chain(6, false);
    edit(p, [=](Model& m) { scale(m.joints[5].inertia, k); });
    hold(p, k1D, "tip");
    move(p, 1);
    return p;
  });
  cases.add("chain of 8 held 3d, every second mass" + at, [=] {
    Problem p = chain(8, false);
    edit(p, [=](Model& m) {
      for (int i = 0; i < 8; i += 2) scale(m.joints[i].inertia, k);
    });
    hold(p, k3D, "tip");
    move(p, 1);
    return p;
  });
  cases.add("quadruped held 3d, feet's mass" + at, [=] {
    Problem p = robot("quadruped", true);
    edit(p, [=](Model& m) {
      for (int i = 3; i < m.njoints(); i += 3) scale(m.joints[i].inertia, k);
    });
    for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot);
    return p;
  });
  for (ContactType type : {k3D, k6D})
    cases.add(std::string("arm and box tied ") + to_string(type) + ", box's mass" + at, [=] {
      Problem p = two_robots("arm", false, "box");
      edit(
          p, [=](Model& m) { scale(m.joints[0].inertia, k); }, 1);
      tie(p, type, "a", "tool", "b", "face_back");
      return p;
    });
  for (double apart : {0.0, 1e-2})
    cases.add("quadruped held 3d twice " + power(apart) + " m apart, feet's mass" + at, [=] {
      Problem p = robot("quadruped", true);
      edit(p, [=](Model& m) {
        for (int i = 3; i < m.njoints(); i += 3) scale(m.joints[i].inertia, k);
      });
      for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"})
        hold(p, k3D, foot), hold(p, k3D, foot, {0, apart, 0});
      return p;
    });
  cases.add("arm and box tied 6d and 3d, box's mass" + at, [=] {
    Problem p = two_robots("arm", false, "box");
    edit(
        p, [=](Model& m) { scale(m.joints[0].inertia, k); }, 1);
    tie(p, k6D, "a", "tool", "b", "face_back");
    tie(p, k3D, "a", "tool", "b", "face_back", {0.1, 0, 0});
    return p;
  });
  cases.add("two boxes tied 6d twice, one's mass" + at, [=] {
    Problem p = two_robots("box", true, "box");
    edit(
        p, [=](Model& m) { scale(m.joints[0].inertia, k); }, 1);
    tie(p, k6D, "a", "face_front", "b", "face_back");
    tie(p, k6D, "a", "top_1", "b", "top_1");
    return p;
  });
}

}  // namespace

void add_mass_ratios(Cases& cases) {
  for (int exponent : {-8, -6, -4, -2, 2, 4, 6, 8}) add_each_ratio(cases, exponent);
  cases.add("chain of 9, masses from 1e8 to 1e-8", [] {
    Problem p = chain(9, false);
    edit(p, [](Model& m) {
      for (int i = 0; i < 9; ++i) scale(m.joints[i].inertia, std::pow(10.0, 8 - 2 * i));
    });
    hold(p, k3D, "tip");
    return p;
  });
  cases.add("chain of 9, masses from 1e-8 to 1e8", [] {
    Problem p = chain(9, false);
    edit(p, [](Model& m) {
      for (int i = 0; i < 9; ++i) scale(m.joints[i].inertia, std::pow(10.0, 2 * i - 8));
    });
    hold(p, k3D, "tip");
    return p;
  });
}

void add_singular_inertias(Cases& cases) {
  const auto massless = [](Problem& p, int from, int to) {
    edit(p, [=](Model& m) {
      for (int i = from; i < to; ++i) m.joints[i].inertia = {};
    });
  };
  for (bool floating : {false, true}) {
    const std::string name = floating ? "floating chain of 6" : "chain of 6";
    cases.add(name + ", last link massless, free", [=] {
      Problem p = chain(6, floating);
      massless(p, 5, 6);
      return p;
    });
    for (ContactType type : {k1D, k3D, k6D}) {
      cases.add(name + ", last link massless, held " + to_string(type), [=] {
        Problem p = chain(6, floating);
        massless(p, 5, 6);
        hold(p, type, "tip", {0.1, 0, 0});
        move(p, 1);
        return p;
      });
      cases.add(name + ", last link massless, root held " + to_string(type), [=] {
        Problem p = chain(6, floating);
        massless(p, 5, 6);
        hold(p, type, "link1");
        return p;
      });
      cases.add(name + ", middle links massless, held " + to_string(type), [=] {
        Problem p = chain(6, floating);
        massless(p, 2, 4);
        hold(p, type, "tip");
        return p;
      });
      cases.add(name + ", last three massless, held " + to_string(type), [=] {
        Problem p = chain(6, floating);
        massless(p, 3, 6);
        hold(p, type, "tip");
        return p;
      });
    }
    for (double armature : {1e-2, 1e-8, 1e-14})
      cases.add(name + ", last link massless with armature " + power(armature), [=] {
        Problem p = chain(6, floating);
        massless(p, 5, 6);
        edit(p, [=](Model& m) { m.armature[m.nv - 1] = armature; });
        hold(p, k3D, "link3");
        p.u.setConstant(1);
        return p;
      });
  }
  cases.add("quadruped without any mass", [=] {
    Problem p = robot("quadruped", true);
    massless(p, 0, 13);
    hold(p, k6D, "trunk");
    return p;
  });
  cases.add("quadruped without any mass, all joints held", [=] {
    Problem p = robot("quadruped", true);
    massless(p, 0, 13);
    hold(p, k6D, "trunk");
    for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot);
    return p;
  });
  for (double mass : {1e-10, 1e-13, 1e-16})
    for (bool held : {false, true})
      cases.add("chain of 4, last mass " + power(mass) + (held ? ", held 1d" : ", free"), [=] {
        Problem p = chain(4, false);
        edit(p, [=](Model& m) { scale(m.joints[3].inertia, mass); });
        if (held) hold(p, k1D, "tip", {0.1, 0, 0});
        move(p, 1);
        return p;
      });
  for (double mass : {1e-10, 1e-13, 1e-16})
    cases.add("chain of 4, last mass " + power(mass) + ", held 1d, pushed", [=] {
      Problem p = chain(4, false);
      edit(p, [=](Model& m) { scale(m.joints[3].inertia, mass); });
      hold(p, k1D, "tip", {0.1, 0, 0});
      p.u.setConstant(1);
      return p;
    });
}

}  // namespace manycontact::test
