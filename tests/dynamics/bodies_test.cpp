// sparse-bodies is compared with the dense reference solver on random trees, with quadruple precision and sparse-ldl on
// chains, and is run on chains too long for either.

#include <gtest/gtest.h>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/truth.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/kkt/bodies/subtrees.hpp"
#include "support/allocations.hpp"
#include "support/chains.hpp"
#include "support/measure.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

const Options kBodies{Method::kSparseBodies, {}};

// Contains the solution and that of the dense reference solver.
struct Both {
  SceneData bodies, dense;
  Both(const Scene& scene, const VectorXd& q, const VectorXd& v, const VectorXd& u)
      : bodies(scene, kBodies), dense(scene, {Method::kDense, {}}) {
    (void)solve(scene, q, v, u, bodies);
    (void)solve(scene, q, v, u, dense);
  }
};

SceneOptions trees(double damping) {
  SceneOptions options;
  options.nrobots = 3;
  options.damping = damping;
  return options;
}

TEST(Bodies, AgreeWithTheOracle) {
  std::mt19937 rng(1);
  int answered = 0, islands = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const RandomScene s = random_scene(rng, trees(trial % 3 == 2 ? 1e-3 : 0));
    Both x(s.scene, s.q, s.v, s.u);
    EXPECT_EQ(x.bodies.report.status, x.dense.report.status) << trial;
    const Errors e = errors<double>(s.scene, x.bodies, x.dense.a, x.dense.f, conditions(s.scene, x.dense));
    EXPECT_LE(e.excess, 1) << trial << ": " << e;
    for (const IslandReport& island : x.bodies.report.islands) {
      ++islands;
      answered += island.method == Method::kSparseBodies;
      EXPECT_LE(island.backward_error, 1e-14) << trial;
    }
  }
  EXPECT_GE(answered, 0.95 * islands);
}

// In addition to the scene's contacts, bodies with children are fixed in 6D wherever six or more coordinates have moved
// them since the last: these trees fall into parts.
RandomScene held_scene(std::mt19937& rng) {
  SceneOptions options = trees(0);
  options.ncontacts = 2;
  RandomScene s = random_scene(rng, options);
  for (int r = 0; r < static_cast<int>(s.scene.robots.size()); ++r) {
    const Model& model = *s.scene.robots[r].model;
    std::vector<int> moved(model.njoints());
    for (int i = 0; i < model.njoints(); ++i) {
      const int parent = model.joints[i].parent;
      moved[i] = (parent < 0 ? 0 : moved[parent]) + model.joints[i].nv();
      if (moved[i] < 6 || model.subtree_end[i] == i + 1) continue;
      Contact c;
      c.name = "held" + std::to_string(r) + "_" + std::to_string(i);
      c.type = ContactType::k6D;
      c.A.robot = r;
      c.A.joint = i;
      c.A.placement.p = Vec3<double>(0.1, -0.2, 0.05);
      c.beta = 3;
      add_contact(s.scene, c);
      moved[i] = 0;
    }
  }
  return s;
}

int cuts_of(const Scene& scene) {
  std::size_t cuts = 0;
  for (const Island& island : find_islands(scene, std::vector<char>(scene.contacts.size(), 1)))
    cuts += split_bodies(island, analyze_bodies(scene, island)).cuts.size();
  return static_cast<int>(cuts);
}

TEST(Bodies, PartsAgreeWithTheOracle) {
  std::mt19937 rng(3);
  int cuts = 0, sound = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const RandomScene s = held_scene(rng);
    cuts += cuts_of(s.scene);
    SceneData dense(s.scene, {Method::kDense, {}});
    (void)solve(s.scene, s.q, s.v, s.u, dense);
    sound += dense.report.status == Status::kOk;
    for (const SimdLevel level : available_simd_levels()) {
      SceneData bodies(s.scene, {Method::kSparseBodies, {}, level});
      (void)solve(s.scene, s.q, s.v, s.u, bodies);
      EXPECT_EQ(bodies.report.status, dense.report.status) << trial << to_string(level);
      const Errors e = errors<double>(s.scene, bodies, dense.a, dense.f, conditions(s.scene, dense));
      EXPECT_LE(e.excess, 1) << trial << to_string(level) << ": " << e;
      for (const IslandReport& island : bodies.report.islands)  // the ladder's solution may be least squares
        if (island.method == Method::kSparseBodies && island.status != Status::kInconsistent) {
          EXPECT_LE(island.backward_error, 1e-14) << trial << to_string(level);
        }
    }
  }
  EXPECT_GE(cuts, 60);
  EXPECT_GE(sound, 15);
}

