// Islands of many alike robots are solved robot by robot, in SIMD batches; if an order is requested, by the island's
// factor. Both are exact up to rounding error.

#include <gtest/gtest.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/dynamics/views.hpp"
#include "spatial/compare.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/workspace.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// Returns `count` robots of these models in turn, at random placements.
RandomScene robots_in_motion(const std::vector<std::shared_ptr<const Model>>& models, int count, std::mt19937& rng) {
  RandomScene s;
  for (int r = 0; r < count; ++r)
    add_robot(s.scene, "r" + std::to_string(r), models[r % models.size()], random_placement(rng, 3));
  s.q.resize(s.scene.nq);
  for (const Robot& r : s.scene.robots) s.q.segment(r.idx_q, r.model->nq) = random_configuration(*r.model, rng);
  s.v = random_vector(s.scene.nv, rng);
  s.u = random_vector(s.scene.nu, rng, 5);
  return s;
}

// Returns a ring of `count` robots of two models in turn, each also fixed at a point, with contacts of all types. Where
// contacts attach to the world, and to other robots, is different everywhere.
RandomScene ring_of_robots(int count, bool floating, double damping) {
  std::mt19937 rng(21);
  ModelOptions options;
  options.njoints = 18;
  options.types = {JointType::kRevolute};
  options.branching = 0.1;
  std::vector<std::shared_ptr<const Model>> models;
  for (const bool floats : {floating, true}) {
    options.floating_base = floats;
    models.push_back(std::make_shared<const Model>(random_model(rng, options)));
  }
  RandomScene s = robots_in_motion(models, count, rng);
  s.scene.damping = damping;
  const auto add = [&](ContactType type, ReferenceFrame frame, Attachment A, Attachment B) {
    Contact c;
    c.name = "c" + std::to_string(s.scene.contacts.size());
    c.type = type, c.reference_frame = frame;
    c.A = A, c.B = B;
    c.alpha = 10, c.beta = 5;
    c.axis = {0, 0.6, 0.8};
    add_contact(s.scene, c);
  };
  const auto at = [&](int robot, int joint) { return Attachment{robot, joint, random_placement(rng, 0.2)}; };
  const ContactType joins[] = {ContactType::k6D, ContactType::k3D, ContactType::k1D, ContactType::k5D};
  const SE3<double> held = random_placement(rng, 0.2), loop = random_placement(rng, 0.2);
  for (int r = 0; r < count; ++r) {
    add(ContactType::k3D, ReferenceFrame::kWorld, {r, 5, held}, {-1, -1, random_placement(rng, 1)});
    if (r % 2) add(ContactType::k1D, ReferenceFrame::kLocal, {r, 7, held}, {r, 3, loop});
    const ContactType type = joins[r % 4];
    add(type, type == ContactType::k5D ? ReferenceFrame::kLocal : ReferenceFrame::kLocalWorldAligned, at(r, 14),
        at((r + 1) % count, 12));
  }
  return s;
}

// Robots have so few joints that the inputs of the contacts between them are larger than their factor.
RandomScene ring_of_arms(int count) {
  std::mt19937 rng(24);
  ModelOptions options;
  options.njoints = 3;
  options.types = {JointType::kRevolute};
  options.branching = 0;
  options.floating_base = false;
  const auto model = std::make_shared<const Model>(random_model(rng, options));
  RandomScene s = robots_in_motion({model}, count, rng);
  for (int r = 0; r < count; ++r) {
    Contact c;
    c.name = "c" + std::to_string(r);
    c.type = ContactType::k1D;
    c.A = {r, 2, random_placement(rng, 0.2)};
    c.B = {(r + 1) % count, 1, random_placement(rng, 0.2)};
    c.axis = {0, 0.6, 0.8};
    add_contact(s.scene, c);
  }
  return s;
}

// Robots have two arms with rungs between them: neighbouring columns of their factors have nearly one pattern.
RandomScene ring_of_ladders(int count) {
  std::mt19937 rng(27);
  ModelOptions options;
  options.njoints = 41;
  options.types = {JointType::kRevolute};
  options.branching = 0;
  options.floating_base = true;
  Model arms = random_model(rng, options);
  arms.joints[21].parent = 0;
  finalize(arms);
  const auto model = std::make_shared<const Model>(std::move(arms));
  RandomScene s = robots_in_motion({model}, count, rng);
  const auto add = [&](ContactType type, Attachment A, Attachment B) {
    Contact c;
    c.name = "c" + std::to_string(s.scene.contacts.size());
    c.type = type, c.A = A, c.B = B;
    c.axis = {0, 0.6, 0.8};
    add_contact(s.scene, c);
  };
  for (int r = 0; r < count; ++r) {
    for (int rung = 3; rung <= 20; ++rung) {
      const SE3<double> place = random_placement(rng, 0.2);
      add(ContactType::k1D, {r, rung, place}, {r, 20 + rung, {}});
    }
    add(ContactType::k3D, {r, 20, random_placement(rng, 0.2)}, {(r + 1) % count, 35, random_placement(rng, 0.2)});
  }
  return s;
}

