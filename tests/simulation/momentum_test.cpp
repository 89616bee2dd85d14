// Bodies without contacts to the world keep their momentum, for any tree and any speed of rotation.

#include "manycontact/detail/simulation/momentum.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/detail/algorithm/energy.hpp"
#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

const Integrator kEuler = Integrator::kSemiImplicitEuler;

// Returns one free body with its centre of mass at c in its own axes.
Model body(const Vec3<double>& c, JointType type = JointType::kFloating) {
  Model model;
  Joint root;
  root.name = "root";
  root.type = type;
  root.inertia = Inertia<double>::from_com(1, c, Vec3<double>(3, 5, 7).asDiagonal());
  const int nv = joint_nv(type);
  root.lower = root.upper = root.velocity_limit = root.effort_limit = Eigen::VectorXd::Zero(nv);
  root.actuated = false;
  model.joints = {root};
  model.floating_base = type == JointType::kFloating;
  finalize(model);
  return model;
}

RandomScene alone(const Model& model, const Eigen::VectorXd& v, const SE3<double>& base = {}) {
  RandomScene s;
  s.scene.gravity.setZero();
  add_robot(s.scene, "body", std::make_shared<const Model>(model), base);
  s.q = neutral(model);
  s.v = v;
  s.u.setZero(s.scene.nu);
  return s;
}

double linear_error(const RandomScene& s, const SimulationData& sim) {
  return error_of(Vec3<double>(end_of(s, sim).momentum.head<3>()), Vec3<double>(start_of(s).momentum.head<3>()));
}
double angular_error(const RandomScene& s, const SimulationData& sim) {
  return error_of(Vec3<double>(end_of(s, sim).momentum.tail<3>()), Vec3<double>(start_of(s).momentum.tail<3>()));
}

// This is ../shared/reports/momentum/spin.xml, with 10 rad/s for 10 s in steps of 1 ms.
TEST(Momentum, OfASpinningBody) {
  for (const Vec3<double>& c : {Vec3<double>(0, 0, 0), Vec3<double>(0.2, -0.1, 0.3)}) {
    RandomScene s = alone(body(c), (Eigen::VectorXd(6) << 0, 1, 0, 10, 0, 0).finished());
    const SimulationData sim = simulated(s, kEuler, 10, 10000);
    EXPECT_LE(linear_error(s, sim), 1e-12);
    EXPECT_LE(angular_error(s, sim), 1e-11);  // about the origin, 10 m away at the end
    // the centre of mass flies straight on
    const Vec3<double> P = start_of(s).momentum.head<3>(), at = placement_of_pose(sim.q).p;
    const Mat3<double> R = placement_of_pose(sim.q).R;
    EXPECT_LE(difference_of(Vec3<double>(at + R * c), Vec3<double>(c + 10 * P)), 1e-10);
  }
}

TEST(Momentum, OfTheReport) {
  const std::string path = std::string(MANYCONTACT_SHARED_DIR) + "/reports/momentum/spin.xml";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const RandomScene s = of_file(load_scene(path));
  const SimulationData sim = simulated(s, kEuler, 10, 10000);
  EXPECT_LE(linear_error(s, sim), 1e-12);
  EXPECT_LE(angular_error(s, sim), 1e-12);
}

// A body tumbles about no principal axis: energy then has the integrator's order of error, momentum has none.
TEST(Momentum, OfATumblingBody) {
  RandomScene s = alone(body({0.1, 0.2, 0}), (Eigen::VectorXd(6) << 1, 1, -2, 4, 5, 6).finished());
  const auto energy_error = [&](int steps) {
    const SimulationData sim = simulated(s, kEuler, 1, steps);
    EXPECT_LE(linear_error(s, sim), 1e-12);
    EXPECT_LE(angular_error(s, sim), 1e-12);
    return std::abs(end_of(s, sim).kinetic - start_of(s).kinetic) / start_of(s).kinetic;
  };
  const double coarse = energy_error(1000), fine = energy_error(2000);
  EXPECT_NEAR(std::log2(coarse / fine), 1, 0.2);
  EXPECT_LE(fine, 1e-2);
}

