// Passive joints have no torques, but the same dynamics. Friction of joints is a torque like any other.

#include <gtest/gtest.h>

#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/detail/algorithm/rnea.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "spatial/compare.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Contacts are copied: add_contact would normalise their axes once more, which may change a last bit.
void take_contacts(const Scene& from, Scene& to) {
  to.contacts = from.contacts;
  to.contact_index = from.contact_index;
}

// Contains a scene, the same with some joints passive, and for each torque of the second its number in the first.
struct Pair {
  RandomScene all, some;
  std::vector<int> kept;
};

Pair pair_of(int seed) {
  Pair p;
  std::mt19937 rng(seed);
  p.all = random_scene(rng, {.ncontacts = 5});
  for (const Robot& robot : p.all.scene.robots) {
    auto model = std::make_shared<Model>(*robot.model);
    for (Joint& joint : model->joints) joint.actuated = !chance(rng, 0.4);
    finalize(*model);
    for (int i : model->actuated)
      p.kept.push_back(robot.idx_u +
                       static_cast<int>(std::find(robot.model->actuated.begin(), robot.model->actuated.end(), i) -
                                        robot.model->actuated.begin()));
    add_robot(p.some.scene, robot.name, model, robot.base);
  }
  take_contacts(p.all.scene, p.some.scene);
  p.some.q = p.all.q;
  p.some.v = p.all.v;
  p.some.u = p.all.u(p.kept);
  p.all.u.setZero();
  p.all.u(p.kept) = p.some.u;
  return p;
}

TEST(Passive, SameDynamicsFewerTorques) {
  for (int seed : {71, 72, 73}) {
    SCOPED_TRACE(seed);
    const Pair p = pair_of(seed);
    ASSERT_LT(p.some.scene.nu, p.all.scene.nu);
    ASSERT_GT(p.some.scene.nu, 0);
    const Options one_by_one{Method::kAuto, {}, SimdLevel::kOff};  // the models differ, and so would SIMD batches
    SceneData all(p.all.scene, one_by_one), some(p.some.scene, one_by_one);
    (void)solve(p.all.scene, p.all.q, p.all.v, p.all.u, all);
    (void)solve(p.some.scene, p.some.q, p.some.v, p.some.u, some);
    EXPECT_TRUE(some.a == all.a);
    EXPECT_TRUE(some.f == all.f);
    (void)differentiate(p.all.scene, all);
    (void)differentiate(p.some.scene, some);
    const SceneDerivatives a = dense_derivatives(p.all.scene, all), s = dense_derivatives(p.some.scene, some);
    EXPECT_EQ(s.da_du.cols(), p.some.scene.nu);
    EXPECT_LE(error_of(s.da_dq, a.da_dq), 1e-11);
    EXPECT_LE(error_of(s.da_du, MatrixXd(a.da_du(Eigen::all, p.kept))), 1e-12);
    EXPECT_LE(error_of(s.dforces_du, MatrixXd(a.dforces_du(Eigen::all, p.kept))), 1e-12);
    std::mt19937 rng(seed);
    const VectorXd du = random_vector(p.some.scene.nu, rng), zero = VectorXd::Zero(p.some.scene.nv);
    VectorXd da(p.some.scene.nv), df(some.f.size());
    jvp(p.some.scene, some, zero, zero, du, da, df);
    EXPECT_LE(error_of(da, VectorXd(s.da_du * du)), 1e-10);
    VectorXd wq(zero.size()), wv(zero.size()), wu(du.size());
    vjp(p.some.scene, some, da, df, wq, wv, wu);
    EXPECT_LE(error_of(wu, VectorXd(s.da_du.transpose() * da + s.dforces_du.transpose() * df)), 1e-10);
  }
}

// The torques are the u part of the least-norm least-squares solution of [S^T J^T] [u; f] = h(q, 0).
TEST(Passive, QuasiStatic) {
  for (int seed : {74, 75}) {
    const RandomScene s = pair_of(seed).some;
    const Scene& scene = s.scene;
    const MatrixXd J = contact_jacobian(scene, s.q);
    MatrixXd A = MatrixXd::Zero(scene.nv, scene.nu + J.rows());
    A.rightCols(J.rows()) = J.transpose();
    VectorXd h(scene.nv);
    for (const Robot& robot : scene.robots) {
      const Model& model = *robot.model;
      for (int k = 0; k < model.nu(); ++k) A(robot.idx_v + model.actuated[k], robot.idx_u + k) = 1;
      Kinematics<double> kin(model);
      std::vector<Vec6<double>> f;
      const VectorXd zero = VectorXd::Zero(model.nv);
      rnea<double>(model, robot.base, s.q.segment(robot.idx_q, model.nq), zero, zero, scene.gravity, {}, kin, f,
                   h.segment(robot.idx_v, model.nv));
    }
    const VectorXd expected = least_norm(A, h).col(0).head(scene.nu);
    EXPECT_LE(error_of(quasi_static(scene, s.q), expected), 1e-9) << seed;
  }
}

TEST(Friction, IsATorque) {
  std::mt19937 rng(76);
  SceneOptions options;
  options.friction = 0.5;
  const RandomScene s = random_scene(rng, options);
  VectorXd tau = VectorXd::Zero(s.scene.nv), without = tau;
  Scene bare;
  for (const Robot& robot : s.scene.robots) {
    add_friction(*robot.model, s.v.data() + robot.idx_v, tau.data() + robot.idx_v);
    auto model = std::make_shared<Model>(*robot.model);
    model->damping = model->friction = VectorXd();
    add_robot(bare, robot.name, model, robot.base);
  }
  take_contacts(s.scene, bare);
  EXPECT_LT(tau.dot(s.v), 0);  // friction takes energy
  const Options one_by_one{Method::kAuto, {}, SimdLevel::kOff};
  SceneData with(s.scene, one_by_one), of_torques(bare, one_by_one);
  (void)solve_tau(s.scene, s.q, s.v, without, with);
  (void)solve_tau(bare, s.q, s.v, tau, of_torques);
  EXPECT_TRUE(with.a == of_torques.a);
  EXPECT_NE(with.a.norm(), 0);
}

}  // namespace
}  // namespace manycontact::test
