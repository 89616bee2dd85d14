// Data belong to a scene, a solution and a contact set. Use with others throws, and a solution that was discarded is
// not returned.

#include <gtest/gtest.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

class Lifecycle : public testing::Test {
 protected:
  void SetUp() override {
    std::mt19937 rng(5);
    disturb(file, rng);
    other = file.v * -1.5;
  }
  void solve_at(const VectorXd& v, SceneData& data) const { (void)solve(file.scene, file.q, v, file.u, data); }

  SceneFile file = load_small(kModels + "two_humanoids_carry_beam.xml");
  const Scene& scene = file.scene;
  VectorXd other;
};

// ---- forces by name -----------------------------------------------------------------------------------------------

TEST_F(Lifecycle, AForceIsItsContacts) {
  SceneData data(scene);
  EXPECT_THROW((void)contact_force(scene, data, 0), std::logic_error);
  solve_at(file.v, data);
  int row = 0;
  for (const auto& contact : scene.contacts) {
    EXPECT_EQ(contact_force(scene, data, contact.name), data.f.segment(row, contact.rows()));
    EXPECT_EQ(contact_force(scene, data, scene.contact_index.at(contact.name)), data.f.segment(row, contact.rows()));
    row += contact.rows();
  }
  EXPECT_THROW((void)contact_force(scene, data, -1), std::invalid_argument);
  EXPECT_THROW((void)contact_force(scene, data, static_cast<int>(scene.contacts.size())), std::invalid_argument);
  try {
    (void)contact_force(scene, data, "a_left_fot");
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'a_left_foot'"), std::string::npos) << error.what();
  }
  data.active[1] = 0;
  EXPECT_THROW((void)contact_force(scene, data, 0), std::logic_error);  // the contact set is another one
  solve_at(file.v, data);
  EXPECT_EQ(contact_force(scene, data, 2), data.f.segment(6, 6));
  EXPECT_THROW((void)contact_force(scene, data, 1), std::logic_error);
}

// ---- stale derivatives ------------------------------------------------------------------------------------------

TEST_F(Lifecycle, DerivativesOfAnEarlierSolutionAreNotHandedOut) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    solve_at(file.v, data);
    if (data.report.status == Status::kFailed) continue;
    const IslandDerivatives& block = differentiate(scene, data).islands[0];
    const Eigen::MatrixXd before = dense_derivatives(scene, data).da_dq, of_island = block.da_dq();
    solve_at(other, data);
    EXPECT_THROW((void)dense_derivatives(scene, data), std::logic_error);
    EXPECT_THROW((void)sparse_derivatives(scene, data), std::logic_error);
    EXPECT_THROW((void)derivatives(data), std::logic_error);
    EXPECT_THROW((void)block.da_dq(), std::logic_error);
    EXPECT_THROW((void)block.dforces_du(), std::logic_error);
    EXPECT_THROW((void)contact_derivatives(data, 0), std::logic_error);
    differentiate(scene, data);
    EXPECT_NE(dense_derivatives(scene, data).da_dq, before);
    EXPECT_NE(Eigen::MatrixXd(derivatives(data).islands[0].da_dq()), of_island);
  }
}

TEST_F(Lifecycle, NothingFollowsASolutionThatWasGivenUp) {
  SceneData data(scene);
  const VectorXd x = VectorXd::Ones(scene.nv), u = VectorXd::Ones(scene.nu);
  VectorXd da(scene.nv), df(data.f.size()), wq(scene.nv), wv(scene.nv), wu(scene.nu);
  const auto expect_nothing = [&](const char* after) {
    SCOPED_TRACE(after);
    EXPECT_EQ(data.serial, 0u);
    EXPECT_THROW(differentiate(scene, data), std::logic_error);
    EXPECT_THROW(jvp(scene, data, x, x, u, da, df), std::logic_error);
    EXPECT_THROW(vjp(scene, data, x, df, wq, wv, wu), std::logic_error);
    EXPECT_THROW(estimate_condition(scene, data), std::logic_error);
    EXPECT_THROW(estimate_errors(scene, data), std::logic_error);
    EXPECT_THROW((void)dense_derivatives(scene, data), std::logic_error);
  };
  expect_nothing("construction");
  const auto solve_and_differentiate = [&] {
    solve_at(file.v, data);
    differentiate(scene, data);
    EXPECT_GT(data.serial, 0u);
  };
  solve_and_differentiate();
  (void)quasi_static(scene, file.q, data);
  expect_nothing("quasi_static");
  solve_and_differentiate();
  update_kinematics(scene, file.q, file.v, data);
  expect_nothing("update_kinematics");
  solve_and_differentiate();
  data.active[0] = 0;
  prepare(scene, data);
  expect_nothing("prepare for other contacts");
}