// A planar joint's v rotates with its angle; the plane may have any orientation.
TEST(Momentum, OfAPlanarJoint) {
  std::mt19937 rng(3);
  for (const Vec3<double>& c : {Vec3<double>(0, 0, 0), Vec3<double>(0.3, -0.2, 0.1)})
    for (const SE3<double>& base : {SE3<double>(), random_placement(rng)}) {
      RandomScene s = alone(body(c, JointType::kPlanar), Vec3<double>(1, 0.5, 10), base);
      const SimulationData sim = simulated(s, kEuler, 10, 10000);
      EXPECT_LE(linear_error(s, sim), 1e-12);
      const Vec3<double> n = base.R.col(2);
      EXPECT_NEAR(n.dot(end_of(s, sim).momentum.tail<3>()), n.dot(start_of(s).momentum.tail<3>()), 1e-9);  // size: 71
    }
}

// Motors push it along: P = F t in the joint's moving axes, here without rotation.
TEST(Momentum, OfAPlanarJointWithMotors) {
  Model model = body({0.3, 0.2, 0}, JointType::kPlanar);
  model.joints[0].actuated = true;
  finalize(model);
  RandomScene s = alone(model, Vec3<double>::Zero());
  s.u = Vec3<double>(2, 1, 0.5 * 0 + (0.3 * 1 - 0.2 * 2));  // through the centre of mass
  const SimulationData sim = simulated(s, kEuler, 1, 1000);
  const Vec6<double> h = end_of(s, sim).momentum;
  EXPECT_NEAR(h[0], 2, 1e-10);
  EXPECT_NEAR(h[1], 1, 1e-10);
  EXPECT_NEAR(sim.v[2], 0, 1e-10);
  s.u[2] += 0.7;  // with a moment in addition: I_zz = 7
  EXPECT_NEAR(simulated(s, kEuler, 1, 1000).v[2], 0.1, 1e-10);
}

// Trees have every joint, floating and planar ones inside, and motors: inner forces cancel.
TEST(Momentum, OfTrees) {
  for (bool passive : {false, true})
    for (int seed : {21, 22, 23, 24, 25, 26}) {
      SCOPED_TRACE(seed);
      std::mt19937 rng(seed);
      ModelOptions model;
      model.njoints = 8;
      model.floating_base = true;
      model.types = {JointType::kRevolute, JointType::kPrismatic, JointType::kPlanar, JointType::kFloating};
      model.passive = passive ? 1 : 0;
      model.armature = 0.1;
      SceneOptions options;
      options.nrobots = 1;
      options.models = {model};
      options.ncontacts = 0;
      RandomScene s = random_scene(rng, options);
      s.scene.gravity.setZero();
      s.u *= 0.1;
      const SimulationData sim = simulated(s, kEuler, 0.5, 500);
      EXPECT_LE(linear_error(s, sim), 1e-11);
      EXPECT_LE(angular_error(s, sim), 1e-11);
    }
}

// A passive floating joint is on a moving body: the body beyond it flies alone and does not affect its carrier.
TEST(Momentum, OfAFloatingJointInsideATree) {
  Model model = body({0.1, 0, 0.2});
  Joint inner = model.joints[0], turning = inner;
  turning.name = "arm";
  turning.type = JointType::kRevolute;
  turning.lower = turning.upper = turning.velocity_limit = turning.effort_limit = Eigen::VectorXd::Zero(1);
  turning.parent = 0;
  turning.placement.p = {0.5, 0, 0};
  inner.name = "inner";
  inner.parent = 1;
  inner.placement.p = {0, 0.3, 0.1};
  for (bool floating_base : {true, false}) {
    SCOPED_TRACE(floating_base);
    Model tree = model;
    if (floating_base) {
      tree.joints = {model.joints[0], turning, inner};
    } else {
      turning.parent = -1;
      inner.parent = 0;
      tree.joints = {turning, inner};
      tree.floating_base = false;
    }
    tree.armature.resize(0);
    finalize(tree);
    std::mt19937 rng(4);
    RandomScene s = alone(tree, 3 * random_vector(tree.nv, rng));
    SimulationData sim(s.scene, s.q, s.v, kEuler, 1e-3);
    const auto inner_momentum = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
      Kinematics<double> kin(tree);
      forward_kinematics<double>(tree, SE3<double>(), q, kin);
      forward_accelerations<double>(tree, v, nullptr, Vec3<double>::Zero(), kin);
      Vec6<double> h = kin.Y.back() * kin.v.back();
      h.tail<3>() += kin.origin(tree.njoints() - 1).cross(Vec3<double>(h.head<3>()));
      return h;
    };
    const Vec6<double> start = inner_momentum(s.q, s.v);
    for (int k = 0; k < 1000; ++k) ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    EXPECT_LE(error_of(inner_momentum(sim.q, sim.v), start), 1e-11);
    if (floating_base) {
      EXPECT_LE(linear_error(s, sim), 1e-11);
      EXPECT_LE(angular_error(s, sim), 1e-11);
    }
    EXPECT_GT(difference_of(sim.q, s.q), 0.1);
  }
}

