// ExternalWrenches and springs act through time.

#include <Eigen/Eigenvalues>

#include "manycontact/algorithm/applied_forces.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/contact/jacobian.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/simulation/free_joints.hpp"
#include "manycontact/simulation/resisting_joints.hpp"
#include "manycontact/simulation/spring_steps.hpp"
#include "simulation/scenes.hpp"
#include "support/allocations.hpp"
#include "support/applied.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

// Returns a mass of 2 kg on a spring of 50 N/m, across gravity, 0.1 m off its rest: 5 rad/s.
RandomScene oscillator(double damping = 0, double stiffness = 50) {
  RandomScene s;
  Model model;
  Joint joint;
  joint.name = "slide";
  joint.type = JointType::kPrismatic;
  joint.axis = Vec3<double>::UnitX();
  joint.inertia = Inertia<double>::from_com(2, Vec3<double>::Zero(), Mat3<double>::Identity());
  joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(1);
  model.joints = {joint};
  model.frames = {{"mass", 0, {}, false, {}, "slide"}};
  finalize(model);
  add_robot(s.scene, "body", std::make_shared<const Model>(model));
  add_spring(s.scene, {"spring",
                       attach(s.scene, "body", "mass"),
                       {-1, -1, {Mat3<double>::Identity(), {-2, 0, 0}}},
                       stiffness,
                       2,
                       damping});
  s.q = VectorXd::Constant(1, 0.1);
  s.v = s.u = VectorXd::Zero(1);
  return s;
}

TEST(Springs, MassOscillates) {
  const RandomScene s = oscillator();
  EXPECT_NEAR(start_of(s).potential, 0.5 * 50 * 0.01, 1e-15);
  const SimulationData fine = simulated(s, Integrator::kRk4, 1, 1000);
  EXPECT_NEAR(fine.q[0], 0.1 * std::cos(5.0), 1e-10);
  EXPECT_NEAR(fine.v[0], -0.5 * std::sin(5.0), 1e-9);
  EXPECT_NEAR(end_of(s, fine).energy(), 0.25, 1e-11);
  const SimulationData first = simulated(s, Integrator::kSemiImplicitEuler, 1, 1000);
  EXPECT_NEAR(first.q[0], 0.1 * std::cos(5.0), 1e-3);
}

// The share of v that a spring does not resist, of z = h^2 k / m.
double share(double z) { return 1 - z * z / ((1 + z) * (1 + z)); }

// A step that resolves the oscillation keeps its energy within h omega / 2, as an explicit one does, for long.
TEST(Springs, EnergyIsKept) {
  for (const bool in_joint : {false, true})
    for (const double h : {1e-2, 1e-3}) {
      RandomScene s = oscillator();
      if (in_joint) {
        s.scene.springs.clear();
        add_joint_spring(s.scene, "body", "slide", 50);
      }
      SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, h);
      double taken = 0;
      for (double t = 0; t < 30; t += h) {
        ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
        EXPECT_NEAR(end_of(s, sim).energy(), 0.25, 0.25 * 5 * h / 2 * (1 + 3 * h));
        taken += sim.work.springs;
      }
      EXPECT_NEAR(taken, 0, 0.25 * 2e-3);
    }
}

// A spring without length balances a weight everywhere: k r d = m g l. The arm goes on as it does.
TEST(Springs, BalanceAWeightEverywhere) {
  RandomScene s = oscillator();
  s.scene.springs.clear(), s.scene.spring_index.clear();
  Model model = *s.scene.robots[0].model;
  model.joints[0].type = JointType::kRevolute;
  model.joints[0].axis = -Vec3<double>::UnitY();
  model.joints[0].inertia = Inertia<double>::from_com(2, {0.5, 0, 0}, 0.02 * Mat3<double>::Identity());
  s.scene.robots[0].model = std::make_shared<const Model>(model);
  s.scene.gravity = {0, 0, -9.81};
  add_spring(s.scene, {"spring",
                       {0, 0, {Mat3<double>::Identity(), {0.2, 0, 0}}},
                       {-1, -1, {Mat3<double>::Identity(), {0, 0, 0.3}}},
                       163.5});
  s.q[0] = 0.4, s.v[0] = 0.5;
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 10, 1000);
  EXPECT_NEAR(sim.q[0], 5.4, 1e-3);
  EXPECT_NEAR(sim.v[0], 0.5, 2e-4);
}

