// manycontact/manycontact.hpp alone is enough for a program from the scene to its derivatives and its next state.

#include <gtest/gtest.h>

#include "manycontact/manycontact.hpp"

namespace manycontact {
namespace {

const std::string kModels = MANYCONTACT_SOURCE_DIR "/models/";

TEST(Umbrella, AFileIsLoadedAndSolved) {
  const SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  SceneData data(file.scene);
  EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kOk);
}

TEST(Umbrella, ASceneIsBuiltInCode) {
  UrdfOptions floating;
  floating.floating_base = true;
  Scene scene;
  add_robot(scene, "arm", std::make_shared<Model>(load_urdf(kModels + "arm.urdf")));
  add_robot(scene, "box", std::make_shared<Model>(load_urdf(kModels + "box.urdf", floating)),
            {Mat3<double>::Identity(), Vec3<double>(0.75, 0, 0.2)});
  Eigen::VectorXd q = neutral(scene);
  q[q_index(scene, "arm", "elbow")] = 1.2;
  const auto hold = [&](const char* name, ContactType type, const Attachment& A, const Attachment& B) {
    Contact c;
    c.name = name;
    c.type = type;
    c.A = A;
    c.B = B;
    resolve_reference(scene, q, true, true, c);
    add_contact(scene, c);
  };
  hold("ground", ContactType::k3D, attach(scene, "box", "bottom_1"), {});
  hold("push", ContactType::k3D, attach(scene, "arm", "tool"), attach(scene, "box", "face_back"));

  const Eigen::VectorXd v = Eigen::VectorXd::Zero(scene.nv), u = quasi_static(scene, q);
  SceneData data(scene);
  EXPECT_EQ(solve(scene, q, v, u, data).status, Status::kOk);
  (void)differentiate(scene, data);
  Eigen::VectorXd wq(scene.nv), wv(scene.nv), wu(scene.nu);
  vjp(scene, data, data.a, data.f, wq, wv, wu);
  EXPECT_TRUE(wq.allFinite() && wv.allFinite() && wu.allFinite());

  SimulationData through_time(scene, q, v, Integrator::kSemiImplicitEuler, 1e-3);
  EXPECT_EQ(step(scene, u, through_time), StepStatus::kOk);
  EXPECT_EQ(difference(scene, q, through_time.q).size(), scene.nv);
}

}  // namespace
}  // namespace manycontact
