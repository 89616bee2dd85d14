#pragma once

#include "manycontact/spatial/se3.hpp"

namespace manycontact {

/// Returns Rz(yaw) Ry(pitch) Rx(roll); angles in rad.
inline Mat3<double> rotation_of_rpy(double roll, double pitch, double yaw) {
  return rotation_about<double>(Vec3<double>::UnitZ(), yaw) * rotation_about<double>(Vec3<double>::UnitY(), pitch) *
         rotation_about<double>(Vec3<double>::UnitX(), roll);
}

}  // namespace manycontact