// Long chains have branches, and rows past a fixed body, which keep what hangs below in its part.
TEST(Bodies, PartsOfChains) {
  ChainOptions options;
  options.links = 100;
  Chain c = make_chain(options);
  EXPECT_EQ(cuts_of(c.scene), 9);  // nothing hangs on the last
  Contact past;
  past.name = "past";
  past.type = ContactType::k3D;
  past.A = {0, 31, {}};
  past.B = {0, 45, {}};
  add_contact(c.scene, past);
  EXPECT_EQ(cuts_of(c.scene), 8);
  Both x(c.scene, c.q, c.v, c.u);
  ASSERT_EQ(x.bodies.report.status, Status::kOk);
  EXPECT_EQ(x.bodies.report.islands[0].method, Method::kSparseBodies);
  const Errors e = errors<double>(c.scene, x.bodies, x.dense.a, x.dense.f, conditions(c.scene, x.dense));
  EXPECT_LE(e.excess, 1) << e;
}

// The numbers of a part do not depend on its place among the parts, nor on their numbers. The first links of a longer
// chain accelerate alike, to the last bit; if links at its end move differently, the parts before keep their bits.
TEST(Bodies, PartsHaveTheirOwnBits) {
  for (const SimdLevel level : available_simd_levels()) {
    const Options bodies{Method::kSparseBodies, {}, level};
    ChainOptions options;
    options.links = 230;  // 23 parts: some elements of batches stay empty
    Chain c = make_chain(options);
    SceneData x(c.scene, bodies);
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk);
    const VectorXd a = x.a, f = x.f;
    const auto expect_same = [&](const SceneData& y, int parts) {
      EXPECT_EQ(y.a.head(10 * parts), a.head(10 * parts)) << to_string(level);
      EXPECT_EQ(y.f.head(6 * (parts - 1)), f.head(6 * (parts - 1))) << to_string(level);  // the next pulls at the last
    };
    for (const int links : {20, 70, 180}) {
      Model model;
      const std::vector<Joint>& joints = c.scene.robots[0].model->joints;
      model.joints.assign(joints.begin(), joints.begin() + links);
      Chain cut;
      cut.scene.gravity = c.scene.gravity;
      finalize(model);
      add_robot(cut.scene, "chain", std::make_shared<const Model>(std::move(model)));
      for (int k = 0; k < links / 10; ++k) add_contact(cut.scene, c.scene.contacts[k]);
      SceneData y(cut.scene, bodies);
      ASSERT_EQ(solve(cut.scene, c.q.head(links), c.v.head(links), c.u.head(links), y).status, Status::kOk);
      expect_same(y, links / 10);
    }
    c.q[225] += 0.3, c.v[227] -= 2;
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk);
    expect_same(x, 22);
    EXPECT_NE(x.a.tail(10), a.tail(10));
  }
}

// Returns two branches on one base: links [0, cut) of a chain fixed at every tenth, and the links from there on, in
// either order.
Chain two_branches(const Chain& c, int cut, bool tail_first) {
  const std::vector<Joint>& joints = c.scene.robots[0].model->joints;
  const int links = static_cast<int>(joints.size()), shift = tail_first ? links - cut : 0;
  const auto place = [&](int link) { return (link + shift) % links; };
  Model model;
  model.joints.resize(joints.size());
  Chain out;
  out.scene.gravity = c.scene.gravity;
  out.q.resize(links), out.v.resize(links), out.u.resize(links);
  for (int i = 0; i < links; ++i) {
    Joint& joint = model.joints[place(i)] = joints[i];
    joint.parent = i == 0 || i == cut ? -1 : place(i - 1);
    out.q[place(i)] = c.q[i], out.v[place(i)] = c.v[i], out.u[place(i)] = c.u[i];
  }
  finalize(model);
  add_robot(out.scene, "branches", std::make_shared<const Model>(std::move(model)));
  const int contacts = links / 10, first = tail_first ? cut / 10 : 0;
  for (int k = 0; k < contacts; ++k) {
    Contact contact = c.scene.contacts[(k + first) % contacts];
    contact.A.joint = place(contact.A.joint);
    add_contact(out.scene, contact);
  }
  return out;
}