struct Solution {
  VectorXd a, f;
  Report report;
};
Solution solution_of(const RandomScene& s, const Options& options) {
  SceneData data(s.scene, options);
  wake_threads_for(data, 0);
  (void)solve(s.scene, s.q, s.v, s.u, data);
  return {data.a, data.f, data.report};
}

class Cut : public testing::TestWithParam<SimdLevel> {
 protected:
  Options options() const { return {Method::kSparseLdl, {}, GetParam()}; }
  Options by_factor() const { return {Method::kSparseLdl, Order::kLeafToRoot, GetParam()}; }
};

TEST_P(Cut, AgreesWithTheOracle) {
  for (const bool floating : {true, false})
    for (const double damping : {0.0, 1e-4}) {
      const RandomScene s = ring_of_robots(32, floating, damping);
      SceneData oracle(s.scene, {Method::kDense, {}});
      ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, oracle).status, Status::kOk);
      estimate_condition(s.scene, oracle);
      const double allowed = std::max(1e-12, 100 * kEps * oracle.report.condition);
      const Solution cut = solution_of(s, options()), factor = solution_of(s, by_factor());
      ASSERT_EQ(cut.report.status, Status::kOk);
      EXPECT_LE(difference_of(cut.a, oracle.a), allowed * size_of(oracle.a));
      EXPECT_LE(difference_of(cut.f, oracle.f), allowed * size_of(oracle.f));
      EXPECT_FALSE(cut.a == factor.a);  // there are two methods
      const IslandReport &x = cut.report.islands[0], &y = factor.report.islands[0];
      EXPECT_EQ(x.rank, y.rank);
      EXPECT_EQ(x.nc, y.nc);
      EXPECT_LE(x.residual_dynamics, 1e-14);
      EXPECT_LE(x.residual_contact, 1e-14);
      EXPECT_LE(x.backward_error, 1e-15);
    }
}

TEST_P(Cut, RobotsOfFewJoints) {
  const RandomScene s = ring_of_arms(64);
  const Solution cut = solution_of(s, options()), factor = solution_of(s, by_factor());
  ASSERT_EQ(cut.report.status, Status::kOk);
  EXPECT_LE(difference_of(cut.a, factor.a), 1e-12 * size_of(factor.a));
  EXPECT_LE(difference_of(cut.f, factor.f), 1e-12 * size_of(factor.f));
  EXPECT_FALSE(cut.a == factor.a);  // there are two methods
}

TEST_P(Cut, ContactsAccelerateAsAsked) {
  const RandomScene s = ring_of_robots(24, true, 0);
  std::mt19937 rng(22);
  SceneData cut(s.scene, options()), factor(s.scene, by_factor());
  VectorXd tau = VectorXd::Zero(s.scene.nv);
  const VectorXd wanted = random_vector(static_cast<int>(cut.f.size()), rng, 3);
  for (SceneData* data : {&cut, &factor})
    EXPECT_EQ(solve_tau(s.scene, s.q, s.v, tau, wanted, *data).status, Status::kOk);
  EXPECT_LE(difference_of(cut.a, factor.a), 1e-10 * size_of(factor.a));
  EXPECT_LE(difference_of(cut.f, factor.f), 1e-10 * size_of(factor.f));
}

// Products and derivatives use the cut robots, products after derivatives too.
TEST_P(Cut, ProductsAndDerivatives) {
  const RandomScene s = ring_of_robots(24, true, 0);
  std::mt19937 rng(23);
  SceneData data(s.scene, options());
  ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
  const VectorXd dq = random_vector(s.scene.nv, rng), dv = random_vector(s.scene.nv, rng),
                 du = random_vector(s.scene.nu, rng), wa = random_vector(s.scene.nv, rng),
                 wf = random_vector(static_cast<int>(data.f.size()), rng);
  VectorXd da(s.scene.nv), df(data.f.size()), wq(s.scene.nv), wv(s.scene.nv), wu(s.scene.nu);
  jvp(s.scene, data, dq, dv, du, da, df);
  vjp(s.scene, data, wa, wf, wq, wv, wu);
  const double one = wa.dot(da) + wf.dot(df), other = wq.dot(dq) + wv.dot(dv) + wu.dot(du);
  const double terms = wq.cwiseAbs().dot(dq.cwiseAbs()) + wv.cwiseAbs().dot(dv.cwiseAbs());
  EXPECT_NEAR(one, other, 1e-10 * terms);
  differentiate(s.scene, data);
  const SceneDerivatives D = dense_derivatives(s.scene, data);
  const VectorXd da_formed = D.da_dq * dq + D.da_dv * dv + D.da_du * du;
  EXPECT_LE(difference_of(da, da_formed), 1e-10 * size_of(da_formed));
  const VectorXd wq_formed = D.da_dq.transpose() * wa + D.dforces_dq.transpose() * wf;
  EXPECT_LE(difference_of(wq, wq_formed), 1e-10 * size_of(wq_formed));
  VectorXd again(s.scene.nv), df_again(data.f.size());
  jvp(s.scene, data, dq, dv, du, again, df_again);
  EXPECT_TRUE(again == da && df_again == df);
}

