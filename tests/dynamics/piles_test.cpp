// Many bodies have redundant contacts. The dense reference solver is used only on request; the solutions agree with it.

#include "support/piles.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/allocations.hpp"
#include "support/folder.hpp"
#include "support/workspace.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

double relative(const VectorXd& x, const VectorXd& truth, double least = 0) {
  return (x - truth).cwiseAbs().maxCoeff() / std::max(truth.cwiseAbs().maxCoeff(), least);
}

struct Case {
  std::string name;
  Pile pile;
};
// Each case has more than 300 rows of J. In motion contacts of loops are inconsistent.
Case case_of(int number, double speed = 0.1) {
  switch (number) {
    case 0:
      return {"tower", tower(60, speed)};
    case 1:
      return {"pyramid", pyramid(8, speed)};
    case 2:
      return {"wall", grid(8, ContactType::k3D, true, speed)};
    case 3:
      return {"grid", grid(6, ContactType::k6D, false, speed)};
    case 4:
      return {"hub", hub(7, speed)};
    case 5:
      return {"uneven", uneven_wall(8, speed)};
    default:
      return {"table", table(60, speed)};
  }
}
constexpr int kCases = 7;
std::string name_of(const testing::TestParamInfo<int>& info) { return case_of(info.param).name; }

class Piles : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Of, Piles, testing::Range(0, kCases), name_of);

TEST_P(Piles, AreSolvedSparselyWithTheOraclesAnswers) {
  const Pile pile = case_of(GetParam()).pile;
  SceneData data(pile.scene), oracle(pile.scene, {Method::kDense, {}});
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, oracle);
  ASSERT_GT(data.report.nc, 300);
  EXPECT_NE(data.report.islands[0].method, Method::kDense);
  EXPECT_EQ(data.report.status, oracle.report.status);
  EXPECT_EQ(data.report.rank, oracle.report.rank);
  EXPECT_EQ(data.report.islands[0].dependent_rows.size(), oracle.report.islands[0].dependent_rows.size());
  EXPECT_LE(relative(data.a, oracle.a), 1e-10);
  EXPECT_LE(relative(data.f, oracle.f), 1e-10);
}

