#pragma once
// An optimal control task from its XML file (src/doc/task_file.md): a scene, phases with their contacts, costs
// and constraints, and how it is to be solved. Plain data; task/problem.hpp makes a shooting problem of it.

#include <string>
#include <vector>

#include "manycontact/io/scene_file.hpp"

namespace manycontact {

/// What a cost or a constraint looks at: a residual of the action floor.
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
/// Whether a residual looks at neither controls, accelerations nor forces: terminal nodes and impacts have these alone.
bool of_state_alone(TaskResidual residual);
/// As in task files: "frame_placement".
const char* to_string(TaskResidual residual);

/// Of a cost; cones have a barrier at their own bounds unless the file says otherwise.
enum class TaskActivation { kQuad, kWeightedQuad, kQuadraticBarrier, kWeightedQuadraticBarrier, kSmooth1Norm };

/// One <cost> or <constraint>. Of the numbers those are set that the residual has, for one copy of the
/// robot or contact.
struct TaskTerm {
  std::string name;
  int line = 1;
  TaskResidual residual = TaskResidual::kState;
  int nr = 0;  // rows, of one copy

  /// Whom it is about: robots, or a frame on each of them, or contacts of the scene. No robot: the whole scene.
  std::vector<int> robots, contacts;
  bool copied = false;  // all copies are meant, and places are those of the robot before `arrange` moved it
  std::string frame;    // of the robots

  Eigen::VectorXd reference;     // state (nq + nv), control, efforts, accelerations, com, momentum, twist, force
  std::vector<ScenePose> poses;  // of a state with reference="pose": its reference is a posture at rest, the whole
                                 // scene's, that meets them; fit_state (analysis/load_scene.hpp) finds it
  SE3<double> placement;         // xyz, quat_xyzw
  ReferenceFrame reference_frame = ReferenceFrame::kLocal;
  double mu = 0;
  std::optional<Vec3<double>> normal;  // of a cone, as Contact::normal; none: the contact's
  Eigen::Vector2d box{0, 0};

  // Of a cost.
  double weight = 1;
  TaskActivation activation = TaskActivation::kQuad;
  Eigen::VectorXd weights;  // nr, of weighted activations
  double eps = 1;           // of kSmooth1Norm
  /// Of a constraint, and of a barrier: nr, -inf and inf allowed; empty: those of the cone.
  Eigen::VectorXd lower, upper;
};

/// A phase, or the terminal node, whose contacts are the last phase's.
struct TaskPhase {
  int line = 1;
  int nodes = 0;                     // without that of an impact
  bool impact = false;               // before them: contacts stop their frames' velocity at once
  bool at_scene = false;             // contacts that close hold where the scene has them, else where they close
  std::vector<bool> active;          // per contact of the scene
  std::vector<Vec6<double>> pushes;  // per push of the scene: its wrench in these nodes; none: the scene's
  std::vector<TaskTerm> costs, constraints;
};

enum class TaskIntegrator { kEuler, kRk2, kRk3, kRk4, kSymplectic };
enum class TaskSolver { kFddp, kBoxFddp, kSparse, kAuto };
/// "box-fddp", as in task files and on the command line.
const char* to_string(TaskSolver solver);
enum class TaskGuess { kQuasiStatic, kZero };

struct TaskFile {  // A task as its file has it.
  std::string path, name;
  SceneFile scene;
  double step = 0;  // s
  TaskIntegrator integrator = TaskIntegrator::kEuler;
  std::vector<TaskPhase> phases;
  TaskPhase terminal;  // nodes = 0

  int solver_line = 1;
  TaskSolver solver = TaskSolver::kAuto;
  int iterations = 100;
  double tolerance = 1e-9;  // of the stopping value |d1 + d2/2|
  TaskGuess guess = TaskGuess::kQuasiStatic;

  int nodes() const;  // running ones, impacts among them
};

/// Throws InputError, for the scene's file too. What takes a solver is left to fit_state (analysis/load_scene.hpp).
TaskFile read_task(const std::string& path);

}  // namespace manycontact
