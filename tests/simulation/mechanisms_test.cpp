// Overconstrained mechanisms move: Bennett's linkage has four hinges and one degree of freedom, which counting rows
// forbids, and only on the closed loop. Without gravity its kinetic energy is constant, so its angle over time is a
// quadrature.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "manycontact/simulation/gains.hpp"
#include "simulation/scenes.hpp"
#include "support/folder.hpp"

namespace manycontact::test {
namespace {

// The hinges have twists alpha, beta, alpha, beta and lengths a, b, a, b with a / sin alpha = b / sin beta.
struct Bennett {
  double alpha, beta, a, b;

  double ratio() const { return std::sin((beta + alpha) / 2) / std::sin((beta - alpha) / 2); }
  Eigen::Vector3d angles(double t) const { return {t, 2 * std::atan2(ratio() * std::cos(t / 2), std::sin(t / 2)), -t}; }
  Eigen::Vector3d velocities(double t) const {  // with respect to t
    const double T = std::tan(t / 2), k = ratio();
    return {1, -k * (1 + T * T) / (T * T + k * k), -1};
  }
};

Bennett random_bennett(std::mt19937& rng) {
  Bennett out{};
  out.alpha = uniform(rng, 20, 80) * std::numbers::pi / 180;
  out.beta = uniform(rng, out.alpha + 20 * std::numbers::pi / 180, 160 * std::numbers::pi / 180);
  out.a = uniform(rng, 0.2, 0.6);
  out.b = out.a * std::sin(out.beta) / std::sin(out.alpha);
  return out;
}

SceneFile bennett_scene(const Bennett& x, double start, const std::string& attributes = "") {
  const TemporaryFolder folder;
  std::ostringstream urdf, scene;
  urdf.precision(17), scene.precision(17);
  const auto link = [&](const char* name, double length) {
    urdf << "<link name='" << name << "'><inertial><origin xyz='" << length / 2
         << " 0 0.02'/><mass value='1.5'/><inertia ixx='0.01' iyy='0.03' izz='0.025' ixy='0.001' ixz='0' "
            "iyz='0.002'/></inertial></link>";
  };
  const auto joint = [&](const char* name, const char* from, const char* to, double length, double twist) {
    urdf << "<joint name='" << name << "' type='continuous'><parent link='" << from << "'/><child link='" << to
         << "'/><origin xyz='" << length << " 0 0' rpy='" << twist << " 0 0'/><axis xyz='0 0 1'/></joint>";
  };
  urdf << "<robot name='bennett'><link name='g'/>";
  link("l1", x.a), link("l2", x.b), link("l3", x.a);
  joint("j1", "g", "l1", 0, 0), joint("j2", "l1", "l2", x.a, x.alpha), joint("j3", "l2", "l3", x.b, x.beta);
  urdf << "</robot>";
  (void)folder.write("bennett.urdf", urdf.str());
  scene << "<scene gravity='0 0 0' " << attributes << "><robot name='r' urdf='bennett.urdf'/><contact name='close' "
        << "type='5d' frame='r/l3' offset='" << x.a << " 0 0' offset_quat_xyzw='" << std::sin(x.alpha / 2) << " 0 0 "
        << std::cos(x.alpha / 2) << "' xyz='" << -x.b << " 0 0' quat_xyzw='" << std::sin(-x.beta / 2) << " 0 0 "
        << std::cos(x.beta / 2) << "' axis='0 0 1'/></scene>";
  SceneFile file = load_scene(folder.write("scene.xml", scene.str()));
  file.q = x.angles(start), file.v = x.velocities(start);
  return file;
}

// Returns the first angle after a second.
double bennett_angle(const Bennett& x, const SceneFile& file, double start) {
  InvariantsData room(file.scene);
  const std::vector<char> active(1, 1);
  const auto kinetic = [&](double t) {
    return invariants(file.scene, active, x.angles(t), x.velocities(t), room).kinetic;
  };
  const double at_start = kinetic(start);
  const auto rate = [&](double t) { return std::sqrt(at_start / kinetic(t)); };
  double t = start;
  constexpr int kSteps = 1000;
  constexpr double h = 1.0 / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const double k1 = rate(t), k2 = rate(t + h / 2 * k1), k3 = rate(t + h / 2 * k2), k4 = rate(t + h * k3);
    t += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return t;
}

double angle_after(const SceneFile& file, Integrator integrator, int steps) {
  SimulationData data(file.scene, file.q, file.v, integrator, 1.0 / steps);
  for (int k = 0; k < steps; ++k)
    if (step(file.scene, file.u, data) != StepStatus::kOk) return std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(data.dynamics.report.rank, 2);
  EXPECT_EQ(data.worst, Status::kRedundant);
  return data.q[0];
}

TEST(Mechanisms, RandomBennettLinkagesMove) {
  for (int seed = 0; seed < 100; ++seed) {
    std::mt19937 rng(seed);
    const Bennett x = random_bennett(rng);
    const double start = uniform(rng, 0.4, 1.6);
    const SceneFile file = bennett_scene(x, start, seed % 4 == 0 ? "tolerance='1e-4'" : "");
    const double q = bennett_angle(x, file, start);
    EXPECT_NEAR(angle_after(file, Integrator::kRk4, 1000), q, 1e-9) << seed;
    EXPECT_NEAR(angle_after(file, Integrator::kSemiImplicitEuler, 1000), q, 5e-3) << seed;
  }
}

// One row is 1/170 of another, and first in the order of elimination.
TEST(Mechanisms, ABennettLinkageWithASmallRowMoves) {
  Bennett x{2 * std::asin(0.23132318433806273), 0, 0.2649178765133539, 0};
  x.beta = 1.5808582310739;
  x.b = x.a * std::sin(x.beta) / std::sin(x.alpha);
  const double start = 1.564022476173701;
  const SceneFile file = bennett_scene(x, start);
  EXPECT_NEAR(angle_after(file, Integrator::kSemiImplicitEuler, 1000), bennett_angle(x, file, start), 1e-3);
}

// Gains correct the constraint violation, at long steps, in scenes of a millimetre and of a kilometre.
TEST(Mechanisms, BennettLinkagesMoveAtAnySizeAndStep) {
  for (int seed = 0; seed < 8; ++seed) {
    std::mt19937 rng(seed);
    Bennett x = random_bennett(rng);
    const double start = uniform(rng, 0.4, 1.6);
    for (const double size : {1e-3, 1.0, 1e3}) {
      Bennett scaled = x;
      scaled.a *= size, scaled.b *= size;
      for (const int steps : {100, 1000}) {
        SceneFile file = bennett_scene(scaled, start);
        const double q = bennett_angle(scaled, file, start);
        for (const bool gains : {false, true}) {
          const Gains g = recommended_gains(Integrator::kSemiImplicitEuler, 1.0 / steps);
          if (gains) set_gains(file.scene, g.alpha, g.beta);
          EXPECT_NEAR(angle_after(file, Integrator::kSemiImplicitEuler, steps), q, 5.0 / steps) << seed << " " << size;
        }
      }
    }
  }
}

}  // namespace
}  // namespace manycontact::test
