// When contacts close, velocities jump to the nearest ones that satisfy them. Energy is that of the constrained bodies.

#include "manycontact/simulation/switch.hpp"

#include <gtest/gtest.h>

#include "manycontact/simulation/gains.hpp"
#include "simulation/scenes.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

double kinetic(const RandomScene& s, const Eigen::VectorXd& v) { return invariants_of(s, s.q, v).kinetic; }

// v+ is the projection: T(v) = T(v+) + T(v - v+), J v+ = 0, and M (v - v+) is in J's range.
TEST(Switch, ProjectsTheVelocity) {
  for (Integrator integrator : kIntegrators)
    for (int seed : {61, 62, 63}) {
      SCOPED_TRACE(seed);
      RandomScene s = tied_scene(seed);
      std::mt19937 rng(seed);
      s.v = random_vector(s.scene.nv, rng);
      SimulationData sim(s.scene, s.q, s.v, integrator, 1e-3);
      sim.dynamics.active.assign(s.scene.contacts.size(), 0);
      EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
      sim.q = s.q, sim.v = s.v;
      const VelocityJump jump = switch_contacts(s.scene, std::vector<char>(s.scene.contacts.size(), 1), sim);
      EXPECT_EQ(jump.status, Status::kOk);
      const double before = kinetic(s, s.v), after = kinetic(s, sim.v);
      EXPECT_NEAR(jump.energy_lost, before - after, 1e-9 * before);
      EXPECT_NEAR(kinetic(s, s.v - sim.v), before - after, 1e-9 * before);
      EXPECT_GT(jump.energy_lost, 1e-3 * before);
      const Eigen::MatrixXd J = contact_jacobian(s.scene, s.q);
      EXPECT_LE((J * sim.v).lpNorm<Eigen::Infinity>(), 1e-10 * (J * s.v).lpNorm<Eigen::Infinity>());
      EXPECT_EQ(jump.impulse.size(), J.rows());
      // a second time the velocity satisfies the contacts, and opening changes nothing
      const Eigen::VectorXd v = sim.v;
      sim.dynamics.active.assign(s.scene.contacts.size(), 0);
      EXPECT_LE(switch_contacts(s.scene, std::vector<char>(s.scene.contacts.size(), 1), sim).energy_lost,
                1e-12 * before);
      EXPECT_LE(difference_of(sim.v, v), 1e-10);
      const Eigen::VectorXd last = sim.v;
      (void)switch_contacts(s.scene, std::vector<char>(s.scene.contacts.size(), 0), sim);
      EXPECT_TRUE(sim.v == last);
      EXPECT_THROW((void)switch_contacts(s.scene, {}, sim), std::invalid_argument);
    }
}

// A box falls on one corner: the impulse is that of a free body struck at a point.
TEST(Switch, ABoxOnItsCorner) {
  const SceneFile file = load_text(
      "<scene><robot name=\"b\" urdf=\"box.urdf\" base=\"floating\"><v>0 0 -2 0 0 0</v></robot>"
      "<contact name=\"c\" type=\"3d\" frame=\"b/bottom_1\" active=\"false\"/></scene>");
  SimulationData sim(file.scene, file.q, file.v, Integrator::kRk4, 1e-3);
  const VelocityJump jump = switch_contacts(file.scene, {1}, sim);
  const Inertia<double>& Y = file.scene.robots[0].model->joints[0].inertia;
  const Frame& corner = file.scene.robots[0].model->frames[file.scene.robots[0].model->find_frame("bottom_1")];
  const Vec3<double> c = Y.h / Y.m, r = corner.placement.p - c;
  const Mat3<double> about_c = Y.I - Y.m * (c.squaredNorm() * Mat3<double>::Identity() - c * c.transpose());
  Mat3<double> cross;
  cross << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
  const Mat3<double> inverse_mass = Mat3<double>::Identity() / Y.m - cross * about_c.inverse() * cross;
  const Vec3<double> impulse = inverse_mass.inverse() * Vec3<double>(0, 0, 2);
  EXPECT_LE(error_of(Vec3<double>(jump.impulse), impulse), 1e-12);
}

// Four quadrupeds fall under a plate that they carry. Their legs pass the straight line at 100 rad/s and more, a tenth
// of a radian per step. Acceleration-level contacts with the same gains add 63 % of the energy there.
TEST(SimulationLaws, RecommendedGainsDoNotPump) {
  std::string text = "<scene><robot name=\"plate\" urdf=\"box.urdf\" base=\"floating\" xyz=\"0 0 0.6\"/>";
  const char* legs[] = {"LF", "RF", "LH", "RH"};
  for (int k = 0; k < 4; ++k) {
    const std::string r = "r" + std::to_string(k);
    text += "<robot name=\"" + r + "\" urdf=\"quadruped.urdf\" base=\"floating\" xyz=\"" + (k < 2 ? "0.6 " : "-0.6 ") +
            (k % 2 ? "0.5" : "-0.5") + " 0.3824\">";
    for (const std::string leg : legs)
      text += "<joint name=\"" + leg + "_hip\" q=\"0.7\"/><joint name=\"" + leg + "_knee\" q=\"-1.4\"/>";
    text += "</robot>";
  }
  for (int k = 0; k < 4; ++k) {
    const std::string n = std::to_string(k);
    for (const std::string leg : legs)
      text += "<contact name=\"" + leg + n + "\" type=\"3d\" frame=\"r" + n + "/" + leg + "_foot\"/>";
    text += "<contact name=\"t" + n + "\" type=\"3d\" frame=\"r" + n + "/trunk\" to=\"plate/crate\"/>";
  }
  RandomScene s = of_file(load_text(text + "</scene>"));
  s.u.setZero();
  const double start = start_of(s).energy();
  const auto most = [&](int steps) {
    const Gains gains = recommended_gains(Integrator::kSemiImplicitEuler, 0.5 / steps);
    set_gains(s.scene, gains.alpha, gains.beta);
    SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 0.5 / steps);
    double largest = start, fastest = 0;
    for (int k = 0; k < steps; ++k) {
      EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
      largest = std::max(largest, end_of(s, sim).energy());
      fastest = std::max(fastest, sim.v.lpNorm<Eigen::Infinity>());
    }
    EXPECT_GT(fastest, 50);
    return largest - start;
  };
  EXPECT_LE(most(500), 0.05 * start);
  EXPECT_LE(most(2000), 0.02 * start);
}

}  // namespace
}  // namespace manycontact::test
