// A task on copied robots is the task of one of them, as often as there are copies.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "manycontact/spatial/explog.hpp"
#include "manycontact/task/optimize.hpp"
#include "spatial/compare.hpp"
#include "support/folder.hpp"
#include "support/random.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

// Returns herd_trots.xml with `copies` in this arrangement.
TaskFile herd(int copies, const std::string& arrange) {
  std::ostringstream task, scene;
  task << std::ifstream(kTasks + "herd_trots.xml").rdbuf();
  scene << std::ifstream(kTasks + "herd_scene.xml").rdbuf();
  std::string task_text = task.str(), scene_text = scene.str();
  replace(scene_text, "copies=\"64\" arrange=\"grid\"",
          "copies=\"" + std::to_string(copies) + "\" arrange=\"" + arrange + "\"");
  replace(scene_text, "../quadruped.urdf", kTasks + "../quadruped.urdf");
  const test::TemporaryFolder folder;
  (void)folder.write("herd_scene.xml", scene_text);
  return read_task(folder.write("herd_trots.xml", task_text));
}

TEST(Copies, TrotAsOneDoes) {
  TaskFile one = read_task(kTasks + "quadruped_trots.xml");
  TaskProblem alone = make_problem(one, TaskSolver::kFddp);
  const TaskSolution a = optimize(one, alone, {TaskSolver::kFddp, 1, {}});
  TaskFile three = herd(3, "line");
  TaskProblem together = make_problem(three, TaskSolver::kFddp);
  const TaskSolution b = optimize(three, together, {TaskSolver::kFddp, 1, {}});
  EXPECT_TRUE(a.converged && b.converged) << a.reason << ", " << b.reason;
  EXPECT_NEAR(b.cost, 3 * a.cost, 1e-6 * b.cost);
  const Scene& scene = three.scene.scene;
  for (const Robot& robot : scene.robots) {
    double worst = 0;
    for (std::size_t t = 0; t < a.us.size(); ++t)
      if (a.us[t].size() > 0)  // not at impacts
        worst = std::max(worst, (b.us[t].segment(robot.idx_u, 12) - a.us[t]).lpNorm<Eigen::Infinity>());
    EXPECT_LE(worst, 1e-4) << robot.name;
  }
}

// In a ring the copies are rotated, and so are their costs.
TEST(Copies, OfARingCostTheSame) {
  TaskFile one = read_task(kTasks + "quadruped_trots.xml");
  TaskProblem alone = make_problem(one, TaskSolver::kFddp);
  TaskFile five = herd(5, "circle");
  TaskProblem together = make_problem(five, TaskSolver::kFddp);
  const double cost = alone.problem->calc(alone.xs, alone.us);
  EXPECT_NEAR(together.problem->calc(together.xs, together.us), 5 * cost, 1e-9 * cost);
}

// One robot's task is compared with that of five copies in a circle, each in the rotated state and under the torques of
// the one. Every term costs five times as much, and constraints have the same rows, for any axes, weights and bounds.
struct Ring {
  const char* name;
  const char* robot;  // attributes and content of its element
  const char* posture;
  const char* contact;  // type and frame
  int rows;             // of a contact's force
};

class RingOfCopies : public testing::TestWithParam<Ring> {
 protected:
  static TaskFile task(const std::string& copies, const std::string& axes, const std::string& term) {
    const Ring& ring = GetParam();
    const std::string scene = std::string("<scene><robot name='r' urdf='") + kTasks + "../" + ring.robot + " " +
                              copies + ">" + ring.posture + "</robot><contact name='c' " + ring.contact +
                              " gains='30 10' reference_frame='" + axes + "'/></scene>";
    return task_of(ring.name, scene, "<phase nodes='1' contacts='c'>" + term + "</phase><solver guess='zero'/>");
  }
  // The first node's [cost; g; h] where every copy is as one robot is at q, v, u.
  static Eigen::VectorXd evaluated(const TaskFile& task, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                   const Eigen::VectorXd& u) {
    TaskProblem problem = make_problem(task, TaskSolver::kFddp);
    const Scene& scene = task.scene.scene;
    Eigen::VectorXd x(scene.nq + scene.nv), us(scene.nu);
    for (std::size_t r = 0; r < scene.robots.size(); ++r) {
      const Robot& robot = scene.robots[r];
      x.segment(robot.idx_q, q.size()) = q;
      if (robot.model->floating_base)
        x.segment<7>(robot.idx_q) = pose_of_placement(task.scene.moved[r] * placement_of_pose(q.head<7>()));
      x.segment(scene.nq + robot.idx_v, v.size()) = v;
      us.segment(robot.idx_u, u.size()) = u;
    }
    const auto& model = problem.problem->get_runningModels()[0];
    const auto& data = problem.problem->get_runningDatas()[0];
    model->calc(data, x, us);
    Eigen::VectorXd out(1 + data->g.size() + data->h.size());
    out << data->cost, data->g, data->h;
    return out;
  }
};

