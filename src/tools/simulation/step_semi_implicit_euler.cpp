#include <stdexcept>

#include "internal.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/simulation/free_joints.hpp"
#include "momentum_steps.hpp"
#include "resisting_forces.hpp"

namespace manycontact::internal {

namespace {

// Returns whether state and active contacts are unchanged since the last step, so that d.contact_v is valid.
bool goes_on_from_last(const SimulationData& d) {
  return d.left_active == d.dynamics.active && d.left_q == d.q && d.left_v == d.v;
}

// Sets d.tau to the armatures' part of M v, which the inverse dynamics of the robots do not contain.
void find_momentum_of_armatures(const Scene& scene, SimulationData& d) {
  for (const Robot& robot : scene.robots)
    d.tau.segment(robot.idx_v, robot.model->nv) =
        -d.h * robot.model->armature.cwiseProduct(d.stop.segment(robot.idx_v, robot.model->nv));
}

// Computes the kinematics that the step needs, and M v and the bias in d.tau unless SIMD batches compute these terms.
void begin_motion(const Scene& scene, bool goes_on, SimulationData& d) {
  stop_in_a_step(scene, d.v, d.h, d.stop);
  d.in_batches = scene.springs.empty();
  if (!d.in_batches) return find_momentum(d);
  find_momentum_of_armatures(scene, d);
  const bool any_free = find_free_groups(scene, d.dynamics.active, d.free_groups);
  if (any_free || !goes_on) kinematics_at(scene, d.q, d.v, d.at_rest.kin);
}

// Sets data.wanted to (1 - beta h) c, with c the contact velocity after the last step, or J v if the state was changed.
void want_contact_velocities(const Scene& scene, bool goes_on, SimulationData& d) {
  prepare(d.at_rest.scene, d.dynamics);
  if (!goes_on) {
    d.contact_v.resize(d.dynamics.f.size());
    d.at_rest.contact_velocities(d.dynamics.f_offset, d.contact_v);
  }
  d.wanted = d.contact_v;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int first = d.dynamics.f_offset[c]; first >= 0)
      d.wanted.segment(first, scene.contacts[c].rows()) *= 1 - scene.contacts[c].beta * d.h;
  if (rows_may_turn(scene, d)) leave_out_alpha_of_turning_rows(scene, d);
}

void follow_contact_velocities(SimulationData& d) {
  d.wanted = d.contact_v;
  if (d.in_batches)
    d.contact_v.swap(d.next_contact_v);
  else
    d.at_rest.contact_velocities_at(d.next_v, d.dynamics.f_offset, d.contact_v);
}

// Solves K v+ = tau + h w with all resisting forces, in the data of at_rest_with_joints. Returns false if it failed.
bool solve_to_the_end(const Scene& scene, SimulationData& d) {
  Eigen::VectorXd& b = d.b;
  for (int k = 0; k < kMostSolves; ++k) {
    b = d.tau + d.h * d.w;
    if (!d.resisting) return solve_with_springs(b, d);
    ResistingJoints& joints = d.resisting->joints;
    joints.set_inertias(scene, d.h);
    joints.add_sliding(d.h, b);
    if (!solve_with_springs(b, d)) return false;
    if (joints.settles(scene, d.dynamics, d.h, at_rest_with_joints(d).data.a)) return true;
  }
  ++d.unsettled;
  return true;
}

// Sets d.w to the torques at the start of the step, and prepares the resisting forces.
void begin_forces(const Scene& scene, const ConstVector& u, SimulationData& d) {
  torques_of_motors(scene, u, d.w);
  if (!d.resisting && d.pd.kp.size() > 0) d.resisting = std::make_shared<ResistingForces>(scene);
  add_loads(scene, d);
  if (!d.resisting) return;
  take_joints(scene, d);
  if (d.resisting->springs) take_springs(scene, d);
}

// Sets the reason of a failed solve if a spring has no direction. The solve itself only reports NaN torques.
void name_springs_without_direction(const Scene& scene, SimulationData& d) {
  if (!d.applied) return;
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    if (d.applied->springs[k].directed) continue;
    for (const Attachment* at : {&scene.springs[k].A, &scene.springs[k].B})
      if (moves(*at))
        d.dynamics.report.islands[island_with_robot(d.dynamics, at->robot)].reason = Reason::kSpringWithoutDirection;
  }
}

void account_for_work(const Scene& scene, SimulationData& d) {
  d.work = {};
  if (!d.resisting) return;
  account_for_joints(scene, d, d.next_v);
  if (d.resisting->springs) account_for_springs(scene, d, d.next_v);
}

}  // namespace

void end_step(const Scene& scene, const Eigen::VectorXd& x, SimulationData& d) {
  end_free_joints(scene, d.q, x, d.h, d.stage_v, d.next_q, d.next_v);
  end_free_motion(scene, d.next_q, d.next_v, d.at_rest.kin, d.free_groups);
}

void find_momentum(SimulationData& d) {
  d.at_rest.inverse_dynamics_of(d.at_rest.scene, d.q, d.v, d.stop, d.at_rest.gravity, d.tau);
  d.tau *= -d.h;
}

bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& d) {
  if (u.size() != scene.nu) throw std::invalid_argument("step: u has a wrong size, nu numbers are expected");
  if (d.dynamics.wrenches.size() != scene.wrenches.size())
    throw std::invalid_argument(
        "step: dynamics.wrenches has a wrong size, a wrench for each wrench of the scene is expected");
  const double h = d.h;
  d.at_rest.follow(scene, h);
  const bool goes_on = goes_on_from_last(d);
  begin_motion(scene, goes_on, d);
  want_contact_velocities(scene, goes_on, d);
  begin_forces(scene, u, d);
  if (!d.in_batches || d.free_groups.any)
    begin_free_motion(scene, d.dynamics.active, d.w, h, d.at_rest.kin, d.free_groups);
  const bool solved = solve_to_the_end(scene, d);
  const auto [rest, data] = at_rest_with_joints(d);
  if (&data != &d.dynamics) d.dynamics.a = data.a, d.dynamics.f = data.f, d.dynamics.report = data.report;
  if (!solved) {
    name_springs_without_direction(scene, d);
    return false;
  }
  watch_condition(rest, data, d);
  keep_what_depends(data, d);
  d.next_v = d.dynamics.a;
  d.dynamics.f /= h;
  account_for_work(scene, d);
  follow_contact_velocities(d);
  begin_bound(scene, goes_on, d);
  add_impulses_of_springs(scene, d);
  end_step(scene, d.dynamics.a, d);
  bound_energy(scene, d);
  d.dynamics.a = d.dynamics.a / h + d.stop;
  give_up_solution(d.dynamics);  // which does not belong to the state after the step
  keep_forces(d);
  d.left_q = d.next_q, d.left_v = d.next_v, d.left_active = d.dynamics.active;
  return true;
}

}  // namespace manycontact::internal
