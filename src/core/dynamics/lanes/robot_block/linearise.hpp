#pragma once
// RobotBlock: evaluates all terms at the solution, for derivatives and products.

#include "robot_block.hpp"

namespace manycontact::lanes {

template <class S>
bool RobotBlock<S>::keeps(std::uint64_t serial, Robots robots) const {
  return serial_ == serial && kept_count_ == robots.size() &&
         std::equal(robots.begin(), robots.end(), kept_.begin(),
                    [](const Robot& r, int number) { return r.number == number; });
}
template <class S>
void RobotBlock<S>::keep(std::uint64_t serial, Robots robots) {
  serial_ = serial;
  kept_count_ = robots.size();
  std::transform(robots.begin(), robots.end(), kept_.begin(), [](const Robot& r) { return r.number; });
}

/// Evaluates kinematics and contact rows at the solution, and for single-robot islands K and its factor. For coupled
/// robots with memory nullptr, evaluates only the kinematics.
template <class S>
template <class Job>
void RobotBlock<S>::linearise(const Job& job, Robots robots, double* memory) {
  const bool alone = plan_->border() == 0, kept = alone && keeps(job.serial, robots);
  if (alone) memory = reinterpret_cast<double*>(own_.data());
  if (memory) use(memory);
  if (!kept) {
    load_state(job, robots);
    if (alone) keep(job.serial, robots);
    forward_kinematics<S>(*model_, base_, q_, robot_.kin);
    if (memory) internal::evaluate_inertia<S>(*model_, robot_, pattern_.M_slot.data(), n_.K);
  }
  load_each(job.scene, robots, model_->nv, a_.data(), [&](const auto& r, auto&) { return job.a + r.idx_v; });
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    load_each(job.scene, robots, static_cast<int>(contact_f_[k].size()), contact_f_[k].data(),
              [&](auto&, const Robot& r) { return job.f + job.f_offset[r.contacts[k]]; });
  forward_accelerations<S>(*model_, v_, a_.data(), job.scene.gravity, robot_.kin);
  if (!memory) return;
  evaluate_rows(job.scene, robots);
  for (int l = 0; l < W && !slope_.empty(); ++l) {
    const Model& model = *job.scene.robots[in_lane(robots, l).number].model;
    for (std::size_t i = 0; i < slope_.size(); ++i)
      slope_[i].set(l, friction_slope(model, static_cast<int>(i), v_[i][l]));
  }
  if (kept || !alone) return;
  size_rows(job.scene, robots);
  assemble_rows(job.scene.damping);
  (void)factorize(all());
}

/// Adds a contact's force F on body A, in A's axes, and -F on body B, to fext, one force per body.
template <class S>
void add_force(const Contact& contact, const ContactData<S>& rows, const Vec6<S>& F, std::vector<Vec6<S>>& fext) {
  each_body_force(contact, rows, F, [&](const Attachment& at, const Vec6<S>& force) { fext[at.joint] += force; });
}

/// Sets fext to the contact forces of the solution.
template <class S>
void RobotBlock<S>::add_forces(const Scene& scene, Robots robots, std::vector<Vec6<S>>& fext) {
  std::fill(fext.begin(), fext.end(), Vec6<S>(Vec6<S>::Zero()));
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    add_force<S>(scene.contacts[robots.front().contacts[k]], contacts_[k], contacts_[k].W.transpose() * contact_f_[k],
                 fext);
}

}  // namespace manycontact::lanes
