// Robots in SIMD batches have dependent contact rows: rank, forces of least norm, derivatives and products are those of
// the whole K and of the dense reference solver, each robot by itself, whatever was solved before.

#include <gtest/gtest.h>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/workspace.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

struct Case {
  Scene scene;
  VectorXd q, v, u;
};

enum class Hold { kApart, kInARow };

// The robots have one model. Under every third one two bodies are fixed at four points each (24 rows of rank 12), under
// the others at two (12 rows of rank 10). In a row each is attached to the next.
Case on_corners(std::mt19937& rng, int count, Hold hold, double gain) {
  Case out;
  ModelOptions options;
  options.njoints = 16;
  options.branching = 0.3;
  options.floating_base = true;
  const auto model = std::make_shared<const Model>(random_model(rng, options));
  const int last = model->njoints() - 1;
  int joined = 1;  // a body on another branch, or further up
  while (joined < last - 3 && model->joints[joined].parent > 2) ++joined;
  for (int r = 0; r < count; ++r) add_robot(out.scene, "r" + std::to_string(r), model);
  for (int r = 0; r < count; ++r) {
    int number = 0;
    for (int body : {last, last - 2})
      for (int corner = 0; corner < (r % 3 == 0 ? 4 : 2); ++corner) {
        Contact c;
        c.name = "c" + std::to_string(r) + "_" + std::to_string(number++);
        c.type = ContactType::k3D;
        c.reference_frame = static_cast<ReferenceFrame>(corner % 3);
        c.A = {r, body, {Mat3<double>::Identity(), {corner & 1 ? 0.1 : -0.1, corner & 2 ? 0.05 : -0.05, 0.02}}};
        c.B.placement = random_placement(rng);
        c.alpha = gain, c.beta = 7;
        add_contact(out.scene, c);
      }
    if (hold == Hold::kApart || r == 0) continue;
    Contact c;
    c.name = "hold" + std::to_string(r);
    c.type = ContactType::k3D;
    c.A = {r - 1, joined, random_placement(rng)};
    c.B = {r, joined, random_placement(rng)};
    add_contact(out.scene, c);
  }
  out.q.resize(out.scene.nq);
  for (const Robot& r : out.scene.robots) out.q.segment(r.idx_q, model->nq) = random_configuration(*model, rng);
  out.v = random_vector(out.scene.nv, rng, 0.5);
  out.u = random_vector(out.scene.nu, rng, 5);
  return out;
}

template <class X>
double relative(const X& x, const X& truth) {
  return (x - truth).norm() / truth.norm();
}

std::vector<Eigen::MatrixXd> derivatives(const Case& c, SceneData& data, const DerivativeRequest& request = {}) {
  differentiate(c.scene, data, request);
  const SceneDerivatives d = dense_derivatives(c.scene, data);
  return {d.da_dq, d.da_dv, d.da_du, d.dforces_dq, d.dforces_dv, d.dforces_du};
}

struct Products {
  VectorXd of_tangent, of_adjoint;
};
Products products(const Case& c, SceneData& data) {
  std::mt19937 rng(3);
  const VectorXd dq = random_vector(c.scene.nv, rng), dv = random_vector(c.scene.nv, rng),
                 du = random_vector(c.scene.nu, rng), wa = random_vector(c.scene.nv, rng),
                 wf = random_vector(static_cast<int>(data.f.size()), rng);
  VectorXd da(c.scene.nv), df(data.f.size()), wq(c.scene.nv), wv(c.scene.nv), wu(c.scene.nu);
  jvp(c.scene, data, dq, dv, du, da, df);
  vjp(c.scene, data, wa, wf, wq, wv, wu);
  Products out;
  out.of_tangent.resize(da.size() + df.size()), out.of_tangent << da, df;
  out.of_adjoint.resize(wq.size() + wv.size() + wu.size()), out.of_adjoint << wq, wv, wu;
  return out;
}