// Robots of joints that turn far in a step, with springs that are next to nothing: they move as without these springs.
TEST(Springs, TakeNothingOfOtherMotion) {
  for (int seed = 1; seed <= 20; ++seed)
    for (const bool tied : {false, true}) {
      SCOPED_TRACE(std::to_string(seed) + (tied ? " tied" : " free"));
      RandomScene s = tied ? tied_scene(seed) : free_scene(seed, seed % 2);
      s.scene.gravity.setZero();
      s.v *= 20;
      RandomScene with = s;
      std::mt19937 rng(static_cast<unsigned>(seed));
      add_random_forces(with.scene, rng, 0, 2);
      with.scene.joint_springs.clear();
      for (Spring& spring : with.scene.springs) spring.stiffness = 1e-9, spring.damping = 0, spring.length = 0.1;
      const SimulationData other = simulated(s, Integrator::kSemiImplicitEuler, 5e-2, 5);
      const SimulationData sim = simulated(with, Integrator::kSemiImplicitEuler, 5e-2, 5);
      EXPECT_LT(difference_of(sim.v, other.v), 1e-5 * size_of(other.v));
    }
}

TEST(Springs, WithoutDirectionAreNamed) {
  RandomScene s = oscillator();
  s.q[0] = -2;
  for (const Integrator integrator : kIntegrators) {
    SimulationData sim(s.scene, s.q, s.v, integrator, 1e-3);
    const StepStatus status = step(s.scene, s.u, sim);
    EXPECT_EQ(status, StepStatus::kSolverFailed);
    EXPECT_NE(failure(s.scene, sim, status).find("ends of a spring coincide"), std::string::npos)
        << failure(s.scene, sim, status);
  }
}

TEST(Springs, DampersTakeEnergy) {
  const RandomScene s = oscillator(4);  // c / 2 m = 1 /s
  const SimulationData sim = simulated(s, Integrator::kRk4, 1, 1000);
  const double w = std::sqrt(24.0);
  EXPECT_NEAR(sim.q[0], 0.1 * std::exp(-1.0) * (std::cos(w) + std::sin(w) / w), 1e-10);
}

// In trees, on floating bases and in loops the energy of springs and bodies is conserved.
TEST(Springs, EnergyOfScenes) {
  for (const bool tied : {false, true}) {
    RandomScene s = tied ? tied_scene(5) : free_scene(3);
    std::mt19937 rng(4);
    add_random_forces(s.scene, rng, 0, 4);
    for (Spring& spring : s.scene.springs) spring.damping = 0;
    s.u.setZero();
    const double before = start_of(s).energy();
    const SimulationData coarse = simulated(s, Integrator::kRk4, 0.1, 100),
                         fine = simulated(s, Integrator::kRk4, 0.1, 200);
    const double error = std::abs(end_of(s, fine).energy() - before);
    EXPECT_LE(error, 1e-6 * start_of(s).kinetic);
    EXPECT_GT(std::abs(end_of(s, coarse).energy() - before), 8 * error);  // the error is of fourth order
  }
}

// Two bodies in space are coupled by a spring: momentum is exact up to rounding, in steps that are far from exact.
TEST(Springs, MomentumOfBodiesOnASpring) {
  RandomScene s = free_scene(7);
  const RandomScene other = free_scene(8);
  add_robot(s.scene, "other", other.scene.robots[0].model);
  const auto join = [](VectorXd& x, const VectorXd& y) {
    const VectorXd both = (VectorXd(x.size() + y.size()) << x, y).finished();
    x = both;
  };
  join(s.q, other.q), join(s.v, other.v), join(s.u, other.u);
  s.scene.gravity.setZero();
  s.u.setZero();
  add_spring(s.scene, {"rope", {0, 2, {}}, {1, 3, {}}, 40, 0.2, 1});
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 0.2, 100);
  EXPECT_LE(error_of(end_of(s, sim).momentum, start_of(s).momentum), 1e-11);
  EXPECT_GT((sim.v - s.v).norm(), 0.1);
}

// A push acts on a body in space: momentum grows by exactly force times time.
TEST(ExternalWrenches, MomentumGrows) {
  RandomScene s = free_scene(7);
  s.scene.gravity.setZero();
  s.u.setZero();
  Vec6<double> w = Vec6<double>::Zero();
  w.head<3>() << 1, 2, 3;
  add_external_wrench(s.scene, {"push", {0, 0, {Mat3<double>::Identity(), {0.1, 0, 0}}}, ReferenceFrame::kWorld, w});
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 0.2, 100);
  EXPECT_LE(difference_of(Vec3<double>(end_of(s, sim).momentum.head<3>()),
                          Vec3<double>(start_of(s).momentum.head<3>() + 0.2 * w.head<3>())),
            1e-12);
}

