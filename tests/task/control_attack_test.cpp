// Control is attacked with random tasks of known solutions: robots attached to each other against nodes of the whole
// scene, motions that meet their constraints by construction, infeasible constraints, weights of any size. Some seconds
// of it are among the tests. MANYCONTACT_CONTROL_ATTACK=1000 runs the tasks 0 to 999 of each kind and prints how they
// ended. MANYCONTACT_CONTROL_SEED=7 selects others; MANYCONTACT_CONTROL_FIRST=999 begins with that one.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <numeric>

#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/detail/contact/reference.hpp"
#include "manycontact/task/optimize.hpp"
#include "support/random.hpp"

namespace manycontact::test::control_attack {
namespace {

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}
int tasks(int few) { return from_environment("MANYCONTACT_CONTROL_ATTACK", few); }
unsigned seed_of(int kind, int k) {
  return static_cast<unsigned>(100000 * kind + k + 1000000 * from_environment("MANYCONTACT_CONTROL_SEED", 0));
}
int first() { return from_environment("MANYCONTACT_CONTROL_FIRST", 0); }
bool is_long() { return std::getenv("MANYCONTACT_CONTROL_ATTACK") != nullptr; }

int pick(std::mt19937& rng, int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); }
double power(std::mt19937& rng, double low, double high) { return std::pow(10, uniform(rng, low, high)); }

// Counts how the tasks of a kind ended, and prints it if all of them were requested.
class Ends {
 public:
  explicit Ends(const char* kind) : kind_(kind) {}
  void add(const TaskSolution& s) { ++counts_[s.reason.substr(0, s.reason.find_first_of(";:"))]; }
  int of(const std::string& reason) const {
    const auto at = counts_.find(reason);
    return at == counts_.end() ? 0 : at->second;
  }
  ~Ends() {
    if (!is_long()) return;
    std::cout << kind_ << ":";
    for (const auto& [reason, count] : counts_) std::cout << " " << count << " \"" << reason << "\"";
    std::cout << std::endl;
  }

 private:
  const char* kind_;
  std::map<std::string, int> counts_;
};

TaskTerm term(const std::string& name, TaskResidual residual, double weight) {
  TaskTerm out;
  out.name = name;
  out.residual = residual;
  out.weight = weight;
  return out;
}

// Returns a task of these robots: so many nodes, all contacts, costs on controls and states.
TaskFile task_on(const RandomScene& s, int phases, std::mt19937& rng) {
  TaskFile task;
  task.scene.scene = s.scene;
  task.scene.q = s.q;
  task.scene.v = s.v;
  task.scene.u = Eigen::VectorXd::Zero(s.scene.nu);
  task.step = power(rng, -2.3, -1.5);
  task.iterations = 300;
  task.tolerance = 1e-12;
  task.guess = chance(rng, 0.5) ? TaskGuess::kQuasiStatic : TaskGuess::kZero;
  for (int k = 0; k <= phases; ++k) {
    TaskPhase phase;
    phase.active.assign(s.scene.contacts.size(), true);
    if (k < phases) {
      phase.nodes = pick(rng, 1, 3);
      phase.costs.push_back(term("control", TaskResidual::kControl, power(rng, -3, -1)));
    }
    phase.costs.push_back(term("state", TaskResidual::kState, power(rng, -2, 1)));
    (k < phases ? task.phases.emplace_back() : task.terminal) = std::move(phase);
  }
  return task;
}

// ---- robots attached to each other

struct Joined {
  std::string what;
  TaskFile task;
};

