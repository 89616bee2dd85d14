#pragma once
// Scenes in motion, and the result of a run.

#include "dynamics/simulation.hpp"
#include "manycontact/algorithm/integrate.hpp"
#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/simulation/step.hpp"
#include "spatial/compare.hpp"
#include "support/scenes.hpp"

namespace manycontact::test {

/// Returns one robot of eight random joints that rotate and slide in space and in planes, tumbling freely in gravity.
inline RandomScene free_scene(int seed, bool floating_base = true) {
  std::mt19937 rng(seed);
  ModelOptions model;
  model.njoints = 8;
  model.floating_base = floating_base;
  model.types = {JointType::kRevolute, JointType::kPrismatic, JointType::kPlanar, JointType::kFloating};
  SceneOptions options;
  options.nrobots = 1;
  options.models = {model};
  options.ncontacts = 0;
  RandomScene s = random_scene(rng, options);
  s.u *= 0.1;
  return s;
}

/// Returns two such robots tied together at a point, and one of them to the world. J v = 0 at the start.
inline RandomScene tied_scene(int seed, const std::vector<JointType>& types = {
                                            JointType::kRevolute, JointType::kRevolute, JointType::kPlanar}) {
  std::mt19937 rng(seed);
  ModelOptions model;
  model.njoints = 6;
  model.floating_base = true;
  model.types = types;
  model.armature = 0.1;
  SceneOptions options;
  options.nrobots = 2;
  options.models = {model, model};
  options.same_model = 0;
  options.ncontacts = 0;
  RandomScene s = random_scene(rng, options);
  hold(s, "joined", ContactType::k3D, {0, 4, random_placement(rng, 0.2)}, {1, 3, {}});
  hold(s, "grounded", ContactType::k6D, {1, 0, random_placement(rng, 0.2)}, {});
  s.v = consistent(s.scene, s.q, 0.5 * s.v);
  s.u *= 0.1;
  return s;
}

inline RandomScene of_file(const SceneFile& file) { return {file.scene, file.q, file.v, file.u}; }

inline void set_gains(Scene& scene, double alpha, double beta) {
  for (Contact& contact : scene.contacts) contact.alpha = alpha, contact.beta = beta;
}

/// Returns `s` after `time` in `steps` steps.
inline SimulationData simulated(const RandomScene& s, Integrator integrator, double time, int steps,
                                const Options& options = {Method::kSparseLdl, {}}) {
  SimulationData sim(s.scene, s.q, s.v, integrator, time / steps, options);
  for (int k = 0; k < steps; ++k)
    if (const StepStatus status = step(s.scene, s.u, sim); status != StepStatus::kOk) {
      ADD_FAILURE() << failure(s.scene, sim, status);
      break;
    }
  return sim;
}

inline Invariants invariants_of(const RandomScene& s, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  InvariantsData room(s.scene);
  return invariants(s.scene, std::vector<char>(s.scene.contacts.size(), 1), q, v, room);
}
inline Invariants start_of(const RandomScene& s) { return invariants_of(s, s.q, s.v); }
inline Invariants end_of(const RandomScene& s, const SimulationData& sim) { return invariants_of(s, sim.q, sim.v); }

}  // namespace manycontact::test
