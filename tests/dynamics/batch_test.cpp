// In batches of states every state has the numbers of new SceneData, whatever states share its batch, for any number of
// threads.

#include "manycontact/dynamics/batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <thread>

#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/dynamics/copies.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "support/allocations.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

struct States {
  BatchMatrix q, v, u;
  int count() const { return static_cast<int>(q.rows()); }
  BatchStates view() const { return {q, v, u}; }

  States(const Scene& scene, int count) : q(count, scene.nq), v(count, scene.nv), u(count, scene.nu) {}
  void set(int k, const SceneFile& file) {
    q.row(k) = file.q.transpose();
    v.row(k) = file.v.transpose();
    u.row(k) = file.u.transpose();
  }
  States picked(const std::vector<int>& order) const {
    States out = *this;
    out.q = q(order, Eigen::all).eval();
    out.v = v(order, Eigen::all).eval();
    out.u = u(order, Eigen::all).eval();
    return out;
  }
};

/// The outputs are full of NaN, as a caller may have left anything there.
struct Answers {
  BatchMatrix A, F, D, WA, WF, WQ, WV, WU, WW;
  std::vector<Status> status;

  Answers(const Scene& scene, int nf, int count) : status(count, Status::kRegularised) {
    const auto poisoned = [count](Eigen::Index cols) -> BatchMatrix {
      return BatchMatrix::Constant(count, cols, std::numeric_limits<double>::quiet_NaN());
    };
    A = WQ = WV = poisoned(scene.nv);
    F = poisoned(nf);
    D = poisoned((scene.nv + nf) * (2 * scene.nv + scene.nu));
    WU = poisoned(scene.nu);
    WW = poisoned(static_cast<Eigen::Index>(6 * scene.wrenches.size()));
    std::mt19937 rng(5);  // the same weights for each state
    WA = random_vector(scene.nv, rng).transpose().replicate(count, 1);
    WF = random_vector(nf, rng).transpose().replicate(count, 1);
  }
  Answers picked(const std::vector<int>& order) const {
    Answers out = *this;
    for (auto X : {&Answers::A, &Answers::F, &Answers::D, &Answers::WQ, &Answers::WV, &Answers::WU, &Answers::WW})
      out.*X = (this->*X)(order, Eigen::all).eval();
    for (std::size_t k = 0; k < order.size(); ++k) out.status[k] = status[order[k]];
    return out;
  }
};

void expect_same_bits(const BatchMatrix& x, const BatchMatrix& y, const char* what) {
  ASSERT_EQ(x.rows(), y.rows()) << what;
  ASSERT_EQ(x.cols(), y.cols()) << what;
  for (Eigen::Index k = 0; x.cols() > 0 && k < x.rows(); ++k)
    EXPECT_EQ(std::memcmp(x.data() + k * x.cols(), y.data() + k * y.cols(), sizeof(double) * x.cols()), 0)
        << what << " of state " << k;
}
void expect_same(const Answers& x, const Answers& y) {
  expect_same_bits(x.A, y.A, "a");
  expect_same_bits(x.F, y.F, "f");
  expect_same_bits(x.D, y.D, "derivatives");
  expect_same_bits(x.WQ, y.WQ, "wq");
  expect_same_bits(x.WV, y.WV, "wv");
  expect_same_bits(x.WU, y.WU, "wu");
  expect_same_bits(x.WW, y.WW, "ww");
  EXPECT_EQ(x.status, y.status);
}

int nf_of(const Scene& scene, const std::vector<char>& active) {
  int rows = 0;
  for (std::size_t c = 0; c < active.size(); ++c) rows += active[c] ? scene.contacts[c].rows() : 0;
  return rows;
}

