#include <stdexcept>

#include "internal.hpp"
#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/model/torques.hpp"

namespace manycontact::internal {

namespace {

// (1 - beta h) c; c is J v where the state or the contacts are not those of the last step.
void want_contact_velocities(const Scene& scene, SimulationData& d) {
  prepare(d.at_rest.scene, d.dynamics);
  if (d.left_active != d.dynamics.active || d.left_q != d.q || d.left_v != d.v) {
    d.contact_v.resize(d.dynamics.f.size());
    d.at_rest.contact_velocities(d.dynamics.f_offset, d.contact_v);
  }
  d.wanted = d.contact_v;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int first = d.dynamics.f_offset[c]; first >= 0)
      d.wanted.segment(first, scene.contacts[c].rows()) *= 1 - scene.contacts[c].beta * d.h;
}

}  // namespace

bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& d) {
  if (u.size() != scene.nu) throw std::invalid_argument("step: u does not fit the scene");
  if (d.dynamics.pushes.size() != scene.pushes.size())
    throw std::invalid_argument("step: dynamics.pushes does not fit the scene");
  const double h = d.h;
  d.at_rest.follow(scene, h);
  d.stage_v = d.v / -h;
  d.at_rest.inverse_dynamics_of(scene, d.q, d.v, d.stage_v, scene.gravity, d.tau);
  torques_of_motors(scene, u, d.w);  // what motors, pushes and springs give
  if (d.applied) add_applied_forces<double>(scene, d.q.data(), d.v.data(), d.dynamics.pushes, *d.applied, d.w.data());
  d.tau *= -h;  // M v - h h(q, v)
  for (const Robot& robot : scene.robots)
    add_friction(*robot.model, d.v.data() + robot.idx_v, d.tau.data() + robot.idx_v, h);
  want_contact_velocities(scene, d);
  const bool taken = take_springs(scene, d);
  const auto [rest, data] = at_rest_with_springs(scene, d);
  Status status = Status::kFailed;
  if (taken) {
    begin_free_motion(scene, d.dynamics.active, d.w, h, d.at_rest.kin, d.free_groups);
    d.tau += h * d.w;
    status = solve_tau(rest, d.q, d.at_rest.zero, d.tau, d.wanted, data).status;
    watch_condition(rest, data, d);
    d.worst = std::max(d.worst, status);
  }
  if (&data != &d.dynamics) d.dynamics.a = data.a, d.dynamics.f = data.f, d.dynamics.report = data.report;
  if (status == Status::kFailed) return false;
  keep_what_depends(data, d);
  d.next_v = d.dynamics.a;
  d.dynamics.a = (d.next_v - d.v) / h;
  d.dynamics.f /= h;
  give_up_solution(d.dynamics);  // what it was solved at is not the state
  keep_forces(d);
  d.w = h * d.next_v;
  integrate_scene(scene, d.q, d.w, d.next_q);
  d.at_rest.contact_velocities_at(d.next_v, d.dynamics.f_offset, d.contact_v);
  end_free_motion(scene, d.next_q, d.next_v, d.at_rest.kin, d.free_groups);
  d.left_q = d.next_q, d.left_v = d.next_v, d.left_active = d.dynamics.active;
  return true;
}

}  // namespace manycontact::internal