// Robots are attached to each other alone; the constraint violation of their contact keeps its order.
TEST(Momentum, OfRobotsThatHoldEachOther) {
  for (int seed : {41, 42, 43}) {
    RandomScene s = tied_scene(seed);
    s.scene.gravity.setZero();
    s.scene.contacts[1].active = false;
    const SimulationData sim = simulated(s, kEuler, 0.5, 1000);
    EXPECT_LE(linear_error(s, sim), 1e-11);
    EXPECT_LE(angular_error(s, sim), 1e-11);
    const auto drift = [&](int steps) {
      const SimulationData after = simulated(s, kEuler, 0.5, steps);
      InvariantsData room(s.scene);
      return invariants(s.scene, after.dynamics.active, after.q, after.v, room).violation_position;
    };
    EXPECT_NEAR(std::log2(drift(500) / drift(1000)), 1, 0.3);
  }
}

// Galilei: a motion does not depend on the speed of the whole.
void expect_the_same_when_thrown(RandomScene s, double h, int steps) {
  s.scene.gravity.setZero();
  const SimulationData at_rest = simulated(s, kEuler, steps * h, steps);
  const Vec3<double> V(30, -70, 60);
  RandomScene thrown = s;
  for (const Robot& robot : s.scene.robots)
    thrown.v.segment<3>(robot.idx_v) += placement_of_pose(s.q.segment<7>(robot.idx_q)).R.transpose() * V;
  const SimulationData moved = simulated(thrown, kEuler, steps * h, steps);
  VectorXd q = moved.q, v = moved.v;
  for (const Robot& robot : s.scene.robots) {
    q.segment<3>(robot.idx_q) -= steps * h * V;
    v.segment<3>(robot.idx_v) -= placement_of_pose(moved.q.segment<7>(robot.idx_q)).R.transpose() * V;
  }
  EXPECT_LE(difference_of(q, at_rest.q), 1e-10);
  EXPECT_LE(difference_of(v, at_rest.v), 1e-9);
}

TEST(Momentum, ThrownRobotsMoveAsAtRest) {
  for (int seed : {41, 42, 43}) {
    SCOPED_TRACE(seed);
    RandomScene s = tied_scene(seed);
    s.scene.contacts[1].active = false;
    for (Robot& robot : s.scene.robots) {  // rotors of a base would turn against the world
      Model model = *robot.model;
      model.armature.head<6>().setZero();
      robot.model = std::make_shared<const Model>(model);
    }
    expect_the_same_when_thrown(s, 1e-3, 50);
    for (const double stiffness : {100.0, 1e7}) {
      SCOPED_TRACE(stiffness);
      RandomScene on_springs = s;
      on_springs.scene.contacts[0].active = false;
      Spring spring{"spring", {0, 4, {}}, {1, 3, {Mat3<double>::Identity(), {0.2, 0.1, 0}}}, stiffness, 0, 1};
      spring.length = 0.9 * spring_length(on_springs.scene, on_springs.q, spring);  // far from it, errors grow
      add_spring(on_springs.scene, spring);
      expect_the_same_when_thrown(on_springs, 1e-3, 50);
    }
    expect_the_same_when_thrown(free_scene(seed), 1e-3, 50);
  }
}

