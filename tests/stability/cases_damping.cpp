// Damping ranges from nearly zero to dominant.

#include "stability/cases.hpp"

namespace manycontact::test {

void add_damping(Cases& cases) {
  using enum ContactType;
  for (double damping : {1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-4, 1.0, 1e4, 1e8}) {
    const std::string at = ", " + power(damping);
    const auto add = [&](const std::string& name, std::function<Problem()> make) {
      cases.add(name + at, [=] {
        Problem p = make();
        p.scene.damping = damping;
        return p;
      });
    };
    add("quadruped's feet 3d", [] {
      Problem p = robot("quadruped", true);
      for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot);
      move(p);
      return p;
    });
    add("quadruped's feet 3d twice", [] {
      Problem p = robot("quadruped", true);
      for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) hold(p, k3D, foot), hold(p, k3D, foot);
      return p;
    });
    add("arm's tool 6d twice, pulled apart", [] {
      Problem p = robot("arm", false);
      hold(p, k6D, "tool");
      Contact& c = hold(p, k6D, "tool");
      c.B.placement.p.x() += 0.1, c.alpha = 100;
      return p;
    });
    for (ContactType type : {k3D, k6D})
      add("arm's tool " + to_string(type) + " twice, once in the world's axes, pulled apart", [=] {
        Problem p = robot("arm", false);
        hold(p, type, "tool");
        Contact& c = hold(p, type, "tool", {0.1, 0, 0}, ReferenceFrame::kWorld);
        c.B.placement.p.x() += 0.1, c.alpha = 100;
        return p;
      });
    add("arm's tool 6d twice beside a heavy box held 3d", [] {  // two islands: the damping is lost in one only
      Problem p = two_robots("arm", false, "box");
      edit(
          p, [](Model& m) { scale(m.joints[0].inertia, 1e8); }, 1);
      hold(p, k6D, "tool", {0, 0, 0}, ReferenceFrame::kLocal, "a");
      hold(p, k6D, "tool", {0.1, 0, 0}, ReferenceFrame::kWorld, "a");
      hold(p, k3D, "bottom_4", {0, 0, 0}, ReferenceFrame::kLocal, "b");
      move(p);
      return p;
    });
    add("chain of 6, last link massless, held 1d twice", [] {
      Problem p = chain(6, false);
      edit(p, [](Model& m) { m.joints[5].inertia = {}; });
      hold(p, k1D, "tip", {0.1, 0, 0});
      hold(p, k1D, "tip", {0.1, 0, 0});
      return p;
    });
    add("arm tied to the box 1d and 2d", [] {
      Problem p = two_robots("arm", false, "box");
      tie(p, k1D, "a", "tool", "b", "face_back");
      tie(p, k2D, "a", "tool", "b", "face_back", {0, 0.1, 0});
      move(p);
      return p;
    });
    add("chain of 6, last link massless, held 1d", [] {
      Problem p = chain(6, false);
      edit(p, [](Model& m) { m.joints[5].inertia = {}; });
      hold(p, k1D, "tip", {0.1, 0, 0});
      move(p, 1);
      return p;
    });
  }
  cases.add("quadruped's feet 3d, negative", [] {
    Problem p = robot("quadruped", true);
    for (const char* foot : {"LF_foot", "RF_foot"}) hold(p, k3D, foot);
    p.scene.damping = -1e-3;
    p.answerable = false;
    return p;
  });
}

}  // namespace manycontact::test