/// Solves each state with new SceneData.
Answers alone(const Scene& scene, const States& s, const Options& options, const std::vector<char>& active) {
  const int nf = nf_of(scene, active), cols = 2 * scene.nv + scene.nu;
  Answers out(scene, nf, s.count());
  for (int k = 0; k < s.count(); ++k) {
    SceneData data(scene, options);
    data.active = active;
    out.status[k] = solve(scene, s.q.row(k).transpose(), s.v.row(k).transpose(), s.u.row(k).transpose(), data).status;
    out.A.row(k) = data.a.transpose();
    out.F.row(k) = data.f.transpose();
    differentiate(scene, data);
    const SceneDerivatives d = dense_derivatives(scene, data);
    Eigen::Map<BatchMatrix> D(out.D.row(k).data(), scene.nv + nf, cols);
    D.topRows(scene.nv) << d.da_dq, d.da_dv, d.da_du;
    D.bottomRows(nf) << d.dforces_dq, d.dforces_dv, d.dforces_du;
    Eigen::VectorXd wq(scene.nv), wv(scene.nv), wu(scene.nu), ww(out.WW.cols());
    vjp(scene, data, out.WA.row(k).transpose(), out.WF.row(k).transpose(), wq, wv, wu, ww);
    out.WQ.row(k) = wq.transpose();
    out.WV.row(k) = wv.transpose();
    out.WU.row(k) = wu.transpose();
    out.WW.row(k) = ww.transpose();
  }
  return out;
}

Answers in_batch(const Scene& scene, const States& s, BatchData& batch) {
  Answers out(scene, force_rows(scene, batch), s.count());
  solve_batch(scene, s.view(), batch, out.A, out.F, out.status);
  const BatchMatrix A = out.A, F = out.F;
  const std::vector<Status> status = out.status;
  differentiate_batch(scene, s.view(), batch, out.A, out.F, out.D, out.status);
  expect_same_bits(A, out.A, "a, solved and differentiated");
  expect_same_bits(F, out.F, "f, solved and differentiated");
  EXPECT_EQ(status, out.status);
  vjp_batch(scene, s.view(), out.WA, out.WF, batch, out.WQ, out.WV, out.WU, out.WW, out.status);
  Answers bare = out;
  vjp_batch(scene, s.view(), out.WA, out.WF, batch, bare.WQ, bare.WV, bare.WU, bare.status);
  expect_same(bare, out);
  return out;
}

/// Expects the same results for 1, 2, 3 and 5 threads, and in another order of the states.
void expect_history_counts_for_nothing(const Scene& scene, const States& s, const Options& options,
                                       const std::vector<char>& active) {
  const Answers expected = alone(scene, s, options, active);
  std::mt19937 rng(11);
  std::vector<int> order(s.count());
  std::iota(order.begin(), order.end(), 0);
  for (int threads : {1, 2, 3, 5}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    BatchData batch(scene, threads, options);
    ASSERT_EQ(batch.threads.size(), static_cast<std::size_t>(threads));
    batch.active = active;
    expect_same(in_batch(scene, s.picked(order), batch), expected.picked(order));
    expect_same(in_batch(scene, s, batch), expected);  // again, with memory in use
    std::shuffle(order.begin(), order.end(), rng);
  }
}

States disturbed_states(SceneFile file, int count, double size, unsigned seed) {
  States s(file.scene, count);
  std::mt19937 rng(seed);
  const SceneFile start = file;
  for (int k = 0; k < count; ++k) {
    file.q = start.q;
    file.v = start.v;
    file.u = start.u;
    disturb(file, rng, size);
    s.set(k, file);
  }
  return s;
}

TEST(Batch, AsManyTimesSolveOnEveryModel) {
  for (const std::string& path : model_scenes()) {
    SCOPED_TRACE(path);
    const SceneFile file = load_small(path);
    const States s = disturbed_states(file, 7, 0.1, 1);
    expect_history_counts_for_nothing(file.scene, s, {}, SceneData(file.scene).active);
  }
}