TEST(ExternalWrenches, ChangeBetweenSteps) {
  RandomScene s = oscillator(0, 0);
  add_external_wrench(s.scene, {"push", s.scene.springs[0].A});
  for (const Integrator integrator : kIntegrators) {
    SimulationData sim(s.scene, VectorXd::Zero(1), s.v, integrator, 0.01);
    for (int k = 0; k < 100; ++k) {
      sim.dynamics.wrenches[0][0] = k < 50 ? 4 : 0;
      ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    }
    EXPECT_NEAR(sim.v[0], 1, 1e-12);  // 4 N on 2 kg for half a second
  }
}

// ---- springs that are too stiff for the steps ----------------------------------------------------------------------

// m (v+ - v) = -h k (x + h (v+ - s v)) - h c v+ is valid for a spring between points and for one in the joint.
TEST(StiffSprings, AreTakenAtTheEndOfTheStep) {
  for (const bool in_joint : {false, true})
    for (const double c : {0.0, 30.0}) {
      SCOPED_TRACE((in_joint ? "in the joint, damping " : "between points, damping ") + std::to_string(c));
      const double m = 2, k = 5e6, h = 0.01, x = 0.1, v = 3;
      RandomScene s = oscillator(c, k);
      s.v[0] = v;
      if (in_joint) {
        s.scene.springs.clear();
        Model model = *s.scene.robots[0].model;
        model.damping = VectorXd::Constant(1, c);
        model.friction = VectorXd::Zero(1);
        s.scene.robots[0].model = std::make_shared<const Model>(model);
        add_joint_spring(s.scene, "body", "slide", k);
      }
      SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, h);
      ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
      const double kept = share(h * h * k / m) * h * h * k * v;
      EXPECT_NEAR(sim.v[0], (m * v - h * k * x + kept) / (m + h * h * k + h * c), 1e-10);
      EXPECT_NEAR(sim.dynamics.a[0], (sim.v[0] - v) / h, 1e-9);
    }
}

// A step leaves its own accelerations in the data: derivatives computed before are no longer valid.
TEST(StiffSprings, DerivativesBeforeAStepEndWithIt) {
  RandomScene s = oscillator();
  s.scene.springs.clear();
  add_joint_spring(s.scene, "body", "slide", 5e6);
  SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 0.01);
  ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  (void)solve(s.scene, s.q, s.v, s.u, sim.dynamics);
  const IslandDerivatives& before = differentiate(s.scene, sim.dynamics).islands[0];
  EXPECT_NO_THROW((void)before.da_dq());
  ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
  EXPECT_THROW((void)before.da_dq(), std::logic_error);
}

// A damper alone is 250 times too stiff for an explicit step: v+ = v / (1 + h c / m).
TEST(StiffSprings, DampersInJointsToo) {
  const double m = 2, c = 1e5, h = 0.01;
  RandomScene s = oscillator();
  s.scene.springs.clear();
  Model model = *s.scene.robots[0].model;
  model.damping = VectorXd::Constant(1, c);
  model.friction = VectorXd::Zero(1);
  s.scene.robots[0].model = std::make_shared<const Model>(model);
  s.v[0] = 3;
  SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, h);
  for (int k = 1; k < 4; ++k) {
    ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
    EXPECT_NEAR(sim.v[0], 3 / std::pow(1 + h * c / m, k), 1e-12);
  }
}

