// In scenes with large islands, products with derivatives along random directions, and whole matrices times these,
// agree with differences of the truth.

#include "derivatives/judge.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

constexpr int kEach = 2;  // directions in q, v and u

// The directions are columns, the first kEach in q, then in v, then in u; zero in the others.
struct Directions {
  Directions(const Scene& scene, unsigned seed) : q(scene.nv, 3 * kEach), v(q), u(scene.nu, 3 * kEach) {
    std::mt19937 rng(seed);
    for (Eigen::MatrixXd* all : {&q, &v, &u}) all->setZero();
    for (int k = 0; k < kEach; ++k) {
      q.col(k) = random_vector(scene.nv, rng);
      v.col(kEach + k) = random_vector(scene.nv, rng);
      u.col(2 * kEach + k) = random_vector(scene.nu, rng);
    }
  }
  Eigen::MatrixXd q, v, u;
};

// Returns [a; f] differentiated along the directions, scene.nv + nc rows.
MatX<Quad> true_products(const Scene& scene, const std::vector<char>& active, const State& s, const Directions& d) {
  MatX<Quad> out;
  for (int k = 0; k < 3 * kEach; ++k) {
    const DirectionalTruth t =
        difference_along(scene, active, s, d.q.col(k).cast<Quad>(), d.v.col(k).cast<Quad>(), d.u.col(k).cast<Quad>());
    out.conservativeResize(t.da.size() + t.df.size(), 3 * kEach);
    out.col(k) << t.da, t.df;
  }
  return out;
}

Eigen::MatrixXd products(const Scene& scene, SceneData& data, const Directions& d) {
  Eigen::MatrixXd out(scene.nv + data.f.size(), 3 * kEach);
  Eigen::VectorXd da(scene.nv), df(data.f.size());
  for (int k = 0; k < 3 * kEach; ++k) {
    da.setConstant(NAN), df.setConstant(NAN);
    jvp(scene, data, d.q.col(k), d.v.col(k), d.u.col(k), da, df);
    out.col(k) << da, df;
  }
  return out;
}

Eigen::MatrixXd matrices_times(const Scene& scene, SceneData& data, const Directions& d) {
  differentiate_afresh(scene, data);
  const SceneDerivatives m = dense_derivatives(scene, data);
  Eigen::MatrixXd out(scene.nv + data.f.size(), 3 * kEach);
  out << m.da_dq * d.q + m.da_dv * d.v + m.da_du * d.u, m.dforces_dq * d.q + m.dforces_dv * d.v + m.dforces_du * d.u;
  return out;
}

DerivativeErrors errors_along(const Scene& scene, const SceneData& data, const Eigen::MatrixXd& answer,
                              const MatX<Quad>& truth, const std::vector<double>& condition) {
  DerivativeErrors e;
  const std::vector<Island> islands = islands_at(scene, data);
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const Places p(scene, data, islands[i]);
    std::vector<int> rows = p.v;
    for (int f : p.f) rows.push_back(scene.nv + f);
    e.add(derivative_errors(scene, islands[i], answer(rows, Eigen::all), truth(rows, Eigen::all),
                            {0, kEach, 2 * kEach, 3 * kEach}, condition[i]));
  }
  return e;
}

void expect_differences_along(const std::string& name, const Scene& scene, const State& s) {
  SCOPED_TRACE(name);
  SceneData oracle(scene, {Method::kDense, {}});
  ASSERT_EQ(solve(scene, s.q, s.v, s.u, oracle).status, Status::kOk);
  const std::vector<double> condition = conditions(scene, oracle);
  const Directions directions(scene, 13);
  const MatX<Quad> truth = true_products(scene, oracle.active, s, directions);
  DerivativeErrors all;
  std::string worst;
  for (const Way& way : ways(true)) {
    SceneData data(scene, way.options);
    EXPECT_EQ(solve(scene, s.q, s.v, s.u, data).status, Status::kOk);
    for (bool by_matrices : {false, true}) {
      SCOPED_TRACE(way.name + (by_matrices ? " matrices" : " jvp"));
      Eigen::MatrixXd answer =
          by_matrices ? matrices_times(scene, data, directions) : products(scene, data, directions);
      const DerivativeErrors e = errors_along(scene, data, answer, truth, condition);
      EXPECT_LE(e.excess, 1);
      for (double error : e.quantity) EXPECT_LE(error, kExpected);
      if (!(e.excess <= all.excess)) worst = way.name + (by_matrices ? " matrices" : " jvp");
      all.add(e);
      EXPECT_GT(size_of(answer), 1);
      EXPECT_FALSE(answer == truth.cast<double>());
      answer.col(0) *= 1 + 1e-5;  // the largest entry of the other direction may be larger
      EXPECT_GT(errors_along(scene, data, answer, truth, condition).excess, 1);
    }
  }
  print_row(name, oracle.report.condition, all, worst);
}

class DirectionsOf : public testing::TestWithParam<std::string> {};

// Copies are reduced to four.
TEST_P(DirectionsOf, MatricesAndProductsByEveryMethod) {
  SceneFile file = load_small(GetParam());
  expect_differences_along(scene_name(GetParam()) + " as given", file.scene, {file.q, file.v, file.u});
  std::mt19937 rng(11);
  disturb(file, rng);
  expect_differences_along(scene_name(GetParam()) + " moving", file.scene, {file.q, file.v, file.u});
}

std::vector<std::string> large_scenes() {
  std::vector<std::string> out;
  for (const char* name : {"herd", "ring_of_humanoids", "two_humanoids_carry_beam"})
    out.push_back(std::string(MANYCONTACT_SOURCE_DIR "/models/") + name + ".xml");
  for (const std::string& path : golden_scenes())
    if (path.ends_with("/ring_of_four_talos.xml") || path.ends_with("/two_talos_hand_in_hand.xml")) out.push_back(path);
  return out;
}

INSTANTIATE_TEST_SUITE_P(Large, DirectionsOf, testing::ValuesIn(large_scenes()), scene_title);

// No scene is left out: those that differences_test.cpp finds too large are here.
TEST(Directions, CoverWhatIsTooLarge) {
  for (const std::string& path : model_scenes()) {
    const std::vector<std::string> here = large_scenes();
    if (largest_island(load_small(path).scene) > 60) {
      EXPECT_NE(std::find(here.begin(), here.end(), path), here.end()) << path;
    }
  }
}

}  // namespace
}  // namespace manycontact::test