// Some states fail, are redundant or inconsistent.
TEST(Batch, WhatStoodBeforeCountsForNothing) {
  for (const char* name : {"feet_on_corners", "quadruped_loop", "humanoid_hands_and_feet", "arm_pushes_box"}) {
    SceneFile file = load_small(kModels + name + ".xml");
    const Scene& scene = file.scene;
    const SceneFile start = file;
    States s(scene, 16);
    for (int k = 0; k < s.count(); ++k) {
      std::mt19937 rng(k % 4);
      file.q = start.q;
      file.v = start.v;
      file.u = start.u;
      if (k % 5 > 0) disturb(file, rng, k % 3 == 0 ? 1e-6 : 0.2);
      if (k == 6) file.q[scene.nq - 1] = std::numeric_limits<double>::quiet_NaN();
      if (k == 9) file.u[0] = std::numeric_limits<double>::infinity();
      if (k == 12) file.v.setConstant(1e160);
      s.set(k, file);
    }
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(std::string(name) + ", " + way.name);
      expect_history_counts_for_nothing(scene, s, way.options, SceneData(scene).active);
    }
  }
}

// An arm fixed at its tool is straightened step by step: in between its rows are nearly dependent, which one order of
// elimination detects and another does not. Straight arms are among the others.
TEST(Batch, RowsThatBecomeDependentAndIndependentAgain) {
  SceneFile file = load_text(R"(<scene>
  <robot name="arm" urdf="arm.urdf" base="fixed"/>
  <contact name="hold" type="6d" frame="arm/tool" xyz="0.3 0 0.9" gains="100 20"/>
</scene>)");
  const Scene& scene = file.scene;
  std::mt19937 rng(3);
  disturb(file, rng, 0.5);
  States s(scene, 64);
  for (int k = 0; k < s.count(); ++k) {
    file.q[q_index(scene, "arm", "elbow")] = k % 2 ? 0 : std::pow(10.0, -2 - k / 5.0);
    s.set(k, file);
  }
  std::vector<Way> all = ways(true);
  for (const Way& way : all) {
    SCOPED_TRACE(way.name);
    expect_history_counts_for_nothing(scene, s, way.options, {1});
    if (way.options.method == Method::kDenseSchur) continue;
    const std::vector<Status> status = alone(scene, s, way.options, {1}).status;
    EXPECT_GT(std::count(status.begin(), status.end(), Status::kOk), 5);
    EXPECT_GT(std::count(status.begin(), status.end(), Status::kInconsistent), 34);
  }
}

TEST(Batch, ContactsAreSwitchedByTheBatch) {
  const SceneFile file = load_small(kModels + "herd.xml");
  const States s = disturbed_states(file, 3, 0.1, 4);
  BatchData batch(file.scene, 2);
  for (const std::size_t off : {0u, 3u}) {
    batch.active.assign(file.scene.contacts.size(), 1);
    batch.active[off] = 0;
    expect_same(in_batch(file.scene, s, batch), alone(file.scene, s, {}, batch.active));
  }
  batch.options = {Method::kSparseCholmod, Order::kCamd};
  expect_same(in_batch(file.scene, s, batch), alone(file.scene, s, batch.options, batch.active));
}

// States fill SIMD batches, however many are left over, at every level of instructions. The scene has a robot alone and
// two that are tied, and changes between calls.
TEST(Batch, StatesStandInLanes) {
  SceneFile file = load_text(R"(<scene>
  <robot name="arm" urdf="arm.urdf" base="fixed"/> <contact name="hold" type="3d" frame="arm/tool" gains="100 20"/>
  <robot name="other" urdf="arm.urdf" base="fixed" xyz="3 0 0"/>
  <robot name="box" urdf="box.urdf" base="floating" xyz="3.4 0 0.5"/>
  <contact name="push" type="3d" frame="other/tool" to="box/face_back" gains="50 10"/>
  <push frame="arm/tool" force="1 2 3" torque="0 0.1 0"/> <push frame="box/crate" force="0 5 0" reference_frame="world"/>
</scene>)");
  for (SimdLevel lanes : available_simd_levels()) {
    Scene scene = file.scene;
    const Options options{Method::kAuto, {}, lanes};
    BatchData batch(scene, 1, options);
    for (int count : {1, 2, 3, 8, 11, 17}) {
      SCOPED_TRACE(to_string(lanes) + ", " + std::to_string(count) + " states");
      const States s = disturbed_states(file, count, 0.2, static_cast<unsigned>(count));
      expect_same(in_batch(scene, s, batch), alone(scene, s, options, batch.active));
      scene.gravity[1] += 1;
      scene.damping = count % 2 * 1e-3;
      scene.robots[1].base.p[2] += 0.1;
      scene.contacts[0].B.placement.p[0] += 0.01;
      scene.contacts[1].beta += 3;
      batch.active[0] = static_cast<char>(count % 3 > 0);
    }
  }
}