// On these random piles a test of the pivots' sizes alone gives a wrong rank or solution, or refuses: a row may nearly
// depend on those before it. Where the configuration is nearly singular (14, 25), the dense solver is used.
constexpr unsigned kRandomPiles[] = {1, 7, 12, 14, 25, 36, 64, 85, 112, 118};
TEST(RandomPiles, HaveTheDenseSolversAnswers) {
  for (const unsigned seed : kRandomPiles) {
    SCOPED_TRACE(seed);
    const Pile pile = random_pile(seed);
    SceneData data(pile.scene), dense(pile.scene, {Method::kDense, {}});
    (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
    (void)solve(pile.scene, pile.q, pile.v, pile.u, dense);
    EXPECT_EQ(data.report.status, dense.report.status);
    EXPECT_EQ(data.report.rank, dense.report.rank);
    EXPECT_LE(relative(data.a, dense.a, 9.81), 1e-9);
    EXPECT_LE(relative(data.f, dense.f), 1e-8);
  }
}

// 256 boxes are on a hub and on each other. With contacts last, the rows of all of them fill one dense matrix; the
// contacts of boxes that others fix already go early.
TEST(PilesOnAHub, AreSolvedInAnOrderThatStaysSparse) {
  const Pile pile = hub(16, 0);
  SceneData data(pile.scene);
  const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_EQ(report.status, Status::kRedundant);
  EXPECT_EQ(report.rank, pile.scene.nv);
  EXPECT_EQ(report.islands[0].order, Order::kContactsEarly);
  EXPECT_LT(report.factor_nonzeros, 1000000);  // with contacts last 4.4 million
  EXPECT_LE(data.a.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_NEAR(contact_force(pile.scene, data, 0)[2] / (257 * 9 * 9.81), 1, 1e-10);
}

// Hundreds of rows wait in a large pyramid. A damping below rounding is lost there, and the solution is that without
// it.
TEST(Piles, LoseADampingBelowRounding) {
  Pile pile = pyramid(12, 0);
  pile.scene.damping = 1e-20;
  SceneData data(pile.scene);
  const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_EQ(report.status, Status::kRegularised);
  EXPECT_EQ(report.islands[0].reason, Reason::kDampingLost);
  EXPECT_LE(data.a.cwiseAbs().maxCoeff(), 1e-10);
}

// Boxes on each other by four points. From the ground on all pivots are sound. The accelerations of a tall tower at
// rest are rounding errors of its forces, so that its contacts' residuals are as large as their terms.
TEST(Piles, OfThousandsInATowerAreSolved) {
  for (const int boxes : {2500, 10000}) {
    SCOPED_TRACE(boxes);
    PileMaker make;
    for (int i = 0; i < boxes; ++i) {
      make.box(0, 0, i);
      for (double x : {-0.4, 0.4})
        for (double y : {-0.4, 0.4}) make.join(ContactType::k3D, i, i - 1, {x, y, i - 0.5});
    }
    const Pile pile = make.finish(0);
    SceneData data(pile.scene);
    const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
    EXPECT_EQ(report.status, Status::kRedundant);
    EXPECT_EQ(report.rank, pile.scene.nv);
    // rounding of the weight above, at an arm as long as the tower
    EXPECT_LE(data.a.cwiseAbs().maxCoeff(), std::numeric_limits<double>::epsilon() * 9.81 * boxes * boxes);
    EXPECT_NEAR(contact_force(pile.scene, data, 0)[2] * 4 / (boxes * 9 * 9.81), 1, 1e-4);
  }
}

// A thousand arms are bolted to a base and have their tools on a workpiece. An order that lets a few contacts wait
// costs 364,000 entries of L; one that lets all wait for more of their joints 40 million, and its test would not end.
TEST(ArmsOnAHub, AreAnalysedInAMoment) {
  const std::string arm = MANYCONTACT_SHARED_DIR "/robots/panda.urdf";
  if (!std::filesystem::exists(arm)) GTEST_SKIP() << "skipped: no " << arm;
  constexpr int kArms = 1000;
  const TemporaryFolder folder;
  const auto body = [&](const std::string& name, const std::string& mass, const std::string& moment) {
    (void)folder.write(name, "<robot name=\"b\"><link name=\"b\"><inertial><mass value=\"" + mass +
                                 "\"/><inertia ixx=\"" + moment + "\" iyy=\"" + moment + "\" izz=\"" + moment +
                                 "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link></robot>");
  };
  body("plate.urdf", "500", "200");
  body("box.urdf", "9", "1");
  std::string scene =
      "<scene><robot name=\"base\" urdf=\"plate.urdf\" base=\"floating\"/><contact name=\"ground\" type=\"6d\" "
      "frame=\"base/b\"/><robot name=\"work\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 0.5\"/><contact "
      "name=\"clamp\" type=\"6d\" frame=\"work/b\" to=\"base/b\"/>";
  for (int i = 0; i < kArms; ++i) {
    const std::string name = "a" + std::to_string(i);
    const double angle = 6.283 * i / kArms;
    scene += "<robot name=\"" + name + "\" urdf=\"" + arm + "\" base=\"floating\" xyz=\"" +
             std::to_string(1.2 * std::cos(angle)) + " " + std::to_string(1.2 * std::sin(angle)) + " 0.2\" rpy=\"0 0 " +
             std::to_string(3.14 + angle) +
             "\"><joint name=\"panda_joint2\" q=\"0.4\"/><joint name=\"panda_joint4\" q=\"-1.5\"/></robot><contact "
             "name=\"bolt" +
             name + "\" type=\"6d\" frame=\"" + name + "/panda_link0\" to=\"base/b\"/><contact name=\"tool" + name +
             "\" type=\"3d\" frame=\"" + name + "/panda_link7\" offset=\"0 0 0.2\" to=\"work/b\"/>";
  }
  const SceneFile file = load_scene(folder.write("scene.xml", scene + "</scene>"));
  SceneData data(file.scene);
  const Report& report = solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_EQ(report.islands[0].order, Order::kContactsEarly);
  EXPECT_LT(report.factor_nonzeros, 400 * kArms);
  EXPECT_EQ(report.rank, report.nc);
}

// A strip of two rows of welded boxes, with a free end: taking out the forces' part in the null space leaves rounding
// of these in the dynamics of boxes that carry little.
TEST(Strips, OfWeldedBoxesWithAFreeEndAreSolved) {
  constexpr int kLength = 200;
  PileMaker make;
  for (int i = 0; i < kLength; ++i)
    for (int j = 0; j < 2; ++j) {
      const int box = make.box(i, j, 0);
      if (i == 0 && j == 0) make.join(ContactType::k6D, box, -1, {0, 0, -0.5});
      if (j > 0) make.join(ContactType::k6D, box, box - 1, {1.0 * i, 0.5, 0});
      if (i > 0) make.join(ContactType::k6D, box, box - 2, {i - 0.5, 1.0 * j, 0});
    }
  const Pile pile = make.finish(0);
  SceneData data(pile.scene);
  const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_EQ(report.status, Status::kRedundant);
  EXPECT_EQ(report.rank, pile.scene.nv);
  const double weight = 2 * kLength * 9 * 9.81, moment = weight * kLength / 2;  // moments of inertia: 1 kg m^2
  EXPECT_LE(data.a.cwiseAbs().maxCoeff(), 4 * std::numeric_limits<double>::epsilon() * moment);
  EXPECT_NEAR(contact_force(pile.scene, data, 0)[2] / weight, 1, 1e-9);
}

// Legs with loops, at rest: the contacts' rows are rounding errors of accelerations that vanish.
TEST(Loops, OfLegsAtRestAreSolvedSparsely) {
  for (const std::string name : {"kangaroo_like", "kangaroo_like_2legs"}) {
    SCOPED_TRACE(name);
    const std::string path = MANYCONTACT_SHARED_DIR "/public/closed/converted/" + name + ".xml";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: no " << path;
    const SceneFile file = load_scene(path);
    SceneData data(file.scene), dense(file.scene, {Method::kDense, {}});
    const Report& report = solve(file.scene, file.q, file.v, file.u, data);
    (void)solve(file.scene, file.q, file.v, file.u, dense);
    EXPECT_EQ(report.islands[0].method, Method::kSparseLdl);
    EXPECT_EQ(report.rank, dense.report.rank);
    EXPECT_LE(relative(data.a, dense.a, 9.81), 1e-12);
    EXPECT_LE(relative(data.f, dense.f, 9.81), 1e-11);
  }
}

// Strips of two rows of boxes between a box and the ground, on points in their plane. Each has four rows that depend on
// others, and hundreds that nearly do: the exponents of their pivots sum up to an integer only together.
TEST(Strips, HaveTheirRank) {
  constexpr int kStrips = 4, kLength = 200;
  PileMaker make;
  const int hub = make.box(-1, 0, 0);
  make.join(ContactType::k6D, hub, -1, {-1, 0, -0.5});
  for (int strip = 0; strip < kStrips; ++strip)
    for (int i = 0; i < kLength; ++i)
      for (int j = 0; j < 2; ++j) {
        const double y = 2.0 * strip;
        const int box = make.box(i, y, j);
        if (i == 0) make.join(ContactType::k3D, box, hub, {-0.5, y, 1.0 * j});
        if (i == kLength - 1) make.join(ContactType::k3D, box, -1, {i + 0.5, y, 1.0 * j});
        if (j > 0) make.join(ContactType::k3D, box, box - 1, {1.0 * i, y, 0.5});
        if (i > 0) make.join(ContactType::k3D, box, box - 2, {i - 0.5, y, 1.0 * j});
      }
  const Pile pile = make.finish(0);
  SceneData data(pile.scene);
  const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_EQ(report.status, Status::kRedundant);
  EXPECT_EQ(report.rank, report.nc - 4 * kStrips);
  EXPECT_LE(report.residual_dynamics, 1e-13);
}

// At rest the accelerations vanish, and all terms of the rows between boxes are rounding error. Compared with each
// other they would refuse the solution box by box, and the whole K would be factorized.
TEST(PilesAtRest, AreSolvedBoxByBox) {
  for (const double damping : {0.0, 1e-8}) {
    Pile pile = tower(60, 0);
    pile.scene.damping = damping;
    SceneData data(pile.scene);
    const Report& report = solve(pile.scene, pile.q, pile.v, pile.u, data);
    EXPECT_EQ(report.status, Status::kOk);
    EXPECT_EQ(factorizations_of(data, 0), 1);
    EXPECT_LE(report.backward_error, 1e-12);
    const double top = damping * 9 * 9.81 * 60 * 61 / 2;  // each contact yields to the weight above it
    EXPECT_NEAR(data.a.cwiseAbs().maxCoeff(), top, 1e-10 + top * top / 9.81);  // weights are less by that part
  }
}

TEST_P(Piles, HaveTheOraclesProducts) {
  const Pile pile = case_of(GetParam(), 0).pile;
  SceneData data(pile.scene), oracle(pile.scene, {Method::kDense, {}});
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, oracle);
  EXPECT_EQ(data.report.status, oracle.report.status);
  EXPECT_LE(relative(data.a, oracle.a, 9.81), 1e-10);
  EXPECT_LE(relative(data.f, oracle.f), 1e-10);
  std::mt19937 rng(5);
  const VectorXd dq = random_vector(pile.scene.nv, rng), dv = random_vector(pile.scene.nv, rng),
                 du = random_vector(pile.scene.nu, rng), wf = random_vector(static_cast<int>(data.f.size()), rng);
  const auto products = [&](SceneData& of) {
    VectorXd da(pile.scene.nv), df(of.f.size()), wq(pile.scene.nv), wv(pile.scene.nv), wu(pile.scene.nu), all;
    jvp(pile.scene, of, dq, dv, du, da, df);
    vjp(pile.scene, of, dq, wf, wq, wv, wu);
    return std::array{da, df, wq, wv};
  };
  const auto x = products(data), y = products(oracle);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_LE(relative(x[k], y[k], 1), 1e-9) << k;
}

// Derivatives agree with products, which agree with the dense reference solver.
TEST_P(Piles, HaveTheDerivativesOfTheirProducts) {
  const Pile pile = case_of(GetParam(), 0).pile;
  SceneData data(pile.scene);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  std::mt19937 rng(6);
  const VectorXd dq = random_vector(pile.scene.nv, rng), dv = random_vector(pile.scene.nv, rng),
                 du = random_vector(pile.scene.nu, rng);
  VectorXd da(pile.scene.nv), df(data.f.size());
  jvp(pile.scene, data, dq, dv, du, da, df);
  differentiate(pile.scene, data);
  EXPECT_NE(data.report.islands[0].method, Method::kDense);
  const SceneDerivatives x = dense_derivatives(pile.scene, data);
  EXPECT_LE(relative(x.da_dq * dq + x.da_dv * dv, da, 1), 1e-9);
  EXPECT_LE(relative(x.dforces_dq * dq + x.dforces_dv * dv, df), 1e-9);
}

TEST_P(Piles, AllocateNothingAgain) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const Pile pile = case_of(GetParam()).pile;
  SceneData data(pile.scene);
  const auto solve_once = [&] { (void)solve(pile.scene, pile.q, pile.v, pile.u, data); };
  solve_once();
  EXPECT_EQ(allocations(solve_once), 0u);
}

TEST_P(Piles, AnswersDependOnTheStateAlone) {
  const Pile pile = case_of(GetParam()).pile;
  SceneData data(pile.scene);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  const VectorXd a = data.a, f = data.f;
  (void)solve(pile.scene, pile.q, (2 * pile.v).eval(), pile.u, data);
  (void)solve(pile.scene, pile.q, pile.v, pile.u, data);
  EXPECT_TRUE(a == data.a);
  EXPECT_TRUE(f == data.f);
}

}  // namespace
}  // namespace manycontact::test