// Bits do not depend on the batch element either: the same parts are three or seven elements further on. One part hangs
// on the base: it has both branches in their order, and pulls at the first fixed body of each.
TEST(Bodies, PartsHaveTheirOwnBitsInEveryLane) {
  ChainOptions options;
  options.links = 100;
  const int cut = 30, rest = options.links - cut;
  const Chain c = make_chain(options), one = two_branches(c, cut, false), other = two_branches(c, cut, true);
  for (const SimdLevel level : available_simd_levels()) {
    SceneData x(one.scene, {Method::kSparseBodies, {}, level}), y(other.scene, {Method::kSparseBodies, {}, level});
    ASSERT_EQ(solve(one.scene, one.q, one.v, one.u, x).status, Status::kOk);
    ASSERT_EQ(solve(other.scene, other.q, other.v, other.u, y).status, Status::kOk);
    const int n = cut - 10, m = rest - 10;
    EXPECT_EQ(x.a.segment(10, n), y.a.tail(n)) << to_string(level);
    EXPECT_EQ(x.a.tail(m), y.a.segment(10, m)) << to_string(level);
    EXPECT_EQ(x.f.segment(6, 6 * n / 10), y.f.tail(6 * n / 10)) << to_string(level);
    EXPECT_EQ(x.f.tail(6 * m / 10), y.f.segment(6, 6 * m / 10)) << to_string(level);
  }
}

// Products by the recursion, and blocks by panels, are compared with those of sparse-ldl.
TEST(Bodies, DerivativesAgreeWithSparseLdl) {
  std::mt19937 rng(2);
  for (int trial = 0; trial < 30; ++trial) {
    const RandomScene s = trial < 20 ? random_scene(rng, trees(trial % 3 == 2 ? 1e-3 : 0)) : held_scene(rng);
    SceneData x(s.scene, kBodies), y(s.scene, {Method::kSparseLdl, {}});
    if (solve(s.scene, s.q, s.v, s.u, x).status != Status::kOk) continue;
    if (solve(s.scene, s.q, s.v, s.u, y).status != Status::kOk) continue;
    estimate_condition(s.scene, y);
    const double tolerance = 10 * allowed(y.report.condition);
    const VectorXd dq = random_vector(s.scene.nv, rng), dv = random_vector(s.scene.nv, rng),
                   du = random_vector(s.scene.nu, rng), wf = random_vector(static_cast<int>(x.f.size()), rng);
    VectorXd da(s.scene.nv), df(x.f.size()), da2 = da, df2 = df;
    jvp(s.scene, x, dq, dv, du, da, df);
    jvp(s.scene, y, dq, dv, du, da2, df2);
    const auto near = [&](const VectorXd& a, const VectorXd& b, const char* what) {
      ASSERT_TRUE(a.allFinite()) << trial << what;
      if (b.size() > 0) {
        EXPECT_LE((a - b).cwiseAbs().maxCoeff(), tolerance * b.cwiseAbs().maxCoeff()) << trial << what;
      }
    };
    near(da, da2, " jvp a"), near(df, df2, " jvp f");
    VectorXd wq(s.scene.nv), wv = wq, wu(s.scene.nu), wq2 = wq, wv2 = wq, wu2 = wu;
    vjp(s.scene, x, dq, wf, wq, wv, wu);
    vjp(s.scene, y, dq, wf, wq2, wv2, wu2);
    near(wq, wq2, " vjp q"), near(wv, wv2, " vjp v"), near(wu, wu2, " vjp u");
    differentiate(s.scene, x), differentiate(s.scene, y);
    const SceneDerivatives a = dense_derivatives(s.scene, x), b = dense_derivatives(s.scene, y);
    near(a.da_dq.reshaped(), b.da_dq.reshaped(), " da_dq"), near(a.da_dv.reshaped(), b.da_dv.reshaped(), " da_dv");
    near(a.dforces_dq.reshaped(), b.dforces_dq.reshaped(), " df_dq");
    near(a.da_du.reshaped(), b.da_du.reshaped(), " da_du");
  }
}

