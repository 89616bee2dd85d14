#pragma once
// An optimal control task read from its XML file. A task is plain data. task/problem.hpp makes a shooting problem from
// the task.

#include <string>
#include <vector>

#include "manycontact/io/scene_file.hpp"

namespace manycontact {

/// The residual of a cost or a constraint.
enum class TaskResidual {
  kState,
  kControl,
  kJointEffort,
  kJointAcceleration,
  kCom,
  kCentroidalMomentum,
  kFramePlacement,
  kFrameTranslation,
  kFrameRotation,
  kFrameVelocity,
  kContactForce,
  kFrictionCone,
  kWrenchCone,
  kCop,
  kControlGrav,
  kContactControlGrav,
};
/// Returns whether a residual depends on the state alone, without controls, accelerations and forces. Terminal nodes
/// and impacts allow only such residuals.
bool of_state_alone(TaskResidual residual);
/// Returns the residual's name in task files: "frame_placement".
const char* to_string(TaskResidual residual);

/// The activation of a cost. In a file, a cone without an activation has a quadratic barrier at the bounds of the cone.
enum class TaskActivation { kQuad, kWeightedQuad, kQuadraticBarrier, kWeightedQuadraticBarrier, kSmooth1Norm };

/// One <cost> or <constraint>. Only members that its residual uses are set; vectors are for one robot or contact.
struct TaskTerm {
  std::string name;
  int line = 1;
  TaskResidual residual = TaskResidual::kState;
  int nr = 0;  // number of rows for one robot or contact

  /// The robots, a frame on each of these robots, or the contacts that the term refers to. Without robots, the term
  /// refers to the whole scene.
  std::vector<int> robots, contacts;
  bool copied = false;  // the term applies to all copies; placements are then relative to a copy before `arrange`
  std::string frame;    // name of the frame on each of the robots

  Eigen::VectorXd reference;     // state (nq + nv), control, efforts, accelerations, com, momentum, twist, force
  std::vector<ScenePose> poses;  // for reference="pose": the reference is a configuration of the scene at rest
                                 // with these poses, which fit_state (analysis/load_scene.hpp) computes
  SE3<double> placement;         // xyz, quat_xyzw
  ReferenceFrame reference_frame = ReferenceFrame::kLocal;
  double mu = 0;
  std::optional<Vec3<double>> normal;  // normal of a cone, as Contact::normal; none: the contact's normal
  Eigen::Vector2d box{0, 0};

  double weight = 1;
  TaskActivation activation = TaskActivation::kQuad;
  Eigen::VectorXd weights;  // nr numbers, for weighted activations
  double eps = 1;           // parameter of kSmooth1Norm
  /// The bounds of a constraint or barrier: nr numbers, which may be infinite. If empty, they are the bounds of the
  /// cone.
  Eigen::VectorXd lower, upper;
};

/// A phase, or the terminal node, whose contacts are those of the last phase.
struct TaskPhase {
  int line = 1;
  int nodes = 0;                       // number of nodes, not counting the impact's node
  bool impact = false;                 // starts with an impact: contacts stop the velocity of their frames at once
  bool at_scene = false;               // contacts that close have the placement of the scene; false: the placement of
                                       // their frames when they close
  std::vector<bool> active;            // one flag per contact of the scene
  std::vector<Vec6<double>> wrenches;  // external wrenches in these nodes, as in SceneData; empty: the scene's
  std::vector<TaskTerm> costs, constraints;
};

/// The integrator of the nodes.
enum class TaskIntegrator { kEuler, kRk2, kRk3, kRk4, kSymplectic };
/// The solver of a task.
enum class TaskSolver { kFddp, kBoxFddp, kSparse, kAuto };
/// Returns the solver's name in task files and on the command line: "box-fddp".
const char* to_string(TaskSolver solver);
/// The initial guess of the controls.
enum class TaskGuess { kQuasiStatic, kZero };

struct TaskFile {  // A task: a scene, phases with contacts, costs and constraints, and solver settings.
  std::string path, name;
  SceneFile scene;
  double step = 0;  // s
  TaskIntegrator integrator = TaskIntegrator::kEuler;
  std::vector<TaskPhase> phases;
  TaskPhase terminal;  // its number of nodes is 0

  int solver_line = 1;
  TaskSolver solver = TaskSolver::kAuto;
  int iterations = 100;
  double tolerance = 1e-9;  // tolerance for the stopping value |d1 + d2/2|
  TaskGuess guess = TaskGuess::kQuasiStatic;

  int nodes() const;  // number of running nodes, impacts included
};

/// Reads a task file and its scene. fit_state (analysis/load_scene.hpp) computes what needs a solver. Throws
/// InputError, also for the scene's file. Thread-safe.
TaskFile read_task(const std::string& path);

}  // namespace manycontact