// A solve of one state with the same data does not change how many states fill a SIMD batch.
TEST(Batch, StatesFillSimdBatchesAfterASolveToo) {
  const SceneFile file = load_small(kModels + "humanoid_standing.xml");
  SceneData data(file.scene);
  prepare(file.scene, data);
  const int before = internal::states_side_by_side(data);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_EQ(internal::states_side_by_side(data), before);
}

TEST(Batch, BatchesOfTwoThreadsRunAtTheSameTime) {
  const SceneFile file = load_small(kModels + "ring_of_humanoids.xml");
  const States s = disturbed_states(file, 6, 0.1, 4);
  std::vector<BatchData> batches;
  for (int k = 0; k < 2; ++k) batches.emplace_back(file.scene, 2);
  const Answers expected = alone(file.scene, s, {}, batches[0].active);
  std::vector<Answers> found(2, expected);
  const auto run = [&](int k) { found[k] = in_batch(file.scene, s, batches[k]); };
  std::thread other(run, 1);
  run(0);
  other.join();
  for (const Answers& out : found) expect_same(out, expected);
}

TEST(Batch, NoStatesAndNoContacts) {
  const SceneFile file = load_text(R"(<scene><robot name="b" urdf="box.urdf" base="floating"/></scene>)");
  BatchData batch(file.scene, 2);
  for (int count : {0, 1, 5}) {
    const States s = disturbed_states(file, count, 0.1, 2);
    expect_same(in_batch(file.scene, s, batch), alone(file.scene, s, {}, {}));
  }
}

// Views of one wide matrix, as `manycontact batch` has it, are accepted as they are.
TEST(Batch, BlocksOfAWiderMatrix) {
  const SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  const Scene& scene = file.scene;
  const States s = disturbed_states(file, 4, 0.1, 3);
  BatchMatrix in(4, scene.nq + scene.nv + scene.nu);
  in << s.q, s.v, s.u;
  BatchData batch(scene, 2);
  const int nf = force_rows(scene, batch);
  const Answers expected = alone(scene, s, {}, batch.active);
  BatchMatrix out = BatchMatrix::Constant(4, scene.nv + nf + 1, -7);
  std::vector<Status> status(4);
  solve_batch(scene, {in.leftCols(scene.nq), in.middleCols(scene.nq, scene.nv), in.rightCols(scene.nu)}, batch,
              out.leftCols(scene.nv), out.middleCols(scene.nv, nf), status);
  expect_same_bits(out.leftCols(scene.nv), expected.A, "a");
  expect_same_bits(out.middleCols(scene.nv, nf), expected.F, "f");
  EXPECT_TRUE((out.rightCols(1).array() == -7).all());
}