Joined joined(int k) {
  std::mt19937 rng(seed_of(1, k));
  SceneOptions options;
  options.nrobots = pick(rng, 2, 4);
  options.ncontacts = 0;
  for (int r = 0; r < options.nrobots; ++r)
    options.models.push_back({.njoints = pick(rng, 3, 5), .floating_base = chance(rng, 0.5), .armature = 0.1});
  options.damping = std::vector<double>{0, 0, 1e-7, 1e-3}[static_cast<std::size_t>(pick(rng, 0, 3))];
  RandomScene s = random_scene(rng, options);
  s.v *= 0.2;
  Joined out;
  const auto add = [&](Contact c) {
    c.name = "bond" + std::to_string(s.scene.contacts.size());
    if (c.type == ContactType::k5D) c.reference_frame = ReferenceFrame::kLocal;
    c.axis = random_vector(3, rng).normalized();
    resolve_reference(s.scene, s.q, true, true, c);
    if (chance(rng, 0.5)) c.alpha = uniform(rng, 1, 50), c.beta = uniform(rng, 1, 15);
    out.what += to_string(c.type) + " ";
    add_contact(s.scene, c);
  };
  const auto on = [&](int robot) {
    return Attachment{robot, pick(rng, 0, s.scene.robots[static_cast<std::size_t>(robot)].model->njoints() - 1),
                      random_placement(rng, 0.2)};
  };
  constexpr ContactType types[] = {ContactType::k1D, ContactType::k2D, ContactType::k3D, ContactType::k5D,
                                   ContactType::k6D};
  for (int r = 1; r < options.nrobots; ++r) {
    Contact c;
    c.type = types[(k + r) % 5];
    c.reference_frame = static_cast<ReferenceFrame>(pick(rng, 0, 2));
    c.A = on(r);
    c.B = on(chance(rng, 0.7) ? r - 1 : pick(rng, 0, r - 1));
    add(c);
    if (chance(rng, 0.1)) add(c);  // once more: they are redundant
  }
  if (chance(rng, 0.3)) {
    Contact c;
    c.type = ContactType::k3D;
    c.A = on(0);
    add(c);
  }
  out.task = task_on(s, pick(rng, 1, 2), rng);
  out.what += "damping " + std::to_string(options.damping);
  return out;
}

TEST(ControlAttack, RobotsThatHoldEachOtherEndAtTheOptimumOfTheWhole) {
  Ends ends("joined");
  int by_blocks = 0, compared = 0, told = 0, unsolved = 0;
  const int count = tasks(200);
  for (int k = first(); k < count; ++k) {
    Joined drawn = joined(k);
    drawn.task.tolerance = 1e-15;  // some end by their iterations then, at the cost's rounding
    SCOPED_TRACE(std::to_string(k) + ": " + drawn.what);
    const TaskSolver solver = k % 2 == 0 ? TaskSolver::kSparse : TaskSolver::kAuto;
    TaskProblem whole = make_problem(drawn.task, TaskSolver::kFddp), own = make_problem(drawn.task, solver);
    by_blocks += own.blocks.size() > 1 ? 1 : 0;
    const TaskSolution dense = optimize(drawn.task, whole, {TaskSolver::kFddp, 1, {}});
    const TaskSolution ours = optimize(drawn.task, own, {solver, 1, {}});
    ends.add(ours);
    told += ours.remarks.empty() ? 0 : 1;
    if (ours.converged != dense.converged) {
      ++unsolved;
      if (is_long())
        std::cout << k << ": " << drawn.what << ": ours " << ours.reason << ", dense " << dense.reason << "\n";
    }
    if (ours.kkt_residual > 1e-6 || dense.kkt_residual > 1e-6) continue;
    ++compared;
    EXPECT_NEAR(ours.cost, dense.cost, 1e-9 * dense.cost);
  }
  EXPECT_GE(by_blocks, count / 3);
  EXPECT_GE(compared, count - count / 100);
  if (is_long())
    std::cout << by_blocks << " by blocks, " << compared << " compared, " << told << " with remarks, " << unsolved
              << " where one did not converge" << std::endl;
}

// ---- constraints

// Contains an arm on a fixed base, and the place of its last link.
struct Arm {
  RandomScene s;
  int joint = 0;
  double reach = 0;  // m: no further from the first joint

  explicit Arm(std::mt19937& rng) {
    SceneOptions options;
    options.nrobots = 1;
    options.ncontacts = 0;
    options.models = {{.njoints = pick(rng, 2, 5), .types = {JointType::kRevolute}, .branching = 0, .armature = 0.1}};
    s = random_scene(rng, options);
    s.v *= chance(rng, 0.5) ? 0 : 0.3;
    const Model& model = *s.scene.robots[0].model;
    joint = model.njoints() - 1;
    for (int j = 1; j < model.njoints(); ++j) reach += model.joints[static_cast<std::size_t>(j)].placement.p.norm();
    for (const Frame& frame : model.frames)
      if (frame.name == name()) reach += frame.placement.p.norm();
  }
  std::string name() const { return "link" + std::to_string(joint); }
  Vec3<double> shoulder() const { return (s.scene.robots[0].base * s.scene.robots[0].model->joints[0].placement).p; }
  Vec3<double> tip(const Eigen::VectorXd& x) const {
    const Robot& robot = s.scene.robots[0];
    Kinematics<double> kin(*robot.model);
    forward_kinematics<double>(*robot.model, robot.base, x.head(robot.model->nq), kin);
    const Frame& frame = robot.model->frames[static_cast<std::size_t>(robot.model->find_frame(name()))];
    return frame_placement<double>(kin, robot.base, frame.joint, frame.placement).p;
  }
  // imposes lower <= tip - at <= upper
  TaskTerm tip_within(const std::string& name, const Vec3<double>& at, const Vec3<double>& lower,
                      const Vec3<double>& upper) const {
    TaskTerm out = term(name, TaskResidual::kFrameTranslation, 1);
    out.robots = {0};
    out.frame = this->name();
    out.placement.p = at;
    out.nr = 3;
    out.lower = lower;
    out.upper = upper;
    return out;
  }
};

