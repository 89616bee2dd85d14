// Products with the derivatives agree with the matrices, and with each other.

#include "derivatives/judge.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd nan_vector(Eigen::Index n) { return VectorXd::Constant(n, NAN); }

// Returns the scene's derivatives as one matrix, [a; f] by [q | v | u].
MatrixXd whole_matrix(const Scene& scene, SceneData& data) {
  differentiate_afresh(scene, data);
  const SceneDerivatives d = dense_derivatives(scene, data);
  MatrixXd J(scene.nv + data.f.size(), 2 * scene.nv + scene.nu);
  J << d.da_dq, d.da_dv, d.da_du, d.dforces_dq, d.dforces_dv, d.dforces_du;
  return J;
}

VectorXd times(const Scene& scene, SceneData& data, const VectorXd& x) {
  VectorXd da = nan_vector(scene.nv), df = nan_vector(data.f.size());
  jvp(scene, data, x.head(scene.nv), x.segment(scene.nv, scene.nv), x.tail(scene.nu), da, df);
  VectorXd out(da.size() + df.size());
  out << da, df;
  return out;
}

VectorXd transposed_times(const Scene& scene, SceneData& data, const VectorXd& w) {
  VectorXd wq = nan_vector(scene.nv), wv = wq, wu = nan_vector(scene.nu);
  vjp(scene, data, w.head(scene.nv), w.tail(data.f.size()), wq, wv, wu);
  VectorXd out(2 * scene.nv + scene.nu);
  out << wq, wv, wu;
  return out;
}

// Compares each number of x with the sum that it approximates.
void expect_sum(const VectorXd& x, const VectorXd& sum, const VectorXd& terms, double allowed) {
  ASSERT_EQ(x.size(), sum.size());
  EXPECT_LE(difference_of(x, sum), allowed * size_of(terms));
}

// Returns directions along all three, and along each alone.
std::vector<VectorXd> some_directions(const Scene& scene, std::mt19937& rng) {
  const VectorXd x = random_vector(2 * scene.nv + scene.nu, rng);
  std::vector<VectorXd> out = {x};
  const int first[] = {0, scene.nv, 2 * scene.nv, static_cast<int>(x.size())};
  for (int k = 0; k < 3; ++k) {
    VectorXd one = VectorXd::Zero(x.size());
    one.segment(first[k], first[k + 1] - first[k]) = x.segment(first[k], first[k + 1] - first[k]);
    out.push_back(one);
  }
  return out;
}

void expect_products(const std::string& name, const Scene& scene, const State& s, bool redundant = false) {
  SCOPED_TRACE(name);
  SceneData oracle(scene, {Method::kDense, {}});
  (void)solve(scene, s.q, s.v, s.u, oracle);
  conditions(scene, oracle);
  const double allowed = test::allowed(oracle.report.condition);
  EXPECT_EQ(oracle.report.status != Status::kOk, redundant);
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    std::mt19937 rng(21);
    SceneData data(scene, way.options);
    (void)solve(scene, s.q, s.v, s.u, data);
    const VectorXd w = random_vector(scene.nv + static_cast<int>(data.f.size()), rng);
    const std::vector<VectorXd> directions = some_directions(scene, rng);
    if (way.options.method == Method::kDenseSchur && redundant) {  // no solution
      EXPECT_TRUE(times(scene, data, directions[0]).array().isNaN().all());
      EXPECT_TRUE(transposed_times(scene, data, w).array().isNaN().all());
      continue;
    }
    const VectorXd wJ = transposed_times(scene, data, w), Jx = times(scene, data, directions[0]);  // before any matrix
    const MatrixXd J = whole_matrix(scene, data);
    EXPECT_GT(size_of(J), 1);
    for (const VectorXd& x : directions) expect_sum(times(scene, data, x), J * x, J.cwiseAbs() * x.cwiseAbs(), allowed);
    expect_sum(wJ, J.transpose() * w, J.transpose().cwiseAbs() * w.cwiseAbs(), allowed);
    EXPECT_LE(std::abs(w.dot(Jx) - wJ.dot(directions[0])),
              allowed * w.cwiseAbs().dot(J.cwiseAbs() * directions[0].cwiseAbs()));
    // The bits are the same when called again, after other products and the matrices.
    EXPECT_EQ(times(scene, data, directions[0]), Jx);
    EXPECT_EQ(transposed_times(scene, data, w), wJ);
    EXPECT_NE(Jx, J * directions[0]);  // computed without the matrix
  }
}