// In a herd in free fall each robot's P gains exactly m g t.
TEST(Momentum, OfAHerdInFreeFall) {
  RandomScene s =
      of_file(load_text("<scene><robot name=\"h\" urdf=\"quadruped.urdf\" base=\"floating\" copies=\"5\" "
                        "arrange=\"line\" spacing=\"100\"/>"
                        "</scene>"));
  std::mt19937 rng(5);
  s.v = 2 * random_vector(s.scene.nv, rng);
  SimulationData sim(s.scene, s.q, s.v, kEuler, 1e-3);
  for (int k = 0; k < 300; ++k) ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  for (const Robot& robot : s.scene.robots) {
    const auto momentum_at = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
      Kinematics<double> kin(*robot.model);
      forward_kinematics<double>(*robot.model, robot.base, q.segment(robot.idx_q, robot.model->nq), kin);
      forward_accelerations<double>(*robot.model, v.segment(robot.idx_v, robot.model->nv), nullptr,
                                    Vec3<double>::Zero(), kin);
      return momentum<double>(kin);
    };
    const Vec3<double> gained = (momentum_at(sim.q, sim.v) - momentum_at(s.q, s.v)).head<3>();
    EXPECT_LE(error_of(gained, Vec3<double>(0.3 * robot.model->mass() * s.scene.gravity)), 1e-11);
  }
}

// A box on three 1D contacts with the ground slides and spins in the plane at constant height.
TEST(Momentum, OfWhatSlidesOnAPlane) {
  const std::string contact = "<contact type=\"1d\" frame=\"b/crate\" axis=\"0 0 1\" reference_frame=\"world\" name=";
  RandomScene s =
      of_file(load_text("<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>1 0.5 0 0 0 10</v>"
                        "</robot>" +
                        contact + "\"x\" offset=\"0.3 0 0\"/>" + contact + "\"y\" offset=\"-0.3 0.2 0\"/>" + contact +
                        "\"z\" offset=\"0 -0.2 0\"/></scene>"));
  const SimulationData sim = simulated(s, kEuler, 10, 10000);
  EXPECT_LE(linear_error(s, sim), 1e-11);
  EXPECT_NEAR(end_of(s, sim).momentum[5], start_of(s).momentum[5], 1e-9);
  EXPECT_LE(end_of(s, sim).violation_position, 1e-10);
}

// Groups with a contact to the world are not moved: the bits are those of a scene without moved groups.
TEST(Momentum, GroupsAreFoundAsContactsTie) {
  RandomScene s = tied_scene(44);
  FreeGroups groups(s.scene);
  std::vector<Kinematics<double>> kin;
  for (const Robot& robot : s.scene.robots) {
    kin.emplace_back(*robot.model);
    forward_kinematics<double>(*robot.model, robot.base, s.q.segment(robot.idx_q, robot.model->nq), kin.back());
    forward_accelerations<double>(*robot.model, s.v.segment(robot.idx_v, robot.model->nv), nullptr,
                                  Vec3<double>::Zero(), kin.back());
  }
  const auto tied = [&](const std::vector<char>& active) {
    begin_free_motion(s.scene, active, Eigen::VectorXd::Zero(s.scene.nv), 1e-3, kin, groups);
    std::string out;
    for (const FreeGroups::FreeJoint& j : groups.joints)
      if (j.parent == 0)
        out += groups.groups[static_cast<std::size_t>(groups.group[static_cast<std::size_t>(j.node)])].tied ? "t" : "f";
    return out + (groups.any ? "!" : "");
  };
  EXPECT_EQ(tied({0, 0}), "ff!");
  EXPECT_EQ(tied({1, 0}), "ff!");  // tied to each other
  EXPECT_EQ(tied({0, 1}), "ft!");  // the second is tied to the world
  EXPECT_EQ(tied({1, 1}), "tt");
}

}  // namespace
}  // namespace manycontact::test
