#include <set>

#include "manycontact/detail/algorithm/energy.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "optimize.hpp"
#include "program/text/table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostRows = 12;

std::string point(const Vec3<double>& p) { return decimal(p[0], 3) + " " + decimal(p[1], 3) + " " + decimal(p[2], 3); }

Kinematics<double> kinematics_at(const Robot& robot, const Eigen::VectorXd& x) {
  Kinematics<double> kin(*robot.model);
  forward_kinematics<double>(*robot.model, robot.base, x.segment(robot.idx_q, robot.model->nq), kin);
  return kin;
}

Vec3<double> frame_at(const Robot& robot, const Kinematics<double>& kin, const Frame& frame) {
  return frame_placement<double>(kin, robot.base, frame.joint, frame.placement).p;
}

// Returns robot and name of the frames to which costs of any phase refer, in the order of the file.
std::vector<std::pair<int, std::string>> frames_of(const TaskFile& task) {
  std::vector<std::pair<int, std::string>> out;
  std::set<std::pair<int, std::string>> seen;
  const auto add = [&](const TaskPhase& phase) {
    for (const TaskTerm& term : phase.costs)
      if (!term.frame.empty())
        for (const int robot : term.robots)
          if (seen.emplace(robot, term.frame).second) out.emplace_back(robot, term.frame);
  };
  for (const TaskPhase& phase : task.phases) add(phase);
  add(task.terminal);
  return out;
}

}  // namespace

void print_motion(std::ostream& out, const OptimizedTask& motion) {
  const Scene& scene = motion.task.scene.scene;
  const Eigen::VectorXd &first = motion.solution.xs.front(), &last = motion.solution.xs.back();
  if (!first.allFinite() || !last.allFinite()) return;
  Table table("moved<40|from [m]|to [m]|by [m]");
  std::size_t rows = 0, left_out = 0;
  const auto add = [&](const std::string& name, const Vec3<double>& from, const Vec3<double>& to) {
    if (rows++ < kMostRows)
      table.add({printable(name), point(from), point(to), decimal((to - from).norm(), 3)});
    else
      ++left_out;
  };
  for (const Robot& robot : scene.robots) {
    if (robot.model->mass() <= 0 || !(rows < kMostRows)) {
      left_out += robot.model->mass() > 0;
      continue;
    }
    add(robot.name + ", centre of mass", center_of_mass<double>(kinematics_at(robot, first)),
        center_of_mass<double>(kinematics_at(robot, last)));
  }
  rows = std::min(rows, kMostRows / 2);  // leaves space for frames
  for (const auto& [r, name] : frames_of(motion.task)) {
    const Robot& robot = scene.robots[r];
    const Frame& frame = robot.model->frames[robot.model->find_frame(name)];
    add(robot.name + "/" + name, frame_at(robot, kinematics_at(robot, first), frame),
        frame_at(robot, kinematics_at(robot, last), frame));
  }
  table.print(out);
  if (left_out > 0) out << "  and " << count(left_out, "other") << "\n";
}

}  // namespace manycontact::cli