TEST_F(Lifecycle, SwitchingAContactIsNoticedBeforeTheNextSolve) {
  SceneData data(scene);
  solve_at(file.v, data);
  differentiate(scene, data);
  data.active[0] = 0;
  EXPECT_THROW(differentiate(scene, data), std::logic_error);
  EXPECT_THROW(estimate_errors(scene, data), std::logic_error);
  data.active[0] = 1;
  EXPECT_NO_THROW(differentiate(scene, data));
}

// A call that throws leaves the data as they were.
TEST_F(Lifecycle, SizesAreCheckedBeforeAnythingIsWritten) {
  SceneData data(scene);
  solve_at(file.v, data);
  differentiate(scene, data);
  const VectorXd tau = data.tau, a = data.a, longer = VectorXd::Zero(scene.nv + 1), shorter = VectorXd::Zero(3);
  const std::uint64_t serial = data.serial;
  const VectorXd torques = VectorXd::Constant(scene.nu, 9), all = VectorXd::Constant(scene.nv, 9);
  EXPECT_THROW((void)solve(scene, shorter, file.v, torques, data), std::invalid_argument);
  EXPECT_THROW((void)solve(scene, file.q, longer, torques, data), std::invalid_argument);
  EXPECT_THROW((void)solve(scene, file.q, file.v, longer, data), std::invalid_argument);
  EXPECT_THROW((void)solve_tau(scene, file.q, longer, all, data), std::invalid_argument);
  EXPECT_THROW((void)solve_tau(scene, file.q, file.v, shorter, data), std::invalid_argument);
  EXPECT_TRUE(data.tau == tau);
  EXPECT_TRUE(data.a == a);
  EXPECT_EQ(data.serial, serial);
  EXPECT_NO_THROW((void)dense_derivatives(scene, data));
}

TEST_F(Lifecycle, ASolveThatThrowsHalfWayLeavesNoAnswer) {
  SceneData data(scene);
  solve_at(file.v, data);
  data.active.pop_back();  // prepare will throw
  EXPECT_THROW(solve_at(other, data), std::invalid_argument);
  data.active.push_back(1);
  EXPECT_EQ(data.serial, 0u);
  EXPECT_THROW(differentiate(scene, data), std::logic_error);
  solve_at(file.v, data);
  SceneData fresh(scene);
  solve_at(file.v, fresh);
  EXPECT_TRUE(data.a == fresh.a);
}

// ---- data and their scene -----------------------------------------------------------------------------------------

TEST_F(Lifecycle, DataOfAnotherSceneAreRefused) {
  const SceneFile small = load_scene(kModels + "humanoid_standing.xml");
  SceneData data(small.scene);
  EXPECT_THROW(solve_at(file.v, data), std::invalid_argument);
  EXPECT_THROW((void)solve_tau(scene, file.q, file.v, VectorXd::Zero(scene.nv), data), std::invalid_argument);
  EXPECT_THROW(prepare(scene, data), std::invalid_argument);
  EXPECT_THROW(differentiate(scene, data), std::invalid_argument);
  EXPECT_THROW((void)quasi_static(scene, file.q, data), std::invalid_argument);
  EXPECT_THROW((void)force_names(scene, data), std::invalid_argument);
  EXPECT_THROW(update_kinematics(scene, file.q, file.v, data), std::invalid_argument);
  EXPECT_NO_THROW((void)solve(small.scene, small.q, small.v, small.u, data));  // as if nothing had happened
  EXPECT_EQ(data.report.status, Status::kOk);
}

