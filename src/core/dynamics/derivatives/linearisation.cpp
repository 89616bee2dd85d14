#include "linearisation.hpp"

#include <algorithm>
#include <map>

#include "../internal.hpp"

namespace manycontact {

Linearisation::Slot::Slot(const Model& model)
    : a(model.njoints(), Vec6<double>::Zero()), rnea(model), fext(model.njoints(), Vec6<double>::Zero()) {}

Linearisation::Linearisation(const Scene& scene)
    : place(scene.robots.size(), -1),
      contacts(scene.contacts.size()),
      derivatives(scene.contacts.size()),
      state(scene.contacts.size(), 0) {
  std::map<const Model*, int> numbers;
  for (const Robot& robot : scene.robots)
    model.push_back(numbers.try_emplace(robot.model.get(), static_cast<int>(numbers.size())).first->second);
  models = numbers.size();
  used.resize(numbers.size());
}

void Linearisation::assign(const Scene& scene, const Workspace& w, const Island& island) {
  if (place[island.robots.back()] >= 0) return;
  for (int c : island.contacts) {
    if (derivatives.has(c)) continue;
    contacts.make(c, scene.contacts[c], w.supports[c]);
    derivatives.make(c, scene, scene.contacts[c], w.supports[c]);
  }
  std::fill(used.begin(), used.end(), 0);
  const std::size_t thread = w.robot_island[island.robots.front()] % w.threads.size();
  of_model.resize(std::max(of_model.size(), (thread + 1) * models));
  for (int r : island.robots) {
    std::vector<int>& places = of_model[thread * models + model[r]];
    const std::size_t k = used[model[r]]++;
    if (k == places.size()) {
      pool.emplace_back(*scene.robots[r].model);
      places.push_back(static_cast<int>(pool.size()) - 1);
    }
    place[r] = places[k];
  }
}

AtSolution::AtSolution(const Scene& scene, SceneData& data, const Island& island)
    : work_(*data.workspace), island_(island) {
  Linearisation& lin = *work_.linearisation;
  lin.assign(scene, work_, island);
  exchange();
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    forward_accelerations<double>(*robot.model, data.v.segment(robot.idx_v, robot.model->nv),
                                  data.a.data() + robot.idx_v, scene.gravity, work_.robots[r].kin);
  }
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    contact_rows<double>(scene, contact, work_.supports[c], work_.robots[contact.A.robot].kin,
                         contact.B.robot < 0 ? nullptr : &work_.robots[contact.B.robot].kin, lin.contacts[c]);
  }
}

AtSolution::~AtSolution() { exchange(); }

void AtSolution::exchange() {
  for (int r : island_.robots) work_.robots[r].kin.a.swap(work_.linearisation->of(r).a);
}

namespace internal {

Linearisation& linearisation_of(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  if (!w.linearisation) w.linearisation = std::make_unique<Linearisation>(scene);
  return *w.linearisation;
}

}  // namespace internal

}  // namespace manycontact