// dense_size is that of refine_truth
Truth<Quad> truth_of(const Chain& c, int dense_size) {
  SceneData data(c.scene, {Method::kSparseLdl, {}});
  EXPECT_EQ(solve(c.scene, c.q, c.v, c.u, data).status, Status::kOk);
  return refine_truth<Quad>(c.scene, data, c.q.cast<Quad>(), c.v.cast<Quad>(), c.u.cast<Quad>(), dense_size);
}

void expect_within_bounds(const Chain& c, SceneData& x, const Truth<Quad>& truth) {
  estimate_errors(c.scene, x);
  const auto error = [](const VectorXd& of, const VecX<Quad>& right) {  // bounds are no larger
    return static_cast<double>((of.cast<Quad>() - right).cwiseAbs().maxCoeff()) / of.cwiseAbs().maxCoeff();
  };
  EXPECT_LE(error(x.a, truth.a), x.report.error_acceleration);
  EXPECT_LE(error(x.f, truth.f), x.report.error_forces);
}

TEST(Bodies, ChainsAgreeWithQuadruplePrecision) {
  for (const ContactType type : {ContactType::k3D, ContactType::k6D}) {
    ChainOptions options;
    options.links = 200;
    options.type = type;
    const Chain c = make_chain(options);
    const Truth<Quad> truth = truth_of(c, 0);
    ASSERT_TRUE(truth.regular[0]);
    // joint-space K has a condition of 1e10; no row of the bodies' own equations is close to that
    const VectorXd a = truth.a.cast<double>(), f = truth.f.cast<double>();
    std::vector<SimdLevel> levels = available_simd_levels();
    levels.push_back(SimdLevel::kOff);
    for (const SimdLevel level : levels) {
      const Options bodies{Method::kSparseBodies, {}, level};
      SceneData x(c.scene, bodies);
      ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk);
      EXPECT_LE((x.a - a).cwiseAbs().maxCoeff(), 1e-11 * a.cwiseAbs().maxCoeff()) << to_string(level);
      EXPECT_LE((x.f - f).cwiseAbs().maxCoeff(), 1e-11 * f.cwiseAbs().maxCoeff()) << to_string(level);
      expect_within_bounds(c, x, truth);
    }
  }
}

// Bias forces are differences of products as large as the square of the speed; the bounds include their rounding.
TEST(Bodies, BoundsHoldForChainsThatFlyFast) {
  for (const double speed : {1e2, 1e5, 1e8}) {
    ChainOptions options;
    options.links = 30;
    options.held_every = 0;
    options.loop_every = 8;
    options.type = ContactType::k3D;
    options.floating_base = true;
    Chain c = make_chain(options);
    c.v.head<3>() += speed * Vec3<double>(1, -0.7, 0.4);
    SceneData x(c.scene, kBodies);
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk);
    const Truth<Quad> truth = truth_of(c, 100);
    ASSERT_TRUE(truth.regular[0]);
    SCOPED_TRACE(speed);
    expect_within_bounds(c, x, truth);
  }
}

// Returns a chain fixed every so many links, or at none of them with a loop at every sixtieth.
Chain held_or_looped(int links, int held_every) {
  ChainOptions options;
  options.links = links;
  options.held_every = held_every;
  options.loop_every = held_every == 0 ? 60 : 0;
  return make_chain(options);
}

// Bodies leave no J: where the whole K differentiates their solution, its rows are computed again on request.
TEST(Bodies, DerivativesHaveTheSameBoundsAfterProducts) {
  for (const int held_every : {0, 10}) {
    const Chain c = held_or_looped(120, held_every);
    SceneData x(c.scene);
    ASSERT_EQ(chosen_method(x, 0).method, Method::kSparseBodies);
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk);
    (void)differentiate(c.scene, x);
    const DerivativeBounds before = estimate_derivative_errors(c.scene, x).front();
    VectorXd da(c.scene.nv), df(x.f.size());
    jvp(c.scene, x, VectorXd::Ones(c.scene.nv), c.v, c.u, da, df);
    const DerivativeBounds after = estimate_derivative_errors(c.scene, x).front();
    EXPECT_GT(before.da_dq, 0);
    EXPECT_EQ(after.da_dq, before.da_dq) << held_every;
    EXPECT_EQ(after.dforces_dq, before.dforces_dq) << held_every;
    EXPECT_EQ(after.dforces_dv, before.dforces_dv) << held_every;
  }
}

