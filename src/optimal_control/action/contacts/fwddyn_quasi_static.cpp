#include <limits>

#include "fwddyn_steps.hpp"
#include "manycontact/dynamics/quasi_static.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact::internal {

// Computes u from the actuation's torques linearised at u = 0.
void quasi_static(ActuationModelAbstract& actuation, const ConstVectorRef& x, DataCollector& m, VectorRef u) {
  u.setZero();
  actuation.calc(m.actuation, x, u);
  actuation.calcDiff(m.actuation, x, u);
  if (!unusable_configuration("q", x.head(m.scene.nq), m.scene).empty()) {  // a solver's trial may be unusable
    u.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  u = manycontact::quasi_static(m.scene, x.head(m.scene.nq), m.actuation->tau, m.actuation->dtau_du, m.solution);
}

}  // namespace manycontact::internal
