#include <stdexcept>

#include "internal.hpp"
#include "manycontact/algorithm/joint_friction.hpp"

namespace manycontact::internal {

bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& d) {
  if (u.size() != scene.nu) throw std::invalid_argument("step: u does not fit the scene");
  const double h = d.h;
  d.at_rest.follow(scene, d.integrator, h);
  d.stage_v = d.v / -h;
  d.at_rest.inverse_dynamics_of(scene, d.q, d.v, d.stage_v, scene.gravity, d.tau);
  d.tau *= -h;  // M v - h h(q, v)
  for (const Robot& robot : scene.robots) {
    add_friction(*robot.model, d.v.data() + robot.idx_v, d.tau.data() + robot.idx_v, h);
    for (int k = 0; k < robot.model->nu(); ++k) d.tau[robot.idx_v + robot.model->actuated[k]] += h * u[robot.idx_u + k];
  }
  const Status status = solve_tau(d.at_rest.scene, d.q, d.at_rest.zero, d.tau, d.dynamics).status;
  watch_condition(d.at_rest.scene, d);
  d.worst = std::max(d.worst, status);
  if (status == Status::kFailed) return false;
  d.next_v = d.dynamics.a;
  d.dynamics.a = (d.next_v - d.v) / h;
  d.dynamics.f /= h;
  d.dynamics.serial = 0;  // what it was solved at is not the state
  keep_forces(d);
  d.w = h * d.next_v;
  integrate_scene(scene, d.q, d.w, d.next_q);
  return true;
}

}  // namespace manycontact::internal
