// With wrenches and springs all derivatives of every method agree with differences of the truth, products with
// matrices.

#include "derivatives/judge.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "support/applied.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

RandomScene pushed_scene(int seed, double damping = 0) {
  std::mt19937 rng(seed);
  SceneOptions options;
  options.nrobots = 1 + seed % 3;
  options.ncontacts = 6;
  options.damping = damping;
  options.passive = 0.2;
  options.friction = seed % 2 == 0 ? 0.5 : 0;
  RandomScene s = random_scene(rng, options);
  add_random_forces(s.scene, rng);
  return s;
}

class AppliedForcesOf : public testing::TestWithParam<int> {};

TEST_P(AppliedForcesOf, AllMatricesByEveryMethod) {
  const RandomScene s = pushed_scene(GetParam());
  const State state{s.q, s.v, s.u};
  expect_differences("forces " + std::to_string(GetParam()), s.scene, state, status_at(s.scene, state));
}

// Returns [da_dw; dforces_dw] of a scene, column by column.
MatX<Quad> differences_by_wrenches(const RandomScene& s, const std::vector<char>& active, Eigen::Index nf) {
  const Scene& scene = s.scene;
  const VecX<Quad> q = s.q.cast<Quad>(), v = s.v.cast<Quad>(), u = s.u.cast<Quad>();
  MatX<Quad> out(scene.nv + nf, 6 * scene.wrenches.size());
  const Quad h = Quad(1) / Quad(10000000000LL);
  for (Eigen::Index k = 0; k < out.cols(); ++k) {
    const auto moved = [&](const Quad& by) {
      std::vector<Vec6<Quad>> w;
      for (const ExternalWrench& push : scene.wrenches) w.push_back(push.wrench.cast<Quad>());
      w[k / 6][k % 6] += by;
      return solve_truth<Quad>(scene, active, q, v, u, w);
    };
    const Truth<Quad> after = moved(h), before = moved(-h);
    out.col(k) << (after.a - before.a) / (2 * h), (after.f - before.f) / (2 * h);
  }
  return out;
}

// Expects errors of each island's matrices within their bounds, and meaningful bounds.
void expect_true_bounds_by_wrenches(const Scene& scene, SceneData& data, const SceneDerivatives& d,
                                    const MatX<Quad>& truth) {
  const std::vector<DerivativeBounds> bounds = estimate_derivative_errors(scene, data);
  const std::vector<Island> islands = islands_at(scene, data);
  ASSERT_EQ(bounds.size(), islands.size());
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const auto expect_within = [&](const MatrixXd& x, Eigen::Index first, const std::vector<int>& rows, double bound) {
      double error = 0, size = 0;
      for (int row : rows) {
        error = std::max(error, difference_of(MatrixXd(x.row(row)), MatX<Quad>(truth.row(first + row))));
        size = std::max(size, size_of(MatrixXd(x.row(row))));
      }
      EXPECT_LE(error, bound * size);
      if (size > 0) {
        EXPECT_LE(bound, 1e-9);
      }
    };
    const Places p(scene, data, islands[i]);
    expect_within(d.da_dw, 0, p.v, bounds[i].da_dw);
    expect_within(d.dforces_dw, scene.nv, p.f, bounds[i].dforces_dw);
  }
}

TEST_P(AppliedForcesOf, ByWrenches) {
  const RandomScene s = pushed_scene(GetParam());
  SceneData oracle(s.scene, {Method::kDense, {}});
  const MatX<Quad> truth = differences_by_wrenches(s, oracle.active, oracle.f.size());
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(s.scene, way.options);
    ASSERT_EQ(solve(s.scene, s.q, s.v, s.u, data).status, Status::kOk);
    for (const bool tau : {false, true}) {
      (void)differentiate(s.scene, data, {true, true, true, true, tau, true});
      const SceneDerivatives d = dense_derivatives(s.scene, data);
      MatrixXd mine(truth.rows(), truth.cols());
      mine << d.da_dw, d.dforces_dw;
      EXPECT_LE(difference_of(mine, truth), 1e-10 * size_of(truth));
      EXPECT_GT(size_of(mine), 1e-3);
      expect_true_bounds_by_wrenches(s.scene, data, d, truth);
      const MatrixXd sparse(sparse_derivatives(s.scene, data));
      EXPECT_EQ(sparse.rightCols(mine.cols()), mine);
    }
  }
}

