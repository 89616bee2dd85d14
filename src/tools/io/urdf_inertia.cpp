#include <Eigen/Eigenvalues>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "urdf_check.hpp"

namespace manycontact::io {

namespace {

std::string brief(double x) {  // returns x with six significant digits
  char digits[40];
  return {digits, std::to_chars(digits, digits + sizeof digits, x, std::chars_format::general, 6).ptr};
}

}  // namespace

InertiaVerdict judge_inertia(const Inertia<double>& Y) {
  if (!std::isfinite(Y.m) || !Y.h.allFinite() || !Y.I.allFinite())
    return {"an inertia that is too large for computation, expected finite numbers", ""};
  if (Y.m < 0) return {"the mass " + show(Y.m) + " kg, expected a mass of 0 or more", ""};
  if (Y.m == 0 && Y.h.squaredNorm() > 0) return {"no mass but a first moment of mass, expected no first moment", ""};
  const Vec3<double> c = Y.m > 0 ? Vec3<double>(Y.h / Y.m) : Vec3<double>::Zero();
  const Mat3<double> shift = Y.m * (c.squaredNorm() * Mat3<double>::Identity() - c * c.transpose());
  const Mat3<double> Ic = Y.I - shift;  // rotational inertia about the centre of mass
  const Vec3<double> moments =
      Eigen::SelfAdjointEigenSolver<Mat3<double>>(Ic, Eigen::EigenvaluesOnly).eigenvalues();  // ascending order
  const double trace = Ic.trace();
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * (Y.I.norm() + shift.norm());
  const double allowed = 1e-9 * std::max(trace, 0.0) + rounding;
  if (!(moments[0] >= -allowed))
    return {"the principal moment of inertia " + show(moments[0]) + " kg m^2 (trace " + show(trace) +
                "), expected no moment below -1e-9 of the trace",
            ""};
  // I_1 + I_2 - I_3 = 2 int x_3^2 dm is never negative for a rigid body
  if (Y.m > 0 && !(moments[0] + moments[1] - moments[2] >= -allowed))
    return {"", "the principal moments of inertia " + brief(moments[0]) + ", " + brief(moments[1]) + ", " +
                    brief(moments[2]) +
                    " kg m^2, which violate the triangle inequality: the last exceeds the sum of the others by " +
                    brief(moments[2] - moments[0] - moments[1])};
  return {};
}

}  // namespace manycontact::io