// Fixed bodies cut off what hangs below; they may have no inertia.
TEST(Bodies, HeldBodiesWithoutInertia) {
  for (const ContactType type : {ContactType::k3D, ContactType::k6D}) {
    ChainOptions options;
    options.links = 60;
    options.type = type;
    Chain c = make_chain(options);
    Model model = *c.scene.robots[0].model;
    for (const int i : {9, 29, 39}) model.joints[i].inertia = {};
    c.scene.robots[0].model = std::make_shared<const Model>(std::move(model));
    Both x(c.scene, c.q, c.v, c.u);
    ASSERT_EQ(x.bodies.report.status, Status::kOk);
    EXPECT_EQ(x.bodies.report.islands[0].method, Method::kSparseBodies);
    EXPECT_LE(x.bodies.report.backward_error, 1e-14);
    const Errors e = errors<double>(c.scene, x.bodies, x.dense.a, x.dense.f, conditions(c.scene, x.dense));
    EXPECT_LE(e.excess, 1) << e;
  }
}

TEST(Bodies, LoopsAlongAChain) {
  ChainOptions options;
  options.links = 120;
  options.loop_every = 8;
  options.held_every = 0;
  options.type = ContactType::k3D;
  const Chain c = make_chain(options);
  Both x(c.scene, c.q, c.v, c.u);
  ASSERT_EQ(x.bodies.report.status, Status::kOk);
  EXPECT_EQ(x.bodies.report.islands[0].method, Method::kSparseBodies);
  const Errors e = errors<double>(c.scene, x.bodies, x.dense.a, x.dense.f, conditions(c.scene, x.dense));
  EXPECT_LE(e.excess, 1) << e;
}

TEST(Bodies, AutoTakesThemForDeepTreesAlone) {
  ChainOptions options;
  options.links = 20000;
  const Chain deep = make_chain(options);
  SceneData x(deep.scene);
  ASSERT_EQ(solve(deep.scene, deep.q, deep.v, deep.u, x).status, Status::kOk);
  EXPECT_EQ(chosen_method(x, 0).method, Method::kSparseBodies);
  EXPECT_LE(x.report.backward_error, 1e-14);
  EXPECT_THROW((void)assembled_matrix_of(deep.scene, x, 0), std::logic_error);
  EXPECT_THROW((void)joint_space_inertia(deep.scene, x, 0), std::logic_error);
  EXPECT_THROW(differentiate(deep.scene, x), std::length_error);
  options.links = 6;
  options.held_every = 0;
  const Chain shallow = make_chain(options);
  EXPECT_EQ(chosen_method(SceneData(shallow.scene), 0).method, Method::kSparseLdl);
}

// A point of each leaf of a complete binary tree, on its joint, is constrained along one direction.
Chain binary_tree(int leaves) {
  ChainOptions options;
  options.links = 2 * leaves - 1;
  options.held_every = 0;
  options.floating_base = true;
  Chain c = make_chain(options);
  Model model = *c.scene.robots[0].model;
  for (int i = 1; i < model.njoints(); ++i) model.joints[i].parent = (i - 1) / 2;
  // the order is depth first, as in any model
  std::vector<int> order{0}, place(model.joints.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    for (int child : {2 * order[k] + 2, 2 * order[k] + 1})
      if (child < model.njoints()) order.insert(order.begin() + static_cast<std::ptrdiff_t>(k) + 1, child);
  std::vector<Joint> joints;
  for (int i : order) {
    place[i] = static_cast<int>(joints.size());
    joints.push_back(model.joints[i]);
    if (i > 0) joints.back().parent = place[joints.back().parent];
  }
  model.joints = std::move(joints);
  finalize(model);
  Chain out;
  add_robot(out.scene, "tree", std::make_shared<const Model>(std::move(model)));
  out.q = c.q, out.v = c.v, out.u = c.u;
  for (int i = leaves - 1; i < 2 * leaves - 1; ++i) {
    Contact contact;
    contact.name = "hold" + std::to_string(i);
    contact.type = ContactType::k1D;
    contact.A = {0, place[i], {}};
    contact.axis = Vec3<double>(std::sin(i), std::cos(i), 1).normalized();
    add_contact(out.scene, contact);
  }
  return out;
}

// Few rows are open at a time, however many a tree has.
TEST(Bodies, AutoTakesThemForLargeTreesOfFewOpenRows) {
  for (const auto& [leaves, method] : {std::pair(18, Method::kSparseLdl), std::pair(150, Method::kSparseBodies)}) {
    const Chain c = binary_tree(leaves);
    SceneData x(c.scene);
    EXPECT_EQ(chosen_method(x, 0).method, method) << leaves;
    EXPECT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk) << leaves;
    EXPECT_EQ(x.report.islands[0].method, method) << leaves;
  }
}

