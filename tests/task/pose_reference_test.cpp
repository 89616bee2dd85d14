// References of states are found from poses.

#include <gtest/gtest.h>

#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/analysis/load_scene.hpp"
#include "manycontact/task/optimize.hpp"
#include "task/task_of.hpp"

namespace manycontact::test {
namespace {

std::string humanoid() { return "<scene><include file='" + kTasks + "humanoid_scene.xml'/></scene>"; }

TaskFile posed(const std::string& phases) {
  TaskFile task = task_of("t", humanoid(), phases);
  fit_state(task);
  return task;
}

std::string state(const std::string& poses, const std::string& more = "") {
  return "<cost name='posture' type='state' reference='pose' " + more + ">" + poses + "</cost>";
}

// Returns the placement of a link at a reference.
SE3<double> at(const TaskFile& task, const TaskTerm& term, const std::string& frame) {
  const Scene& scene = task.scene.scene;
  RigidBodyData data(scene);
  forward_kinematics(scene, term.reference.head(scene.nq), data);
  return frame_placement(scene, data, find_frame(scene, frame));
}

TEST(PoseReference, IsMetWithTheContactsInPlace) {
  const TaskFile task = posed("<phase nodes='30' contacts='left right'>" +
                              state("<pose frame='humanoid/pelvis' z='0.7'/>", "weight='100'") +
                              "<cost name='u' type='control' weight='1e-4'/></phase><terminal>" +
                              state("<pose frame='humanoid/pelvis' z='0.7'/>", "weight='1e4'") + "</terminal>");
  const Scene& scene = task.scene.scene;
  for (const TaskTerm* term : {&task.phases[0].costs[0], &task.terminal.costs[0]}) {
    ASSERT_EQ(term->reference.size(), scene.nq + scene.nv);
    EXPECT_NEAR(at(task, *term, "humanoid/pelvis").p[2], 0.7, 1e-9);
    EXPECT_TRUE(placement_errors(scene, term->reference.head(scene.nq), {1, 1}).empty());
    EXPECT_TRUE(term->reference.tail(scene.nv).isZero(0));
  }
  TaskProblem problem = make_problem(task);
  const TaskSolution solution = optimize(task, problem, {{}, 1, {}});
  RigidBodyData data(scene);
  forward_kinematics(scene, solution.xs.back().head(scene.nq), data);
  EXPECT_NEAR(frame_placement(scene, data, find_frame(scene, "humanoid/pelvis")).p[2], 0.7, 0.01);
}

// A foot that is lifted and set down again has no reference in the scene, unless the phase defines it.
TEST(PoseReference, LeavesContactsThatWereOpen) {
  const std::string lifted = state("<pose frame='humanoid/right_sole' z='0.1' y='-0.15'/>"), shut = "left right";
  const auto phase = [](const std::string& contacts, const std::string& inside, const std::string& more = "") {
    return "<phase nodes='2' contacts='" + contacts + "' " + more + ">" + inside + "</phase>";
  };
  const TaskFile task = posed(phase(shut, "") + phase("left", lifted) + phase(shut, lifted));
  for (const int k : {1, 2}) EXPECT_NEAR(at(task, task.phases[k].costs[0], "humanoid/right_sole").p[2], 0.1, 1e-9);
  for (const std::string& bad :
       {phase(shut, lifted), phase(shut, "") + phase("left", "") + phase(shut, lifted, "at='scene'")}) {
    try {
      (void)posed(bad);
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("expected poses that can be met together"), std::string::npos)
          << error.what();
    }
  }
}

TEST(PoseReference, ThatIsNoneIsRefused) {
  const auto refused = [](const std::string& cost, const std::string& why) {
    try {
      (void)task_of("t", humanoid(), "<phase nodes='1' contacts='left'>" + cost + "</phase>");
      ADD_FAILURE() << why;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  const std::string pose = "<pose frame='humanoid/pelvis' z='0.7'/>";
  refused("<cost name='a' type='state' reference='pose'/>", "expected <pose> elements in <cost>");
  refused("<cost name='a' type='state'>" + pose + "</cost>", "without reference=\"pose\"");
  refused("<cost name='a' type='control' reference='pose'>" + pose + "</cost>", "without reference=\"pose\"");
  refused(state("<pose frame='humanoid/pelvsi' z='1'/>"), "pelvsi");
  const TaskFile read = task_of("t", humanoid(), "<phase nodes='1' contacts='left'>" + state(pose) + "</phase>");
  EXPECT_THROW((void)make_problem(read), std::logic_error);  // still to be found
}

}  // namespace
}  // namespace manycontact::test
