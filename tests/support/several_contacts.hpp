#pragma once
// Random scenes in which several contacts join the same two bodies, so that rows depend on each other.

#include "manycontact/detail/contact/reference.hpp"
#include "support/piles.hpp"
#include "support/random.hpp"

namespace manycontact::test {

inline int integer(std::mt19937& rng, int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); }

/// Returns up to four boxes on each other at several points, at least one on the ground, some with wrenches or springs.
inline RandomScene random_boxes(std::mt19937& rng) {
  PileMaker make;
  const int boxes = integer(rng, 1, 4);
  for (int k = 0; k < boxes; ++k) make.box(0, 0, k);
  for (int k = 0; k < boxes; ++k) {
    const bool joined = k > 0 && chance(rng, 0.8);
    for (int points = integer(rng, 1, 4); points > 0; --points) {
      const ContactType types[] = {ContactType::k3D, ContactType::k3D, ContactType::k3D,
                                   ContactType::k1D, ContactType::k2D, ContactType::k6D};
      make.join(types[integer(rng, 0, 5)], k, joined ? k - 1 : -1,
                {uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5), k - 0.5});
    }
  }
  RandomScene s = make.finish(0.3);
  if (chance(rng, 0.3)) s.v.setZero();
  for (Contact& c : s.scene.contacts)
    if (chance(rng, 0.7)) c.alpha = uniform(rng, 0, 100), c.beta = uniform(rng, 0, 20);
  const Attachment corner{0, 0, random_placement(rng, 0.3)};
  if (chance(rng, 0.3)) s.scene.wrenches.push_back({"push", corner, ReferenceFrame::kLocal, Vec6<double>::Constant(3)});
  if (chance(rng, 0.3))
    s.scene.springs.push_back({"spring", corner, {boxes - 1, 0, random_placement(rng, 0.4)}, 50, 0.1, 1});
  return s;
}

/// Returns up to three trees of hinges, at rest, with two to eight closed contacts, to the world or between few links.
inline RandomScene random_hinges(std::mt19937& rng) {
  RandomScene s;
  const int robots = integer(rng, 1, 3);
  for (int r = 0; r < robots; ++r) {
    ModelOptions options;
    options.types = {JointType::kRevolute};
    options.njoints = integer(rng, 1, 6);
    options.floating_base = chance(rng, 0.3);
    const auto model = std::make_shared<const Model>(random_model(rng, options));
    add_robot(s.scene, "r" + std::to_string(r), model, random_placement(rng));
    s.q.conservativeResize(s.scene.nq);
    s.q.tail(model->nq) = random_configuration(*model, rng);
  }
  s.v.setZero(s.scene.nv), s.u = random_vector(s.scene.nu, rng, 5);
  const auto link = [&] {
    const int r = integer(rng, 0, robots - 1);
    return Attachment{r, integer(rng, 0, s.scene.robots[r].model->njoints() - 1), random_placement(rng, 0.3)};
  };
  for (int count = integer(rng, 2, 8); count > 0; --count) {
    Contact c;
    c.name = "contact" + std::to_string(s.scene.contacts.size());
    const ContactType types[] = {ContactType::k1D, ContactType::k2D, ContactType::k3D, ContactType::k5D,
                                 ContactType::k6D};
    c.type = types[integer(rng, 0, 4)];
    c.axis = random_vector(3, rng).normalized();
    c.A = link();
    if (chance(rng, 0.3)) c.B = link();
    if (!s.scene.contacts.empty() && chance(rng, 0.5)) {
      const Contact& before = s.scene.contacts.back();
      c.A.robot = before.A.robot, c.A.joint = before.A.joint;
      c.B.robot = before.B.robot, c.B.joint = before.B.joint;
    }
    if (c.A.robot == c.B.robot && c.A.joint == c.B.joint) continue;
    resolve_reference(s.scene, s.q, true, true, c);
    add_contact(s.scene, c);
  }
  return s;
}

}  // namespace manycontact::test
