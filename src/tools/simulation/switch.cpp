#include "manycontact/simulation/switch.hpp"

#include <stdexcept>

#include "manycontact/dynamics/give_up_solution.hpp"

namespace manycontact {

VelocityJump switch_contacts(const Scene& scene, const std::vector<char>& active, SimulationData& data) {
  if (active.size() != scene.contacts.size())
    throw std::invalid_argument("switch_contacts: one flag for each contact is expected");
  bool closes = false;
  for (std::size_t c = 0; c < active.size(); ++c) closes = closes || (active[c] && !data.dynamics.active[c]);
  data.dynamics.active = active;
  VelocityJump out;
  if (!closes) return out;
  data.at_rest.follow(scene, 0);
  Eigen::VectorXd momentum(scene.nv);
  data.at_rest.inverse_dynamics_of(scene, data.q, data.at_rest.zero, data.v, Vec3<double>::Zero(), momentum);
  out.status = solve_tau(data.at_rest.scene, data.q, data.at_rest.zero, momentum, data.dynamics).status;
  data.worst = std::max(data.worst, out.status);
  if (out.status == Status::kFailed) return out;
  const Eigen::VectorXd jump = data.v - data.dynamics.a;
  Eigen::VectorXd M_jump(scene.nv);
  data.at_rest.inverse_dynamics_of(scene, data.q, data.at_rest.zero, jump, Vec3<double>::Zero(), M_jump);
  out.energy_lost = jump.dot(M_jump) / 2 + jump.dot(momentum - M_jump);
  out.impulse = data.dynamics.f;
  data.v = data.dynamics.a;
  give_up_solution(data.dynamics);
  return out;
}

}  // namespace manycontact
