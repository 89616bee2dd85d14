// The node of an impact.

#include "manycontact/control/impulse_fwddyn.hpp"
#include "nodes.hpp"

namespace manycontact::task {

std::shared_ptr<ActionModelAbstract> impact_of(const TaskFile& task, const TaskPhase& phase,
                                               const std::shared_ptr<StateMultibody>& state) {
  const Scene& scene = task.scene.scene;
  auto impulses = std::make_shared<ImpulseModelMultiple>(state);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (phase.active[c])
      impulses->addImpulse(scene.contacts[c].name, std::make_shared<ImpulseModelOfScene>(state, scene.contacts[c]));
  return std::make_shared<ActionModelImpulseFwdDynamics>(state, impulses, std::make_shared<CostModelSum>(state, 0), 0.0,
                                                         scene.damping);
}

}  // namespace manycontact::task
