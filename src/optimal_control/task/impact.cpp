// The node of an impact.

#include "manycontact/control/impulse_fwddyn.hpp"
#include "nodes.hpp"
#include "terms.hpp"

namespace manycontact::task {

namespace {

// The constraints of the phase that ends there, on its last state; null where none looks at the state alone.
std::shared_ptr<ConstraintModelManager> constraints_of(const TaskFile& task, const TaskPhase& before,
                                                       const std::shared_ptr<StateMultibody>& state) {
  const Parts parts{task, state, nullptr, nullptr};
  auto out = std::make_shared<ConstraintModelManager>(state, 0);
  for (const TaskTerm& term : before.constraints)
    if (of_state_alone(term.residual)) add_constraint(term, parts, *out);
  return out->get_constraints().empty() ? nullptr : out;
}

}  // namespace

std::shared_ptr<ActionModelAbstract> impact_of(const TaskFile& task, const TaskPhase& before, const TaskPhase& phase,
                                               const std::shared_ptr<StateMultibody>& state) {
  const Scene& scene = task.scene.scene;
  auto impulses = std::make_shared<ImpulseModelMultiple>(state);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (phase.active[c])
      impulses->addImpulse(scene.contacts[c].name, std::make_shared<ImpulseModelOfScene>(state, scene.contacts[c]));
  return std::make_shared<ActionModelImpulseFwdDynamics>(state, impulses, std::make_shared<CostModelSum>(state, 0),
                                                         constraints_of(task, before, state), 0.0, scene.damping);
}

}  // namespace manycontact::task
