// A 5D contact is a hinge: it rotates freely and constrains all other motion.

#include <gtest/gtest.h>

#include <cmath>

#include "manycontact/simulation/gains.hpp"
#include "simulation/scenes.hpp"

namespace manycontact::test {
namespace {

const std::string kSpinning =
    "<scene gravity=\"0 0 0\"><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>VELOCITY</v></robot>"
    "<contact name=\"pin\" type=\"5d\" frame=\"b/crate\" offset=\"0.3 0.1 0.2\" axis=\"1 2 2\"/></scene>";

RandomScene spinning(const Vec3<double>& axis, double rate, const Vec3<double>& pin) {
  const Vec3<double> w = rate * axis, v = pin.cross(w);  // v at the pin: v + w x pin = 0
  std::ostringstream numbers;
  numbers.precision(17);
  numbers << v[0] << " " << v[1] << " " << v[2] << " " << w[0] << " " << w[1] << " " << w[2];
  std::string text = kSpinning;
  text.replace(text.find("VELOCITY"), 8, numbers.str());
  return of_file(load_text(text));
}

// Without gravity it keeps its rate, through half and whole revolutions, and forces do no work.
TEST(Hinge, SpinsOn) {
  const Vec3<double> axis = Vec3<double>(1, 2, 2) / 3, pin(0.3, 0.1, 0.2);
  for (Integrator integrator : kIntegrators) {
    SCOPED_TRACE(to_string(integrator));
    RandomScene s = spinning(axis, 10, pin);
    const int steps = 2000;
    const Gains gains = recommended_gains(integrator, 2.0 / steps);
    set_gains(s.scene, gains.alpha, gains.beta);
    const SimulationData sim = simulated(s, integrator, 2, steps);  // 20 rad, more than three turns
    const bool rk4 = integrator == Integrator::kRk4;
    EXPECT_LE(end_of(s, sim).violation_position, rk4 ? 1e-7 : 1e-4);
    EXPECT_NEAR(sim.v.tail<3>().dot(axis), 10, rk4 ? 1e-5 : 0.1);
    EXPECT_LE(sim.v.tail<3>().cross(axis).norm(), rk4 ? 1e-4 : 0.1);
    EXPECT_NEAR(end_of(s, sim).kinetic, start_of(s).kinetic, (rk4 ? 1e-5 : 2e-2) * start_of(s).kinetic);
  }
}

// An axis 0.3 off its reference returns to it at every angle of the hinge, half a revolution away too.
TEST(Hinge, ComesBackFromEveryAngle) {
  for (double turned : {0.0, 1.0, 2.0, 3.0, M_PI, 4.0}) {
    SCOPED_TRACE(turned);
    RandomScene s = spinning(Vec3<double>(1, 2, 2) / 3, 0, {0.3, 0.1, 0.2});
    Contact& pin = s.scene.contacts[0];
    const Mat3<double> off = rotation_about<double>(Vec3<double>(2, -1, 0).normalized(), 0.3);
    pin.B.placement.R = pin.B.placement.R * off * rotation_about<double>(pin.axis, turned);
    set_gains(s.scene, 100, 20);
    s.u.setZero();
    EXPECT_NEAR(start_of(s).violation_position, std::sin(0.3), 0.1);
    const SimulationData sim = simulated(s, Integrator::kRk4, 2, 1000);
    EXPECT_LE(end_of(s, sim).violation_position, 1e-6);
  }
}

}  // namespace
}  // namespace manycontact::test
