// States and references are unusual: fast, half a revolution off, denormal, invalid quaternions.

#include <cmath>
#include <numbers>

#include "manycontact/spatial/explog.hpp"
#include "stability/cases.hpp"

namespace manycontact::test {

using enum ContactType;

void add_velocities(Cases& cases) {
  for (double speed : {1e1, 1e3, 1e6})
    for (ContactType type : {k1D, k2D, k3D, k6D}) {
      const std::string at = std::string(" ") + to_string(type) + ", " + power(speed) + " rad/s";
      cases.add("arm's tool" + at, [=] {
        Problem p = robot("arm", false);
        hold(p, type, "tool");
        move(p, speed);
        return p;
      });
      cases.add("quadruped's feet" + at, [=] {
        Problem p = robot("quadruped", true);
        for (const char* foot : {"LF_foot", "RH_foot"}) hold(p, type, foot);
        move(p, speed);
        return p;
      });
      cases.add("quadruped's feet held twice" + at, [=] {
        Problem p = robot("quadruped", true);
        for (const char* foot : {"LF_foot", "RH_foot"}) hold(p, type, foot), hold(p, type, foot, {0, 1e-2, 0});
        move(p, speed);
        return p;
      });
      cases.add("arm's tool tied to the box" + at, [=] {
        Problem p = two_robots("arm", false, "box");
        tie(p, type, "a", "tool", "b", "face_back").beta = 10;
        move(p, speed);
        return p;
      });
    }
}

void add_half_turns(Cases& cases) {
  const Vec3<double> axes[] = {Vec3<double>::UnitX(), Vec3<double>(1, 2, -3).normalized()};
  for (double off : {1e-1, 1e-3, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12})
    for (const Vec3<double>& axis : axes) {
      const std::string at = std::string(axis.x() == 1 ? " about x" : " about a slanted axis") + ", pi - " + power(off);
      const auto turn = [=](Contact& c) {
        Vec6<double> error;
        error << 0.1, -0.2, 0.3, (std::numbers::pi - off) * axis;
        c.B.placement = c.B.placement * exp6<double>(error);
        c.alpha = 25, c.beta = 10;
      };
      cases.add("arm's tool" + at, [=] {
        Problem p = robot("arm", false);
        turn(hold(p, k6D, "tool"));
        move(p);
        return p;
      });
      cases.add("arm's tool tied to the box" + at, [=] {
        Problem p = two_robots("arm", false, "box");
        turn(tie(p, k6D, "a", "tool", "b", "face_back", {0, 0, 0}, ReferenceFrame::kWorld));
        move(p);
        return p;
      });
      cases.add("quadruped's trunk" + at, [=] {
        Problem p = robot("quadruped", true);
        turn(hold(p, k6D, "trunk", {0.1, 0, 0}, ReferenceFrame::kLocalWorldAligned));
        return p;
      });
    }
}

namespace {
constexpr double kTiny = 5e-324, kSmall = 1e-310;
}  // namespace

void add_denormals(Cases& cases) {
  for (ContactType type : {k1D, k2D, k3D, k6D}) {
    const auto add = [&](const std::string& what, std::function<void(Problem&)> change) {
      cases.add("arm's tool " + to_string(type) + ", " + what, [=] {
        Problem p = robot("arm", false);
        hold(p, type, "tool").alpha = 1;
        move(p);
        change(p);
        return p;
      });
    };
    add("q", [](Problem& p) { p.q.setConstant(kTiny); });
    add("v", [](Problem& p) { p.v.setConstant(kTiny); });
    add("u", [](Problem& p) { p.u.setConstant(kSmall); });
    add("gravity, u and v", [](Problem& p) {
      p.scene.gravity *= 1e-311;
      p.u.setConstant(kSmall);
      p.v.setZero();
      p.scene.contacts[0].alpha = 0;
    });
    add("gains", [](Problem& p) { p.scene.contacts[0].alpha = p.scene.contacts[0].beta = kSmall; });
    add("reference and offset", [](Problem& p) {
      p.scene.contacts[0].A.placement.p.setConstant(kSmall);
      p.scene.contacts[0].B.placement.p.setConstant(kSmall);
    });
    add("armature", [](Problem& p) { edit(p, [](Model& m) { m.armature.setConstant(kSmall); }); });
    add("all inertias", [](Problem& p) {
      edit(p, [](Model& m) {
        for (Joint& joint : m.joints) scale(joint.inertia, 1e-310);
      });
    });
    add("all inertias 1e-300", [](Problem& p) {
      edit(p, [](Model& m) {
        for (Joint& joint : m.joints) scale(joint.inertia, 1e-300);
      });
      p.u *= 1e-300;
    });
    add("last inertia", [](Problem& p) { edit(p, [](Model& m) { scale(m.joints.back().inertia, 1e-310); }); });
    add("damping", [](Problem& p) { p.scene.damping = kSmall; });
    add("damping, held twice", [type](Problem& p) {
      p.scene.damping = kSmall;
      hold(p, type, "tool");
    });
  }
}

void add_quaternions(Cases& cases) {
  struct Off {
    std::string name;
    std::function<void(Eigen::Ref<Eigen::VectorXd>)> change;
    bool answerable = true;  // whether the norm is within 1e-6 of 1, as the library requires
  };
  const Off offs[] = {
      {"negated", [](auto x) { x *= -1; }},
      {"x (1 + 1e-9)", [](auto x) { x *= 1 + 1e-9; }},
      {"x (1 + 9e-7)", [](auto x) { x *= 1 + 9e-7; }},
      {"x (1 - 9e-7)", [](auto x) { x *= 1 - 9e-7; }},
      {"x (1 + 2e-6)", [](auto x) { x *= 1 + 2e-6; }, false},
      {"x 2", [](auto x) { x *= 2; }, false},
      {"x 1e-200", [](auto x) { x *= 1e-200; }, false},
      {"x 1e200", [](auto x) { x *= 1e200; }, false},
      {"zero", [](auto x) { x.setZero(); }, false},
      {"half a turn", [](auto x) { x << 1, 0, 0, 0; }},
      {"half a turn less 1e-12", [](auto x) { x << 1, 0, 0, 1e-12; }},
  };
  for (const Off& off : offs) {
    cases.add("quadruped's feet 3d, " + off.name, [=] {
      Problem p = robot("quadruped", true);
      for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot);
      move(p);
      off.change(p.q.segment(3, 4));
      p.answerable = off.answerable;
      return p;
    });
    cases.add("arm's tool tied to the box 6d, " + off.name, [=] {
      Problem p = two_robots("arm", false, "box");
      tie(p, k6D, "a", "tool", "b", "face_back").alpha = 10;
      move(p);
      off.change(p.q.tail(4));
      p.answerable = off.answerable;
      return p;
    });
  }
}

}  // namespace manycontact::test