// Derivatives come from the whole K, which has all columns at once.
TEST(Bodies, DerivativesAreTheSameWhereAutoTookThem) {
  for (const Chain& c : {binary_tree(150), make_chain({.links = 120, .type = ContactType::k3D})}) {
    SceneData x(c.scene), bodies(c.scene, kBodies);
    for (SceneData* data : {&x, &bodies}) {
      (void)solve(c.scene, c.q, c.v, c.u, *data);
      ASSERT_EQ(data->report.islands[0].method, Method::kSparseBodies);
      (void)differentiate(c.scene, *data);
    }
    EXPECT_NO_THROW((void)assembled_matrix_of(c.scene, x, 0));
    const SceneDerivatives a = dense_derivatives(c.scene, x), b = dense_derivatives(c.scene, bodies);
    EXPECT_LT((a.da_dq - b.da_dq).norm(), 1e-8 * b.da_dq.norm());
    EXPECT_LT((a.da_dv - b.da_dv).norm(), 1e-8 * b.da_dv.norm());
    EXPECT_LT((a.dforces_dq - b.dforces_dq).norm(), 1e-8 * b.dforces_dq.norm());
  }
}

// P stays symmetric along the links, or it would not stay positive.
TEST(Bodies, AnswerTenThousandLinksHeldByFewRows) {
  for (const ContactType type : {ContactType::k1D, ContactType::k3D, ContactType::k6D})
    for (const int held_every : {30, 300, 3000})
      for (const double extent : {0.2, 1.0}) {
        ChainOptions options;
        options.links = 10000;
        options.type = type;
        options.held_every = held_every;
        options.extent = extent;
        const Chain c = make_chain(options);
        SceneData x(c.scene, kBodies);
        EXPECT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk) << held_every << ", " << extent;
        EXPECT_LE(x.report.backward_error, 1e-14) << held_every << ", " << extent;
      }
}

// The world constrains none of the loops: each leaves less of those that are eliminated after it.
TEST(Bodies, AnswerLoopsAlongThousandsOfLinks) {
  for (const int links : {300, 3000})
    for (const int loop_every : {20, 60})
      for (const double extent : {0.2, 1.0}) {
        ChainOptions options;
        options.links = links;
        options.held_every = 0;
        options.loop_every = loop_every;
        options.extent = extent;
        const Chain c = make_chain(options);
        SceneData x(c.scene, kBodies);
        ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kOk) << links << ", " << loop_every;
        EXPECT_EQ(x.report.islands[0].method, Method::kSparseBodies);
        EXPECT_LE(x.report.backward_error, 1e-14);
        if (links > 300) continue;
        SceneData y(c.scene, {Method::kSparseLdl, {}});
        ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, y).status, Status::kOk);
        const Errors e = errors<double>(c.scene, x, y.a, y.f, conditions(c.scene, y));
        EXPECT_LE(e.excess, 1) << loop_every << ", " << extent << ": " << e;
      }
}

// A straight chain is fixed here and there, as a cable at rest: rows along it move nothing or duplicate others.
Chain straight_chain(int links, ContactType type, bool floating_base, bool moving) {
  ChainOptions options;
  options.links = links;
  options.type = type;
  options.floating_base = floating_base;
  Chain c = make_chain(options);
  Model model = *c.scene.robots[0].model;
  for (Joint& joint : model.joints) {
    joint.placement.p.tail<2>().setZero();
    joint.inertia =
        Inertia<double>::from_com(joint.inertia.m, {0.15, 0, 0}, Vec3<double>(0.002, 0.01, 0.011).asDiagonal());
  }
  c.scene.robots[0].model = std::make_shared<const Model>(std::move(model));
  for (Contact& contact : c.scene.contacts) contact.A.placement.p.tail<2>().setZero();
  c.q.tail(c.scene.nq - (floating_base ? 7 : 0)).setZero();
  if (!moving) c.v.setZero();
  return c;
}