// Expects the results of the whole K and of the dense reference solver. All states have inconsistent contacts, except
// for gain 0, where only velocities cause them.
void expect_as_without_lanes(const Case& c, SimdLevel lanes) {
  SceneData data(c.scene, {Method::kSparseLdl, {}, lanes}), off(c.scene, {Method::kSparseLdl, {}, SimdLevel::kOff}),
      oracle(c.scene, {Method::kDense, {}, SimdLevel::kOff});
  for (SceneData* d : {&data, &off, &oracle}) (void)solve(c.scene, c.q, c.v, c.u, *d);
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport &x = data.report.islands[i], &y = off.report.islands[i], &z = oracle.report.islands[i];
    EXPECT_EQ(x.status, z.status) << i;
    EXPECT_EQ(x.rank, z.rank) << i;
    EXPECT_EQ(x.reason, y.reason) << i;
    EXPECT_EQ(x.dependent_rows, y.dependent_rows) << i;
    EXPECT_NEAR(x.residual_contact, y.residual_contact, 1e-9 * y.residual_contact + 1e-12) << i;
  }
  EXPECT_LT(relative(data.a, oracle.a), 1e-10);
  EXPECT_LT(relative(data.f, oracle.f), 1e-10);
  const Products x = products(c, data), y = products(c, oracle);
  EXPECT_LT(relative(x.of_tangent, y.of_tangent), 1e-9);
  EXPECT_LT(relative(x.of_adjoint, y.of_adjoint), 1e-9);
  const auto X = derivatives(c, data), Y = derivatives(c, oracle);
  for (std::size_t k = 0; k < X.size(); ++k) EXPECT_LT(relative(X[k], Y[k]), 1e-9) << k;
}

class DependentInLanes : public testing::TestWithParam<SimdLevel> {};

TEST_P(DependentInLanes, AsWithoutLanes) {
  std::mt19937 rng(4);
  for (const Hold hold : {Hold::kApart, Hold::kInARow})
    for (const int count : {1, 2, 9})
      for (const double gain : {0.0, 20.0}) {
        SCOPED_TRACE(std::to_string(count) + (hold == Hold::kApart ? " apart" : " in a row") + ", gain " +
                     std::to_string(gain));
        expect_as_without_lanes(on_corners(rng, count, hold, gain), GetParam());
      }
}

TEST_P(DependentInLanes, ConsistentStatesAreRedundant) {
  std::mt19937 rng(5);
  for (const Hold hold : {Hold::kApart, Hold::kInARow}) {
    Case c = on_corners(rng, 9, hold, 0);
    c.v.setZero();
    SceneData data(c.scene, {Method::kSparseLdl, {}, GetParam()});
    EXPECT_EQ(solve(c.scene, c.q, c.v, c.u, data).status, Status::kRedundant);
    EXPECT_EQ(data.report.nc - data.report.rank, 3 * 12 + 6 * 2);
    expect_as_without_lanes(c, GetParam());
    c.v = data.a / data.a.norm();  // J a = 0, so J v = 0
    c.u = random_vector(c.scene.nu, rng, 5);
    EXPECT_EQ(solve(c.scene, c.q, c.v, c.u, data).status, Status::kRedundant);
    expect_as_without_lanes(c, GetParam());
  }
}

// Derivatives with respect to some of q, v, u, and to all torques, do not depend on earlier requests.
TEST_P(DependentInLanes, DerivativesByRequest) {
  std::mt19937 rng(7);
  Case c = on_corners(rng, 9, Hold::kApart, 0);
  c.v.setZero();
  SceneData data(c.scene, {Method::kSparseLdl, {}, GetParam()}), oracle(c.scene, {Method::kDense, {}, SimdLevel::kOff});
  (void)solve(c.scene, c.q, c.v, c.u, data);
  (void)solve(c.scene, c.q, c.v, c.u, oracle);
  for (const DerivativeRequest& request : {DerivativeRequest{.q = false}, DerivativeRequest{.v = false, .u = false},
                                           DerivativeRequest{.tau = true}, DerivativeRequest{.forces = false}}) {
    const auto X = derivatives(c, data, request), Y = derivatives(c, oracle, request);
    for (std::size_t k = 0; k < X.size(); ++k) EXPECT_LE((X[k] - Y[k]).norm(), 1e-9 * Y[k].norm()) << k;
  }
}

