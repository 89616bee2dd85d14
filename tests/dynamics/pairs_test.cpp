// Contacts between the same two bodies are reduced to the rows that span them. The dense method uses all rows as they
// are: both agree in accelerations, least-norm forces, statuses, derivatives, products, bounds.

#include <gtest/gtest.h>

#include "manycontact/contact/jacobian.hpp"
#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test::pairs {
namespace {

using Eigen::VectorXd;

std::string box(const std::string& name, double x, double z) {
  return "<robot name='" + name + "' urdf=\"box.urdf\" base='floating' xyz='" + std::to_string(x) + " 0 " +
         std::to_string(z) + "'/>";
}

// Four points are under a box, on the world or on another box.
std::string face(const std::string& name, const std::string& on, const std::string& to, const std::string& more = "") {
  std::string out;
  const char* const corners[] = {"-0.15 -0.18 -0.2", "-0.15 0.18 -0.2", "0.15 -0.18 -0.2", "0.15 0.18 -0.2"};
  for (int k = 0; k < 4; ++k)
    out += "<contact name='" + name + std::to_string(k) + "' type='3d' frame='" + on + "/crate' offset='" + corners[k] +
           "' " + (to.empty() ? "" : "to='" + to + "/crate'") + " " + more + "/>";
  return out;
}

std::string tower(int boxes, const std::string& more = "") {
  std::string xml;
  for (int k = 0; k < boxes; ++k) xml += box("b" + std::to_string(k), 0.003 * k, 0.4 * k);
  for (int k = 0; k < boxes; ++k)
    xml += face("c" + std::to_string(k) + "_", "b" + std::to_string(k), k ? "b" + std::to_string(k - 1) : "", more);
  return xml;
}

// There are two layers: each upper box is on two lower ones.
std::string bridge() {
  return box("l", -0.2, 0) + box("r", 0.2, 0) + box("t", 0, 0.4) + face("gl", "l", "") + face("gr", "r", "") +
         face("tl", "t", "l") + face("tr", "t", "r");
}

// There are contacts of every type between two boxes, some of them twice.
std::string all_types(const std::string& gains = "") {
  const auto contact = [&](const char* name, const char* type, const char* offset, const char* more = "") {
    return std::string("<contact name='") + name + "' type='" + type + "' frame='b/crate' to='a/crate' offset='" +
           offset + "' " + more + " " + gains + "/>";
  };
  return box("a", 0, 0) + box("b", 0.02, 0.4) + face("g", "a", "", gains) +
         contact("p1", "1d", "0.1 0 -0.1", "axis='0 0.6 0.8'") + contact("p2", "2d", "-0.1 0.02 -0.1") +
         contact("p3", "3d", "0 0.08 -0.1") + contact("h5", "5d", "0.03 0 -0.1", "axis='0 1 0'") +
         contact("w6", "6d", "0 0 -0.1", "offset_quat_xyzw='0 0 0.6 0.8'") +
         contact("again", "5d", "0.03 0.05 -0.1", "axis='1 0 0'");
}

struct Case {
  std::string name, xml;
  double speed = 0;  // magnitude of random velocities
};

struct Answer {
  Status status;
  int rank;
  VectorXd a, f;
  SceneDerivatives d;
  VectorXd da, df, wq, wv, wu;
};

double largest(const Eigen::Ref<const Eigen::MatrixXd>& x) { return x.size() ? x.cwiseAbs().maxCoeff() : 0; }

// The error is relative to the largest entry, or to `least` if that is larger.
void expect_near(const Eigen::Ref<const Eigen::MatrixXd>& x, const Eigen::Ref<const Eigen::MatrixXd>& y, double least,
                 double allowed, const char* what) {
  ASSERT_EQ(x.rows(), y.rows()) << what;
  ASSERT_EQ(x.cols(), y.cols()) << what;
  EXPECT_LE(largest(x - y), allowed * std::max(largest(y), least)) << what;
}

Answer solve_by(const SceneFile& file, const VectorXd& v, const Options& options) {
  const Scene& scene = file.scene;
  SceneData data(scene, options);
  const Report& report = solve(scene, file.q, v, file.u, data);
  Answer out{report.status, report.rank, data.a, data.f, {}, {}, {}, {}, {}, {}};
  std::mt19937 rng(5);
  const VectorXd dq = random_vector(scene.nv, rng), dv = random_vector(scene.nv, rng),
                 du = random_vector(scene.nu, rng), wa = random_vector(scene.nv, rng),
                 wf = random_vector(static_cast<int>(data.f.size()), rng);
  out.da.resize(scene.nv), out.df.resize(data.f.size());
  out.wq.resize(scene.nv), out.wv.resize(scene.nv), out.wu.resize(scene.nu);
  jvp(scene, data, dq, dv, du, out.da, out.df);
  vjp(scene, data, wa, wf, out.wq, out.wv, out.wu);
  differentiate(scene, data);
  out.d = dense_derivatives(scene, data);
  return out;
}

void expect_as_dense(const Case& c, Method method, double allowed) {
  SCOPED_TRACE(c.name + " by " + to_string(method));
  const SceneFile file = load_text(c.xml);
  std::mt19937 rng(7);
  const VectorXd v = file.v + random_vector(file.scene.nv, rng, c.speed);
  const Answer x = solve_by(file, v, {method}), y = solve_by(file, v, {Method::kDense});
  EXPECT_EQ(x.status, y.status);
  EXPECT_EQ(x.rank, y.rank);
  expect_near(x.a, y.a, 9.81, allowed, "a");
  expect_near(x.f, y.f, 1, allowed, "f");
  expect_near(x.d.da_dq, y.d.da_dq, 9.81, 10 * allowed, "da_dq");
  expect_near(x.d.da_dv, y.d.da_dv, 1, 10 * allowed, "da_dv");
  expect_near(x.d.dforces_dq, y.d.dforces_dq, 1, 10 * allowed, "dforces_dq");
  expect_near(x.d.dforces_dv, y.d.dforces_dv, 1, 10 * allowed, "dforces_dv");
  expect_near(x.da, y.da, 9.81, 10 * allowed, "jvp a");
  expect_near(x.df, y.df, 1, 10 * allowed, "jvp f");
  expect_near(x.wq, y.wq, 9.81, 10 * allowed, "vjp q");
  expect_near(x.wv, y.wv, 1, 10 * allowed, "vjp v");
}

const Method kReducing[] = {Method::kAuto, Method::kSparseLdl, Method::kSparseCholmod, Method::kSuiteSparseLdl,
                            Method::kSparseBodies};

TEST(Pairs, AnswersOfAllContacts) {
  const Case cases[] = {
      {"tower", "<scene>" + tower(6) + "</scene>"},
      {"tower that slides", "<scene>" + tower(4) + "</scene>", 0.4},
      {"tower with gains", "<scene>" + tower(3, "gains='30 10'") + "</scene>", 0.4},
      {"bridge", "<scene>" + bridge() + "</scene>"},
      {"bridge that slides", "<scene>" + bridge() + "</scene>", 0.3},
      {"all types", "<scene>" + all_types() + "</scene>", 0.3},
      {"all types with gains, moments weighed", "<scene moment_length='0.2'>" + all_types("gains='20 5'") + "</scene>",
       0.3},
  };
  for (const Case& c : cases)
    for (Method method : kReducing) expect_as_dense(c, method, 1e-11);
}

// K has the damping as an eigenvalue: the relative error is 1e-16 / 1e-4.
TEST(Pairs, DampedAnswersOfAllContacts) {
  const Case cases[] = {
      {"tower", "<scene damping='1e-4'>" + tower(5) + "</scene>"},
      {"tower that slides", "<scene damping='1e-4'>" + tower(3) + "</scene>", 0.4},
      {"all types with gains", "<scene damping='1e-4'>" + all_types("gains='20 5'") + "</scene>", 0.3},
  };
  for (const Case& c : cases)
    for (Method method : {Method::kAuto, Method::kSparseLdl}) expect_as_dense(c, method, 1e-9);
}

// Each face keeps six rows, and no row of K depends on others.
TEST(Pairs, NoDependentRowsAreLeft) {
  const SceneFile file = load_text("<scene>" + tower(8) + "</scene>");
  SceneData data(file.scene);
  const Report& report = solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_EQ(report.nc, 96);
  EXPECT_EQ(report.rank, 48);
  EXPECT_EQ(report.islands[0].reason, Reason::kNone);
  EXPECT_EQ(report.islands[0].dependent_rows.size(), 48u);
  EXPECT_EQ(solved_island(data, 0).nc, 96);
  EXPECT_EQ(data_solved(data).report.nc, 48);
  EXPECT_EQ(data_solved(data).report.rank, 48);
}

// Each dependent row is listed once; those of one pair come after the first rows that span all.
TEST(Pairs, NamesRowsThatDepend) {
  const SceneFile file = load_text("<scene>" + bridge() + "</scene>");
  SceneData data(file.scene);
  const Report& report = solve(file.scene, file.q, file.v, file.u, data);
  const std::vector<int>& rows = report.islands[0].dependent_rows;
  ASSERT_EQ(static_cast<int>(rows.size()), report.nc - report.rank);
  EXPECT_TRUE(std::ranges::is_sorted(rows));
  EXPECT_EQ(std::ranges::adjacent_find(rows), rows.end());

  const SceneFile one = load_text("<scene>" + tower(1) + "</scene>");
  SceneData of_one(one.scene);
  (void)solve(one.scene, one.q, one.v, one.u, of_one);
  const std::vector<int>& dropped = of_one.report.islands[0].dependent_rows;
  const Eigen::MatrixXd J = contact_jacobian(one.scene, one.q);
  Eigen::MatrixXd kept(of_one.report.rank, J.cols());
  for (int row = 0, k = 0; row < J.rows(); ++row)
    if (!std::ranges::binary_search(dropped, row)) kept.row(k++) = J.row(row);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(kept);
  qr.setThreshold(1e-9);
  EXPECT_EQ(qr.rank(), of_one.report.rank);
}

// Six independent rows, one of them with a moment arm of 1e7 m: relative to that arm the others seemed dependent, and
// the body accelerated where it cannot. Rows whose rank is in doubt are left to the factorization.
TEST(Pairs, PointsFarApartAreNotReduced) {
  const auto at_rest = [](double arm) {
    return load_text("<scene>" + box("b", 0, 0) +
                     "<contact name='c0' type='5d' frame='b/crate' offset='-49 -61 -64' axis='0 0 1'/>"
                     "<contact name='c1' type='1d' frame='b/crate' offset='" +
                     std::to_string(0.72 * arm) + " " + std::to_string(0.77 * arm) + " " + std::to_string(-0.02 * arm) +
                     "' axis='0.73 -0.68 0.05'/></scene>");
  };
  for (double arm = 1; arm < 1e8; arm *= 10) {
    const SceneFile file = at_rest(arm);
    SceneData data(file.scene), dense(file.scene, {Method::kDense});
    (void)solve(file.scene, file.q, file.v, file.u, data);
    (void)solve(file.scene, file.q, file.v, file.u, dense);
    EXPECT_EQ(data.report.rank, dense.report.rank) << arm;
    EXPECT_LE(largest(data.a), 1e-6) << arm;
  }
}

TEST(Pairs, BoundsAreTrue) {
  const SceneFile file = load_text("<scene>" + tower(5, "gains='30 10'") + "</scene>");
  std::mt19937 rng(9);
  const VectorXd v = random_vector(file.scene.nv, rng, 0.3);
  SceneData data(file.scene), dense(file.scene, {Method::kDense});
  (void)solve(file.scene, file.q, v, file.u, data);
  (void)solve(file.scene, file.q, v, file.u, dense);
  estimate_errors(file.scene, data);
  EXPECT_LE(largest(data.a - dense.a) / largest(dense.a), data.report.error_acceleration + 1e-12);
  EXPECT_LE(largest(data.f - dense.f) / largest(dense.f), data.report.error_forces + 1e-12);
  EXPECT_LT(data.report.error_forces, 1e-7);
  estimate_condition(file.scene, data);
  EXPECT_GT(data.report.condition, 1);
}

TEST(Pairs, PrescribedAccelerations) {
  const SceneFile file = load_text("<scene>" + tower(3) + "</scene>");
  std::mt19937 rng(3);
  SceneData data(file.scene), dense(file.scene, {Method::kDense});
  VectorXd moved = random_vector(file.scene.nv, rng), tau = random_vector(file.scene.nv, rng);
  const Eigen::MatrixXd J = contact_jacobian(file.scene, file.q);
  const VectorXd prescribed = J * moved, contradicting = random_vector(static_cast<int>(J.rows()), rng);
  for (const VectorXd& asked : {prescribed, contradicting})
    for (SceneData* d : {&data, &dense}) {
      const Report& report = solve_tau(file.scene, file.q, file.v, tau, asked, *d);
      EXPECT_EQ(report.status, &asked == &prescribed ? Status::kRedundant : report.status);
      if (d == &data) continue;
      EXPECT_EQ(data.report.status, dense.report.status);
      expect_near(data.a, dense.a, 1, 1e-11, "a");
      expect_near(data.f, dense.f, 1, 1e-11, "f");
    }
}

TEST(Pairs, OtherSetsOfContacts) {
  const SceneFile file = load_text("<scene>" + tower(4) + "</scene>");
  SceneData data(file.scene);
  const std::vector<std::vector<int>> off = {{}, {4}, {4, 5}, {4, 5, 6}, {0, 1, 2, 3}, {12, 13}, {}};
  for (int round = 0; round < 3; ++round)  // a new pair drops earlier analyses
    for (const std::vector<int>& set : off) {
      std::fill(data.active.begin(), data.active.end(), 1);
      for (int c : set) data.active[static_cast<std::size_t>(c)] = 0;
      const std::size_t allocated = allocations([&] { (void)solve(file.scene, file.q, file.v, file.u, data); });
      if (round == 2) EXPECT_EQ(allocated, 0u) << set.size();
      SceneData fresh(file.scene), dense(file.scene, {Method::kDense});
      fresh.active = dense.active = data.active;
      (void)solve(file.scene, file.q, file.v, file.u, fresh);
      (void)solve(file.scene, file.q, file.v, file.u, dense);
      EXPECT_EQ(data.a, fresh.a) << set.size();
      EXPECT_EQ(data.f, fresh.f) << set.size();
      EXPECT_EQ(data.report.rank, dense.report.rank) << set.size();
      EXPECT_EQ(data.report.status, dense.report.status) << set.size();
      expect_near(data.f, dense.f, 1, 1e-11, "f");
    }
}

// Data in use follow changes of gains, gravity and contact placements.
TEST(Pairs, FollowTheScene) {
  SceneFile file = load_text("<scene>" + tower(3, "gains='10 2'") + "</scene>");
  SceneData data(file.scene);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  file.scene.gravity = {1, 2, -5};
  file.scene.contacts[1].alpha = 40, file.scene.contacts[6].beta = 7;
  file.scene.contacts[2].B.placement.p += Vec3<double>(0.01, 0, 0.02);
  SceneData fresh(file.scene), dense(file.scene, {Method::kDense});
  for (SceneData* d : {&data, &fresh, &dense}) (void)solve(file.scene, file.q, file.v, file.u, *d);
  EXPECT_EQ(data.a, fresh.a);
  EXPECT_EQ(data.f, fresh.f);
  EXPECT_EQ(data.report.status, dense.report.status);
  expect_near(data.f, dense.f, 1, 1e-11, "f");
  file.scene.contacts[2].reference_frame = ReferenceFrame::kWorld;
  file.scene.damping = 1e-3;
  SceneData other(file.scene);
  for (SceneData* d : {&data, &other}) (void)solve(file.scene, file.q, file.v, file.u, *d);
  EXPECT_EQ(data.a, other.a);
  EXPECT_EQ(data.f, other.f);
}

TEST(Pairs, BatchesHaveTheBitsOfSolves) {
  const SceneFile file = load_text("<scene>" + box("b", 0, 0) + face("c", "b", "") + "</scene>");
  SceneData data(file.scene);
  BatchData batch(file.scene, 1);
  constexpr int kStates = 20;
  std::mt19937 rng(2);
  BatchMatrix q(kStates, file.scene.nq), v(kStates, file.scene.nv), u(kStates, file.scene.nu),
      a(kStates, file.scene.nv), f(kStates, 12);
  std::vector<Status> status(kStates);
  for (int k = 0; k < kStates; ++k) q.row(k) = file.q, v.row(k) = random_vector(file.scene.nv, rng, 0.3);
  solve_batch(file.scene, {q, v, u}, batch, a, f, status);
  for (int k = 0; k < kStates; ++k) {
    (void)solve(file.scene, q.row(k), v.row(k), u.row(k), data);
    EXPECT_EQ(data.a, a.row(k).transpose()) << k;
    EXPECT_EQ(data.f, f.row(k).transpose()) << k;
    EXPECT_EQ(data.report.status, status[static_cast<std::size_t>(k)]) << k;
  }
}

// Solves and derivatives allocate nothing after the first.
TEST(Pairs, AllocateOnce) {
  const SceneFile file = load_text("<scene>" + bridge() + "</scene>");
  SceneData data(file.scene);
  VectorXd da(file.scene.nv), df;
  const VectorXd dq = VectorXd::Ones(file.scene.nv), du = VectorXd::Ones(file.scene.nu);
  const auto once = [&] {
    (void)solve(file.scene, file.q, file.v, file.u, data);
    differentiate(file.scene, data);
    df.resize(data.f.size());
    jvp(file.scene, data, dq, dq, du, da, df);
  };
  once(), once();
  EXPECT_EQ(allocations(once), 0u);
}

}  // namespace
}  // namespace manycontact::test::pairs
