#include <algorithm>
#include <chrono>
#include <iostream>

#include "manycontact/algorithm/frames.hpp"
#include "manycontact/control.hpp"
#include "manycontact/simulation/step.hpp"
#include "manycontact/task/problem.hpp"

using namespace manycontact;
using Clock = std::chrono::steady_clock;

int main(int, char** argv) {
  const TaskFile task = read_task(argv[1]);  // a humanoid reaches with its left hand
  const Scene& scene = task.scene.scene;
  const TaskProblem problem = make_problem(task);
  ShootingProblem& horizon = *problem.problem;
  SolverFDDP solver(problem.problem);
  if (!solver.solve(problem.xs, problem.us)) return 1;
  std::vector<Eigen::VectorXd> xs = solver.get_xs(), us = solver.get_us();

  constexpr int control_steps = 60, simulated = 10;  // simulation steps in each
  SimulationData world(scene, task.scene.q, task.scene.v, Integrator::kRk4, task.step / simulated);
  std::vector<double> ms;
  for (int k = 0; k < control_steps; ++k) {
    for (int i = 0; i < simulated; ++i)
      if (step(scene, us[0], world) != StepStatus::kOk) return 1;

    const auto start = Clock::now();
    const auto last = horizon.get_runningModels().back();
    const bool same = horizon.get_runningModels()[0] == last;
    horizon.circularAppend(last, same ? horizon.get_runningDatas()[0] : last->createData());  // a node later
    std::rotate(xs.begin(), xs.begin() + 1, xs.end());
    std::rotate(us.begin(), us.begin() + 1, us.end());
    xs[0] << world.q, world.v;
    xs.back() = xs[xs.size() - 2];  // the old end, once more
    us.back() = us[us.size() - 2];
    horizon.set_x0(xs[0]);
    solver.solve(xs, us, 1);  // one iteration
    xs = solver.get_xs();
    us = solver.get_us();
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }

  const Robot& robot = scene.robots[0];
  Kinematics<double> kin(*robot.model);
  forward_kinematics<double>(*robot.model, robot.base, world.q, kin);
  const Frame& hand = robot.model->frames[robot.model->find_frame("left_hand")];
  const Eigen::Vector3d goal = task.terminal.costs[0].placement.p;
  const double miss = (frame_placement<double>(kin, robot.base, hand.joint, hand.placement).p - goal).norm();
  std::sort(ms.begin(), ms.end());
  std::cout << "after " << world.time() << " s the hand is " << miss << " m from its goal\n"
            << "a control step of " << 1e3 * task.step << " ms takes " << ms[ms.size() / 2] << " ms, at most "
            << ms.back() << "\n";
}
