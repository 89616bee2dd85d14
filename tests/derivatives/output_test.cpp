// Derivatives have several forms: blocks per island, whole matrices, one sparse matrix; parts of them; after other
// states and contacts; of failed islands. Their allocations are tested too.

#include "derivatives/judge.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/views.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Returns whether numbers are equal, NaN being equal to NaN.
bool same(const MatrixXd& x, const MatrixXd& y) {
  return x.rows() == y.rows() && x.cols() == y.cols() &&
         ((x.array() == y.array()) || (x.array().isNaN() && y.array().isNaN())).all();
}

std::array<MatrixXd, 6> list(const SceneDerivatives& d) {
  return {d.da_dq, d.da_dv, d.da_du, d.dforces_dq, d.dforces_dv, d.dforces_du};
}

std::array<MatrixXd, 6> list(const IslandDerivatives& d) {
  return {d.da_dq(), d.da_dv(), d.da_du(), d.dforces_dq(), d.dforces_dv(), d.dforces_du()};
}

bool same(const SceneDerivatives& x, const SceneDerivatives& y) {
  const std::array<MatrixXd, 6> xs = list(x), ys = list(y);
  for (int k = 0; k < 6; ++k)
    if (!same(xs[k], ys[k])) return false;
  return true;
}

// Two of three robots are coupled, each with contacts with the world: two islands, neither contiguous.
struct TwoIslands {
  TwoIslands() {
    std::mt19937 rng(40);
    SceneOptions options;
    options.models = {{.njoints = 7, .floating_base = true}, {.njoints = 6}, {.njoints = 8, .floating_base = true}};
    options.nrobots = 3;
    options.same_model = 0;
    options.between_bodies = 0;
    options.ncontacts = 5;
    s = random_scene(rng, options);
    Contact joined;
    joined.name = "joined";
    joined.type = ContactType::k3D;
    joined.A = {0, 3, random_placement(rng, 0.2)};
    joined.B = {2, 4, random_placement(rng, 0.2)};
    add_contact(s.scene, joined);
  }
  State state() const { return {s.q, s.v, s.u}; }
  RandomScene s;
};

class Output : public testing::Test {
 protected:
  // Returns derivatives in data of their own.
  static SceneDerivatives fresh(const Scene& scene, const State& s, const Options& options,
                                const std::vector<char>& active) {
    SceneData data(scene, options);
    data.active = active;
    (void)solve(scene, s.q, s.v, s.u, data);
    differentiate(scene, data);
    return dense_derivatives(scene, data);
  }

  TwoIslands two;
  const Scene& scene = two.s.scene;
  const State state = two.state();
};

TEST_F(Output, TheSceneIsWhatItShouldBe) {
  SceneData data(scene);
  ASSERT_EQ(island_count(data), 2u);
  EXPECT_EQ(solved_island(data, 0).robots, (std::vector<int>{0, 2}));
  EXPECT_EQ(solved_island(data, 1).robots, (std::vector<int>{1}));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_GT(solved_island(data, i).nc, 0);
  EXPECT_EQ(status_at(scene, state), Status::kOk);
}