// The solution is that of new data, to the last bit.
TEST_P(DependentInLanes, LeaveNothingBehind) {
  std::mt19937 rng(6);
  for (const Hold hold : {Hold::kApart, Hold::kInARow}) {
    Case c = on_corners(rng, 9, hold, 20);
    SceneData used(c.scene, {Method::kSparseLdl, {}, GetParam()});
    for (int k = 0; k < 12; ++k) {
      if (k == 6) {  // from here on contacts are consistent
        c.v.setZero();
        for (Contact& contact : c.scene.contacts) contact.alpha = 0;
      }
      VectorXd q = c.q;
      for (const Robot& r : c.scene.robots) q.segment(r.idx_q, r.model->nq) = random_configuration(*r.model, rng);
      if (k % 3 == 2)  // other rows are dependent, or none
        for (std::size_t i = 0; i < used.active.size(); ++i) used.active[i] = rng() % 3 != 0;
      SceneData fresh(c.scene, {Method::kSparseLdl, {}, GetParam()});
      fresh.active = used.active;
      (void)solve(c.scene, q, c.v, c.u, used);
      (void)solve(c.scene, q, c.v, c.u, fresh);
      EXPECT_TRUE(used.a == fresh.a && used.f == fresh.f) << k;
      EXPECT_EQ(used.report.status, fresh.report.status);
      const Products x = products(c, used), y = products(c, fresh);
      EXPECT_TRUE(x.of_tangent == y.of_tangent && x.of_adjoint == y.of_adjoint) << k;
      EXPECT_TRUE(derivatives(c, used) == derivatives(c, fresh)) << k;
    }
  }
}

// The robots are at rest, bent in the sagittal plane alone. Accelerations across it are tiny relative to those in other
// rows of the same contacts. The dense reference solver is not used.
TEST_P(DependentInLanes, AtRestInAPlane) {
  std::string robots, contacts;
  const auto contact = [&](const std::string& type, const std::string& name, const std::string& at) {
    contacts += "<contact type=\"" + type + "\" name=\"" + name + "\" frame=\"" + at + "/>";
  };
  for (int i = 0; i < 2; ++i) {
    const std::string n = std::to_string(i);
    robots += "<robot name=\"r" + n + "\" urdf=\"humanoid.urdf\" base=\"floating\" xyz=\"0 " + n + " 1\">";
    for (const char* side : {"left_", "right_"})
      for (const auto& [joint, q] : {std::pair{"hip_pitch", "-0.6"},
                                     {"knee", "1.2"},
                                     {"ankle_pitch", "-0.6"},
                                     {"elbow", "-1.5"},
                                     {"shoulder_roll", "0.2"}})
        robots += "<joint name=\"" + std::string(side) + joint + "\" q=\"" + q + "\"/>";
    robots += "</robot>";
    for (const char* side : {"left", "right"}) contact("6d", side + n, "r" + n + "/" + side + "_sole\"");
    if (i > 0) continue;
    for (const char* at : {"-0.1 -0.05 0", "-0.1 0.05 0", "0.1 -0.05 0", "0.1 0.05 0"})
      contact("3d", "corner " + std::string(at), "r0/left_sole\" offset=\"" + std::string(at) + "\"");
  }
  for (const std::string tie : {"", R"(<contact name="hands" type="6d" frame="r0/left_hand" to="r1/right_hand"/>)"}) {
    const SceneFile file = load_text("<scene name=\"rest\">" + robots + contacts + tie + "</scene>");
    SceneData data(file.scene, {Method::kSparseLdl, {}, GetParam()}), oracle(file.scene, {Method::kDense, {}});
    for (SceneData* d : {&data, &oracle}) (void)solve(file.scene, file.q, file.v, file.u, *d);
    for (const IslandReport& island : data.report.islands) EXPECT_EQ(island.method, Method::kSparseLdl) << tie;
    EXPECT_EQ(data.report.status, Status::kRedundant);
    EXPECT_EQ(data.report.rank, oracle.report.rank);
    EXPECT_LT(relative(data.a, oracle.a), 1e-11);
    EXPECT_LT(relative(data.f, oracle.f), 1e-11);
  }
}