const Vec3<double> kNothing = Vec3<double>::Zero(), kAnything = Vec3<double>::Constant(INFINITY);

// The tip's goal is the end of a random motion, with torques and heights of this motion.
TaskFile feasible(int k) {
  std::mt19937 rng(seed_of(2, k));
  const Arm arm(rng);
  TaskFile task = task_on(arm.s, 2, rng);
  task.step = power(rng, -2, -1.3);
  for (TaskPhase& phase : task.phases) phase.nodes = pick(rng, 2, 8);
  TaskProblem problem = make_problem(task, TaskSolver::kFddp);
  const double size = power(rng, -1, 0.7);
  std::vector<Eigen::VectorXd> us = problem.us;
  double most = 0, lowest = INFINITY;
  for (Eigen::VectorXd& u : us) {
    u += random_vector(static_cast<int>(u.size()), rng, size);
    most = std::max(most, u.lpNorm<Eigen::Infinity>());
  }
  const std::vector<Eigen::VectorXd> xs = problem.problem->rollout_us(us);
  for (const Eigen::VectorXd& x : xs) lowest = std::min(lowest, arm.tip(x)[2]);
  const Vec3<double> end = arm.tip(xs.back());
  const Vec3<double> slack = chance(rng, 0.5) ? kNothing : Vec3<double>::Constant(power(rng, -4, -1));
  task.terminal.constraints.push_back(arm.tip_within("end", end, -slack, slack));
  if (chance(rng, 0.3))
    for (TaskPhase& phase : task.phases) {
      phase.constraints.push_back(term("torque", TaskResidual::kControl, 1));
      phase.constraints.back().lower.setConstant(arm.s.scene.nu, -most);
      phase.constraints.back().upper.setConstant(arm.s.scene.nu, most);
      phase.constraints.back().nr = arm.s.scene.nu;
    }
  if (chance(rng, 0.3))
    for (TaskPhase& phase : task.phases)
      phase.constraints.push_back(arm.tip_within("above", {0, 0, lowest}, {-INFINITY, -INFINITY, 0}, kAnything));
  return task;
}

TEST(ControlAttack, WhatCanBeMetIsNeverCalledInfeasible) {
  Ends ends("feasible");
  const int count = tasks(250);
  int converged = 0;
  for (int k = first(); k < count; ++k) {
    SCOPED_TRACE(k);
    const TaskFile task = feasible(k);
    TaskProblem problem = make_problem(task, TaskSolver::kFddp);
    const TaskSolution s = optimize(task, problem, {TaskSolver::kFddp, 1, {}});
    ends.add(s);
    EXPECT_FALSE(s.infeasible()) << s.reason;
    if (s.converged) {
      EXPECT_LE(s.constraint_violation, 1e-9);
    } else if (is_long()) {
      std::cout << k << ": " << s.reason << ", " << s.iterations.size() << " iterations, KKT residual "
                << s.kkt_residual << "\n";
    }
    converged += s.converged ? 1 : 0;
  }
  EXPECT_GE(converged, 4 * count / 5);  // the others end by their iterations, and report it
}

// The least violation lies in a curved valley where searches come to no end; they do from other motions.
TEST(ControlAttack, AValleyWithoutStepsIsLeftByOtherMotions) {
  const TaskFile task = feasible(1916);
  TaskProblem problem = make_problem(task, TaskSolver::kFddp);
  const TaskSolution s = optimize(task, problem, {TaskSolver::kFddp, 1, {}});
  EXPECT_TRUE(s.converged) << s.reason;
  EXPECT_LE(s.constraint_violation, 1e-9);
}

