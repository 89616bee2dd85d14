// Many threads, each with data of its own, on one constant scene: the bits of one thread alone. Under ThreadSanitizer
// (`./run test --threads`) that nothing is shared that one of them writes.

#include <gtest/gtest.h>

#include <thread>

#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/jvp.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "support/methods.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// All that is computed from three states, contacts being switched between them.
std::vector<VectorXd> everything(const SceneFile& file, const Options& options) {
  const Scene& scene = file.scene;
  std::vector<VectorXd> out;
  SceneData data(scene, options);
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

}  // namespace
}  // namespace manycontact::test
