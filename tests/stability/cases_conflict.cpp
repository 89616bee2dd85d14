// Contacts request different accelerations: by gains on different errors, by gains on the velocity, by rotation.

#include "stability/cases.hpp"

namespace manycontact::test {

namespace {

using enum ContactType;

Problem feet_held_twice(ContactType first, ContactType second, double apart) {
  Problem p = robot("quadruped", true);
  for (const char* foot : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"}) {
    hold(p, first, foot);
    hold(p, second, foot, {0, apart, 0}, ReferenceFrame::kWorld);
  }
  return p;
}

// Moves the reference of every second contact by `off` metres.
void pull_apart(Problem& p, double off) {
  for (std::size_t c = 1; c < p.scene.contacts.size(); c += 2) {
    p.scene.contacts[c].B.placement.p += Vec3<double>(off, 2 * off, -off);
    p.scene.contacts[c].alpha = 100;
  }
}

}  // namespace

void add_conflicts(Cases& cases) {
  const std::pair<ContactType, ContactType> pairs[] = {{k1D, k1D}, {k2D, k2D}, {k3D, k3D}, {k6D, k6D}, {k6D, k3D}};
  for (const auto& [first, second] : pairs) {
    const std::string types = to_string(first) + "+" + to_string(second);
    for (double apart : {0.0, 1e-2})
      for (double off : {1e-1, 1e-4})
        cases.add("quadruped's feet " + types + ", " + power(apart) + " m apart, pulled " + power(off) + " m apart",
                  [=, first = first, second = second] {
                    Problem p = feet_held_twice(first, second, apart);
                    pull_apart(p, off);
                    return p;
                  });
    cases.add("quadruped's feet " + types + ", one braked, one not", [=, first = first, second = second] {
      Problem p = feet_held_twice(first, second, 0);
      move(p);
      for (std::size_t c = 1; c < p.scene.contacts.size(); c += 2) p.scene.contacts[c].beta = 20;
      return p;
    });
    cases.add("quadruped's feet " + types + ", 1e-02 m apart, turning", [=, first = first, second = second] {
      Problem p = feet_held_twice(first, second, 1e-2);
      move(p, 1);
      return p;
    });
  }
  for (ContactType type : {k3D, k6D}) {
    cases.add(std::string("arm's tool pulled two ways ") + to_string(type), [=] {
      Problem p = robot("arm", false);
      hold(p, type, "tool");
      hold(p, type, "tool");
      pull_apart(p, 0.2);
      return p;
    });
    cases.add(std::string("box pulled off four corners ") + to_string(type), [=] {
      Problem p = robot("box", true);
      for (const char* frame : {"bottom_1", "bottom_2", "bottom_3", "bottom_4"}) hold(p, type, frame);
      pull_apart(p, 0.2);
      return p;
    });
    cases.add(std::string("two boxes tied and pulled ") + to_string(type), [=] {
      Problem p = two_robots("box", true, "box");
      for (const char* frame : {"bottom_1", "bottom_2", "top_3", "top_4"}) tie(p, type, "a", frame, "b", frame);
      pull_apart(p, 0.2);
      return p;
    });
    cases.add(std::string("plane chain pulled out of its plane ") + to_string(type), [=] {
      Problem p = planar_chain(3);
      hold(p, type, "tip");
      p.scene.contacts[0].B.placement.p.z() += 0.1;
      p.scene.contacts[0].alpha = 100;
      return p;
    });
  }
}

}  // namespace manycontact::test