TEST_F(Output, BlocksMatricesAndTheSparseMatrixAreOne) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    (void)solve(scene, state.q, state.v, state.u, data);
    const DerivativeData& dd = differentiate_afresh(scene, data);
    const SceneDerivatives dense = dense_derivatives(scene, data);
    MatrixXd whole(scene.nv + data.f.size(), 2 * scene.nv + scene.nu);
    whole << dense.da_dq, dense.da_dv, dense.da_du, dense.dforces_dq, dense.dforces_dv, dense.dforces_du;
    EXPECT_TRUE(whole.allFinite());
    const Eigen::SparseMatrix<double> sparse = sparse_derivatives(scene, data);
    EXPECT_TRUE(MatrixXd(sparse) == whole);
    Eigen::Index entries = 0;
    MatrixXd rest = whole;  // outside the islands' blocks: zero
    for (std::size_t i = 0; i < dd.islands.size(); ++i) {
      const IslandDerivatives& d = dd.islands[i];
      const Places p(scene, data, solved_island(data, i));
      std::vector<int> rows = p.v, columns = p.v;
      for (int f : p.f) rows.push_back(scene.nv + f);
      for (int v : p.v) columns.push_back(scene.nv + v);
      for (int u : p.u) columns.push_back(2 * scene.nv + u);
      MatrixXd blocks(d.nv + d.nc, 2 * d.nv + d.nu);
      blocks << d.da_dq(), d.da_dv(), d.da_du(), d.dforces_dq(), d.dforces_dv(), d.dforces_du();
      EXPECT_TRUE(whole(rows, columns) == blocks);
      rest(rows, columns).setZero();
      entries += blocks.size();
      EXPECT_EQ(d.X.rightCols(d.X.cols() - d.cols).cwiseAbs().sum(), 0);  // the padding
    }
    EXPECT_EQ(size_of(rest), 0);
    EXPECT_EQ(sparse.nonZeros(), entries);
  }
}

// Every combination of requests gives the same numbers as the full request, and nothing else.
void expect_requests(const Scene& scene, const State& s, const Options& options) {
  SceneData full(scene, options);
  (void)solve(scene, s.q, s.v, s.u, full);
  differentiate(scene, full);
  const std::array<MatrixXd, 6> all = list(dense_derivatives(scene, full));
  SceneData data(scene, options);
  (void)solve(scene, s.q, s.v, s.u, data);
  for (int bits = 15; bits >= 0; --bits) {
    const DerivativeRequest request{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0};
    SCOPED_TRACE("q " + std::to_string(request.q) + " v " + std::to_string(request.v) + " u " +
                 std::to_string(request.u) + " forces " + std::to_string(request.forces));
    differentiate_afresh(scene, data, request);
    const std::array<MatrixXd, 6> parts = list(dense_derivatives(scene, data));
    const Eigen::SparseMatrix<double> sparse = sparse_derivatives(scene, data);
    const bool asked[] = {request.q, request.v, request.u};
    Eigen::Index columns = 0;
    for (int k = 0; k < 6; ++k) {
      if (k < 3 || request.forces) {
        EXPECT_EQ(parts[k].rows(), all[k].rows());
      } else {
        EXPECT_EQ(parts[k].rows(), 0);
      }
      EXPECT_EQ(parts[k].cols(), asked[k % 3] ? all[k].cols() : 0);
      if (parts[k].size() > 0) {
        EXPECT_LE(error_of(parts[k], all[k]), 1e-14) << kQuantities[k];  // columns may be summed up in another order
        EXPECT_TRUE(MatrixXd(sparse).block(k < 3 ? 0 : scene.nv, columns, parts[k].rows(), parts[k].cols()) ==
                    parts[k]);
      }
      columns = k == 2 ? 0 : columns + parts[k].cols();
    }
    EXPECT_EQ(sparse.rows(), scene.nv + (request.forces ? full.f.size() : 0));
    EXPECT_EQ(sparse.cols(), columns);
  }
}

TEST_F(Output, PartsAreThoseOfTheWhole) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    expect_requests(scene, state, way.options);
  }
}

TEST_F(Output, PartsAreThoseOfTheWholeOfDependentContacts) {
  SceneFile file = load_scene(kModels + "feet_on_corners.xml");
  expect_requests(file.scene, {file.q, file.v, file.u}, {});  // redundant
  std::mt19937 rng(3);
  disturb(file, rng);
  expect_requests(file.scene, {file.q, file.v, file.u}, {});  // inconsistent
}

