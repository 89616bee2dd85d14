// Robots in SIMD batches have the same bits at every place in a batch, with any neighbours, at every level of
// instructions. Elements that fall out of a batch do so alone.

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <numeric>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/static_torque.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/spatial/explog.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

struct Herd {
  Scene scene;
  VectorXd q, v, u;
};

// Returns `count` robots of one random model, floating or fixed, each in its own state with the same contacts on its
// bodies (to the world and between its bodies).
Herd any_herd(std::mt19937& rng, int count, bool floating, double damping, int njoints) {
  Herd h;
  ModelOptions options;
  options.njoints = njoints;
  options.branching = 0.1;
  options.floating_base = floating;
  options.friction = floating ? 0.5 : 0;
  const auto model = std::make_shared<const Model>(random_model(rng, options));
  std::vector<Contact> contacts;
  for (int k = 0; k < 4; ++k) {
    Contact c;
    c.type = k == 0 ? ContactType::k6D : k == 1 ? ContactType::k3D : k == 2 ? ContactType::k1D : ContactType::k5D;
    c.reference_frame = static_cast<ReferenceFrame>(k % 3);
    c.A = {0, k == 3 ? 6 : 8 + 2 * k, random_placement(rng)};
    if (k == 2) c.B = {0, 2, random_placement(rng)};  // a loop
    c.axis = random_vector(3, rng);
    c.alpha = k == 1 ? 0 : 20;
    c.beta = 7;
    contacts.push_back(c);
  }
  h.scene.damping = damping;
  for (int r = 0; r < count; ++r) add_robot(h.scene, "r" + std::to_string(r), model, random_placement(rng));
  for (int r = 0; r < count; ++r)
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      Contact c = contacts[k];
      c.name = "c" + std::to_string(r) + "_" + std::to_string(k);
      c.A.robot = r;
      if (c.B.robot >= 0)
        c.B.robot = r;
      else
        c.B.placement = random_placement(rng);
      add_contact(h.scene, c);
    }
  h.q.resize(h.scene.nq);
  for (const Robot& r : h.scene.robots) h.q.segment(r.idx_q, model->nq) = random_configuration(*model, rng);
  h.v = random_vector(h.scene.nv, rng);
  h.u = random_vector(h.scene.nu, rng, 5);
  return h;
}

