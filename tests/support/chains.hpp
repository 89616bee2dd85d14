#pragma once

#include <cmath>
#include <random>
#include <string>

#include "manycontact/model/scene.hpp"

namespace manycontact::test {

struct ChainOptions {
  int links = 1000;
  int held_every = 10;  // the last of so many links is fixed to the world; 0: none is
  ContactType type = ContactType::k6D;
  bool floating_base = false;
  int loop_every = 0;   // a link is attached to the one so many links before it; 0: no loops
  double extent = 0.2;  // scale of angles: smaller values make the chain reach further
};

struct Chain {
  Scene scene;
  Eigen::VectorXd q, v, u;
};

/// Returns links of 0.3 m and 1 kg on revolute joints about x, y, z in turn, in an asymmetric configuration and motion.
inline Chain make_chain(const ChainOptions& options) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> noise(-1, 1);
  Model model;
  model.name = "chain";
  model.floating_base = options.floating_base;
  for (int i = 0; i < options.links; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = i - 1;
    joint.axis = Vec3<double>::Unit(i % 3);
    if (i > 0) joint.placement.p = Vec3<double>(0.3, 0.02, 0);
    if (i == 0 && options.floating_base) joint.type = JointType::kFloating;
    const Vec3<double> com(0.15, 0.01 * noise(rng), 0.01 * noise(rng));
    joint.inertia = Inertia<double>::from_com(1 + 0.2 * noise(rng), com, Vec3<double>(0.002, 0.01, 0.011).asDiagonal());
    const int nv = joint.nv();
    for (Eigen::VectorXd* limit : {&joint.lower, &joint.upper, &joint.velocity_limit, &joint.effort_limit})
      limit->setConstant(nv, INFINITY);
    model.joints.push_back(std::move(joint));
  }
  finalize(model);
  Chain out;
  add_robot(out.scene, "chain", std::make_shared<const Model>(std::move(model)));
  const auto contact = [&](int a, int b) {
    Contact c;
    c.name = "hold" + std::to_string(out.scene.contacts.size());
    c.type = options.type;
    c.A.robot = 0;
    c.A.joint = a;
    c.A.placement.p = Vec3<double>(0.25, 0.03, 0.01);
    c.beta = 5;
    if (b >= 0) {
      c.B.robot = 0;
      c.B.joint = b;
    }
    add_contact(out.scene, c);
  };
  for (int i = options.held_every; options.held_every > 0 && i <= options.links; i += options.held_every)
    contact(i - 1, -1);
  for (int i = options.loop_every; options.loop_every > 0 && i < options.links; i += options.loop_every)
    contact(i, i - options.loop_every);
  const auto random = [&](int n, double size) {
    return Eigen::VectorXd::NullaryExpr(n, [&] { return size * noise(rng); }).eval();
  };
  out.q = random(out.scene.nq, options.extent);
  for (int i = 0; i < out.scene.nq; ++i) out.q[i] += options.extent * std::sin(0.7 * i);
  if (options.floating_base) out.q.head<7>() << 0.1, 0.2, 0.3, 0, 0, 0, 1;
  out.v = random(out.scene.nv, 0.1);
  out.u = random(out.scene.nu, 1);
  return out;
}

}  // namespace manycontact::test
