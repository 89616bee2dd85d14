// With another link of a URDF as the root the robot is the same, joint by joint, at the corresponding state.

#include <gtest/gtest.h>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/contact/jacobian.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/io/input_error.hpp"
#include "manycontact/io/urdf.hpp"
#include "support/folder.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

std::string link(const std::string& name, double mass) {
  return "<link name='" + name + "'><inertial><origin xyz='0.1 -0.05 0.02' rpy='0.3 0.1 -0.2'/><mass value='" +
         std::to_string(mass) + "'/><inertia ixx='0.1' ixy='0.01' ixz='0.02' iyy='0.12' iyz='0.03' izz='0.15'/>" +
         "</inertial></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& axis) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='0.2 0.1 -0.3' rpy='0.4 -0.5 0.6'/><axis xyz='" + axis +
         "'/><limit lower='-1' upper='2' velocity='3' effort='4'/></joint>";
}

// trunk -z_neck- head; trunk -m_arm- upper =a_fixed= elbow -k_slide- lower -b_wrist- hand -locked- finger, hand
// -c_thumb- thumb; a ball hangs on the trunk and stays on its side of every root that is tested.
const std::string kRobot =
    "<robot name='r'>" + link("trunk", 5) + link("head", 1) + link("upper", 2) + link("elbow", 0.5) +
    link("lower", 1.5) + link("hand", 0.7) + link("finger", 0.2) + link("thumb", 0.3) + link("ball", 0.4) +
    joint("z_neck", "revolute", "trunk", "head", "0 0 1") + joint("m_arm", "revolute", "trunk", "upper", "1 2 -1") +
    joint("a_fixed", "fixed", "upper", "elbow", "1 0 0") + joint("k_slide", "prismatic", "elbow", "lower", "0 -1 1") +
    joint("b_wrist", "continuous", "lower", "hand", "0 1 0") + joint("locked", "revolute", "hand", "finger", "1 0 0") +
    joint("c_thumb", "revolute", "hand", "thumb", "0 0 -1") + joint("y_ball", "floating", "trunk", "ball", "1 0 0") +
    "</robot>";
const char* const kRoots[] = {"trunk", "head", "upper", "elbow", "lower", "hand", "finger", "thumb"};

std::shared_ptr<const Model> robot(const std::string& root, bool floating) {
  const TemporaryFolder folder;
  UrdfOptions options{.floating_base = floating, .armature = 0.1, .locked = {{"locked", 0.7}}};
  options.joint_armature["k_slide"] = {0.3};
  options.joint_damping["b_wrist"] = 0.4;
  options.root = root;
  return std::make_shared<const Model>(load_urdf(folder.write("r.urdf", kRobot), options));
}

// Returns the robot with a hand and the trunk constrained, and the head tied to the finger.
Scene scene_of(const std::string& root, bool floating, std::mt19937 rng) {
  Scene scene;
  add_robot(scene, "r", robot(root, floating));
  const auto hold = [&](const char* frame, ContactType type, const Attachment& B) {
    Contact contact{frame, type, ReferenceFrame::kLocal, attach(scene, "r", frame, random_placement(rng)), B};
    contact.alpha = 3, contact.beta = 2;
    add_contact(scene, contact);
  };
  hold("hand", ContactType::k3D, {-1, -1, random_placement(rng)});
  hold("trunk", ContactType::k1D, {-1, -1, random_placement(rng)});
  hold("head", ContactType::k1D, attach(scene, "r", "finger", random_placement(rng)));
  add_joint_spring(scene, "r", "k_slide", 20, 0.3);
  return scene;
}

// Copies the entries of x, in the coordinates of `from`, to joints of the same name in y, in those of `to`.
template <class First, class Count>
void copy_joints(const Model& from, const VectorXd& x, const Model& to, VectorXd& y, First first, Count count) {
  for (const Joint& joint : to.joints)
    if (joint.name != "root")
      y.segment(joint.*first, (joint.*count)()) =
          x.segment(from.joints[from.find_joint(joint.name)].*first, (joint.*count)());
}

