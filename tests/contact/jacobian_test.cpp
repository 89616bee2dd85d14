// J, a0 and the contact forces on bodies satisfy the equations of a solve's solution, and agree with differences.

#include "manycontact/contact/jacobian.hpp"

#include <gtest/gtest.h>

#include "contact/scene_rows.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/applied.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

RandomScene some_scene(unsigned seed) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.friction = 0.2;
  return random_scene(rng, options);
}

TEST(ContactJacobian, SolutionsObeyTheEquations) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    RandomScene s = some_scene(seed);
    std::vector<char> active(s.scene.contacts.size(), 1);
    active[0] = 0;
    SceneData data(s.scene);
    data.active = active;
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
    const Eigen::MatrixXd J = contact_jacobian(s.scene, s.q, active);
    const VectorXd a0 = contact_bias_acceleration(s.scene, s.q, s.v, active);
    ASSERT_EQ(J.rows(), data.f.size());
    EXPECT_LE(size_of(J * data.a + a0), 1e-9 * (1 + size_of(a0)));

    RigidBodyData bodies(s.scene);
    const Eigen::MatrixXd M = crba(s.scene, s.q, bodies);
    const VectorXd h = nonlinear_effects(s.scene, s.q, s.v, bodies);
    VectorXd tau = VectorXd::Zero(s.scene.nv);
    for (const Robot& robot : s.scene.robots)
      for (int k = 0; k < robot.model->nu(); ++k) tau[robot.idx_v + robot.model->actuated[k]] = s.u[robot.idx_u + k];
    const double size = 1 + size_of(h) + size_of(J.transpose() * data.f);
    EXPECT_LE(size_of(M * data.a + h - J.transpose() * data.f - tau), 1e-9 * size);

    const auto forces = contact_forces_on_bodies(s.scene, s.q, data.f, data.f_offset);
    EXPECT_LE(difference_of(rnea(s.scene, s.q, s.v, data.a, bodies, forces), tau), 1e-9 * size);
    EXPECT_GT(size_of(forces[0]) + size_of(forces.back()) + data.f.norm(), 0);
  }
}

// With wrenches and springs, those in joints being part of rnea, motors give the remaining torques.
TEST(ContactJacobian, ForcesOnBodiesAreAllFromOutsideTheJoints) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    std::mt19937 rng(seed);
    RandomScene s = some_scene(seed);
    add_random_forces(s.scene, rng);
    SceneData data(s.scene);
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
    data.wrenches[1] *= 2;
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
    RigidBodyData bodies(s.scene);
    const auto forces = forces_on_bodies(s.scene, s.q, s.v, data.f, data.f_offset, data.wrenches);
    const VectorXd tau = rnea(s.scene, s.q, s.v, data.a, bodies, forces);
    VectorXd motors = VectorXd::Zero(s.scene.nv);
    for (const Robot& robot : s.scene.robots)
      for (int k = 0; k < robot.model->nu(); ++k) motors[robot.idx_v + robot.model->actuated[k]] = s.u[robot.idx_u + k];
    const double size = 1 + size_of(nonlinear_effects(s.scene, s.q, s.v, bodies)) + size_of(data.f);
    EXPECT_LE(difference_of(tau, motors), 1e-9 * size);
    EXPECT_LE(difference_of(aba(s.scene, s.q, s.v, motors, bodies, forces), data.a), 1e-8 * (1 + size_of(data.a)));
    EXPECT_THROW((void)forces_on_bodies(s.scene, s.q, s.v, data.f, data.f_offset, {data.wrenches.data(), 1}),
                 std::invalid_argument);
  }
}

// J v and its bias acceleration are rates of the motion of A relative to B', in quadruple precision.
TEST(ContactJacobian, DriftIsTheRateOfJv) {
  for (unsigned seed = 21; seed <= 26; ++seed) {
    RandomScene s = some_scene(seed);
    for (Contact& contact : s.scene.contacts) contact.alpha = contact.beta = 0;
    const Eigen::MatrixXd J = contact_jacobian(s.scene, s.q);
    const VectorXd a0 = contact_bias_acceleration(s.scene, s.q, s.v);
    const double h = 1e-6;
    const auto velocities = [&](double t) -> VectorXd {
      return contact_jacobian(s.scene, integrate(s.scene, s.q, t * s.v)) * s.v;
    };
    const VectorXd rates = (velocities(h) - velocities(-h)) / (2 * h);
    Eigen::Index row = 0;
    for (const Contact& contact : s.scene.contacts) {
      // rows are in A's axes; world-aligned axes rotate, and a0 is as seen in A's axes
      if (contact.reference_frame == ReferenceFrame::kLocal && contact.type == ContactType::k6D) {
        EXPECT_LE(difference_of(a0.segment(row, 6), rates.segment(row, 6)), 1e-7 * (1 + size_of(rates)));
      }
      row += contact.rows();
    }
    EXPECT_EQ(row, J.rows());
  }
}

TEST(ContactJacobian, SizesAreLookedAt) {
  RandomScene s = some_scene(3);
  EXPECT_THROW((void)contact_jacobian(s.scene, s.q.head(2)), std::invalid_argument);
  EXPECT_THROW((void)contact_jacobian(s.scene, s.q, {1}), std::invalid_argument);
  EXPECT_THROW((void)contact_bias_acceleration(s.scene, s.q, s.v.head(1)), std::invalid_argument);
  EXPECT_THROW((void)contact_forces_on_bodies(s.scene, s.q, s.v.head(1), {0}), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
