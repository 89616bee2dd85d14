// Contacts are redundant and consistent: at rest, or in a motion that all of them allow.

#include "stability/cases.hpp"

namespace manycontact::test {

namespace {

using enum ContactType;
constexpr ReferenceFrame kWorldAxes = ReferenceFrame::kLocalWorldAligned;

struct Structure {
  std::string name, urdf;
  bool floating;
  std::vector<std::string> frames;
};

const Structure kQuadruped{"quadruped's feet", "quadruped", true, {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}};
const Structure kHumanoid{"humanoid's soles", "humanoid", true, {"left_sole", "right_sole"}};
const Structure kArm{"arm's tool", "arm", false, {"tool"}};
const Structure kBox{"box's edges", "box", true, {"bottom_1", "bottom_4"}};

// Fixes every frame, and fixes it again `apart` metres away.
Problem twice(const Structure& s, ContactType first, ContactType second, double apart, ReferenceFrame axes) {
  Problem p = robot(s.urdf, s.floating);
  for (const std::string& frame : s.frames) {
    hold(p, first, frame);
    hold(p, second, frame, apart * Vec3<double>(0.6, 0.8, 0), axes);
  }
  return p;
}

std::string pair_name(ContactType first, ContactType second) { return to_string(first) + "+" + to_string(second); }

}  // namespace

void add_held_twice(Cases& cases) {
  struct Kind {
    Structure structure;
    std::vector<std::pair<ContactType, ContactType>> types;
  };
  const Kind kinds[] = {
      {kQuadruped, {{k1D, k1D}, {k2D, k2D}, {k3D, k3D}, {k6D, k6D}, {k6D, k3D}, {k3D, k1D}}},
      {kHumanoid, {{k3D, k3D}, {k6D, k6D}, {k6D, k3D}}},
      {kArm, {{k3D, k3D}, {k6D, k6D}, {k2D, k6D}}},
      {kBox, {{k3D, k3D}, {k6D, k6D}}},
  };
  for (const Kind& kind : kinds)
    for (const auto& [first, second] : kind.types)
      for (double apart : {0.0, 1e-1, 1e-2, 1e-3, 1e-4}) {
        const auto make = [s = kind.structure, first = first, second = second, apart] {
          return twice(s, first, second, apart, kWorldAxes);
        };
        cases.add(kind.structure.name + " " + pair_name(first, second) + ", " + power(apart) + " m apart", make)
            .demanded = true;
      }
  for (const auto& [first, second] : kinds[0].types)
    cases.add("quadruped's feet " + pair_name(first, second) + " moving with the ground",
              [first = first, second = second] {
                Problem p = twice(kQuadruped, first, second, 0, ReferenceFrame::kLocal);
                if (first == second) move_within_contacts(p);
                return p;
              });
  for (ContactType type : {k1D, k2D, k3D, k6D})
    for (int times : {3, 10})
      cases.add("arm's tool " + to_string(type) + " held " + std::to_string(times) + " times", [=] {
        Problem p = robot("arm", false);
        for (int k = 0; k < times; ++k) hold(p, type, "tool", {0, 0, 0}, k % 2 ? kWorldAxes : ReferenceFrame::kLocal);
        return p;
      });
  for (ContactType type : {k1D, k2D, k3D, k6D})
    cases.add("box tied to the arm twice " + to_string(type), [=] {
      Problem p = two_robots("arm", false, "box");
      tie(p, type, "a", "tool", "b", "face_back");
      tie(p, type, "a", "tool", "b", "face_back", {0, 0, 0}, kWorldAxes);
      return p;
    });
}

void add_corners(Cases& cases) {
  const Vec3<double> corners[] = {{0.1, 0.04, 0}, {0.1, -0.04, 0}, {-0.1, -0.04, 0}, {-0.1, 0.04, 0}};
  for (const Structure& s : {kHumanoid, kArm, kQuadruped})
    for (ContactType type : {k1D, k2D, k3D, k6D})
      for (ReferenceFrame axes : {ReferenceFrame::kLocal, kWorldAxes})
        cases.add(s.name + " " + to_string(type) + (axes == kWorldAxes ? " in the world's axes" : ""), [=] {
          Problem p = robot(s.urdf, s.floating);
          for (const std::string& frame : s.frames)
            for (const Vec3<double>& corner : corners) hold(p, type, frame, corner, axes);
          return p;
        });
  for (ContactType type : {k1D, k2D, k3D, k6D})
    cases.add(std::string("box's four corners and faces ") + to_string(type), [=] {
      Problem p = robot("box", true);
      for (const char* frame : {"bottom_1", "bottom_2", "bottom_3", "bottom_4", "face_top"}) hold(p, type, frame);
      return p;
    });
  cases.add("humanoid's soles of all types", [=] {
    Problem p = robot("humanoid", true);
    const ContactType types[] = {k1D, k2D, k3D, k6D};
    for (const std::string& frame : kHumanoid.frames)
      for (int k = 0; k < 4; ++k) hold(p, types[k], frame, corners[k]);
    return p;
  });
}

void add_loops(Cases& cases) {
  for (ContactType type : {k1D, k2D, k3D, k6D}) {
    for (int n : {1, 2, 3, 5, 20})
      cases.add("plane chain of " + std::to_string(n) + " closed " + to_string(type), [=] {
        Problem p = planar_chain(n);
        hold(p, type, "tip");
        return p;
      });
    cases.add(std::string("quadruped's fore feet held and tied ") + to_string(type), [=] {
      Problem p = robot("quadruped", true);
      hold(p, k3D, "LF_foot");
      hold(p, k3D, "RF_foot");
      tie(p, type, "r", "LF_foot", "r", "RF_foot");
      return p;
    });
    cases.add(std::string("quadruped's feet tied all round ") + to_string(type), [=] {
      Problem p = robot("quadruped", true);
      const auto& feet = kQuadruped.frames;
      for (int k = 0; k < 4; ++k) tie(p, type, "r", feet[k], "r", feet[(k + 1) % 4]);
      return p;
    });
    cases.add(std::string("two boxes tied at three places ") + to_string(type), [=] {
      Problem p = two_robots("box", true, "box");
      for (const char* frame : {"bottom_1", "bottom_2", "top_3"}) tie(p, type, "a", frame, "b", frame);
      return p;
    });
  }
  // Rows vanish, up to rounding error once the world is rotated.
  for (int n : {1, 3, 5, 20}) {
    const auto across = [=] {
      Problem p = planar_chain(n);
      hold(p, k1D, "tip").axis = Vec3<double>::UnitZ();
      return p;
    };
    const std::string name = "plane chain of " + std::to_string(n);
    cases.add(name + " held 1d across its plane", across);
    cases.add(name + " held 1d across its plane, turned", [=] { return turned(across()); });
    for (ContactType type : {k2D, k3D, k6D})
      cases.add(name + " closed " + to_string(type) + ", turned", [=] {
        Problem p = planar_chain(n);
        hold(p, type, "tip");
        return turned(p);
      });
  }
  cases.add("quadruped's feet held 3d, tied all round 6d, trunk held 6d", [=] {
    Problem p = robot("quadruped", true);
    const auto& feet = kQuadruped.frames;
    for (int k = 0; k < 4; ++k) hold(p, k3D, feet[k]), tie(p, k6D, "r", feet[k], "r", feet[(k + 1) % 4]);
    hold(p, k6D, "trunk");
    return p;
  });
  cases.add("humanoid's hands tied 6d and 3d, soles held 6d and tied 6d", [=] {
    Problem p = robot("humanoid", true);
    tie(p, k6D, "r", "left_hand", "r", "right_hand");
    tie(p, k3D, "r", "left_hand", "r", "right_hand", {0, 0.05, 0}, kWorldAxes);
    for (const std::string& frame : kHumanoid.frames) hold(p, k6D, frame);
    tie(p, k6D, "r", "left_sole", "r", "right_sole", {0.1, 0, 0});
    return p;
  });
  cases.add("arm and box tied 6d, both held 6d", [=] {
    Problem p = two_robots("arm", false, "box");
    tie(p, k6D, "a", "tool", "b", "face_back");
    hold(p, k6D, "tool", {0, 0, 0.1}, ReferenceFrame::kLocal, "a");
    hold(p, k6D, "bottom_1", {0, 0, 0}, kWorldAxes, "b");
    return p;
  });
  for (int n : {2, 4})
    for (ContactType type : {k3D, k6D})
      cases.add("chain of " + std::to_string(n) + " in space closed " + to_string(type), [=] {
        Problem p = chain(n, false);
        hold(p, type, "tip");
        for (int k = 0; k < n; ++k) p.u[k] = 1 + k;
        return p;
      });
}

}  // namespace manycontact::test