// Returns a herd whose contacts are independent.
Herd random_herd(std::mt19937& rng, int count, bool floating, double damping = 0, int njoints = 14) {
  for (;;) {
    Herd h = any_herd(rng, count, floating, damping, njoints);
    SceneData data(h.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
    if (solve(h.scene, h.q, h.v, h.u, data).status == Status::kOk) return h;
  }
}

// Returns the herd's robots `which`, in that order, as a scene of their own.
Herd part_of(const Herd& h, const std::vector<int>& which) {
  Herd p;
  p.scene.damping = h.scene.damping;
  for (int r : which) add_robot(p.scene, h.scene.robots[r].name, h.scene.robots[r].model, h.scene.robots[r].base);
  for (std::size_t k = 0; k < which.size(); ++k)
    for (Contact contact : h.scene.contacts) {
      if (contact.A.robot != which[k]) continue;
      const Vec3<double> axis = contact.axis;
      contact.A.robot = static_cast<int>(k);
      if (contact.B.robot >= 0) contact.B.robot = static_cast<int>(k);
      const int number = add_contact(p.scene, contact);
      p.scene.contacts[number].axis = axis;  // not normalised twice
    }
  p.q.resize(p.scene.nq), p.v.resize(p.scene.nv), p.u.resize(p.scene.nu);
  for (std::size_t k = 0; k < which.size(); ++k) {
    const Robot &from = h.scene.robots[which[k]], &to = p.scene.robots[k];
    const Model& model = *from.model;
    p.q.segment(to.idx_q, model.nq) = h.q.segment(from.idx_q, model.nq);
    p.v.segment(to.idx_v, model.nv) = h.v.segment(from.idx_v, model.nv);
    p.u.segment(to.idx_u, model.nu()) = h.u.segment(from.idx_u, model.nu());
  }
  return p;
}

// Returns the same herd with separate numbers for each robot: masses, placements, armatures, friction, and contact
// placements.
Herd of_own_numbers(Herd h, std::mt19937& rng) {
  std::uniform_real_distribution<double> by(0.95, 1.05);
  Scene scene;
  scene.damping = h.scene.damping;
  for (const Robot& robot : h.scene.robots) {
    auto model = std::make_shared<Model>(*robot.model);
    for (Joint& joint : model->joints) {
      const double mass = by(rng);
      joint.inertia.m *= mass, joint.inertia.h *= mass, joint.inertia.I *= mass;
      joint.placement.p *= by(rng);
      if (joint.placement_rotates)
        joint.placement.R = joint.placement.R * exp3(Vec3<double>(0.05 * random_vector(3, rng)));
    }
    for (Eigen::VectorXd* x : {&model->armature, &model->damping, &model->friction}) *x *= by(rng);
    finalize(*model);
    add_robot(scene, robot.name, model, robot.base);
  }
  for (Contact contact : h.scene.contacts) {
    contact.A.placement.p *= by(rng);
    if (contact.B.robot >= 0) contact.B.placement.p *= by(rng);
    const Vec3<double> axis = contact.axis;
    const int number = add_contact(scene, contact);
    scene.contacts[number].axis = axis;  // not normalised twice
  }
  h.scene = std::move(scene);
  return h;
}

struct Answer {
  VectorXd a, f;
  std::vector<IslandDerivatives::Panel> X;
  Report report;
};
Answer answer(const Herd& h, SimdLevel lanes) {
  SceneData data(h.scene, {Method::kSparseLdl, {}, lanes});
  (void)solve(h.scene, h.q, h.v, h.u, data);
  differentiate(h.scene, data);
  Answer out{data.a, data.f, {}, data.report};
  for (const IslandDerivatives& island : derivatives(data).islands) out.X.push_back(island.X);
  return out;
}

bool same(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  return ((x.array() == y.array()) || (x.array().isNaN() && y.array().isNaN())).all();
}

// Expects that robot `number` of x has the same bits as robot 0 of y.
void expect_same(const Herd& h, const Answer& x, int number, const Answer& y) {
  const int nv = h.scene.robots[0].model->nv;
  const Eigen::Index nf = y.f.size();
  EXPECT_TRUE(same(x.a.segment(number * nv, nv), y.a)) << number;
  EXPECT_TRUE(same(x.f.segment(number * nf, nf), y.f)) << number;
  EXPECT_TRUE(same(x.X[number], y.X[0])) << number;
  EXPECT_EQ(x.report.islands[number].status, y.report.islands[0].status) << number;
  EXPECT_EQ(x.report.islands[number].backward_error, y.report.islands[0].backward_error) << number;
}

class InLanes : public testing::TestWithParam<SimdLevel> {};

TEST_P(InLanes, ARobotsBitsAreItsOwn) {
  std::mt19937 rng(11);
  for (const bool floating : {true, false})
    for (const double damping : {0.0, 1e-3}) {
      const Herd herd = random_herd(rng, 19, floating, damping);
      const Answer all = answer(herd, GetParam());
      ASSERT_EQ(all.report.status, Status::kOk);
      std::vector<int> backwards;
      for (int r = 18; r >= 0; --r) backwards.push_back(r);
      const Answer reversed = answer(part_of(herd, backwards), GetParam());
      for (int r = 0; r < 19; ++r) {
        const Answer alone = answer(part_of(herd, {r}), GetParam());
        expect_same(herd, all, r, alone);
        expect_same(herd, reversed, 18 - r, alone);
      }
    }
}

// The panels of large robots in a batch are solved one band of columns after the other: the bits are the same.
TEST_P(InLanes, PanelsOfLargeRobots) {
  std::mt19937 rng(17);
  const Herd herd = random_herd(rng, 9, true, 0, 150);
  SceneData data(herd.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
  (void)solve(herd.scene, herd.q, herd.v, herd.u, data);
  estimate_condition(herd.scene, data);
  const Answer all = answer(herd, GetParam()), off = answer(herd, SimdLevel::kOff);
  ASSERT_EQ(all.report.status, Status::kOk);
  ASSERT_GT(2 * 8 * all.X.front().size(), 1 << 19);  // kBand
  for (const int r : {0, 1, 7, 8}) {
    expect_same(herd, all, r, answer(part_of(herd, {r}), GetParam()));
    const double allowed = std::max(1e-12, 100 * 2.2e-16 * data.report.islands[r].condition);
    EXPECT_LE((all.X[r] - off.X[r]).norm(), 10 * allowed * off.X[r].norm());
  }
}

// So many are written past the caches (kCacheBytes), with the same bits.
TEST_P(InLanes, MoreDerivativesThanCachesHold) {
  std::mt19937 rng(15);
  constexpr int kCount = 339;
  const Herd herd = random_herd(rng, kCount, true, 1e-3);
  const Answer all = answer(herd, GetParam());
  ASSERT_GT(8.0 * kCount * all.X.front().size(), 5 << 20);
  for (const int r : {0, 1, 70, 336, 337, 338}) expect_same(herd, all, r, answer(part_of(herd, {r}), GetParam()));
}

// Panels of humanoids at rest are refined, element by element of a batch; those of the others, in motion, are not.
TEST_P(InLanes, MoreDerivativesThanCachesHoldOfSomeThatAreRefined) {
  std::mt19937 rng(16);
  const std::string herd = "base=\"floating\" copies=\"131\" arrange=\"grid\" spacing=\"2\"";
  const SceneFile rest = load_edited(kModels + "humanoid_standing.xml", {{"base=\"floating\"", herd}});
  SceneFile moved = rest;
  disturb(moved, rng);
  Herd some{rest.scene, moved.q, moved.v, moved.u};
  for (int r = 1; r < 131; r += 3) {
    const Robot& robot = rest.scene.robots[r];
    some.q.segment(robot.idx_q, robot.model->nq) = rest.q.segment(robot.idx_q, robot.model->nq);
    some.v.segment(robot.idx_v, robot.model->nv).setZero();
  }
  std::vector<int> every(131);
  std::iota(every.begin(), every.end(), 0);
  const Herd mixed = part_of(some, every);  // contacts are ordered robot by robot
  const Answer all = answer(mixed, GetParam());
  ASSERT_GT(8.0 * 131 * all.X.front().size(), 5 << 20);
  for (const int r : {0, 1, 2, 3, 60, 61, 62, 63, 64, 65, 127, 128, 129, 130})
    expect_same(mixed, all, r, answer(part_of(some, {r}), GetParam()));
}

// At rest, in a symmetric configuration, many accelerations are rounding error: refinement changes them completely, and
// those of the other robots only a little.
TEST_P(InLanes, AtRestBesideOthersInMotionToo) {
  std::mt19937 rng(14);
  const SceneFile rest =
      load_edited(kModels + "humanoid_standing.xml",
                  {{"base=\"floating\"", "base=\"floating\" copies=\"9\" arrange=\"grid\" spacing=\"2\""}});
  SceneFile moved = rest;
  disturb(moved, rng);
  Herd some{rest.scene, rest.q, rest.v, rest.u};
  for (int r = 0; r < 9; r += 2) {
    const Robot& robot = rest.scene.robots[r];
    const Model& model = *robot.model;
    some.q.segment(robot.idx_q, model.nq) = moved.q.segment(robot.idx_q, model.nq);
    some.v.segment(robot.idx_v, model.nv) = moved.v.segment(robot.idx_v, model.nv);
    some.u.segment(robot.idx_u, model.nu()) = moved.u.segment(robot.idx_u, model.nu());
  }
  const Herd herd = part_of(some, {0, 1, 2, 3, 4, 5, 6, 7, 8});  // contacts are ordered robot by robot
  const Answer all = answer(herd, GetParam());
  for (int r = 0; r < 9; ++r) expect_same(herd, all, r, answer(part_of(herd, {r}), GetParam()));
}

TEST_P(InLanes, LevelsAgreeToRounding) {
  std::mt19937 rng(12);
  for (int k = 0; k < 6; ++k) {
    const Herd herd = random_herd(rng, 9, k % 2, k < 3 ? 0 : 1e-4);
    SceneData data(herd.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
    (void)solve(herd.scene, herd.q, herd.v, herd.u, data);
    estimate_condition(herd.scene, data);
    const Answer off = answer(herd, SimdLevel::kOff), on = answer(herd, GetParam());
    const int nv = herd.scene.robots[0].model->nv;
    for (int r = 0; r < 9; ++r) {
      const double allowed = std::max(1e-12, 100 * 2.2e-16 * data.report.islands[r].condition);
      const VectorXd a = off.a.segment(r * nv, nv);
      EXPECT_LE((on.a.segment(r * nv, nv) - a).lpNorm<Eigen::Infinity>(), allowed * a.lpNorm<Eigen::Infinity>());
      EXPECT_LE((on.X[r] - off.X[r]).lpNorm<Eigen::Infinity>(), 10 * allowed * off.X[r].lpNorm<Eigen::Infinity>());
      EXPECT_EQ(on.report.islands[r].rank, off.report.islands[r].rank);
      EXPECT_EQ(on.report.islands[r].factor_nonzeros, off.report.islands[r].factor_nonzeros);
      EXPECT_LE(on.report.islands[r].residual_dynamics, 1e-14);
      EXPECT_LE(on.report.islands[r].residual_contact, 1e-14);
    }
  }
}

// One element of a batch falls out, for several reasons; the others' bits stay.
TEST_P(InLanes, ALaneFallsOutAlone) {
  std::mt19937 rng(13);
  Herd herd = random_herd(rng, 11, true);
  const Model& model = *herd.scene.robots[0].model;
  int angle = -1;
  for (const Joint& joint : model.joints)
    if (joint.type == JointType::kRevolute) angle = joint.idx_q;
  ASSERT_GE(angle, 0);
  const Answer before = answer(herd, GetParam());
  const auto at = [&](int r) -> Eigen::Ref<VectorXd> { return herd.q.segment(herd.scene.robots[r].idx_q, model.nq); };
  at(2)[angle] = kNaN;
  at(4)[3] = 7;                                          // not a unit quaternion
  at(5)[angle] = std::remainder(at(5)[angle], 1) + 3e7;  // an angle beyond the range of SIMD batches
  herd.v[herd.scene.robots[7].idx_v] = 1e200;            // overflows
  herd.u[herd.scene.robots[9].idx_u] = std::numeric_limits<double>::infinity();
  const Answer after = answer(herd, GetParam());
  const Answer off = answer(herd, SimdLevel::kOff);
  const int nv = model.nv;
  for (int r = 0; r < 11; ++r) {
    if (r == 2 || r == 4 || r == 5 || r == 7 || r == 9) {
      EXPECT_EQ(after.report.islands[r].status, off.report.islands[r].status) << r;
      EXPECT_EQ(after.report.islands[r].reason, off.report.islands[r].reason) << r;
      EXPECT_TRUE(same(after.a.segment(r * nv, nv), off.a.segment(r * nv, nv))) << r;
      EXPECT_TRUE(same(after.X[r], off.X[r])) << r;
    } else {
      EXPECT_TRUE(same(after.a.segment(r * nv, nv), before.a.segment(r * nv, nv))) << r;
      EXPECT_TRUE(same(after.X[r], before.X[r])) << r;
    }
  }
  EXPECT_EQ(after.report.islands[5].status, Status::kOk);
  EXPECT_EQ(after.report.islands[2].reason, Reason::kNotFinite);
  EXPECT_EQ(after.report.islands[4].reason, Reason::kBadQuaternion);
}

// The contacts of one robot are dependent in its configuration only; the dependency vanishes again.
TEST_P(InLanes, DependentRowsOfOneRobotAreItsOwn) {
  std::mt19937 rng(14);
  const auto model = [&] {
    ModelOptions options;
    options.njoints = 8;
    options.types = {JointType::kRevolute};
    options.branching = 0;
    return std::make_shared<const Model>(random_model(rng, options));
  }();
  Herd h;
  for (int r = 0; r < 6; ++r) {
    add_robot(h.scene, "r" + std::to_string(r), model);
    for (int k = 0; k < 2; ++k) {
      Contact c;
      c.name = "c" + std::to_string(2 * r + k);
      c.type = ContactType::k1D;
      c.A = {r, 7, {Mat3<double>::Identity(), {0, 0, 0.1 * k}}};
      c.reference_frame = ReferenceFrame::kWorld;
      add_contact(h.scene, c);
    }
  }
  h.q.resize(h.scene.nq);
  for (const Robot& r : h.scene.robots) h.q.segment(r.idx_q, model->nq) = random_configuration(*model, rng);
  h.v = random_vector(h.scene.nv, rng);
  h.u = random_vector(h.scene.nu, rng);
  const Answer before = answer(h, GetParam());
  EXPECT_EQ(before.report.status, Status::kOk);
  SceneData data(h.scene, {Method::kSparseLdl, {}, GetParam()});
  // The points move along one line when both contacts are at the same point. Placements of A may not change, so the
  // scene is made again with robot 3's second contact at the first one's point.
  Herd twice = h;
  twice.scene.contacts[7].A.placement = twice.scene.contacts[6].A.placement;
  const Answer on = answer(twice, GetParam()), off = answer(twice, SimdLevel::kOff);
  EXPECT_EQ(on.report.islands[3].rank, 1);
  EXPECT_EQ(on.report.islands[3].dependent_rows, off.report.islands[3].dependent_rows);
  EXPECT_LT((on.a.segment(24, 8) - off.a.segment(24, 8)).norm(), 1e-12 * off.a.segment(24, 8).norm());
  EXPECT_LT((on.X[3] - off.X[3]).norm(), 1e-11 * off.X[3].norm());
  for (int r : {0, 1, 2, 4, 5}) EXPECT_TRUE(same(on.X[r], before.X[r])) << r;
}

TEST_P(InLanes, TermsAreEvaluatedForWhoReadsThem) {
  std::mt19937 rng(15);
  const Herd h = random_herd(rng, 3, true);
  SceneData data(h.scene, {Method::kSparseLdl, {}, GetParam()}),
      off(h.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
  (void)solve(h.scene, h.q, h.v, h.u, data);
  (void)solve(h.scene, h.q, h.v, h.u, off);
  const VectorXd a = data.a;
  Scene other = h.scene;
  other.robots[0].model = std::make_shared<const Model>(*other.robots[0].model);
  EXPECT_THROW((void)robot_kinematics(other, data, 0), std::invalid_argument);
  const Kinematics<double>& kin = robot_kinematics(h.scene, data, 0);
  EXPECT_EQ(&robot_kinematics(h.scene, data, 0), &kin);
  StaticTorque at_rest(h.scene), at_rest_off(h.scene);
  static_torque(h.scene, data, h.q.data(), true, at_rest);
  static_torque(h.scene, off, h.q.data(), true, at_rest_off);
  EXPECT_LT((at_rest.tau - at_rest_off.tau).norm(), 1e-11 * at_rest_off.tau.norm());
  for (int r = 0; r < 3; ++r) {
    EXPECT_TRUE(same(robot_kinematics(h.scene, data, r).J, robot_kinematics(h.scene, off, r).J));
    EXPECT_EQ(assembled_matrix_of(h.scene, data, r).values, assembled_matrix_of(h.scene, off, r).values);
    const Eigen::MatrixXd K = kkt_matrix(h.scene, data, r);
    EXPECT_TRUE(same(K, K.transpose()));
    const Model& model = *h.scene.robots[r].model;
    for (int i = 0; i < model.nv; ++i) EXPECT_EQ(K(i, i), joint_space_inertia(h.scene, data, r)[model.M_begin[i]]);
    const Island& island = solved_island(data, r);
    for (std::size_t c = 0; c < island.contacts.size(); ++c) {
      const Eigen::MatrixXd& J = contact_data(h.scene, data, island.contacts[c]).J;
      const std::vector<int>& columns = contact_support(h.scene, data, island.contacts[c]).a;
      for (std::size_t k = 0; k < columns.size(); ++k)
        EXPECT_TRUE(same(K.col(columns[k]).segment(island.nv + island.row_offset[c], J.rows()), J.col(k)));
    }
  }
  EXPECT_TRUE(same(data.a, a));
  const Eigen::MatrixXd X = differentiate(h.scene, data).islands[0].X;
  (void)solve(h.scene, h.q, h.v, h.u, data);
  EXPECT_TRUE(same(X, differentiate(h.scene, data).islands[0].X));  // whether terms were read or not
  EXPECT_THROW((void)contact_at_solution(data, 0), std::logic_error);
}

double heap() {
  const auto m = mallinfo2();
  return static_cast<double>(m.uordblks + m.hblkhd);
}

// A wall of boxes is coupled to its neighbours: what SIMD batches do not need, K above all, is not made.
TEST_P(InLanes, JoinedBoxesTakeLittleMemory) {
  constexpr int n = 40;
  Model model;
  model.name = "box";
  model.floating_base = true;
  model.joints.resize(1);
  model.joints[0].type = JointType::kFloating;
  model.joints[0].inertia = Inertia<double>::from_com(6.4, {0, 0, 0.02}, Vec3<double>(0.17, 0.19, 0.2).asDiagonal());
  for (VectorXd* x :
       {&model.joints[0].lower, &model.joints[0].upper, &model.joints[0].velocity_limit, &model.joints[0].effort_limit})
    x->setConstant(6, INFINITY);
  finalize(model);
  const auto box = std::make_shared<const Model>(std::move(model));
  Scene scene;
  for (int i = 0; i < n * n; ++i) add_robot(scene, "box" + std::to_string(i), box);
  VectorXd q(scene.nq);
  for (int i = 0; i < n * n; ++i) q.segment<7>(7 * i) << 0.5 * (i % n), 0, 0.5 * (i / n), 0, 0, 0, 1;
  const auto join = [&scene](int a, int b, const Vec3<double>& at, const Vec3<double>& axis) {
    Contact c;
    c.name = "join" + std::to_string(scene.contacts.size());
    c.type = ContactType::k1D;
    c.A = {a, 0, {Mat3<double>::Identity(), at}};
    c.B = {b, 0, {Mat3<double>::Identity(), at - Vec3<double>(a + 1 == b ? 0.5 : 0, 0, a + 1 == b ? 0 : 0.5)}};
    c.axis = axis.normalized();
    add_contact(scene, c);
  };
  for (int i = 0; i < n * n; ++i) {
    if (i % n + 1 < n) join(i, i + 1, {0.25, 0, 0.02 * (i % 3)}, {0.3, 1, 0.2});
    if (i + n < n * n) join(i, i + n, {0.02 * (i % 5), 0, 0.25}, {0, 0, 1});
  }
  const double before = heap();
  SceneData data(scene, Options{Method::kAuto, {}, GetParam()});
  const VectorXd zero = VectorXd::Zero(scene.nv);
  EXPECT_EQ(solve(scene, q, zero, VectorXd::Zero(scene.nu), data).status, Status::kOk);
  EXPECT_LE((heap() - before) / (n * n), 13000);
  EXPECT_NO_THROW((void)contact_support(scene, data, 0));
}

TEST_P(InLanes, DerivativesOfWhatWasAskedFor) {
  std::mt19937 rng(16);
  const Herd h = random_herd(rng, 5, true);
  SceneData data(h.scene, {Method::kSparseLdl, {}, GetParam()});
  (void)solve(h.scene, h.q, h.v, h.u, data);
  const auto all = dense_derivatives(h.scene, (differentiate(h.scene, data, {.tau = true}), data));
  for (int k = 0; k < 7; ++k) {
    const DerivativeRequest request{.q = bool(k & 1), .v = bool(k & 2), .u = bool(k & 4), .tau = true};
    const auto some = dense_derivatives(h.scene, (differentiate(h.scene, data, request), data));
    EXPECT_TRUE(!request.q || same(some.da_dq, all.da_dq));
    EXPECT_TRUE(!request.v || same(some.da_dv, all.da_dv));
    EXPECT_TRUE(!request.u || same(some.da_du, all.da_du));
    EXPECT_TRUE(!request.u || same(some.dforces_du, all.dforces_du));
  }
}

// ---- robots of one island are blocks of SIMD batches; if an order is requested, the whole K is factorized -------

Contact holding(std::mt19937& rng) {
  Contact c;
  c.type = ContactType::k3D;
  c.A = {0, 12, random_placement(rng)};
  c.B = {0, 6, random_placement(rng)};
  c.alpha = 30, c.beta = 4;
  return c;
}
void join(Herd& h, int A, int B, Contact like) {
  like.name = "hold" + std::to_string(A);
  like.A.robot = A;
  like.B.robot = B;
  add_contact(h.scene, like);
}
Herd joined_in_a_ring(Herd h, const Contact& like) {
  const int count = h.scene.nrobots();
  for (int r = 0; r < count; ++r) join(h, r, (r + 1) % count, like);
  return h;
}

void expect_same_contact(const ContactData<double>& x, const ContactData<double>& y) {
  EXPECT_TRUE(same(x.J, y.J));
  EXPECT_TRUE(same(x.Jl, y.Jl));
  EXPECT_TRUE(same(x.W, y.W));
  EXPECT_TRUE(same(x.a0, y.a0));
  EXPECT_TRUE(same(x.aMA.R, y.aMA.R) && same(x.bMA.p, y.bMA.p) && same(x.G.R, y.G.R) && same(x.x, y.x));
  EXPECT_TRUE(same(x.vA, y.vA) && same(x.vB, y.vB) && same(x.aA, y.aA) && same(x.aB, y.aB));
}
void expect_same_terms(const Scene& of_x, const SceneData& x, int r, const Scene& of_y, const SceneData& y, int s) {
  const Kinematics<double>&a = robot_kinematics(of_x, x, r), &b = robot_kinematics(of_y, y, s);
  EXPECT_TRUE(same(a.J, b.J) && same(a.origin(0), b.origin(0)) && same(a.a_base, b.a_base));
  for (std::size_t i = 0; i < a.oMi.size(); ++i) {
    EXPECT_TRUE(same(a.oMi[i].R, b.oMi[i].R) && same(a.oMi[i].p, b.oMi[i].p)) << i;
    EXPECT_TRUE(same(a.v[i], b.v[i]) && same(a.a[i], b.a[i])) << i;
    EXPECT_TRUE(same(a.Y[i].matrix(), b.Y[i].matrix())) << i;
    EXPECT_TRUE(same(composite_inertias(of_x, x, r)[i].matrix(), composite_inertias(of_y, y, s)[i].matrix())) << i;
  }
  EXPECT_TRUE(std::ranges::equal(joint_space_inertia(of_x, x, r), joint_space_inertia(of_y, y, s)));
  EXPECT_TRUE(same(bias_torques(of_x, x, r), bias_torques(of_y, y, s)));
}

TEST_P(InLanes, InAnIslandARobotsTermsAreItsOwn) {
  std::mt19937 rng(17);
  for (const bool floating : {true, false}) {
    const Herd herd = random_herd(rng, 11, floating, 1e-3);
    const Contact like = holding(rng);
    const Herd ring = joined_in_a_ring(herd, like);
    const Options options{Method::kSparseLdl, Order::kLeafToRoot, GetParam()};
    SceneData data(ring.scene, options);
    ASSERT_EQ(solve(ring.scene, ring.q, ring.v, ring.u, data).status, Status::kOk);
    ASSERT_EQ(island_count(data), 1u);
    ModelOptions small;
    small.njoints = 2;
    const auto other = std::make_shared<const Model>(random_model(rng, small));
    for (int r = 0; r < 11; ++r) {
      SCOPED_TRACE(r);
      Herd two = part_of(herd, {r, (r + 1) % 11});
      join(two, 0, 1, like);
      SceneData of_two(two.scene, options);
      (void)solve(two.scene, two.q, two.v, two.u, of_two);
      for (int k = 0; k < 2; ++k) expect_same_terms(ring.scene, data, (r + k) % 11, two.scene, of_two, k);
      for (int k = 0; k < 4; ++k)
        expect_same_contact(contact_data(ring.scene, data, 4 * r + k), contact_data(two.scene, of_two, k));
      expect_same_contact(contact_data(ring.scene, data, 44 + r), contact_data(two.scene, of_two, 8));

      Herd alone = part_of(herd, {r});  // next to one of another model
      add_robot(alone.scene, "other", other);
      VectorXd q(alone.scene.nq), v = VectorXd::Zero(alone.scene.nv), u = VectorXd::Zero(alone.scene.nu);
      q << alone.q, neutral(*other);
      v.head(alone.v.size()) = alone.v;
      Contact to_other = like;
      to_other.B.joint = 1;
      join(alone, 0, 1, to_other);
      SceneData of_one(alone.scene, options);
      (void)solve(alone.scene, q, v, u, of_one);
      ASSERT_EQ(island_count(of_one), 1u);
      expect_same_terms(ring.scene, data, r, alone.scene, of_one, 0);
      for (int k = 0; k < 4; ++k)
        expect_same_contact(contact_data(ring.scene, data, 4 * r + k), contact_data(alone.scene, of_one, k));
    }
  }
}

TEST_P(InLanes, InAnIslandLevelsAgreeToRounding) {
  std::mt19937 rng(18);
  for (int k = 0; k < 4; ++k) {
    Herd ring = joined_in_a_ring(random_herd(rng, 5, k % 2, k < 2 ? 0 : 1e-3), holding(rng));
    ring.scene.contacts[3].alpha = 2;  // one differs from the others
    SceneData data(ring.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
    if (solve(ring.scene, ring.q, ring.v, ring.u, data).status != Status::kOk) continue;
    estimate_condition(ring.scene, data);
    const Answer off = answer(ring, SimdLevel::kOff), on = answer(ring, GetParam());
    const double allowed = std::max(1e-12, 100 * 2.2e-16 * data.report.islands[0].condition);
    EXPECT_LE((on.a - off.a).lpNorm<Eigen::Infinity>(), allowed * off.a.lpNorm<Eigen::Infinity>());
    EXPECT_LE((on.f - off.f).lpNorm<Eigen::Infinity>(), allowed * off.f.lpNorm<Eigen::Infinity>());
    EXPECT_LE((on.X[0] - off.X[0]).lpNorm<Eigen::Infinity>(), 10 * allowed * off.X[0].lpNorm<Eigen::Infinity>());
    EXPECT_FALSE(same(on.X[0], off.X[0])) << "not in lanes";
  }
}

// Robots of one structure share a SIMD batch whatever their numbers are. They have the bits that each has alone, and
// the derivatives and products without SIMD batches.
TEST_P(InLanes, RobotsOfOwnNumbersToo) {
  std::mt19937 rng(12);
  for (const bool floating : {true, false})
    for (const double damping : {0.0, 1e-3}) {
      const Herd alike = random_herd(rng, 11, floating, damping), herd = of_own_numbers(alike, rng);
      for (const Robot& robot : herd.scene.robots) {
        EXPECT_NE(robot.model, alike.scene.robots[0].model);
        EXPECT_EQ(robot.model->structure, alike.scene.robots[0].model->structure);
      }
      const Answer all = answer(herd, GetParam()), off = answer(herd, SimdLevel::kOff);
      ASSERT_EQ(off.report.status, Status::kOk);
      const auto expect_near = [](const auto& x, const auto& y) {
        EXPECT_LE((x - y).template lpNorm<Eigen::Infinity>(), 1e-8 * y.template lpNorm<Eigen::Infinity>());
      };
      expect_near(all.a, off.a), expect_near(all.f, off.f);
      for (int r = 0; r < 11; ++r) {
        expect_same(herd, all, r, answer(part_of(herd, {r}), GetParam()));
        expect_near(all.X[r], off.X[r]);
      }
      const VectorXd d = random_vector(herd.scene.nv, rng), du = random_vector(herd.scene.nu, rng);
      const auto tangents = [&](SimdLevel lanes) {
        SceneData data(herd.scene, {Method::kSparseLdl, {}, lanes});
        (void)solve(herd.scene, herd.q, herd.v, herd.u, data);
        VectorXd da(data.a.size()), df(data.f.size());
        jvp(herd.scene, data, d, d, du, da, df);
        VectorXd out(da.size() + df.size());
        out << da, df;
        return out;
      };
      expect_near(tangents(GetParam()), tangents(SimdLevel::kOff));

      const Contact like = holding(rng);
      const Answer ring = answer(joined_in_a_ring(herd, like), GetParam());
      const Answer without = answer(joined_in_a_ring(herd, like), SimdLevel::kOff);
      expect_near(ring.a, without.a), expect_near(ring.f, without.f), expect_near(ring.X[0], without.X[0]);
    }
}

// An angle is too large for SIMD batches, or a state is not finite: that robot's terms are those without batches.
TEST_P(InLanes, InAnIslandALaneFallsOutAlone) {
  std::mt19937 rng(19);
  Herd ring = joined_in_a_ring(random_herd(rng, 11, true, 1e-3), holding(rng));
  const Model& model = *ring.scene.robots[0].model;
  int angle = -1;
  for (const Joint& joint : model.joints)
    if (joint.type == JointType::kRevolute) angle = joint.idx_q;
  ASSERT_GE(angle, 0);
  const Options on{Method::kSparseLdl, Order::kLeafToRoot, GetParam()};
  SceneData before(ring.scene, on), after(ring.scene, on),
      off(ring.scene, {Method::kSparseLdl, Order::kLeafToRoot, SimdLevel::kOff});
  (void)solve(ring.scene, ring.q, ring.v, ring.u, before);
  double& at = ring.q[ring.scene.robots[5].idx_q + angle];
  at = std::remainder(at, 1) + 3e7;
  EXPECT_EQ(solve(ring.scene, ring.q, ring.v, ring.u, after).status, Status::kOk);
  (void)solve(ring.scene, ring.q, ring.v, ring.u, off);
  for (int r = 0; r < 11; ++r) expect_same_terms(ring.scene, after, r, ring.scene, r == 5 ? off : before, r);
  at = kNaN;
  EXPECT_EQ(solve(ring.scene, ring.q, ring.v, ring.u, after).status, Status::kFailed);
  EXPECT_EQ(after.report.islands[0].reason, Reason::kNotFinite);
}

// Robots coupled by springs alone are solved as blocks without a border, as single robots are: neither is mistaken for
// the other.
TEST_P(InLanes, RobotsJoinedBySpringsLeaveOthersAsTheyAre) {
  std::mt19937 rng(19);
  for (const bool floating : {true, false})
    for (const int joined : {2, 3, 5})
      for (const int alone : {1, 2, 3}) {
        Herd herd = random_herd(rng, joined + alone, floating);
        const Answer bare = answer(herd, GetParam());
        for (int r = 1; r < joined; ++r)
          add_spring(herd.scene, {"s" + std::to_string(r), {r - 1, 7, {}}, {r, 7, {}}, 100, 0.3, 1});
        const Answer on = answer(herd, GetParam()), off = answer(herd, SimdLevel::kOff);
        ASSERT_EQ(on.report.islands.size(), 1u + alone);
        EXPECT_LE((on.X[0] - off.X[0]).lpNorm<Eigen::Infinity>(), 1e-8 * off.X[0].lpNorm<Eigen::Infinity>());
        for (int k = 1; k <= alone; ++k) EXPECT_TRUE(same(on.X[k], bare.X[joined + k - 1])) << k << " of " << alone;

        const int nv = herd.scene.nv, nu = herd.scene.nu;
        SceneData data(herd.scene, {Method::kSparseLdl, {}, GetParam()});
        (void)solve(herd.scene, herd.q, herd.v, herd.u, data);
        const int nf = static_cast<int>(data.f.size());
        const VectorXd x = random_vector(2 * nv + nu, rng), y = random_vector(nv + nf, rng);
        VectorXd Jx(nv + nf), yJ(2 * nv + nu);
        jvp(herd.scene, data, x.head(nv), x.segment(nv, nv), x.tail(nu), Jx.head(nv), Jx.tail(nf));
        vjp(herd.scene, data, y.head(nv), y.tail(nf), yJ.head(nv), yJ.segment(nv, nv), yJ.tail(nu));
        SceneData other(herd.scene, {Method::kSparseLdl, {}, SimdLevel::kOff});
        (void)solve(herd.scene, herd.q, herd.v, herd.u, other);
        differentiate(herd.scene, other);
        const Eigen::MatrixXd J(sparse_derivatives(herd.scene, other));
        EXPECT_LE((Jx - J * x).lpNorm<Eigen::Infinity>(), 1e-8 * (J.cwiseAbs() * x.cwiseAbs()).maxCoeff());
        EXPECT_LE((yJ - J.transpose() * y).lpNorm<Eigen::Infinity>(),
                  1e-8 * (J.cwiseAbs().transpose() * y.cwiseAbs()).maxCoeff());
      }
}

INSTANTIATE_TEST_SUITE_P(Levels, InLanes, testing::ValuesIn(available_simd_levels()),
                         [](const auto& level) { return to_string(level.param); });

}  // namespace
}  // namespace manycontact::test