TEST_F(Lifecycle, AScenesCopyIsTheSameScene) {
  SceneData data(scene);
  const Scene copy = scene;
  EXPECT_NO_THROW((void)solve(copy, file.q, file.v, file.u, data));
}

TEST_F(Lifecycle, WhatMayNotChangeUnderDataIsNoticed) {
  const auto expect_noticed = [&](const char* what, const std::function<void(Scene&)>& change) {
    SCOPED_TRACE(what);
    Scene changed = scene;
    SceneData data(changed);
    ASSERT_EQ(solve(changed, file.q, file.v, file.u, data).status, SceneData(scene).report.status);
    change(changed);
    try {
      (void)solve(changed, file.q, file.v, file.u, data);
      FAIL() << "not noticed";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
    EXPECT_THROW(differentiate(changed, data), std::invalid_argument);
    SceneData fresh(changed);
    EXPECT_NO_THROW((void)solve(changed, file.q, file.v, file.u, fresh));
  };
  expect_noticed("another type", [](Scene& s) { s.contacts[0].type = ContactType::k3D; });
  expect_noticed("another body A", [](Scene& s) { s.contacts[0].A.joint = 0; });
  expect_noticed("another body B", [](Scene& s) {
    for (Contact& c : s.contacts)
      if (c.B.robot >= 0) c.B = {};
  });
  expect_noticed("another placement on A", [](Scene& s) { s.contacts[0].A.placement.p.x() += 0.1; });
  expect_noticed("another axis", [](Scene& s) { s.contacts[0].axis = Vec3<double>::UnitX(); });
  expect_noticed("contacts", [](Scene& s) { s.contacts.push_back(s.contacts[0]); });
  expect_noticed("another model",
                 [](Scene& s) { s.robots[0].model = std::make_shared<const Model>(*s.robots[0].model); });
}

// Solutions and derivatives are those of new data.
TEST_F(Lifecycle, WhatMayChangeUnderDataIsFollowed) {
  const auto expect_followed = [&](const char* what, const std::function<void(Scene&)>& change) {
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(std::string(what) + ", " + way.name);
      Scene changed = scene;
      SceneData data(changed, way.options);
      (void)solve(changed, file.q, file.v, file.u, data);
      if (data.report.status == Status::kFailed) continue;
      differentiate(changed, data);
      const VectorXd before = data.f;
      change(changed);
      (void)solve(changed, file.q, file.v, file.u, data);
      differentiate(changed, data);
      SceneData fresh(changed, way.options);
      (void)solve(changed, file.q, file.v, file.u, fresh);
      differentiate(changed, fresh);
      EXPECT_FALSE(data.f == before);
      EXPECT_TRUE(data.a == fresh.a);
      EXPECT_TRUE(data.f == fresh.f);
      EXPECT_TRUE(dense_derivatives(changed, data).dforces_dq == dense_derivatives(changed, fresh).dforces_dq);
    }
  };
  expect_followed("gravity", [](Scene& s) { s.gravity << 1, 2, -8; });
  expect_followed("damping", [](Scene& s) { s.damping = 1e-3; });
  expect_followed("gains", [](Scene& s) { s.contacts[0].alpha = 9, s.contacts[0].beta = 4; });
  expect_followed("B's placement", [](Scene& s) {
    s.contacts[0].alpha = 9;
    s.contacts[0].B.placement.p.x() += 0.01;
  });
  expect_followed("reference frame", [](Scene& s) {
    for (Contact& c : s.contacts)
      c.reference_frame = c.reference_frame == ReferenceFrame::kLocal ? ReferenceFrame::kWorld : ReferenceFrame::kLocal;
  });
}

}  // namespace
}  // namespace manycontact::test