TEST(Batch, WrongSizesAndOtherScenesAreRefused) {
  const SceneFile file = load_scene(kModels + "humanoid_standing.xml"), other = load_scene(kModels + "herd.xml");
  const Scene& scene = file.scene;
  const States s = disturbed_states(file, 3, 0.1, 3);
  BatchData batch(scene, 2);
  const int nf = force_rows(scene, batch);
  Answers x(scene, nf, 3);
  const auto refused = [&](auto&& call, const std::string& part) {
    try {
      call();
      ADD_FAILURE() << "not refused: " << part;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  BatchMatrix few = x.A.topRows(2), narrow = x.F.leftCols(nf - 1);
  std::vector<Status> two(2);
  refused(
      [&] {
        solve_batch(scene, {s.q.topRows(2), s.v, s.u}, batch, x.A, x.F, two);
      },
      "v is 3 x 38, expected 2 x 38");
  refused([&] { solve_batch(scene, {s.v, s.v, s.u}, batch, x.A, x.F, x.status); }, "q is 3 x 38");
  refused([&] { solve_batch(scene, s.view(), batch, few, x.F, x.status); }, "A is 2 x 38, expected 3 x 38");
  refused([&] { solve_batch(scene, s.view(), batch, x.A, narrow, x.status); }, "F is 3 x 11, expected 3 x 12");
  refused([&] { solve_batch(scene, s.view(), batch, x.A, x.F, two); }, "status has 2");
  refused([&] { differentiate_batch(scene, s.view(), batch, x.A, x.F, x.A, x.status); }, "D is 3 x 38");
  refused([&] { vjp_batch(scene, s.view(), few, x.WF, batch, x.WQ, x.WV, x.WU, x.status); }, "WA is 2 x 38");
  refused([&] { vjp_batch(scene, s.view(), x.WA, x.WF, batch, x.WQ, x.WV, x.WU, x.WU, x.status); }, "WW is 3 x 32");
  refused([&] { solve_batch(other.scene, s.view(), batch, x.A, x.F, x.status); }, "the data do not fit the scene");
  batch.active.push_back(1);
  refused([&] { solve_batch(scene, s.view(), batch, x.A, x.F, x.status); },
          "batch.active has 3 flags, the scene has 2 contacts");
}

TEST(Batch, ASecondCallAllocatesNothing) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  const SceneFile file = load_scene(kModels + "ring_of_humanoids.xml");
  const Scene& scene = file.scene;
  const States s = disturbed_states(file, 8, 0.05, 6);
  BatchData batch(scene, 2, {Method::kSparseLdl, {}});
  Answers x(scene, force_rows(scene, batch), s.count());
  const auto all = [&] {
    solve_batch(scene, s.view(), batch, x.A, x.F, x.status);
    differentiate_batch(scene, s.view(), batch, x.A, x.F, x.D, x.status);
    vjp_batch(scene, s.view(), x.WA, x.WF, batch, x.WQ, x.WV, x.WU, x.WW, x.status);
  };
  all();
  EXPECT_EQ(allocations(all), 0u);
}

// Allocations of the first thread can be made to fail: the exception leaves the call, and the next call is correct.
TEST(Batch, AnExceptionInAThreadComesOut) {
  if (!MANYCONTACT_FAILS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be made to fail here";
  const SceneFile file = load_text(R"(<scene>
  <robot name="arm" urdf="arm.urdf" base="fixed"/> <contact name="hold" type="6d" frame="arm/tool"/>
</scene>)");
  const States s = disturbed_states(file, 5, 0.5, 6);
  const Answers expected = alone(file.scene, s, {Method::kAuto, {}, SimdLevel::kOff}, {1});
  for (int threads : {1, 3}) {
    // OpenMP makes its threads before memory fails; without memory it would end the program
    BatchData first(file.scene, threads), batch(file.scene, threads);
    (void)in_batch(file.scene, s, first);
    batch.options.simd_level = SimdLevel::kOff;
    bool threw = false;
    {
      Answers x(file.scene, 6, s.count());
      const FailingAllocation failing(0, true);  // the factors are made in the first solve
      try {
        solve_batch(file.scene, s.view(), batch, x.A, x.F, x.status);
      } catch (const std::bad_alloc&) {
        threw = true;
      }
    }
    EXPECT_TRUE(threw);
    expect_same(in_batch(file.scene, s, batch), expected);
  }
}

}  // namespace
}  // namespace manycontact::test