// Checks the equations of the step with spring forces at its end and directions of springs from differences of lengths.
// Soft and stiff springs share bodies; contacts are in place, or displaced with gains.
void expect_equations_of_the_step(bool displaced) {
  RandomScene s = tied_scene(5);
  std::mt19937 rng(3);
  add_random_forces(s.scene, rng, 2, 5);
  const double h = 0.01;
  Scene& scene = s.scene;
  if (displaced) {
    set_gains(scene, 1 / (4 * h * h), 3 / (4 * h));
    s.q = integrate(scene, s.q, VectorXd::Constant(scene.nv, 0.01));
  }
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    Spring& spring = scene.springs[k];
    spring.length = 1.2 * spring_length(scene, s.q, spring);  // compressed: it has no stiffness across
    if (k != 2) spring.stiffness = 1e6, spring.damping = 100.0 * static_cast<double>(k);
  }
  for (std::size_t k = 0; k < scene.joint_springs.size(); k += 2) scene.joint_springs[k].stiffness = 1e6;
  SimulationData sim(scene, s.q, s.v, Integrator::kSemiImplicitEuler, h);
  ASSERT_EQ(step(scene, s.u, sim), StepStatus::kOk);

  VectorXd stop;  // x: the velocity at the end in the axes of the start
  internal::stop_in_a_step(scene, s.v, h, stop);
  const VectorXd x = h * (sim.dynamics.a - stop), ahead = integrate(scene, s.q, h * x);
  internal::ResistingJoints joints(scene);
  joints.find(scene, {}, h);
  Scene stiff = joints.with_inertias(scene);
  const SpringMobilities mobilities = spring_mobilities(stiff, {}, sim.dynamics.active, s.q);
  AppliedForces<double> at_start(scene);
  std::vector<Vec6<double>> no_pushes(scene.wrenches.size(), Vec6<double>::Zero());
  find_applied_wrenches<double>(scene, s.q.data(), s.v.data(), no_pushes, at_start);
  VectorXd tau = VectorXd::Zero(scene.nv);
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) tau[robot.idx_v + robot.model->actuated[k]] += s.u[robot.idx_u + k];
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const Spring& spring = scene.springs[k];
    VectorXd g(scene.nv);
    for (int i = 0; i < scene.nv; ++i) {
      const double e = 1e-6;
      const VectorXd d = e * VectorXd::Unit(scene.nv, i);
      g[i] = (spring_length(scene, integrate(scene, s.q, d), spring) -
              spring_length(scene, integrate(scene, s.q, -d), spring)) /
             (2 * e);
    }
    const double stretch = spring_length(scene, s.q, spring) - spring.length + h * g.dot(x);
    const Vec3<double>& n = at_start.springs[k].n;
    const double kept = share(h * h * spring.stiffness * n.dot(mobilities.springs[k] * n)) * h * g.dot(s.v);
    tau -= g * (spring.stiffness * (stretch - kept) + spring.damping * g.dot(x));
  }
  for (std::size_t k = 0; k < scene.joint_springs.size(); ++k) {
    const JointSpring& spring = scene.joint_springs[k];
    const Robot& robot = scene.robots[spring.robot];
    const Joint& joint = robot.model->joints[spring.joint];
    const int i = robot.idx_v + joint.idx_v;
    tau[i] -= spring.stiffness * (ahead[robot.idx_q + joint.idx_q] - spring.rest - joints.kept[i] * h * s.v[i]);
  }
  Scene plain = scene;
  plain.springs.clear(), plain.joint_springs.clear();
  SceneData data(plain);
  (void)solve_tau(plain, s.q, s.v, tau, data);  // wrenches too: M a + h = tau + J^T f
  RigidBodyData rigid(plain);
  const VectorXd held = contact_jacobian(plain, s.q).transpose() * (sim.dynamics.f - data.f);
  const VectorXd left = crba(plain, s.q, rigid) * (sim.dynamics.a - data.a) - held;
  EXPECT_LT(left.norm(), 1e-6 * tau.norm());
}

TEST(StiffSprings, SolveTheEquationsOfTheStep) {
  for (const bool displaced : {false, true}) {
    SCOPED_TRACE(displaced);
    expect_equations_of_the_step(displaced);
  }
}