// The factors that solved an island also give its derivatives and products.
TEST_P(Cut, FactorizesOnce) {
  for (const RandomScene& s : {ring_of_robots(24, true, 0), ring_of_robots(24, true, 1e-4), ring_of_ladders(16)}) {
    SCOPED_TRACE(s.scene.nrobots());
    SceneData data(s.scene, options());
    VectorXd wq(s.scene.nv), wv(s.scene.nv), wu(s.scene.nu);
    for (int times : {1, 2}) {
      ASSERT_EQ(solve(s.scene, s.q, times * s.v, s.u, data).status, Status::kOk);
      EXPECT_EQ(factorizations_of(data, 0), 1);
      const DerivativeData& made = differentiate(s.scene, data);
      EXPECT_EQ(factorizations_of(data, 0), 1);
      vjp(s.scene, data, data.a, data.f, wq, wv, wu);
      EXPECT_EQ(factorizations_of(data, 0), 1);
      SceneData by_whole(s.scene, by_factor());
      (void)solve(s.scene, s.q, times * s.v, s.u, by_whole);
      EXPECT_LE(difference_of(data.a, by_whole.a), 1e-10 * size_of(by_whole.a));
      const auto& whole = differentiate(s.scene, by_whole).islands[0].X;
      EXPECT_LE((made.islands[0].X - whole).cwiseAbs().maxCoeff(), 1e-10 * whole.cwiseAbs().maxCoeff());
      EXPECT_FALSE(made.islands[0].X == whole);
      estimate_condition(s.scene, data);  // it needs the whole K
      EXPECT_EQ(factorizations_of(data, 0), 2);
    }
  }
}

TEST_P(Cut, ThreadsDoNotChangeBits) {
  const RandomScene s = ring_of_robots(24, true, 0);
  const Solution one = solution_of(s, options());
  for (const int threads : {2, 3}) {
    Options some = options();
    some.threads = threads;
    const Solution x = solution_of(s, some);
    EXPECT_TRUE(x.a == one.a && x.f == one.f) << threads;
    EXPECT_EQ(x.report.islands[0].backward_error, one.report.islands[0].backward_error);
  }
}

// Another method solves what this one cannot, and the report names it.
TEST_P(Cut, FallsBack) {
  RandomScene s = ring_of_robots(24, true, 0);
  const Robot& robot = s.scene.robots[9];
  const Solution before = solution_of(s, options());
  const VectorXd q = s.q;
  SceneData data(s.scene, options());
  for (const double bad : {kNaN, 3e7}) {  // an angle beyond the range of SIMD batches
    s.q[robot.idx_q + robot.model->nq - 1] = bad;
    (void)solve(s.scene, s.q, s.v, s.u, data);
    const Solution factor = solution_of(s, by_factor());
    EXPECT_EQ(data.report.status, factor.report.status);
    EXPECT_EQ(data.report.islands[0].reason, factor.report.islands[0].reason);
  }
  s.q = q;
  (void)solve(s.scene, s.q, s.v, s.u, data);
  EXPECT_TRUE(data.a == before.a && data.f == before.f);
  Contact again = s.scene.contacts[2];  // twice the same, between two robots and on one
  again.name = "again";
  for (const int which : {2, 0}) {
    RandomScene twice = s;
    again = s.scene.contacts[which];
    again.name = "again";
    add_contact(twice.scene, again);
    const Solution x = solution_of(twice, options()), y = solution_of(twice, by_factor());
    EXPECT_EQ(x.report.status, Status::kRedundant);
    EXPECT_EQ(x.report.islands[0].rank, y.report.islands[0].rank);
    EXPECT_LE(difference_of(x.a, before.a), 1e-9 * size_of(before.a));
  }
}

TEST_P(Cut, AllocatesNothingLater) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const RandomScene s = ring_of_robots(24, true, 0);
  SceneData data(s.scene, options());
  VectorXd wq(s.scene.nv), wv(s.scene.nv), wu(s.scene.nu);
  const auto work = [&] {
    (void)solve(s.scene, s.q, s.v, s.u, data);
    vjp(s.scene, data, data.a, data.f, wq, wv, wu);
  };
  work();
  const VectorXd a = data.a;
  EXPECT_EQ(allocations(work), 0u);
  for (const bool again : {false, true}) {
    for (const bool closed : {false, true}) {
      data.active[2] = closed;
      const std::size_t count = allocations(work);
      EXPECT_TRUE(!again || count == 0) << count;
    }
    EXPECT_TRUE(data.a == a);
  }
}

INSTANTIATE_TEST_SUITE_P(, Cut, testing::ValuesIn(available_simd_levels()),
                         [](const auto& level) { return to_string(level.param); });

}  // namespace
}  // namespace manycontact::test
