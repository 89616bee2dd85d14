#include "fwddyn_steps.hpp"
#include "manycontact/dynamics/quasi_static.hpp"

namespace manycontact::internal {

// With the actuation's torques linearised at u = 0.
void quasi_static(ActuationModelAbstract& actuation, const ConstVectorRef& x, DataCollector& m, VectorRef u) {
  u.setZero();
  actuation.calc(m.actuation, x, u);
  actuation.calcDiff(m.actuation, x, u);
  u = manycontact::quasi_static(m.scene, x.head(m.scene.nq), m.actuation->tau, m.actuation->dtau_du, m.solution);
}

}  // namespace manycontact::internal