// An island's derivatives do not change, to the last bit, when another island moves.
TEST_F(Output, IslandsAreIndependent) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    (void)solve(scene, state.q, state.v, state.u, data);
    differentiate(scene, data);
    const std::vector<Island> islands = islands_at(scene, data);
    const MatrixXd before[] = {answer_of(scene, data, islands[0], 0), answer_of(scene, data, islands[1], 1)};
    State moved = state;
    const Robot& robot = scene.robots[1];  // the second island
    moved.v.segment(robot.idx_v, robot.model->nv) *= -2;
    moved.u.segment(robot.idx_u, robot.model->nu()).array() += 3;
    (void)solve(scene, moved.q, moved.v, moved.u, data);
    differentiate(scene, data);
    // the baseline treats all islands as one
    const double tolerance = way.options.method == Method::kDenseSchur ? 1e-12 : 0;
    EXPECT_LE(error_of(answer_of(scene, data, islands[0], 0), before[0]), tolerance);
    EXPECT_GT(error_of(answer_of(scene, data, islands[1], 1), before[1]), 1e-3);
  }
}

TEST_F(Output, ForgetTheStateBefore) {
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    std::mt19937 rng(8);
    (void)solve(scene, state.q, random_vector(scene.nv, rng), random_vector(scene.nu, rng), data);
    differentiate(scene, data);
    (void)solve(scene, state.q, state.v, state.u, data);
    differentiate(scene, data);
    EXPECT_TRUE(same(dense_derivatives(scene, data), fresh(scene, state, way.options, data.active)));
  }
}

// Contacts are switched off, on again, others off: earlier sets have no effect. Without the tie an island is added.
TEST_F(Output, ForgetTheContactsBefore) {
  const std::size_t n = scene.contacts.size();
  std::vector<std::vector<char>> sets(5, std::vector<char>(n, 1));
  sets[1].back() = 0;
  sets[2].assign(n, 0);
  sets[4][0] = 0;
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    SceneData data(scene, way.options);
    for (const std::vector<char>& active : sets) {
      data.active = active;
      (void)solve(scene, state.q, state.v, state.u, data);
      if (way.options.method != Method::kDenseSchur) {
        EXPECT_EQ(island_count(data), active.back() ? 2u : 3u);
      }
      differentiate(scene, data);
      const SceneDerivatives d = dense_derivatives(scene, data);
      EXPECT_EQ(d.dforces_dq.rows(), data.f.size());
      EXPECT_TRUE(same(d, fresh(scene, state, way.options, active)));
      VectorXd da = VectorXd::Constant(scene.nv, NAN), df = VectorXd::Constant(data.f.size(), NAN);
      const VectorXd x = VectorXd::Ones(scene.nv), u = VectorXd::Ones(scene.nu);
      jvp(scene, data, x, x, u, da, df);
      EXPECT_LE(error_of(da, VectorXd(d.da_dq * x + d.da_dv * x + d.da_du * u)), 1e-11);
    }
  }
}

