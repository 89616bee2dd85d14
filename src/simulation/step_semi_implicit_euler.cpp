#include "internal.hpp"

namespace manycontact::internal {

bool step_semi_implicit_euler(const Scene& scene, const ConstVector& u, SimulationData& d) {
  if (!solve_stage(scene, d.q, d.v, u, d)) return false;
  d.next_v = d.v + d.h * d.dynamics.a;
  d.w = d.h * d.next_v;
  integrate_scene(scene, d.q, d.w, d.next_q);
  return true;
}

}  // namespace manycontact::internal
