#pragma once
// Joints of several coordinates in a step of symplectic Euler, of compile-time size.

#include <type_traits>

#include "manycontact/control/euler.hpp"

namespace manycontact::internal {

/// use(first coordinate, number of them, J1, J2), floating joints and planar ones.
template <class Use>
void each_wide_joint(const IntegratedActionDataEuler& data, Use&& use) {
  for (const IntegratedActionDataEuler::WideJoint& joint : data.wide_joints) {
    if (joint.size == 6)
      use(joint.first, std::integral_constant<int, 6>(), joint.of_x, joint.of_dx);
    else
      use(joint.first, std::integral_constant<int, 3>(), Mat3<double>(joint.of_x.topLeftCorner<3, 3>()),
          Mat3<double>(joint.of_dx.topLeftCorner<3, 3>()));
  }
}

}  // namespace manycontact::internal