// A robot with an invalid quaternion fails with its island alone.
TEST(FailedIslands, AreNotANumber) {
  SceneFile file = load_small(kModels + "herd.xml");
  const Scene& scene = file.scene;
  std::mt19937 rng(4);
  disturb(file, rng);
  VectorXd broken = file.q;
  broken.segment<4>(scene.robots[2].idx_q + 3) *= 2;
  for (const Way& way : ways(true)) {
    SCOPED_TRACE(way.name);
    const bool whole = way.options.method == Method::kDenseSchur;  // one system: all islands fail
    SceneData good(scene, way.options), bad(scene, way.options);
    (void)solve(scene, file.q, file.v, file.u, good);
    (void)solve(scene, broken, file.v, file.u, bad);
    EXPECT_EQ(bad.report.status, Status::kFailed);
    const DerivativeData& expected = differentiate(scene, good);
    const DerivativeData& dd = differentiate_afresh(scene, bad);
    ASSERT_EQ(dd.islands.size(), whole ? 1u : 4u);
    for (std::size_t i = 0; i < dd.islands.size(); ++i)
      for (int k = 0; k < 6; ++k) {
        const MatrixXd x = list(dd.islands[i])[k];
        EXPECT_TRUE(i == 2 || whole ? x.array().isNaN().all() : same(x, list(expected.islands[i])[k]));
      }
    VectorXd da(scene.nv), df(bad.f.size()), wq(scene.nv), wv(scene.nv), wu(scene.nu);
    jvp(scene, bad, VectorXd::Ones(scene.nv), VectorXd::Ones(scene.nv), VectorXd::Ones(scene.nu), da, df);
    vjp(scene, bad, VectorXd::Ones(scene.nv), VectorXd::Ones(df.size()), wq, wv, wu);
    for (int r = 0; r < 4; ++r) {
      const Robot& robot = scene.robots[r];
      const auto all = [&](const VectorXd& x, int first, int count) {  // all NaN, or none
        return r == 2 || whole ? x.segment(first, count).array().isNaN().all() : x.segment(first, count).allFinite();
      };
      for (const VectorXd* x : {&da, &wq, &wv}) EXPECT_TRUE(all(*x, robot.idx_v, robot.model->nv));
      EXPECT_TRUE(all(wu, robot.idx_u, robot.model->nu()));
    }
    // The next solve is not affected.
    (void)solve(scene, file.q, file.v, file.u, bad);
    differentiate(scene, bad);
    EXPECT_TRUE(same(dense_derivatives(scene, bad), dense_derivatives(scene, good)));
  }
}

// ---- allocation -------------------------------------------------------------------------------------------------

// Counts after the first solve, derivatives and products. `file` changes in between.
void expect_no_allocations(const Scene& scene, SceneFile& file, const Options& options,
                           const DerivativeRequest& request) {
  std::mt19937 rng(13);
  disturb(file, rng);
  SceneData data(scene, options);
  const VectorXd x = random_vector(scene.nv, rng), u = random_vector(scene.nu, rng);
  const VectorXd w = random_vector(static_cast<int>(data.f.size()), rng);
  VectorXd da(scene.nv), df(w.size()), wq(scene.nv), wv(scene.nv), wu(scene.nu);
  const auto all = [&] {
    (void)solve(scene, file.q, file.v, file.u, data);
    differentiate(scene, data, request);
    jvp(scene, data, x, x, u, da, df);
    vjp(scene, data, x, w, wq, wv, wu);
  };
  all();
  for (int again = 0; again < 4; ++again) {
    disturb(file, rng);  // other numbers, the same contacts; some need refinement, some do not
    EXPECT_EQ(allocations(all), 0u);
    EXPECT_EQ(data.report.status, status_at(scene, {file.q, file.v, file.u}));
  }
}

class SteadyDerivatives : public testing::TestWithParam<std::string> {};

TEST_P(SteadyDerivatives, AllocateNothingAfterTheFirstCall) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const SceneFile file = load_small(GetParam());
  for (const Way& way : ways_here()) {
    if (way.options.method != Method::kSparseLdl) continue;
    SCOPED_TRACE(way.name);
    for (const DerivativeRequest& request : {DerivativeRequest{}, DerivativeRequest{true, false, false, false}}) {
      SceneFile moving = file;
      expect_no_allocations(file.scene, moving, way.options, request);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, SteadyDerivatives, testing::ValuesIn(model_scenes()), scene_title);

// Islands of different sizes share the workspace.
TEST(Steady, AllocateNothingForUnequalIslands) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const TwoIslands two;
  SceneFile file;
  file.scene = two.s.scene, file.q = two.s.q, file.v = two.s.v, file.u = two.s.u;
  expect_no_allocations(two.s.scene, file, {Method::kSparseLdl, Order::kLeafToRoot}, {});
}

// The counter counts allocations.
TEST(Steady, AllocationsAreCounted) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  static VectorXd x;  // so that compilers may not omit it
  EXPECT_GE(allocations([] { x = VectorXd::Zero(100); }), 1u);
}

}  // namespace
}  // namespace manycontact::test
