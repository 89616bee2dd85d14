// The nodes of tasks are simulate's steps: with every solver, in parts and whole, `step` reproduces the plan.

#include <gtest/gtest.h>

#include "manycontact/detail/simulation/invariants.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/optimize.hpp"
#include "manycontact/task/plan.hpp"
#include "support/folder.hpp"

namespace manycontact::test {
namespace {

// A free body has an arm that a motor rotates.
const char* const kDiver =
    "<robot name='diver'><link name='body'><inertial><origin xyz='0 0.05 0.1'/><mass value='2'/>"
    "<inertia ixx='0.05' iyy='0.08' izz='0.02' ixy='0' ixz='0.01' iyz='0'/></inertial></link>"
    "<link name='arm'><inertial><origin xyz='0.3 0 0'/><mass value='0.7'/>"
    "<inertia ixx='0.01' iyy='0.03' izz='0.03' ixy='0' ixz='0' iyz='0'/></inertial></link>"
    "<joint name='shoulder' type='revolute'><parent link='body'/><child link='arm'/><origin xyz='0 0.1 0.2'/>"
    "<axis xyz='0 1 0'/><limit effort='4' velocity='100' lower='-9' upper='9'/></joint></robot>";

TaskFile diving(const std::string& solver, int robots, bool held) {
  const TemporaryFolder folder;
  (void)folder.write("diver.urdf", kDiver);
  std::string scene = "<scene name='s'>", contacts;
  for (int r = 0; r < robots; ++r) {
    const std::string name = "d" + std::to_string(r);
    scene += "<robot name='" + name + "' urdf='diver.urdf' base='floating' xyz='0 " + std::to_string(2 * r) +
             " 2'><v>0.3 0 1 0.5 6 -2 1</v></robot>";
    if (!held || r > 0) continue;
    scene += "<contact name='hand' type='3d' frame='" + name + "/arm' offset='0.6 0 0' gains='100 60'/>";
    contacts = " contacts='hand'";
  }
  if (held && robots > 1)
    scene += "<contact name='tie' type='3d' frame='d0/body' to='d1/body' to_offset='0 -2 0' gains='0 50'/>";
  if (held && robots > 1) contacts = " contacts='hand tie'";
  (void)folder.write("scene.xml", scene + "</scene>");
  return read_task(folder.write(
      "task.xml",
      "<task scene='scene.xml' step='0.01' integrator='symplectic'><phase nodes='20'" + contacts +
          "><cost name='u' type='control' weight='1e-2'/><cost name='x' type='state' weight='1e-2'/></phase>"
          "<terminal><cost name='com' type='com' robot='d0' reference='0.1 0 2' weight='10'/></terminal>"
          "<solver type='" +
          solver + "' iterations='200' guess='zero'/></task>"));
}

class SymplecticTasks : public testing::TestWithParam<const char*> {};

TEST_P(SymplecticTasks, ArePlansOfSteps) {
  for (const bool held : {false, true})
    for (const int robots : {1, 2}) {
      SCOPED_TRACE(std::string(held ? "held" : "free") + ", robots: " + std::to_string(robots));
      const TaskFile task = diving(GetParam(), robots, held);
      const Scene& scene = task.scene.scene;
      TaskProblem problem = make_problem(task);
      const TaskSolution s = optimize(task, problem, {{}, 1, {}});
      EXPECT_TRUE(s.converged) << s.reason;
      for (std::size_t t = 0; t < s.us.size(); ++t) {
        SimulationData sim(scene, s.xs[t].head(scene.nq), s.xs[t].tail(scene.nv), Integrator::kSemiImplicitEuler,
                           task.step);
        ASSERT_EQ(step(scene, s.us[t], sim), StepStatus::kOk);
        EXPECT_LE((sim.q - s.xs[t + 1].head(scene.nq)).lpNorm<Eigen::Infinity>(), 1e-11) << t;
        EXPECT_LE((sim.v - s.xs[t + 1].tail(scene.nv)).lpNorm<Eigen::Infinity>(), 1e-10) << t;
      }
      const auto forces = contact_forces(task, problem, 3);
      EXPECT_EQ(forces.size(), scene.contacts.size());
      double sum = 0;
      for (const PlanCost& cost : cost_by_term(task, problem)) sum += cost.cost;
      EXPECT_NEAR(sum, s.cost, 1e-9 * s.cost);
    }
}

INSTANTIATE_TEST_SUITE_P(By, SymplecticTasks, testing::Values("fddp", "box-fddp", "sparse", "auto"));

// A plan in flight conserves its momentum across gravity; one with euler does not.
TEST(SymplecticFlights, KeepMomentum) {
  TaskFile task = diving("fddp", 1, false);
  const Scene& scene = task.scene.scene;
  const auto lost = [&] {
    TaskProblem problem = make_problem(task);
    const TaskSolution s = optimize(task, problem, {{}, 1, {}});
    EXPECT_TRUE(s.converged) << s.reason;
    InvariantsData room(scene);
    const auto momentum_of = [&](const Eigen::VectorXd& x) {
      return invariants(scene, {}, x.head(scene.nq), x.tail(scene.nv), room).momentum;
    };
    const Vec6<double> change = momentum_of(s.xs.back()) - momentum_of(s.xs.front());
    return change.head<2>().norm();  // gravity pulls along z
  };
  EXPECT_LE(lost(), 1e-11);
  task.integrator = TaskIntegrator::kEuler;
  EXPECT_GT(lost(), 1e-3);
}

}  // namespace
}  // namespace manycontact::test