class ProductsOf : public testing::TestWithParam<std::string> {};

TEST_P(ProductsOf, AreTheMatricesTimesVectors) {
  SceneFile file = load_small(GetParam());
  const std::string name = scene_name(GetParam());
  State s{file.q, file.v, file.u};
  expect_products(name + " as given", file.scene, s, status_at(file.scene, s) != Status::kOk);
  std::mt19937 rng(11);
  disturb(file, rng);
  s = {file.q, file.v, file.u};
  expect_products(name + " moving", file.scene, s, status_at(file.scene, s) != Status::kOk);
}

INSTANTIATE_TEST_SUITE_P(Models, ProductsOf, testing::ValuesIn(model_scenes()), scene_title);
INSTANTIATE_TEST_SUITE_P(Golden, ProductsOf, testing::ValuesIn(golden_scenes()), scene_title);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ProductsOf);

TEST(Products, OfRandomScenes) {
  for (int seed = 1; seed <= 40; ++seed) {
    std::mt19937 rng(800 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 4;
    options.damping = seed % 4 == 0 ? 1e-3 : 0;
    options.redundant = seed % 5 == 0 ? 2 : 0;
    options.contradicting = seed % 10 == 0 ? 1 : 0;
    const RandomScene s = random_scene(rng, options);
    expect_products("seed " + std::to_string(seed), s.scene, {s.q, s.v, s.u}, seed % 5 == 0 && s.scene.damping == 0);
  }
}

// Repeated contacts have all types and frames, in the world, between robots and within one, in motion; some agree.
TEST(Products, OfRandomScenesWhoseContactsDepend) {
  for (int seed = 1; seed <= 24; ++seed) {
    std::mt19937 rng(1700 + seed);
    SceneOptions options;
    options.nrobots = 1 + seed % 3;
    options.redundant = 3;
    options.contradicting = seed % 2;
    options.frames = {
        std::array{ReferenceFrame::kLocal, ReferenceFrame::kWorld, ReferenceFrame::kLocalWorldAligned}[seed / 3 % 3]};
    options.between_bodies = seed % 4 < 2 ? 1 : 0.5;
    options.passive = seed % 5 == 0 ? 0.3 : 0;
    RandomScene s = random_scene(rng, options);
    s.scene.moment_length = seed % 6 < 2 ? 0.3 : 1;
    expect_products("seed " + std::to_string(seed), s.scene, {s.q, s.v, s.u}, true);
  }
}

// Contacts are inconsistent, with moments weighted by another length: G's solve is in K's units, too.
TEST(Products, OfContradictionsWithAMomentLength) {
  SceneFile file = load_text(R"(<scene moment_length="10"><robot name="a" urdf="arm.urdf" base="fixed"/>
      <contact name="c" type="6d" frame="a/link_5" reference_frame="world" gains="25 10"/>
      <contact name="d" type="3d" frame="a/tool" gains="25 10"/></scene>)");
  std::mt19937 rng(12);
  disturb(file, rng, 0.5);
  ASSERT_EQ(status_at(file.scene, {file.q, file.v, file.u}), Status::kInconsistent);
  expect_products("arm", file.scene, {file.q, file.v, file.u}, true);
}

// One pair of feet of many robots hand in hand is on points: the others' contacts are in no null space.
TEST(Products, OfARowWithOneOnCorners) {
  std::string corners;
  for (const char* at : {"-0.1 -0.05 0", "-0.1 0.05 0", "0.1 -0.05 0", "0.1 0.05 0"})
    corners += std::string(R"(<contact name="at )") + at + R"(" type="3d" frame="humanoid1/left_sole" offset=")" + at +
               R"(" gains="25 10" reference_frame="world"/>)";
  SceneFile file =
      load_edited(kModels + "humanoid_standing.xml",
                  {{R"(<robot name="humanoid")", R"(<robot name="humanoid" copies="3" arrange="line" spacing="1")"},
                   {"</scene>", corners + R"(<contact name="hold" type="6d" frame="humanoid/left_hand"
                                          to="humanoid+1/right_hand"/></scene>)"}});
  expect_products("as given", file.scene, {file.q, file.v, file.u}, true);
  std::mt19937 rng(11);
  disturb(file, rng);
  expect_products("moving", file.scene, {file.q, file.v, file.u}, true);
}

// ---- misuse -----------------------------------------------------------------------------------------------------

class Misuse : public testing::Test {
 protected:
  void solve_it() { (void)solve(scene, file.q, file.v, file.u, data); }
  void call_jvp(int dq, int dv, int du, int da, int df) {
    VectorXd out_a = nan_vector(scene.nv + da), out_f = nan_vector(data.f.size() + df);
    jvp(scene, data, VectorXd::Zero(scene.nv + dq), VectorXd::Zero(scene.nv + dv), VectorXd::Zero(scene.nu + du), out_a,
        out_f);
  }
  void call_vjp(int wa, int wf, int wq, int wv, int wu) {
    VectorXd q = nan_vector(scene.nv + wq), v = nan_vector(scene.nv + wv), u = nan_vector(scene.nu + wu);
    vjp(scene, data, VectorXd::Zero(scene.nv + wa), VectorXd::Zero(data.f.size() + wf), q, v, u);
  }
  // Expects that all functions of derivatives throw.
  void expect_refusal() {
    EXPECT_THROW(differentiate(scene, data), std::logic_error);
    EXPECT_THROW(call_jvp(0, 0, 0, 0, 0), std::logic_error);
    EXPECT_THROW(call_vjp(0, 0, 0, 0, 0), std::logic_error);
    EXPECT_THROW((void)dense_derivatives(scene, data), std::logic_error);
    EXPECT_THROW((void)sparse_derivatives(scene, data), std::logic_error);
  }

  SceneFile file = load_scene(kModels + "arm_pushes_box.xml");
  const Scene& scene = file.scene;
  SceneData data{scene, {Method::kSparseLdl, {}}};
};

TEST_F(Misuse, WrongSizes) {
  solve_it();
  EXPECT_NO_THROW(call_jvp(0, 0, 0, 0, 0));
  EXPECT_NO_THROW(call_vjp(0, 0, 0, 0, 0));
  for (int wrong = 0; wrong < 5; ++wrong)
    for (int by : {-1, 1}) {
      std::array<int, 5> off = {};
      off[wrong] = by;
      EXPECT_THROW(call_jvp(off[0], off[1], off[2], off[3], off[4]), std::invalid_argument) << wrong;
      EXPECT_THROW(call_vjp(off[0], off[1], off[2], off[3], off[4]), std::invalid_argument) << wrong;
    }
}

TEST_F(Misuse, BeforeASolve) {
  expect_refusal();
  solve_it();
  EXPECT_NO_THROW(call_jvp(0, 0, 0, 0, 0));
  EXPECT_NO_THROW(call_vjp(0, 0, 0, 0, 0));
}

TEST_F(Misuse, MatricesBeforeDifferentiate) {
  solve_it();
  EXPECT_THROW((void)dense_derivatives(scene, data), std::logic_error);
  EXPECT_THROW((void)sparse_derivatives(scene, data), std::logic_error);
  differentiate(scene, data);
  EXPECT_NO_THROW((void)dense_derivatives(scene, data));
  EXPECT_NO_THROW((void)sparse_derivatives(scene, data));
}

TEST_F(Misuse, MatricesAfterProductsOnly) {
  const SceneFile corners = load_scene(kModels + "feet_on_corners.xml");
  SceneData redundant(corners.scene);
  (void)solve(corners.scene, corners.q, corners.v, corners.u, redundant);
  times(corners.scene, redundant, VectorXd::Ones(2 * corners.scene.nv + corners.scene.nu));
  EXPECT_THROW((void)dense_derivatives(corners.scene, redundant), std::logic_error);
  EXPECT_THROW((void)sparse_derivatives(corners.scene, redundant), std::logic_error);
}

TEST_F(Misuse, AfterContactsWereSwitched) {
  solve_it();
  differentiate(scene, data);
  data.active[1] = 0;
  EXPECT_THROW(differentiate(scene, data), std::logic_error);
  EXPECT_THROW(call_jvp(0, 0, 0, 0, 0), std::logic_error);
  EXPECT_THROW(call_vjp(0, 0, 0, 0, 0), std::logic_error);
  prepare(scene, data);  // sets up the islands, and solves nothing
  expect_refusal();
  solve_it();
  EXPECT_NO_THROW(differentiate(scene, data));
}

TEST_F(Misuse, AfterQuasiStaticTookTheData) {
  solve_it();
  quasi_static(scene, file.q, data);
  EXPECT_THROW(differentiate(scene, data), std::logic_error);
  EXPECT_THROW(call_jvp(0, 0, 0, 0, 0), std::logic_error);
  EXPECT_THROW(call_vjp(0, 0, 0, 0, 0), std::logic_error);
}

}  // namespace
}  // namespace manycontact::test