// Masses in space, each on three slides, are in a net that hangs on the world, stretched by a twentieth. Where all its
// modes are faster than the steps, energy falls with every step, until the net is at rest.
TEST(StiffSprings, OfANetTakeEnergy) {
  for (const double stiffness : {1e4, 1e6, 1e9}) {
    SCOPED_TRACE(stiffness);
    RandomScene s;
    Model model;
    for (int k = 0; k < 3; ++k) {
      Joint joint;
      joint.name = "slide" + std::to_string(k);
      joint.type = JointType::kPrismatic;
      joint.axis = Vec3<double>::Unit(k);
      joint.parent = k - 1;
      joint.inertia = Inertia<double>::from_com(k == 2 ? 0.5 : 0, Vec3<double>::Zero(), Mat3<double>::Zero());
      joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(1);
      model.joints.push_back(joint);
    }
    model.frames = {{"mass", 2, {}, false, {}, "slide2"}};
    finalize(model);
    const auto shared = std::make_shared<const Model>(model);
    std::mt19937 rng(4);
    s.scene.gravity.setZero();
    for (int k = 0; k < 8; ++k) add_robot(s.scene, "m" + std::to_string(k), shared);
    s.q.resize(24);
    for (int k = 0; k < 8; ++k) s.q.segment<3>(3 * k) << (k & 1), (k >> 1 & 1), (k >> 2);
    s.q += random_vector(24, rng, 0.1);
    s.v = random_vector(24, rng);
    s.u = VectorXd::Zero(24);
    const auto tie = [&](int a, const Attachment& B) {
      Spring spring{"s" + std::to_string(s.scene.springs.size()), {a, 2, {}}, B, stiffness};
      spring.length = 0.95 * spring_length(s.scene, s.q, spring);
      add_spring(s.scene, spring);
    };
    for (int a = 0; a < 8; ++a)
      for (int b = a + 1; b < 8; ++b) tie(a, {b, 2, {}});
    for (int a = 0; a < 4; ++a) tie(a, {-1, -1, {Mat3<double>::Identity(), Vec3<double>(3 * a - 5, a, -2)}});
    double last = start_of(s).energy();
    const double before = last;
    SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 0.01);
    for (int k = 0; k < 400; ++k) {
      ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk) << "step " << k;
      const double energy = end_of(s, sim).energy();
      EXPECT_LE(energy, stiffness < 1e5 ? 1.01 * before : last * (1 + 1e-9)) << "step " << k;
      last = energy;
    }
    EXPECT_LT(end_of(s, sim).kinetic, (stiffness < 1e5 ? 1e-1 : 1e-3) * before);
  }
}

// Bodies rotate, in trees, loops and on a floating base, for hundreds of steps: the energy of springs is lost or
// rotates the bodies.
TEST(StiffSprings, OfTreesStayBounded) {
  for (const bool tied : {false, true})
    for (const double stiffness : {1e5, 1e9}) {
      SCOPED_TRACE((tied ? "tied, " : "free, ") + std::to_string(stiffness));
      RandomScene s = tied ? tied_scene(5) : free_scene(3);
      std::mt19937 rng(4);
      add_random_forces(s.scene, rng, 0, 4);
      s.scene.gravity.setZero();
      s.u.setZero();
      for (Spring& spring : s.scene.springs) {
        spring.stiffness = stiffness;
        spring.length = 0.95 * spring_length(s.scene, s.q, spring);
      }
      for (JointSpring& spring : s.scene.joint_springs) {
        const Robot& robot = s.scene.robots[spring.robot];
        spring.stiffness = stiffness;
        spring.rest = s.q[robot.idx_q + robot.model->joints[spring.joint].idx_q] + 0.01;
      }
      const double before = start_of(s).energy();
      SimulationData sim(s.scene, s.q, s.v, Integrator::kSemiImplicitEuler, 1e-3, {Method::kSparseLdl, {}});
      double fastest = 0;  // h omega of springs: a step that resolves them keeps their energy within half of it
      const SpringMobilities mobilities = spring_mobilities(s.scene, {}, sim.dynamics.active, s.q);
      for (const Mat3<double>& of : mobilities.springs)
        fastest = std::max(fastest,
                           1e-3 * std::sqrt(stiffness * of.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff()));
      sim.velocity_limit = 1e9;
      for (int k = 0; k < 300; ++k) {
        ASSERT_EQ(step(s.scene, s.u, sim), StepStatus::kOk) << "step " << k;
        EXPECT_LE(end_of(s, sim).energy(), (stiffness < 1e6 ? 1 + fastest / 2 : 1.01) * before) << "step " << k;
      }
      if (MANYCONTACT_COUNTS_ALLOCATIONS) {
        EXPECT_EQ(allocations([&] { (void)step(s.scene, s.u, sim); }), 0u);
      }
    }
}

// Only stiff springs act on a scene without contacts: they conserve its momentum.
TEST(StiffSprings, BetweenBodiesKeepMomentum) {
  RandomScene s = free_scene(7);
  s.scene.gravity.setZero();
  s.u.setZero();
  Spring rod{"rod", {0, 2, {}}, {0, 5, {}}, 1e8, 0, 10};
  rod.length = spring_length(s.scene, s.q, rod);
  add_spring(s.scene, rod);
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 0.2, 100);
  EXPECT_LE(error_of(end_of(s, sim).momentum, start_of(s).momentum), 1e-11);
}

