// Contacts nearly coincide and legs are nearly straight: rows are nearly dependent. No case is at the rank's tolerance
// itself, 1e-11, where either solution is equally good.

#include "stability/cases.hpp"

namespace manycontact::test {

namespace {

using enum ContactType;

}  // namespace

void add_near(Cases& cases) {
  for (double apart : {1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 3e-12, 1e-12}) {
    const std::string at = ", " + power(apart) + " m";
    for (ContactType second : {k1D, k2D, k3D})
      cases.add(std::string("quadruped's feet 3d+") + to_string(second) + at, [=] {
        Problem p = robot("quadruped", true);
        for (const char* foot : {"LF_foot", "RF_foot", "LH_foot"}) {
          hold(p, k3D, foot);
          hold(p, second, foot, {0, apart, 0});
        }
        return p;
      });
    cases.add("quadruped's feet 3d+2d, moving" + at, [=] {
      Problem p = robot("quadruped", true);
      for (const char* foot : {"LF_foot", "RF_foot"}) {
        hold(p, k3D, foot);
        hold(p, k2D, foot, {0, apart, 0});
      }
      move(p, 1);
      return p;
    });
    cases.add("two boxes tied 3d+2d" + at, [=] {
      Problem p = two_robots("box", true, "box");
      tie(p, k3D, "a", "face_front", "b", "face_back");
      tie(p, k2D, "a", "face_front", "b", "face_back", {0, apart, 0});
      move(p, 1);
      return p;
    });
    cases.add("arm's tool at three points 3d+3d+3d" + at, [=] {
      Problem p = robot("arm", false);
      hold(p, k3D, "tool");
      hold(p, k3D, "tool", {apart, 0, 0});
      hold(p, k3D, "tool", {0, apart, 0});
      return p;
    });
  }
}

void add_straight_legs(Cases& cases) {
  for (double angle : {1e-1, 1e-3, 1e-5, 1e-7, 1e-9, 1e-10, 3e-12, 1e-12, 1e-14, 0.0}) {
    const std::string at = ", " + power(angle) + " rad";
    for (const bool moving : {false, true})
      cases.add("quadruped's feet and trunk 3d" + std::string(moving ? ", moving" : "") + at, [=] {
        Problem p = robot("quadruped", true);
        for (const char* leg : {"LF", "RF", "LH", "RH"}) {
          bend(p, std::string(leg) + "_hip", angle / 2);
          bend(p, std::string(leg) + "_knee", -angle);
        }
        hold(p, k6D, "trunk");
        for (const char* leg : {"LF", "RF", "LH", "RH"}) hold(p, k3D, std::string(leg) + "_foot");
        if (moving) move(p, 1);
        return p;
      });
    for (ContactType type : {k1D, k3D, k6D})
      for (bool world : {false, true})
        cases.add("arm stretched, tool " + to_string(type) + (world ? " in the world's axes" : "") + at, [=] {
          Problem p = robot("arm", false);
          for (const char* joint : {"shoulder_yaw", "shoulder_pitch", "upper_arm_yaw", "forearm_yaw", "wrist_yaw"})
            bend(p, joint, 0.3);
          bend(p, "elbow", angle);
          bend(p, "wrist_pitch", angle);
          hold(p, type, "tool", {0, 0, 0}, world ? ReferenceFrame::kWorld : ReferenceFrame::kLocal);
          return p;
        });
  }
  for (double angle : {1e-1, 1e-4, 1e-8, 0.0})
    for (ContactType type : {k3D, k6D})
      cases.add("humanoid's straight knees, soles and trunk " + to_string(type) + ", " + power(angle) + " rad", [=] {
        Problem p = robot("humanoid", true);
        for (const char* side : {"left", "right"}) {
          bend(p, std::string(side) + "_hip_pitch", -angle / 2);
          bend(p, std::string(side) + "_knee", angle);
          bend(p, std::string(side) + "_ankle_pitch", -angle / 2);
        }
        hold(p, type, "left_sole");
        hold(p, type, "right_sole");
        hold(p, k6D, "pelvis");
        return p;
      });
}

}  // namespace manycontact::test
