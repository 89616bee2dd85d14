#include "manycontact/dynamics/data.hpp"

#include <stdexcept>

#include "../internal.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact {

Workspace::Workspace(const Scene& s)
    : scene(s), robots(s.robots.size()), supports(s.contacts.size()), contacts(s.contacts.size()) {
  for (const Contact& contact : s.contacts)  // a fixed end's robot may not be in the contact's island
    for (const Attachment* at : {&contact.A, &contact.B})
      if (at->robot >= 0 && !moves(*at)) internal::make_robot(s, *this, at->robot);
  rows_state.assign(s.contacts.size(), 0);
  for (const Contact& contact : s.contacts) {
    left_offset.push_back(contact.pair ? static_cast<int>(left.size()) : -1);
    if (contact.pair) left.resize(left.size() + contact.pair->unit.size() + 2);
  }
  if (has_applied_forces(s)) applied = std::make_unique<AppliedWork>(s);
}

SceneData::SceneData(const Scene& scene, const Options& opts) : options(opts) {
  for (Eigen::VectorXd* x : {&v, &tau, &a}) x->setZero(scene.nv);
  active = active_contacts(scene);
  wrenches = external_wrenches(scene);
  workspace = std::make_unique<Workspace>(scene);
  prepare(scene, *this);
}

SceneData::~SceneData() = default;
SceneData::SceneData(SceneData&&) noexcept = default;
SceneData& SceneData::operator=(SceneData&&) noexcept = default;

namespace internal {

void check_scene(const Scene& scene, const SceneData& data, const char* function, const Island* island) {
  if (!data.workspace)
    throw std::logic_error(std::string(function) + ": the data were moved to another object, make new data");
  const SceneIdentity& identity = data.workspace->scene;
  const std::string difference = island ? identity.difference(scene, *island) : identity.difference(scene);
  if (!difference.empty())
    throw std::invalid_argument(std::string(function) + ": the data do not fit the scene: " + difference +
                                "; make new data");
}

void check_solved(const Scene& scene, const SceneData& data, const char* function, const Island* island) {
  check_scene(scene, data, function, island);
  if (data.serial == 0) throw std::logic_error(std::string(function) + ": there is no solution, call solve first");
  if (data.workspace->active != data.active)
    throw std::logic_error(std::string(function) +
                           ": the active contacts changed since the last solve, call solve first");
}

void check_not_prescribed(const Scene& scene, const SceneData& data, const char* function) {
  check_solved(scene, data, function);
  if (!data.workspace->prescribed.empty())
    throw std::logic_error(std::string(function) +
                           ": the last solve prescribed accelerations of contacts, call solve first");
}

void check_size(const char* function, const char* what, Eigen::Index given, Eigen::Index expected) {
  if (given != expected)
    throw std::invalid_argument(std::string(function) + ": " + what + " has " + std::to_string(given) +
                                " numbers, expected " + std::to_string(expected));
}

}  // namespace internal

void give_up_solution(SceneData& data) { data.serial = data.workspace->current = 0; }

std::vector<std::string> force_names(const Scene& scene, const SceneData& data) {
  internal::check_scene(scene, data, "force_names");
  std::vector<std::string> names;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    for (int k = 0; data.f_offset[c] >= 0 && k < scene.contacts[c].rows(); ++k)
      names.push_back(scene.contacts[c].name + "[" + std::to_string(k) + "]");
  return names;
}

Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SceneData& data,
                                                        const std::string& contact) {
  return contact_force(scene, data, contact_called(scene, contact));
}

Eigen::VectorBlock<const Eigen::VectorXd> contact_force(const Scene& scene, const SceneData& data, int contact) {
  internal::check_solved(scene, data, "contact_force");
  (void)contact_at(scene, contact, "contact_force");
  if (data.f_offset[contact] < 0)
    throw std::logic_error("contact_force: contact " + quote(scene.contacts[contact].name) +
                           " is not active and has no force");
  return data.f.segment(data.f_offset[contact], scene.contacts[contact].rows());
}

}  // namespace manycontact
