#include "internal.hpp"

namespace manycontact::internal {

bool step_rk4(const Scene& scene, const ConstVector& u, SimulationData& d) {
  constexpr double node[] = {0, 0.5, 0.5, 1}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  d.w_sum.setZero();
  d.v_sum.setZero();
  for (int s = 0; s < 4; ++s) {
    if (s == 0) {
      d.w.setZero();
      d.stage_v = d.v;
      d.stage_q = d.q;
    } else {
      d.w = node[s] * d.h * d.w_rate;
      d.stage_v = d.v + node[s] * d.h * d.v_rate;
      integrate_scene(scene, d.q, d.w, d.stage_q);
    }
    if (!solve_stage(scene, d.stage_q, d.stage_v, u, d)) return false;
    if (s == 0) {
      keep_what_depends(d.dynamics, d);
      keep_forces(d);
      watch_condition(scene, d.dynamics, d);
    }
    dexp_inverse(scene, d.w, d.stage_v, d.w_rate);
    d.v_rate = d.dynamics.a;
    d.w_sum += weight[s] * d.h * d.w_rate;
    d.v_sum += weight[s] * d.h * d.v_rate;
  }
  integrate_scene(scene, d.q, d.w_sum, d.next_q);
  d.next_v = d.v + d.v_sum;
  return true;
}

}  // namespace manycontact::internal