// Unused analyses are dropped, but not those of robots that may need them again. Eight quadrupeds are in a row, each on
// the corners of a foot; the last one lets go.
TEST_P(DependentInLanes, KeepWhatTheyMayNeedAgain) {
  std::string text = "<scene>";
  int number = 0;
  const auto hold = [&](int robot, const std::string& rest) {
    text += R"(<contact name="c)" + std::to_string(number++) + R"(" type="3d" frame="r)" + std::to_string(robot) + "/" +
            rest + "/>";
  };
  for (int r = 0; r < 9; ++r) {
    text += R"(<robot name="r)" + std::to_string(r) + R"(" urdf="quadruped.urdf" base="floating"/>)";
    for (const std::string corner : {"0.1 0.05 0", "0.1 -0.05 0", "-0.1 0.05 0", "-0.1 -0.05 0"})
      hold(r, R"(LF_shank" offset=")" + corner + "\"");
  }
  for (int r = 0; r < 8; ++r) hold(r, R"(RH_shank" to="r)" + std::to_string(r + 1) + R"(/RH_shank")");
  SceneFile file = load_text(text + "</scene>");
  Scene& scene = file.scene;
  std::mt19937 rng(2);
  file.q = integrate(scene, file.q, random_vector(scene.nv, rng, 0.3));
  for (Contact& c : scene.contacts) c.alpha = c.beta = 0;
  SceneData data(scene, {.method = Method::kSparseLdl, .simd_level = GetParam(), .reduce_pairs = false});
  data.active.back() = 0;
  for (int k : {0, 1}) {
    EXPECT_EQ(solve(scene, file.q, file.v, file.u, data).status, Status::kRedundant) << k;
    EXPECT_EQ(factorizations_of(data, 0), 1) << k;
  }
  limit_pool(data, 1);
  for (int k = 0; k < 4; ++k) {
    data.active[4 * 8] ^= 1;  // the last robot's own contact
    (void)solve(scene, file.q, file.v, file.u, data);
  }
  scene.damping = 1e-6;
  SceneData fresh(scene, data.options);
  fresh.active = data.active;
  for (SceneData* d : {&data, &fresh}) {
    EXPECT_EQ(solve(scene, file.q, file.v, file.u, *d).status, Status::kOk);
    differentiate(scene, *d);
  }
  EXPECT_TRUE(data.a == fresh.a);
  EXPECT_TRUE(dense_derivatives(scene, data).da_dq == dense_derivatives(scene, fresh).da_dq);
}

// Each leg of every second quadruped is straight: in contacts-early order rows of its feet have no sound pivot, though
// they are independent. They join the others, and each quadruped has the bits that it has alone.
TEST_P(DependentInLanes, BadlyPlacedRowsJoin) {
  std::string text = "<scene>";
  for (int r = 0; r < 9; ++r) {
    text += R"(<robot name="r)" + std::to_string(r) + R"(" urdf="quadruped.urdf" base="floating">)";
    for (const std::string leg : {"LF", "RF", "LH", "RH"})
      if (r % 2 == 0) text += "<joint name=\"" + leg + R"(_hip" q="0.7"/><joint name=")" + leg + R"(_knee" q="-1.4"/>)";
    text += "</robot>";
    for (const std::string leg : {"LF", "RF", "LH", "RH"})
      text += "<contact name=\"" + leg + std::to_string(r) + R"(" type="3d" frame="r)" + std::to_string(r) + "/" + leg +
              "_foot\"/>";
  }
  SceneFile file = load_text(text + "</scene>");
  const Options options{Method::kSparseLdl, Order::kContactsEarly, GetParam()};
  SceneData data(file.scene, options), alone(file.scene, options), oracle(file.scene, {Method::kDense, {}});
  for (SceneData* d : {&data, &oracle}) {
    EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, *d).status, Status::kOk);
    differentiate(file.scene, *d);
  }
  for (const IslandReport& island : data.report.islands) EXPECT_FALSE(island.changed_order);
  EXPECT_LT(relative(data.a, oracle.a), 1e-11);
  EXPECT_LT(relative(data.f, oracle.f), 1e-11);
  EXPECT_LT(relative(dense_derivatives(file.scene, data).da_dq, dense_derivatives(file.scene, oracle).da_dq), 1e-10);
  for (int r = 0; r < 9; ++r) {
    for (std::size_t c = 0; c < alone.active.size(); ++c) alone.active[c] = static_cast<int>(c) / 4 == r;
    (void)solve(file.scene, file.q, file.v, file.u, alone);
    EXPECT_TRUE(data.a.segment(18 * r, 18) == alone.a.segment(18 * r, 18)) << r;
    EXPECT_TRUE(data.f.segment(12 * r, 12) == alone.f) << r;
  }
}

INSTANTIATE_TEST_SUITE_P(Levels, DependentInLanes, testing::ValuesIn(available_simd_levels()),
                         [](const auto& param) { return to_string(param.param); });

}  // namespace
}  // namespace manycontact::test
