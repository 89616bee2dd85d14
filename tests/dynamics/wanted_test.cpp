// The contacts have prescribed accelerations.

#include <gtest/gtest.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "spatial/compare.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/terms.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

VectorXd torques_of(const Scene& scene, const VectorXd& u) {
  VectorXd tau = VectorXd::Zero(scene.nv);
  for (const Robot& r : scene.robots)
    for (int k = 0; k < r.model->nu(); ++k) tau[r.idx_v + r.model->actuated[k]] = u[r.idx_u + k];
  return tau;
}

// Every method satisfies M a - J^T f = tau - h, J a + delta f = wanted - a0.
TEST(Wanted, ContactsAccelerateAsAsked) {
  for (const double damping : {0.0, 1e-3}) {
    std::mt19937 rng(41);
    SceneOptions options;
    options.damping = damping;
    const RandomScene s = random_scene(rng, options);
    const Terms terms(s.scene, std::vector<char>(s.scene.contacts.size(), 1), s.q, s.v, s.u);
    const VectorXd wanted = random_vector(static_cast<int>(terms.a0.size()), rng, 3), tau = torques_of(s.scene, s.u);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(way.name);
      SceneData data(s.scene, way.options);
      EXPECT_EQ(solve_tau(s.scene, s.q, s.v, tau, wanted, data).status, Status::kOk);
      EXPECT_LE(terms.dynamics_error(data.a, data.f), 1e-12);
      const VectorXd expected = wanted - terms.a0;
      EXPECT_LE(difference_of(VectorXd(terms.J * data.a + damping * data.f), expected), 1e-9 * (1 + size_of(expected)));
      EXPECT_THROW(differentiate(s.scene, data), std::logic_error);
      EXPECT_THROW((void)solve_tau(s.scene, s.q, s.v, tau, VectorXd::Zero(1), data), std::invalid_argument);
      (void)solve(s.scene, s.q, s.v, s.u, data);  // no acceleration is prescribed any more
      EXPECT_LE(difference_of(VectorXd(terms.J * data.a + damping * data.f), VectorXd(-terms.a0)),
                1e-9 * (1 + size_of(expected)));
      differentiate(s.scene, data);
    }
  }
}

// Each robot of a SIMD batch has another prescribed acceleration.
TEST(Wanted, InLanes) {
  const SceneFile file = load_scene(MANYCONTACT_SOURCE_DIR "/models/herd.xml");
  const VectorXd tau = torques_of(file.scene, file.u);
  SceneData in_lanes(file.scene), alone(file.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
  prepare(file.scene, in_lanes);
  std::mt19937 rng(42);
  const VectorXd wanted = random_vector(static_cast<int>(in_lanes.f.size()), rng);
  EXPECT_EQ(solve_tau(file.scene, file.q, file.v, tau, wanted, in_lanes).status, Status::kOk);
  EXPECT_EQ(solve_tau(file.scene, file.q, file.v, tau, wanted, alone).status, Status::kOk);
  EXPECT_LE(error_of(in_lanes.a, alone.a), 1e-11);
  EXPECT_LE(error_of(in_lanes.f, alone.f), 1e-11);
  (void)solve(file.scene, file.q, file.v, file.u, alone);
  EXPECT_GT(error_of(in_lanes.f, alone.f), 1e-3);
}

}  // namespace
}  // namespace manycontact::test
