// Many threads with their own data share one constant scene: each computes the bits of one thread alone.
// ThreadSanitizer (`./run test --threads`) checks that no thread writes shared memory. Inside a call (Options::threads)
// any number of threads computes the same bits.

#include <gtest/gtest.h>
#ifdef __unix__
#include <sys/wait.h>
#include <unistd.h>
#endif

#include <thread>

#include "manycontact/dynamics/batch.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "support/allocations.hpp"
#include "support/methods.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/workspace.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// Returns all that is computed from three states, with contacts switched between them.
std::vector<VectorXd> everything(const SceneFile& file, const Options& options, bool always_by_threads = true) {
  const Scene& scene = file.scene;
  std::vector<VectorXd> out;
  SceneData data(scene, options);
  if (always_by_threads) wake_threads_for(data, 0);
  for (int state = 0; state < 3; ++state) {
    data.active[0] = state != 1;
    const VectorXd v = file.v * (1 + state);
    (void)solve(scene, file.q, v, file.u, data);
    estimate_errors(scene, data);
    out.insert(out.end(), {data.a, data.f});
    const SceneDerivatives d = (differentiate(scene, data), dense_derivatives(scene, data));
    out.insert(out.end(), {VectorXd(d.da_dq.reshaped()), VectorXd(d.dforces_dv.reshaped())});
    VectorXd da(scene.nv), df(data.f.size()), wq(scene.nv), wv(scene.nv), wu(scene.nu);
    jvp(scene, data, v, v, file.u, da, df);
    vjp(scene, data, data.a, data.f, wq, wv, wu);
    out.insert(out.end(), {da, df, wq, wv, wu, quasi_static(scene, file.q, data)});
  }
  return out;
}

TEST(Threads, EachWithItsDataOnOneScene) {
  for (const char* name : {"herd", "two_humanoids_carry_beam", "feet_on_corners"}) {
    SceneFile file = load_small(std::string(MANYCONTACT_SOURCE_DIR "/models/") + name + ".xml");
    std::mt19937 rng(6);
    disturb(file, rng);
    for (const Way& way : ways(true)) {
      SCOPED_TRACE(std::string(name) + ", " + way.name);
      const std::vector<VectorXd> alone = everything(file, way.options);
      std::vector<std::vector<VectorXd>> answers(6);
      std::vector<std::thread> threads;
      for (auto& answer : answers) threads.emplace_back([&] { answer = everything(file, way.options); });
      for (std::thread& thread : threads) thread.join();
      for (const auto& answer : answers) {
        ASSERT_EQ(answer.size(), alone.size());
        for (std::size_t k = 0; k < alone.size(); ++k)
          EXPECT_TRUE(answer[k] == alone[k] || !alone[k].allFinite()) << "number " << k;
      }
    }
  }
}

// Random scenes have islands of different sizes.
SceneFile random_file() {
  std::mt19937 rng(21);
  SceneOptions options;
  options.nrobots = 7;
  options.ncontacts = 12;
  const RandomScene s = random_scene(rng, options);
  SceneFile file;
  file.scene = s.scene;
  file.q = s.q, file.v = s.v, file.u = s.u;
  return file;
}

SceneFile file_of(const std::string& name) {
  if (name == "random") return random_file();
  SceneFile file = load_small(MANYCONTACT_SOURCE_DIR "/models/" + name + ".xml");
  std::mt19937 rng(6);
  disturb(file, rng);
  return file;
}

TEST(Threads, InsideACallCountForNothing) {
  for (const char* name : {"herd", "ring_of_humanoids", "two_humanoids_carry_beam", "feet_on_corners", "random"}) {
    const SceneFile file = file_of(name);
    for (const Way& way : ways_here()) {
      SCOPED_TRACE(std::string(name) + ", " + way.name);
      const std::vector<VectorXd> alone = everything(file, way.options);
      for (int threads : {2, 3, 0}) {
        Options options = way.options;
        options.threads = threads;
        for (const bool always : {true, false}) {  // small scenes wake no thread, unless they are made to
          const std::vector<VectorXd> answer = everything(file, options, always);
          ASSERT_EQ(answer.size(), alone.size());
          for (std::size_t k = 0; k < alone.size(); ++k)
            EXPECT_TRUE(answer[k] == alone[k] || !alone[k].allFinite())
                << "number " << k << ", " << threads << " threads";
        }
      }
    }
  }
}