// Matrices that were not requested do not affect the others.
TEST_P(AppliedForcesOf, PartsOfTheMatrices) {
  const RandomScene s = pushed_scene(GetParam());
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(s.scene, way.options);
    (void)solve(s.scene, s.q, s.v, s.u, data);
    (void)differentiate_afresh(s.scene, data);
    const SceneDerivatives all = dense_derivatives(s.scene, data);
    for (const DerivativeRequest& request : {DerivativeRequest{true, false, false},
                                             {false, true, false},
                                             {false, false, true},
                                             {true, true, false, false}}) {
      (void)differentiate_afresh(s.scene, data, request);
      const SceneDerivatives some = dense_derivatives(s.scene, data);
      const auto expect_part = [](const MatrixXd& part, const MatrixXd& whole, bool wanted) {
        EXPECT_EQ(part.cols(), wanted ? whole.cols() : 0);
        if (wanted && whole.size() > 0) {
          EXPECT_LE(difference_of(part, whole), 1e-10 * size_of(whole));
        }
      };
      expect_part(some.da_dq, all.da_dq, request.q);
      expect_part(some.da_dv, all.da_dv, request.v);
      expect_part(some.da_du, all.da_du, request.u);
      expect_part(some.dforces_dq, request.forces ? all.dforces_dq : MatrixXd(0, all.dforces_dq.cols()), request.q);
      expect_part(some.dforces_du, request.forces ? all.dforces_du : MatrixXd(0, all.dforces_du.cols()), request.u);
    }
  }
}

TEST_P(AppliedForcesOf, Products) {
  const RandomScene s = pushed_scene(GetParam());
  const Scene& scene = s.scene;
  const int nv = scene.nv, nu = scene.nu, nw = static_cast<int>(6 * scene.wrenches.size());
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    std::mt19937 rng(5);
    SceneData data(scene, way.options);
    (void)solve(scene, s.q, s.v, s.u, data);
    const VectorXd x = random_vector(2 * nv + nu + nw, rng),
                   y = random_vector(nv + static_cast<int>(data.f.size()), rng);
    VectorXd Jx = VectorXd::Constant(y.size(), NAN), yJ = VectorXd::Constant(x.size(), NAN);
    VectorXd da(nv), df(data.f.size()), wq(nv), wv(nv), wu(nu), ww(nw);
    jvp(scene, data, x.head(nv), x.segment(nv, nv), x.segment(2 * nv, nu), x.tail(nw), da, df);
    vjp(scene, data, y.head(nv), y.tail(data.f.size()), wq, wv, wu, ww);
    Jx << da, df;
    yJ << wq, wv, wu, ww;
    (void)differentiate(scene, data, {true, true, true, true, false, true});
    const MatrixXd J(sparse_derivatives(scene, data));
    EXPECT_LE(difference_of(Jx, VectorXd(J * x)), 1e-10 * size_of(VectorXd(J.cwiseAbs() * x.cwiseAbs())));
    EXPECT_LE(difference_of(yJ, VectorXd(J.transpose() * y)),
              1e-10 * size_of(VectorXd(J.cwiseAbs().transpose() * y.cwiseAbs())));
    jvp(scene, data, x.head(nv), x.segment(nv, nv), x.segment(2 * nv, nu), da, df);  // dw = 0
    const MatrixXd without = J.topRows(nv).leftCols(2 * nv + nu);
    EXPECT_LE(difference_of(da, VectorXd(without * x.head(2 * nv + nu))),
              1e-10 * size_of(VectorXd(without.cwiseAbs() * x.head(2 * nv + nu).cwiseAbs())));
    vjp(scene, data, y.head(nv), y.tail(data.f.size()), wq, wv, wu);
    EXPECT_EQ(wq, yJ.head(nv));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, AppliedForcesOf, testing::Range(820, 826));

TEST(AppliedForces, WithDamping) {
  const RandomScene s = pushed_scene(832, 1e-3);
  expect_differences("forces, damping", s.scene, {s.q, s.v, s.u}, Status::kOk);
}

TEST(AppliedForces, WhereContactsDepend) {
  std::mt19937 rng(840);
  SceneOptions options;
  options.redundant = 2;
  RandomScene s = random_scene(rng, options);
  add_random_forces(s.scene, rng);
  expect_differences("forces, redundant", s.scene, {s.q, s.v, s.u}, Status::kRedundant);
}

}  // namespace
}  // namespace manycontact::test