// A mass of 2 kg hangs on a spring to the world: it rests where weight and spring are equal, whatever the step.
TEST(StiffSprings, HoldAWeight) {
  RandomScene s;
  Model model;
  Joint joint;
  joint.name = "root";
  joint.type = JointType::kFloating;
  joint.inertia = Inertia<double>::from_com(2, Vec3<double>::Zero(), Mat3<double>::Identity());
  joint.lower = joint.upper = joint.velocity_limit = joint.effort_limit = VectorXd::Zero(6);
  model.floating_base = true;
  model.joints = {joint};
  model.frames = {{"mass", 0, {}, false, {}, "root"}};
  finalize(model);
  add_robot(s.scene, "body", std::make_shared<const Model>(model));
  add_spring(s.scene,
             {"rope", attach(s.scene, "body", "mass"), {-1, -1, {Mat3<double>::Identity(), {0, 0, 2}}}, 1e7, 1, 0});
  s.q = neutral(s.scene);
  s.q[2] = 1;
  s.v = VectorXd::Zero(6);
  s.u.resize(0);
  const SimulationData sim = simulated(s, Integrator::kSemiImplicitEuler, 10, 1000);
  EXPECT_NEAR(sim.q[2], 1 - 2 * 9.81 / 1e7, 1e-9);
}

// The error is of first order also where springs are evaluated at the end of the step.
TEST(StiffSprings, KeepTheOrder) {
  const RandomScene s = oscillator(4000, 4000);  // converges by 1 per second; explicit steps must be below 1 ms
  const SimulationData truth = simulated(s, Integrator::kRk4, 1, 4000);
  double before = 0;
  for (const int steps : {200, 400, 800}) {
    const double error = std::abs(simulated(s, Integrator::kSemiImplicitEuler, 1, steps).q[0] - truth.q[0]);
    if (before > 0) {
      EXPECT_NEAR(before / error, 2, 0.1) << steps;
    }
    before = error;
  }
}

TEST(SpringSteps, OfAMass) {
  const auto shortest = [](const RandomScene& s, Integrator integrator, const PdLaws& pd = {}) {
    return shortest_spring_step(s.scene, pd, {}, s.q, integrator);
  };
  for (const double damping : {0.0, 4.0, 400.0}) {
    RandomScene s = oscillator(damping);
    s.q[0] = 1e-12;  // so small that the spring's length hardly changes as it grows
    for (const Integrator integrator : kIntegrators) {
      SCOPED_TRACE(to_string(integrator) + ", damping " + std::to_string(damping));
      const double most = shortest(s, integrator).largest;
      const auto growth = [&](double h) {  // of the energy, in 100 steps
        SimulationData sim(s.scene, s.q, s.v, integrator, h);
        sim.velocity_limit = 1e100;
        for (int k = 0; k < 100; ++k) EXPECT_EQ(step(s.scene, s.u, sim), StepStatus::kOk);
        return end_of(s, sim).energy() / start_of(s).energy();
      };
      if (integrator == Integrator::kRk4) {
        EXPECT_LE(growth(0.98 * most), 1 + 1e-12);
        EXPECT_GT(growth(1.3 * most), 100);
      } else {
        for (const double times : {1.0, 10.0, 1e4}) EXPECT_LE(growth(times * most), 1 + 1e-12);
      }
    }
  }
  EXPECT_NEAR(shortest(oscillator(), Integrator::kSemiImplicitEuler).largest, 0.4, 1e-12);  // 2 / omega
  EXPECT_EQ(shortest(oscillator(), Integrator::kSemiImplicitEuler).spring, 0);
  RandomScene none = oscillator();
  none.scene.springs.clear();
  EXPECT_FALSE(shortest(none, Integrator::kRk4).any());
  const VectorXd zero = VectorXd::Zero(1), one = VectorXd::Ones(1);
  const SpringStep gain = shortest(none, Integrator::kRk4, {zero, 5200 * one, zero, zero});  // c / m = 2600
  EXPECT_EQ(gain.coordinate, 0);
  EXPECT_NEAR(gain.largest, 1e-3, 1e-12);
  add_joint_spring(none.scene, "body", "slide", 5000);
  const SpringStep step = shortest(none, Integrator::kSemiImplicitEuler);
  EXPECT_EQ(step.coordinate, 0);
  EXPECT_NEAR(step.largest, 0.04, 1e-12);
}

}  // namespace
}  // namespace manycontact::test