TEST(Threads, InsideACallAllocateNothingTheSecondTime) {
  if (!MANYCONTACT_COUNTS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be counted here";
  for (const char* name : {"herd", "ring_of_humanoids", "two_humanoids_carry_beam"})
    for (const SimdLevel lanes : {SimdLevel::kAuto, SimdLevel::kOff}) {
      SCOPED_TRACE(name);
      SceneFile file = file_of(name);
      const Scene& scene = file.scene;
      SceneData data(scene, {Method::kSparseLdl, {}, lanes, 3});
      wake_threads_for(data, 0);
      VectorXd wq(scene.nv), wv(scene.nv), wu(scene.nu), da(scene.nv), df;
      const auto all = [&] {
        (void)solve(scene, file.q, file.v, file.u, data);
        (void)differentiate(scene, data);
        df.resize(data.f.size());
        jvp(scene, data, file.v, file.v, file.u, da, df);
        vjp(scene, data, data.a, data.f, wq, wv, wu);
      };
      all();
      std::mt19937 rng(14);
      disturb(file, rng);
      EXPECT_EQ(allocations(all), 0u);
    }
}

TEST(Threads, AnExceptionInsideACallComesOut) {
  if (!MANYCONTACT_FAILS_ALLOCATIONS) GTEST_SKIP() << "malloc cannot be made to fail here";
  const SceneFile file = file_of("herd");
  const Options options{Method::kSparseLdl, {}, SimdLevel::kOff, 3};
  const std::vector<VectorXd> expected = everything(file, options);  // OpenMP's threads exist from now on
  SceneData data(file.scene, options);
  bool threw = false;
  {
    const FailingAllocation failing(0, true);  // this thread's islands have no factors yet
    try {
      (void)solve(file.scene, file.q, file.v, file.u, data);
    } catch (const std::bad_alloc&) {
      threw = true;
    }
  }
  EXPECT_TRUE(threw);
  EXPECT_EQ(data.serial, 0u);
  (void)solve(file.scene, file.q, file.v, file.u, data);
  EXPECT_TRUE(data.a.allFinite());
  SceneData afresh(file.scene, options);
  (void)solve(file.scene, file.q, file.v, file.u, afresh);
  EXPECT_TRUE(data.a == afresh.a && data.f == afresh.f);
}

TEST(Threads, LessThanNoneAndTooManyAreRefused) {
  const SceneFile file = file_of("herd");
  SceneData data(file.scene);
  for (const int threads : {-1, kMostThreads + 1}) {
    data.options.threads = threads;
    EXPECT_THROW((void)solve(file.scene, file.q, file.v, file.u, data), std::invalid_argument);
  }
  data.options.threads = 2;
  EXPECT_EQ(solve(file.scene, file.q, file.v, file.u, data).status, Status::kOk);
}

// A forked child has none of its parent's threads. The test covers batches, threads inside a call, one after the other,
// and a child's child.
#if defined(__unix__) && !defined(__SANITIZE_THREAD__)
TEST(Threads, ChildrenComputeAfterAFork) {
  const SceneFile file = load_small(MANYCONTACT_SOURCE_DIR "/models/two_humanoids_carry_beam.xml");
  const auto same = [&](const VectorXd& expected) {
    Options options;
    options.threads = 2;
    const std::vector<VectorXd> one = everything(file, options);
    BatchData batch(file.scene, 2);
    const BatchMatrix q = file.q.transpose().replicate(8, 1), v = file.v.transpose().replicate(8, 1),
                      u = file.u.transpose().replicate(8, 1);
    BatchMatrix A(8, file.scene.nv), F(8, force_rows(file.scene, batch));
    std::vector<Status> status(8);
    solve_batch(file.scene, {q, v, u}, batch, A, F, status);
    return one.front() == expected && A.row(7).transpose() == expected;
  };
  const VectorXd expected = everything(file, {}).front();
  ASSERT_TRUE(same(expected));
  for (int depth = 0; depth < 3; ++depth) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(60);
      bool good = same(expected);
      const pid_t inner = fork();
      if (inner == 0) alarm(60), _exit(same(expected) ? 0 : 1);
      int code = 0;
      good = good && waitpid(inner, &code, 0) == inner && code == 0;
      _exit(good ? 0 : 1);
    }
    int code = 0;
    ASSERT_EQ(waitpid(child, &code, 0), child);
    EXPECT_EQ(code, 0);
    EXPECT_TRUE(same(expected));
  }
}
#endif

}  // namespace
}  // namespace manycontact::test