void expect_as_oracle(const Chain& c) {
  Both x(c.scene, c.q, c.v, c.u);
  const IslandReport &bodies = x.bodies.report.islands[0], &dense = x.dense.report.islands[0];
  EXPECT_EQ(bodies.method, Method::kSparseBodies);
  EXPECT_EQ(bodies.status, dense.status);
  EXPECT_EQ(bodies.rank, dense.rank);
  EXPECT_EQ(bodies.dependent_rows.size(), static_cast<std::size_t>(dense.nc - dense.rank));
  const Errors e = errors<double>(c.scene, x.bodies, x.dense.a, x.dense.f, conditions(c.scene, x.dense));
  EXPECT_LE(e.excess, 1) << e;
}

TEST(Bodies, StraightChainsAgreeWithTheOracle) {
  for (const ContactType type : {ContactType::k1D, ContactType::k3D, ContactType::k6D})
    for (const bool floating_base : {false, true})
      for (const bool moving : {false, true}) {
        SCOPED_TRACE(to_string(type) + (floating_base ? " floating" : " fixed") + (moving ? " moving" : " at rest"));
        expect_as_oracle(straight_chain(60, type, floating_base, moving));
      }
}

// Links are on a floating base, the last one fixed in 6D and again in 1D, with another gain.
Chain chain_held_twice(int links, double alpha) {
  ChainOptions options;
  options.links = options.held_every = links;
  options.floating_base = true;
  Chain c = make_chain(options);
  Contact again = c.scene.contacts[0];
  again.name = "again";
  again.type = ContactType::k1D;
  again.alpha = alpha;  // the other has none
  add_contact(c.scene, again);
  return c;
}

// Inconsistency of rows is relative to their own terms, and beyond rounding errors of gravity.
TEST(Bodies, ContradictionsUnderLargeGravity) {
  for (const double gravity : {1.0, 4e8, 4e14}) {
    const Status status = gravity < 1e9 ? Status::kInconsistent : Status::kRedundant;
    Chain c = chain_held_twice(1, 3);
    c.scene.gravity = {0, 0, -gravity};
    Both x(c.scene, c.q, c.v, c.u);
    EXPECT_EQ(x.bodies.report.islands[0].method, Method::kSparseBodies);
    EXPECT_EQ(x.dense.report.status, status) << gravity;
    EXPECT_EQ(x.bodies.report.status, status) << gravity;
  }
}

// Accelerations that cancel in a row are still its terms, as in the whole K. They are those of a base that swings fast
// about the body that is fixed twice, and of the joint between them.
TEST(Bodies, ContradictionsBesideAccelerationsThatCancel) {
  Chain c = chain_held_twice(2, 0.1);
  c.v.setZero();
  for (const double gravity : {1.0, 4e8}) {
    c.scene.gravity = {0, 0, -gravity};
    Both x(c.scene, c.q, c.v, c.u);
    EXPECT_EQ(x.bodies.report.islands[0].method, Method::kSparseBodies);
    EXPECT_EQ(x.dense.report.status, gravity > 1 ? Status::kRedundant : Status::kInconsistent);
    EXPECT_EQ(x.bodies.report.status, x.dense.report.status) << gravity;
  }
}

// There are two points where one would do, and a body fixed twice.
TEST(Bodies, RowsOfOneBodyAgreeWithTheOracle) {
  for (const ContactType type : {ContactType::k3D, ContactType::k6D})
    for (const bool straight : {false, true}) {
      ChainOptions options;
      options.links = 60;
      options.type = type;
      Chain c = straight ? straight_chain(60, type, true, false) : make_chain(options);
      c.v.setZero();
      for (const double x : {0.0, 0.1, 0.2}) {
        Contact again = c.scene.contacts[2];
        again.name = "again" + std::to_string(x);
        again.A.placement.p[0] += x;
        add_contact(c.scene, again);
      }
      SCOPED_TRACE(to_string(type) + (straight ? " straight" : ""));
      expect_as_oracle(c);
    }
}