TEST(Root, IsTheSameRobotOnAFloatingBase) {
  std::mt19937 rng(1);
  const Scene filed = scene_of("", true, rng);
  const Model& file = *filed.robots[0].model;
  for (int k = 0; k < 3; ++k)
    for (const char* root : kRoots) {
      SCOPED_TRACE(root);
      VectorXd q = neutral(filed), v = random_vector(filed.nv, rng);
      q = integrate(filed, q, random_vector(filed.nv, rng));
      RigidBodyData at(filed);
      forward_kinematics(filed, q, v, at);

      const Scene scene = scene_of(root, true, std::mt19937(1));
      const Model& model = *scene.robots[0].model;
      ASSERT_EQ(model.njoints(), file.njoints());
      EXPECT_EQ(model.frames[0].name, root);
      VectorXd q2(scene.nq), v2(scene.nv);
      const Attachment base = attach(filed, "r", root);
      q2.head<7>() = pose_of_placement(frame_placement(filed, at, base));
      v2.head<6>() = frame_velocity(filed, at, base);
      copy_joints(file, q, model, q2, &Joint::idx_q, &Joint::nq);
      copy_joints(file, v, model, v2, &Joint::idx_v, &Joint::nv);
      for (const Joint& joint : model.joints) {
        const Joint& twin = file.joints[file.find_joint(joint.name)];
        EXPECT_EQ(joint.lower, twin.lower);
        EXPECT_EQ(joint.upper, twin.upper);
        EXPECT_EQ(joint.effort_limit, twin.effort_limit);
        EXPECT_EQ(joint.actuated, twin.actuated);
      }
      VectorXd tau = VectorXd::Zero(scene.nv), tau2 = tau;
      for (int i : file.actuated) tau[i] = uniform(rng, -5, 5);
      copy_joints(file, tau, model, tau2, &Joint::idx_v, &Joint::nv);

      SceneData data(filed), data2(scene);
      ASSERT_EQ(solve_tau(filed, q, v, tau, data).status, Status::kOk);
      ASSERT_EQ(solve_tau(scene, q2, v2, tau2, data2).status, Status::kOk);
      EXPECT_LT((data2.f - data.f).norm(), 1e-10 * data.f.norm());
      VectorXd a2 = data2.a;
      copy_joints(file, data.a, model, a2, &Joint::idx_v, &Joint::nv);
      EXPECT_LT((data2.a - a2).norm(), 1e-10 * a2.norm());
      RigidBodyData carried(filed), carried2(scene);
      (void)rnea(filed, q, v, data.a, carried, forces_on_bodies(filed, q, v, data.f, data.f_offset));
      (void)rnea(scene, q2, v2, data2.a, carried2, forces_on_bodies(scene, q2, v2, data2.f, data2.f_offset));
      for (const std::string& name : joint_names(filed)) {
        if (name == "root") continue;
        const Vec6<double> wrench = joint_wrench(filed, carried, find_joint(filed, name));
        EXPECT_LT((joint_wrench(scene, carried2, find_joint(scene, name)) - wrench).norm(), 1e-9 * wrench.norm());
      }
      RigidBodyData at2(scene);
      forward_kinematics(filed, q, v, data.a, at);
      forward_kinematics(scene, q2, v2, data2.a, at2);
      for (const Frame& frame : file.frames) {
        const Attachment one = attach(filed, "r", frame.name), two = attach(scene, "r", frame.name);
        const SE3<double> error = frame_placement(filed, at, one).inverse() * frame_placement(scene, at2, two);
        EXPECT_LT((error.R - Mat3<double>::Identity()).norm() + error.p.norm(), 1e-13) << frame.name;
        const Vec6<double> moves = frame_velocity(filed, at, one), speeds_up = frame_acceleration(filed, at, one);
        EXPECT_LT((frame_velocity(scene, at2, two) - moves).norm(), 1e-13 * moves.norm()) << frame.name;
        EXPECT_LT((frame_acceleration(scene, at2, two) - speeds_up).norm(), 1e-10 * speeds_up.norm()) << frame.name;
      }
      EXPECT_NEAR(kinetic_energy(scene, at2), kinetic_energy(filed, at), 1e-12 * kinetic_energy(filed, at));
      EXPECT_NEAR(potential_energy(scene, at2), potential_energy(filed, at), 1e-11);
    }
}

