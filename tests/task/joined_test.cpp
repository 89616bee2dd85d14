// Robots that hold each other, taken apart at their contacts: nodes, directions and motions against those of the whole
// scene.

#include "manycontact/task/joined.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "manycontact/control/joined_solver.hpp"
#include "manycontact/task/forces.hpp"
#include "manycontact/task/optimize.hpp"
#include "spatial/compare.hpp"
#include "support/random.hpp"

namespace manycontact::test {
namespace {

const std::string kModels = MANYCONTACT_SOURCE_DIR "/models/";

TaskFile task_of(const std::string& name, const std::string& scene, const std::string& task,
                 const std::string& integrator = "euler") {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / ("manycontact_bonds_" + name);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "scene.xml") << scene;
  std::ofstream(folder / "task.xml") << "<task name='" << name << "' scene='scene.xml' step='0.01' integrator='"
                                     << integrator << "'>" << task << "</task>";
  return read_task((folder / "task.xml").string());
}

std::string repeated(const std::string& number, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += number + " ";
  return out;
}

// Quadrupeds in a line, each with a front foot on the trunk of the next: bonds in one frame or the other.
std::string chain_scene(int robots, const std::string& frame = "local", const std::string& damping = "0",
                        const std::string& type = "6d") {
  std::string out = "<scene name='chain' damping='" + damping + "'><robot name='q' urdf='" + kModels +
                    "quadruped.urdf' base='floating' xyz='0 0 0.3824' copies='" + std::to_string(robots) +
                    "' arrange='line' spacing='1'>";
  for (const char* leg : {"LF", "RF", "LH", "RH"})
    out += std::string("<joint name='") + leg + "_hip' q='0.7'/><joint name='" + leg + "_knee' q='-1.4'/>";
  out += "</robot>";
  for (const char* leg : {"RF", "LH", "RH"})
    out += std::string("<contact name='") + leg + "' type='3d' frame='q/" + leg + "_foot' gains='0 20'/>";
  return out + "<contact name='hold' type='" + type +
         "' frame='q/LF_foot' to='q+1/trunk' gains='40 15' reference_frame='" + frame + "'/></scene>";
}

const std::string kCosts =
    "<cost name='state' type='state' weight='1' robot='q' weights='" + repeated("0.1", 6) + repeated("0.5", 12) +
    repeated("0.2", 18) +
    "'/><cost name='control' type='control' weight='1e-3'/>"
    "<cost name='com' type='com' robot='q' weight='10' reference='0.02 0.01 0.36'/>"
    "<cost name='acceleration' type='joint_acceleration' robot='q' weight='1e-4'/>"
    "<cost name='cone' type='friction_cone' contact='RF' mu='0.6' weight='1'/>"
    "<cost name='turn' type='frame_rotation' frame='q/trunk' weight='5' quat_xyzw='0 0 0.05 0.99875'/>";
const std::string kTerminal = "<terminal><cost name='state' type='state' weight='10'/></terminal>";

// Joined in the middle alone.
TaskFile chain(int robots, const std::string& frame = "local", const std::string& damping = "0", int nodes = 4) {
  const std::string n = std::to_string(nodes);
  return task_of("chain" + std::to_string(robots) + frame + damping, chain_scene(robots, frame, damping),
                 "<phase nodes='3' contacts='RF LH RH'>" + kCosts + "</phase><phase nodes='" + n +
                     "' contacts='RF LH RH hold'>" + kCosts + "</phase>" + kTerminal);
}

TaskFile always(int robots, int nodes) {
  return task_of(
      "always" + std::to_string(robots), chain_scene(robots, "local_world_aligned"),
      "<phase nodes='" + std::to_string(nodes) + "' contacts='RF LH RH hold'>" + kCosts + "</phase>" + kTerminal);
}

struct Candidate {
  std::vector<Eigen::VectorXd> xs, us;
};
Candidate random_candidate(const TaskProblem& problem, unsigned seed) {
  std::mt19937 rng(seed);
  Candidate out{problem.xs, problem.us};
  for (Eigen::VectorXd& x : out.xs)
    x = problem.state->integrate_x(x, random_vector(static_cast<int>(problem.state->get_ndx()), rng, 0.2));
  for (Eigen::VectorXd& u : out.us) u += random_vector(static_cast<int>(u.size()), rng, 5);
  return out;
}

// ---- nodes ------------------------------------------------------------------------------------------------------

void expect_nodes_of_the_whole(const TaskFile& task, std::size_t blocks) {
  const TaskProblem whole = make_problem(task), joined = make_problem(task, TaskSolver::kSparse);
  ASSERT_EQ(joined.parts.size(), 1u);
  ASSERT_EQ(joined.blocks.size(), blocks);
  const Candidate at = random_candidate(whole, 1);
  for (const std::size_t t : {std::size_t(0), whole.us.size() - 1, whole.us.size()}) {
    SCOPED_TRACE("node " + std::to_string(t));
    const auto& parts = dynamic_cast<const ActionModelParts&>(*joined.problem->model(t)).get_parts();
    const auto model = std::dynamic_pointer_cast<ActionModelJoined>(parts.at(0).model);
    ASSERT_TRUE(model);
    model->set_storage(MatrixStorage::kDense);
    const auto data = model->createData(), expected = whole.problem->data(t);
    EXPECT_TRUE(model->checkData(data));
    ActionModelAbstract& reference = *whole.problem->model(t);
    if (t < whole.us.size()) {
      reference.calc(expected, at.xs[t], at.us[t]);
      reference.calcDiff(expected, at.xs[t], at.us[t]);
      model->calc(data, at.xs[t], at.us[t]);
      model->calcDiff(data, at.xs[t], at.us[t]);
    } else {
      reference.calc(expected, at.xs[t]);
      reference.calcDiff(expected, at.xs[t]);
      model->calc(data, at.xs[t]);
      model->calcDiff(data, at.xs[t]);
    }
    EXPECT_NEAR(data->cost, expected->cost, 1e-11 * expected->cost);
    EXPECT_LT(difference_of(data->xnext, expected->xnext), 1e-11);
    EXPECT_LT(error_of(data->Fx, expected->Fx), 1e-10);
    EXPECT_LT(error_of(data->Lx, expected->Lx), 1e-10);
    EXPECT_LT(error_of(data->Lxx, expected->Lxx), 1e-10);
    if (t == whole.us.size()) continue;
    EXPECT_LT(error_of(data->Fu, expected->Fu), 1e-10);
    EXPECT_LT(error_of(data->Lu, expected->Lu), 1e-10);
    EXPECT_LT(error_of(data->Lxu, expected->Lxu), 1e-10);
    EXPECT_LT(error_of(data->Luu, expected->Luu), 1e-10);
  }
}

TEST(JoinedNodes, AreThoseOfTheWholeScene) { expect_nodes_of_the_whole(chain(3), 3); }
TEST(JoinedNodes, WithFramesInTheWorld) { expect_nodes_of_the_whole(chain(2, "local_world_aligned"), 2); }
TEST(JoinedNodes, WithDamping) { expect_nodes_of_the_whole(chain(2, "local", "1e-3"), 2); }
TEST(JoinedNodes, WithDampingAndFramesInTheWorld) { expect_nodes_of_the_whole(chain(2, "world", "1e-3"), 2); }

// ---- directions -------------------------------------------------------------------------------------------------

// The step (dx, du) of SolverFDDP's gains on the linear model.
struct Step {
  std::vector<Eigen::VectorXd> x, u;
};
Step step_of(const SolverFDDP& solver) {
  const ShootingProblem& problem = *solver.get_problem();
  Step out;
  out.x.push_back(solver.get_fs()[0]);
  for (std::size_t t = 0; t < problem.get_T(); ++t) {
    const ActionDataAbstract& data = *problem.data(t);
    out.u.push_back(-solver.get_k()[t] - solver.get_K()[t] * out.x[t]);
    out.x.push_back(data.Fx * out.x[t] + data.Fu * out.u[t] + solver.get_fs()[t + 1]);
  }
  return out;
}

void expect_dense_direction(const TaskFile& task, const std::string& way) {
  const TaskProblem whole = make_problem(task), joined = make_problem(task, TaskSolver::kSparse);
  SolverFDDP dense(whole.problem);
  SolverSparse sparse(joined.problem);
  const Candidate at = random_candidate(whole, 2);
  for (SolverAbstract* solver : {static_cast<SolverAbstract*>(&dense), static_cast<SolverAbstract*>(&sparse)}) {
    solver->setCandidate(at.xs, at.us, false);
    solver->set_preg(1e-9);
    solver->set_dreg(1e-9);
    solver->computeDirection(true);
  }
  ASSERT_TRUE(dense.direction_is_sound());
  ASSERT_TRUE(sparse.direction_is_sound());
  EXPECT_EQ(sparse.direction(), way);
  const Step expected = step_of(dense);
  const auto& part = dynamic_cast<const SolverJoinedPart&>(*sparse.parts().at(0));
  const lq::Point& z = part.solution_of_direction();
  const auto& parts = dynamic_cast<const ActionModelJoined&>(*part.part().problem->get_terminalModel()).get_parts();
  for (std::size_t t = 0; t < z.x.size(); ++t) {
    Eigen::VectorXd dx(z.x[t].size());
    Eigen::Index first = 0;
    for (const JoinedPart& own : parts)
      for (const int i : own.dx) dx[i] = z.x[t][first++];
    EXPECT_LT(error_of(dx, expected.x[t]), 1e-9) << t;
    if (t < expected.u.size()) EXPECT_LT(error_of(Eigen::VectorXd(-sparse.get_k()[t]), expected.u[t]), 1e-9) << t;
  }
}

TEST(JoinedDirections, OfChains) {
  expect_dense_direction(chain(3), "Schur complement of bonds");
  expect_dense_direction(always(2, 5), "Schur complement of bonds");
}

}  // namespace
}  // namespace manycontact::test