// In a chain fixed along its own line, contact forces and gravity are what changes its momentum. The axial forces share
// the load equally, as those of least norm do.
TEST(Bodies, StraightChainsOfTenThousandLinks) {
  for (const bool floating_base : {false, true}) {
    const Chain c = straight_chain(10000, ContactType::k3D, floating_base, false);
    SceneData x(c.scene);
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, x).status, Status::kRedundant);
    EXPECT_LE(x.report.backward_error, 1e-14);
    EXPECT_EQ(x.report.rank, floating_base ? 2001 : 2000);
    double mass = 0, along = 0, least = INFINITY, most = -INFINITY;
    for (const Joint& joint : c.scene.robots[0].model->joints) mass += joint.inertia.m;
    for (std::size_t k = 0; k < c.scene.contacts.size(); ++k) {
      const double f = x.f[x.f_offset[k]];
      along += f;
      least = std::min(least, f), most = std::max(most, f);
    }
    // Forces along a chain on a wall move nothing; there the least norm has none at all.
    EXPECT_NEAR(along, floating_base ? -mass * c.scene.gravity[0] : 0, 1e-9 * mass);
    EXPECT_NEAR(most, least, 1e-9 * mass);
  }
}

TEST(Bodies, OtherDependentRowsAreLeftToTheLadder) {
  for (const int links : {60, 20000}) {
    ChainOptions options;
    options.links = links;
    Chain c = make_chain(options);
    Contact again;
    again.name = "loop";
    again.type = ContactType::k3D;
    again.A.robot = again.B.robot = 0;
    again.A.joint = 29, again.B.joint = 39;
    add_contact(c.scene, again);
    SceneData x(c.scene, kBodies);
    (void)solve(c.scene, c.q, c.v, c.u, x);
    EXPECT_TRUE(x.report.status == (links < 100 ? Status::kInconsistent : Status::kFailed));
    EXPECT_EQ(x.report.islands[0].reason, Reason::kSmallPivot);
    EXPECT_EQ(x.a.allFinite(), links < 100);
  }
}

// Products for solutions in which sparse-bodies dropped dependent rows come from the whole K, and are NaN where that
// does not fit.
TEST(Bodies, ProductsOfStraightChains) {
  for (const int links : {60, 20000}) {
    const Chain c = straight_chain(links, ContactType::k3D, true, false);
    SceneData bodies(c.scene, kBodies);
    ASSERT_EQ(solve(c.scene, c.q, c.v, c.u, bodies).status, Status::kRedundant);
    std::mt19937 rng(5);
    const VectorXd dq = random_vector(c.scene.nv, rng), dv = random_vector(c.scene.nv, rng),
                   du = random_vector(c.scene.nu, rng);
    VectorXd da(c.scene.nv), df(bodies.f.size());
    jvp(c.scene, bodies, dq, dv, du, da, df);
    if (links > 100) {
      EXPECT_TRUE(da.hasNaN() && df.hasNaN());
      continue;
    }
    // without the dense reference solver: bent, the chain has another rank, and methods share no derivative of forces
    SceneData ldl(c.scene, {Method::kSparseLdl, {}});
    (void)solve(c.scene, c.q, c.v, c.u, ldl);
    VectorXd da_ldl(c.scene.nv), df_ldl(bodies.f.size());
    jvp(c.scene, ldl, dq, dv, du, da_ldl, df_ldl);
    EXPECT_LE((da - da_ldl).norm(), 1e-8 * da_ldl.norm());
    EXPECT_LE((df - df_ldl).norm(), 1e-8 * df_ldl.norm());
  }
}

TEST(Bodies, AllocateNothingInSteadyState) {
#if MANYCONTACT_COUNTS_ALLOCATIONS
  for (const int held_every : {0, 10}) {
    const Chain c = held_or_looped(300, held_every);
    SceneData x(c.scene, kBodies);
    VectorXd a = c.v, f(x.f.size()), q = c.v, v = c.v, u = c.u;
    const auto work = [&] {
      (void)solve(c.scene, c.q, c.v, c.u, x);
      jvp(c.scene, x, c.v, c.v, c.u, a, f);
      vjp(c.scene, x, a, f, q, v, u);
    };
    work();
    ASSERT_EQ(x.report.islands[0].method, Method::kSparseBodies)
        << held_every << ": " << to_string(x.report.islands[0].reason);
    EXPECT_EQ(allocations(work), 0u);
  }
#endif
}

}  // namespace
}  // namespace manycontact::test