// On a fixed base the root is fixed to the world: it agrees with a floating robot that is fixed there.
TEST(Root, OfAFixedBaseStandsInTheWorld) {
  for (const char* root : {"head", "hand", "finger"}) {
    SCOPED_TRACE(root);
    std::mt19937 rng(2);
    Scene held, fixed;
    add_robot(held, "r", robot("", true));
    add_contact(held, {.name = "root", .type = ContactType::k6D, .A = attach(held, "r", root)});
    VectorXd q = neutral(held);
    q = integrate(held, q, random_vector(held.nv, rng));
    resolve_references(held, q);
    const Model& file = *held.robots[0].model;
    RigidBodyData at(held);
    forward_kinematics(held, q, at);
    const auto model = robot(root, false);
    add_robot(fixed, "r", model, frame_placement(held, at, attach(held, "r", root)));
    EXPECT_EQ(attach(fixed, "r", root).joint, -1);
    ASSERT_EQ(fixed.nv, held.nv - 6);
    VectorXd q2(fixed.nq);
    copy_joints(file, q, *model, q2, &Joint::idx_q, &Joint::nq);
    SceneData data(held), data2(fixed);
    ASSERT_EQ(solve(held, q, VectorXd::Zero(held.nv), VectorXd::Zero(held.nu), data).status, Status::kOk);
    ASSERT_EQ(solve(fixed, q2, VectorXd::Zero(fixed.nv), VectorXd::Zero(fixed.nu), data2).status, Status::kOk);
    VectorXd a = data2.a;
    copy_joints(file, data.a, *model, a, &Joint::idx_v, &Joint::nv);
    EXPECT_LT((data2.a - a).norm(), 1e-10 * a.norm());
  }
}

TEST(Root, OfTheFileIsTheFile) {
  const auto given = robot("trunk", true), none = robot("", true);
  ASSERT_EQ(given->njoints(), none->njoints());
  for (int i = 0; i < none->njoints(); ++i) {
    EXPECT_EQ(given->joints[i].name, none->joints[i].name);
    EXPECT_EQ(given->joints[i].placement.p, none->joints[i].placement.p);
    EXPECT_EQ(given->joints[i].axis, none->joints[i].axis);
  }
  // and a link that is fixed to it is first, its joints ordered by their names
  const auto thumb = robot("thumb", false);
  std::vector<std::string> names;
  for (const Joint& joint : thumb->joints) names.push_back(joint.name);
  EXPECT_EQ(names, (std::vector<std::string>{"c_thumb", "b_wrist", "k_slide", "m_arm", "y_ball", "z_neck"}));
}

TEST(Root, ThatCannotBeIsRefused) {
  const auto refused = [](const std::string& root, const std::string& why) {
    try {
      (void)robot(root, true);
      ADD_FAILURE() << root;
    } catch (const UrdfOptionError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  refused("hnad", "no link 'hnad' for the root");
  refused("ball", "joint 'y_ball' has several coordinates and is between the file's root 'trunk' and 'ball'");
}

TEST(Root, OfASceneFile) {
  const TemporaryFolder folder;
  folder.write("r.urdf", kRobot);
  const auto load = [&](const std::string& attributes) {
    return load_scene(folder.write("s.xml", "<scene>\n<robot name='a' urdf='r.urdf'/>\n<robot name='b' urdf='r.urdf' " +
                                                attributes + "/>\n</scene>"));
  };
  const SceneFile file = load("base='floating' root='hand' xyz='1 2 3'");
  EXPECT_EQ(file.scene.robots[0].model->frames[0].name, "trunk");
  EXPECT_EQ(file.scene.robots[1].model->frames[0].name, "hand");
  EXPECT_EQ(file.q.segment<3>(file.scene.robots[1].idx_q), Vec3<double>(1, 2, 3));
  try {
    (void)load("root='hnad'");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("s.xml:3"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace manycontact::test