// The tip's goal is out of reach, or at two places at once.
TEST(ControlAttack, WhatCannotBeMetIsNeverCalledConverged) {
  Ends ends("impossible");
  const int count = tasks(150);
  int proved = 0;
  for (int k = first(); k < count; ++k) {
    SCOPED_TRACE(k);
    std::mt19937 rng(seed_of(3, k));
    const Arm arm(rng);
    TaskFile task = task_on(arm.s, 2, rng);
    task.step = power(rng, -2, -1.3);
    for (TaskPhase& phase : task.phases) phase.nodes = pick(rng, 2, 8);
    Eigen::VectorXd x0(arm.s.q.size() + arm.s.v.size());
    x0 << arm.s.q, arm.s.v;
    double missed = 0;  // at least
    if (k % 2 == 0) {
      const double by = power(rng, -1, 0.7);
      const Vec3<double> far = arm.shoulder() + (arm.reach + by) * random_vector(3, rng).normalized();
      task.terminal.constraints.push_back(arm.tip_within("far", far, kNothing, kNothing));
      missed = by / std::sqrt(3.0);
    } else {
      const double apart = power(rng, -3, 0);
      const Vec3<double> here = arm.tip(x0);
      task.terminal.constraints.push_back(arm.tip_within("left", here, -kAnything, {0, INFINITY, INFINITY}));
      task.terminal.constraints.push_back(arm.tip_within("right", here, {apart, -INFINITY, -INFINITY}, kAnything));
      missed = apart / 2;
    }
    TaskProblem problem = make_problem(task, TaskSolver::kFddp);
    const TaskSolution s = optimize(task, problem, {TaskSolver::kFddp, 1, {}});
    ends.add(s);
    EXPECT_FALSE(s.converged);
    EXPECT_GE(s.constraint_violation, missed * (1 - 1e-6)) << s.reason;
    EXPECT_NE(s.reason.find("by "), std::string::npos) << s.reason;
    proved += s.infeasible() ? 1 : 0;
    if (!s.infeasible() && is_long()) std::cout << k << ": " << s.reason << ", missed at least " << missed << "\n";
  }
  EXPECT_GE(proved, 9 * count / 10);
}

// ---- weights

void scale_costs(TaskFile& task, double scale) {
  for (TaskPhase& phase : task.phases)
    for (TaskTerm& cost : phase.costs) cost.weight *= scale;
  for (TaskTerm& cost : task.terminal.costs) cost.weight *= scale;
}

// The largest difference of states, relative to their size.
double apart(const TaskSolution& s, const std::vector<Eigen::VectorXd>& right) {
  double out = 0;
  for (std::size_t t = 0; t < right.size(); ++t)
    out = std::max(out,
                   (s.xs[t] - right[t]).lpNorm<Eigen::Infinity>() / std::max(1.0, right[t].lpNorm<Eigen::Infinity>()));
  return out;
}

TEST(ControlAttack, WeightsOfAnySizeGiveTheSameMotion) {
  Ends ends("weights");
  const int count = tasks(60);
  int solves = 0, missed = 0;
  for (int k = first(); k < count; ++k) {
    std::mt19937 rng(seed_of(4, k));
    const Arm arm(rng);
    TaskFile task = task_on(arm.s, 2, rng);
    std::vector<Eigen::VectorXd> right;
    for (const double scale : {1.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-3, 1e3, 1e6, 1e8, 1e10, 1e12}) {
      TaskFile scaled = task;
      scale_costs(scaled, scale);
      TaskProblem problem = make_problem(scaled, TaskSolver::kFddp);
      const TaskSolution s = optimize(scaled, problem, {TaskSolver::kFddp, 1, {}});
      ends.add(s);
      ++solves;
      if (right.empty()) right = s.xs;
      const double off = apart(s, right);
      EXPECT_LE(off, 1e-5) << k << ", weights times " << scale;
      missed += s.converged && off <= 1e-6 ? 0 : 1;
    }
  }
  EXPECT_LE(missed, solves / 1000);
  if (is_long()) std::cout << missed << " of " << solves << " did not converge, or to another motion" << std::endl;
}

// In absolute numbers, the KKT residual of some is never small with large weights, and the penalty of others too small.
TEST(ControlAttack, WeightsOfAnySizeGiveTheSameMotionWithConstraints) {
  for (const int k : {0, 1, 3, 4, 5, 8, 10, 11, 13}) {
    const TaskFile task = feasible(k);
    std::vector<Eigen::VectorXd> right;
    for (const double scale : {1.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2, 1e2, 1e4, 1e5, 1e6, 1e7, 1e8, 1e10}) {
      TaskFile scaled = task;
      scale_costs(scaled, scale);
      TaskProblem problem = make_problem(scaled, TaskSolver::kFddp);
      const TaskSolution s = optimize(scaled, problem, {TaskSolver::kFddp, 1, {}});
      if (right.empty()) right = s.xs;
      EXPECT_TRUE(s.converged) << k << ", weights times " << scale << ": " << s.reason;
      EXPECT_LE(apart(s, right), 1e-6) << k << ", weights times " << scale;
    }
  }
}

}  // namespace
}  // namespace manycontact::test::control_attack
