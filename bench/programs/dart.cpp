// DART runs World::step with a time step of 1 ms. Contacts are weld and ball constraints between velocities, solved as
// a linear complementarity problem; dJ/dt v is omitted, and the time includes integration of positions.

#include <dart/constraint/BallJointConstraint.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/constraint/WeldJointConstraint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>

#include "bodies.hpp"
#include "program.hpp"

namespace manycontact::bench {

namespace {

constexpr double kStep = 1e-3;

Eigen::Isometry3d place(const SE3<double>& M) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = M.R;
  T.translation() = M.p;
  return T;
}

struct Step : Loaded {
  explicit Step(const Posed& scene) : s(scene), bodies(bodies_of(scene)) {
    world->setTimeStep(kStep);
    world->setGravity(s.scene.gravity);
    for (const Body& b : bodies) add(b);
    for (auto& skeleton : skeletons) {
      skeleton->disableSelfCollisionCheck();
      world->addSkeleton(skeleton);
    }
    for (const Hold& h : holds_of(s, bodies)) hold(h);
    for (std::size_t k = 0; k < bodies.size(); ++k) set_torque(k);
    for (auto& skeleton : skeletons) at_rest.push_back(Eigen::VectorXd::Zero(skeleton->getNumDofs()));
    for (auto& skeleton : skeletons) velocities.push_back(skeleton->getVelocities());
    Step::run();
  }

  void run() override {
    for (std::size_t r = 0; r < skeletons.size(); ++r) {
      skeletons[r]->setPositions(at_rest[r]);
      skeletons[r]->setVelocities(velocities[r]);
    }
    world->step(false);
  }

  Eigen::VectorXd accelerations() override {
    Eigen::VectorXd a(s.scene.nv);
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const Eigen::VectorXd v = nodes[k]->getParentJoint()->getVelocities();
      const int at = bodies[k].idx_v;
      if (bodies[k].type == JointType::kFloating)
        a.segment<6>(at) << v.tail<3>(), v.head<3>();
      else
        a[at] = v[0];
      a.segment(at, v.size()) -= s.v.segment(at, v.size());
    }
    return a / kStep;
  }

 private:
  void add(const Body& b) {
    using namespace dart::dynamics;
    if (b.parent < 0) skeletons.push_back(Skeleton::create("r" + std::to_string(skeletons.size())));
    BodyNode* parent = b.parent < 0 ? nullptr : nodes[b.parent];
    const std::string name = std::to_string(nodes.size());
    BodyNode::Properties body;
    body.mName = "b" + name;
    body.mInertia = dart::dynamics::Inertia(b.mass, b.com, b.inertia);
    if (b.type == JointType::kFloating) {
      FreeJoint::Properties joint;
      joint.mName = "j" + name;
      joint.mT_ParentBodyToJoint = place(b.in_parent);
      nodes.push_back(skeletons.back()->createJointAndBodyNodePair<FreeJoint>(parent, joint, body).second);
    } else {
      RevoluteJoint::Properties joint;
      joint.mName = "j" + name;
      joint.mT_ParentBodyToJoint = place(b.in_parent);
      joint.mAxis = b.axis;
      nodes.push_back(skeletons.back()->createJointAndBodyNodePair<RevoluteJoint>(parent, joint, body).second);
    }
    Eigen::VectorXd v = s.v.segment(b.idx_v, b.type == JointType::kFloating ? 6 : 1);
    if (v.size() == 6) v << s.v.segment<3>(b.idx_v + 3), s.v.segment<3>(b.idx_v);  // DART: angular first
    nodes.back()->getParentJoint()->setVelocities(v);
  }

  void hold(const Hold& h) {
    using namespace dart::constraint;
    ConstraintBasePtr c;
    if (h.point && h.b < 0)
      c = std::make_shared<BallJointConstraint>(nodes[h.a], h.in_b.p);
    else if (h.point)
      c = std::make_shared<BallJointConstraint>(nodes[h.a], nodes[h.b], (bodies[h.a].in_world * h.in_a).p);
    else if (h.b < 0)
      c = std::make_shared<WeldJointConstraint>(nodes[h.a]);
    else
      c = std::make_shared<WeldJointConstraint>(nodes[h.a], nodes[h.b]);
    world->getConstraintSolver()->addConstraint(c);
  }

  void set_torque(std::size_t k) {
    if (bodies[k].idx_u >= 0) nodes[k]->getParentJoint()->setForce(0, s.u[bodies[k].idx_u]);
  }

  const Posed& s;
  std::vector<Body> bodies;
  dart::simulation::WorldPtr world = dart::simulation::World::create();
  std::vector<dart::dynamics::SkeletonPtr> skeletons;  // one per robot
  std::vector<dart::dynamics::BodyNode*> nodes;
  std::vector<Eigen::VectorXd> at_rest, velocities;
};

std::unique_ptr<Loaded> load(const Posed& s, const std::string&) { return std::make_unique<Step>(s); }

std::string refuses(const Posed& s, const std::string&) { return strange(s); }

}  // namespace

const Program& program() {
  static const Program p{"DART", DART_VERSION, {"step"}, {}, refuses, load};
  return p;
}

}  // namespace manycontact::bench