TEST_P(RingOfCopies, CostsAsMuchAsTheOne) {
  const Ring& ring = GetParam();
  std::mt19937 rng(9);
  const auto numbers = [&](int n, double low, double high) {
    std::ostringstream out;
    for (int i = 0; i < n; ++i) out << uniform(rng, low, high) << " ";
    return out.str();
  };
  const auto barrier = [&](int n) {
    return " activation='quadratic_barrier' lower='" + numbers(n, -3, -1) + "' upper='" + numbers(n, -0.5, 0.5) + "'";
  };
  const auto weights = [&](int n) { return " activation='weighted_quad' weights='" + numbers(n, 0.1, 3) + "'"; };
  const int rows = ring.rows;
  const std::string frame =
      " frame='r/" + std::string(ring.contact).substr(std::string(ring.contact).find("frame='r/") + 9);
  std::vector<std::string> terms;
  const auto add = [&](const std::string& what, int n) {
    terms.push_back("<cost name='t' " + what + "/>");
    terms.push_back("<cost name='t' " + what + weights(n) + "/>");
    terms.push_back("<cost name='t' " + what + barrier(n) + "/>");
    terms.push_back("<cost name='t' " + what + " activation='smooth_1norm' eps='0.1'/>");
    terms.push_back("<constraint name='t' " + what + " lower='" + numbers(n, -3, -1) + "' upper='" + numbers(n, 0, 1) +
                    "'/>");
    terms.push_back("<constraint name='t' " + what + " lower='" + repeated("0", n) + "' upper='" + repeated("0", n) +
                    "'/>");
  };
  add("type='contact_force' contact='c' reference='" + numbers(rows, -5, 5) + "'", rows);
  add("type='frame_translation'" + frame + " xyz='0.1 0.2 0.3'", 3);
  add("type='frame_placement'" + frame + " xyz='0.1 0.2 0.3' quat_xyzw='0 0.6 0 0.8'", 6);
  add("type='frame_rotation'" + frame + " quat_xyzw='0 0.6 0 0.8'", 3);
  for (const char* axes : {"local", "world", "local_world_aligned"})
    add("type='frame_velocity'" + frame + " reference_frame='" + axes + "' twist='" + numbers(6, -1, 1) + "'", 6);
  add("type='com' robot='r' reference='0.1 0.2 0.3'", 3);
  add("type='centroidal_momentum' robot='r' reference='" + numbers(6, -1, 1) + "'", 6);
  add("type='friction_cone' contact='c' mu='0.3'", 5);
  add("type='friction_cone' contact='c' mu='0.3' normal='0.6 0 0.8'", 5);
  terms.push_back("<cost name='t' type='friction_cone' contact='c' mu='0.3'/>");
  if (rows == 6) {
    add("type='wrench_cone' contact='c' mu='0.3' box='0.2 0.1'", 17);
    add("type='cop' contact='c' box='0.2 0.1' normal='0.6 0 0.8'", 4);
    terms.push_back("<cost name='t' type='wrench_cone' contact='c' mu='0.3' box='0.2 0.1'/>");
  }
  for (const std::string axes : {"local", "world", "local_world_aligned"})
    for (const std::string& term : terms) {
      SCOPED_TRACE(axes + ": " + term);
      const TaskFile one = task("", axes, term), five = task("copies='5' arrange='circle' spacing='2'", axes, term);
      const Scene& scene = one.scene.scene;
      Eigen::VectorXd q = one.scene.q, v = random_vector(scene.nv, rng, 0.3), u = random_vector(scene.nu, rng, 5);
      q.tail(scene.robots[0].model->nu()) += random_vector(scene.robots[0].model->nu(), rng, 0.1);
      const Eigen::VectorXd a = evaluated(one, q, v, u), b = evaluated(five, q, v, u);
      const double size = std::max(1.0, size_of(a));
      EXPECT_NEAR(b[0], 5 * a[0], 1e-9 * size);
      ASSERT_EQ(b.size() - 1, 5 * (a.size() - 1));
      for (Eigen::Index i = 0; i < b.size() - 1; ++i)
        EXPECT_NEAR(b[1 + i], a[1 + i % (a.size() - 1)], 1e-9 * size) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Robots, RingOfCopies,
                         testing::Values(Ring{"Arm", "arm.urdf'",
                                              "<joint name='shoulder_pitch' q='0.9'/><joint name='elbow' q='1.2'/>"
                                              "<joint name='wrist_pitch' q='-0.5'/>",
                                              "type='3d' frame='r/tool'", 3},
                                         Ring{
                                             "Humanoid", "humanoid.urdf' base='floating' xyz='0.3 0 0.8'",
                                             "<joint name='left_knee' q='0.8'/><joint name='left_hip_pitch' q='-0.4'/>",
                                             "type='6d' frame='r/left_sole'", 6}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace manycontact::test
