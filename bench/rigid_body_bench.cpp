// Times one robot's algorithms through their public functions (algorithm/rigid_body.hpp), and inverse kinematics of
// rings hand in hand, whose time should be linear in the number of robots.

#include <benchmark/benchmark.h>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/analysis/place.hpp"
#include "settings.hpp"

namespace manycontact::bench {
namespace {

const std::string kModels = MANYCONTACT_SOURCE_DIR "/models/";

struct Humanoid {
  SceneFile file = load_scene(kModels + "humanoid_standing.xml");
  const Scene& scene = file.scene;
  RigidBodyData data{scene};
  Eigen::VectorXd q = file.q, v = Eigen::VectorXd::LinSpaced(scene.nv, -1, 0.7), a = 2 * v;
  Attachment hand = find_frame(scene, "left_hand");
};

template <class Run>
void add(const char* name, Run&& run) {
  benchmark::RegisterBenchmark((std::string("rigid_body/") + name + "/humanoid").c_str(),
                               [run](benchmark::State& state) {
                                 Humanoid h;
                                 for (auto _ : state) benchmark::DoNotOptimize(run(h));
                               });
}

// Times inverse kinematics of n humanoids in a circle that take each other's hands.
void ring(benchmark::State& state, int n) {
  const SceneFile file = load_scene_text(
      "<scene><robot name=\"r\" urdf=\"humanoid.urdf\" base=\"floating\" xyz=\"0 0 0.7884\" arrange=\"circle\" "
      "spacing=\"0.9\" copies=\"" +
          std::to_string(n) +
          "\"/><contact name=\"left\" type=\"6d\" frame=\"r/left_sole\"/><contact name=\"right\" type=\"6d\" "
          "frame=\"r/right_sole\"/><contact name=\"hold\" type=\"3d\" frame=\"r/left_hand\" to=\"r+1/right_hand\" "
          "to_offset=\"0 0 0\" wrap=\"true\"/></scene>",
      kModels + "ring.xml");
  std::vector<Goal> goals;
  for (const Contact& contact : file.scene.contacts) goals.push_back(contact_goal(file.scene, contact.name));
  for (auto _ : state) {
    const PlacedScene found = place(file.scene, file.q, goals);
    state.counters["iterations"] = found.iterations;
    if (!found.met()) state.SkipWithError("the hands do not meet");
  }
}

const Registration registered([] {
  add("rnea", [](Humanoid& h) { return rnea(h.scene, h.q, h.v, h.a, h.data).data(); });
  add("aba", [](Humanoid& h) { return aba(h.scene, h.q, h.v, h.a, h.data).data(); });
  add("crba", [](Humanoid& h) { return crba(h.scene, h.q, h.data).data(); });
  add("rnea_derivatives", [](Humanoid& h) { return rnea_derivatives(h.scene, h.q, h.v, h.a, h.data).dq.data(); });
  add("aba_derivatives", [](Humanoid& h) { return aba_derivatives(h.scene, h.q, h.v, h.a, h.data).dq.data(); });
  add("frame_jacobian", [](Humanoid& h) {
    forward_kinematics(h.scene, h.q, h.data);
    return frame_jacobian(h.scene, h.data, h.hand)(0, 0);
  });
  for (const int n : {4, 16, 64})
    benchmark::RegisterBenchmark(("place/ring/" + std::to_string(n)).c_str(), [n](benchmark::State& s) {
      ring(s, n);
    })->Unit(benchmark::kMillisecond);
});

}  // namespace
}  // namespace manycontact::bench
