#pragma once
// Inverse kinematics of a scene: a configuration that meets goals, within the joints' limits. With e the goals' errors
// and J their derivatives, both times the root of a goal's weight,
//
//     q := q (+) dq        min |J dq + e|^2 + mu |dq|^2        lower <= q + dq <= upper
//
// again and again: Gauss and Newton's steps, damped by mu as Levenberg and Marquardt do. Of the coordinates that are
// not at a limit a step is
//
//     dq = -J^T y        (J J^T + mu 1) y = e + J_limited dq_limited
//
// and that matrix is sparse: goals meet only where they are on one robot or on robots that contacts join. Which
// coordinates a limit holds is found by block pivoting, which ends at the step's one minimum. Source: Judice, Pires, A
// block principal pivoting algorithm for large-scale strictly monotone linear complementarity problems, Computers &
// Operations Research 21 (1994).
//
// Where these steps gain little, because much of e remains, Newton's take over, with the Hessian of |e|^2 by
// conjugate gradients. Where |e| is stationary and not zero the search steps aside by a millimetre and a milliradian
// and goes on: straight knees and elbows, as of the neutral q, are saddles.
//
// Goals that contradict each other share what is left by their weights. What is found is near where the search starts,
// and the nearest of several minima, not the best of all: `restarts` look further.

#include <array>
#include <optional>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/model/rigid_bodies.hpp"

namespace manycontact {

struct TaskFile;  // io/task_file.hpp

/// Three numbers of which some may be left open: {std::nullopt, std::nullopt, 0.0} asks for z = 0.
using Partial = std::array<std::optional<double>, 3>;

/// What is wanted of a configuration; by the functions below.
struct Goal {
  enum class Of { kFrame, kCenterOfMass, kJoint, kContact };
  Of of = Of::kFrame;
  std::string name;  // for reports
  double weight = 1;

  Attachment frame = {};              // kFrame
  Partial position = {};              // kFrame, kCenterOfMass: x, y, z in the world [m]
  std::vector<Attachment> from = {};  // if any: position is from the middle of these frames' origins
  Partial rpy = {};                   // kFrame: its axes turned about the world's x, then y, then z [rad], as in URDF
  std::optional<Mat3<double>> axes = {};  // kFrame: all of them, in the world; then without rpy
  int robot = -1;                         // kCenterOfMass: -1: of the whole scene; kJoint
  int joint = -1;                         // kJoint: a revolute or prismatic one
  double value = 0;                       // kJoint [rad, m]
  int contact = -1;                       // kContact: its frames are to stand where it holds them
};

/// A frame's place in the world: all of it, or what of x, y, z [m] and roll, pitch, yaw [rad] is given. Roll and pitch
/// without yaw say how the frame is tilted ({0, 0, open}: its z is up); other incomplete angles are those of rpy, which
/// have no meaning at a pitch of pi/2. frame: by frame_called or attach, of a robot.
Goal pose_goal(const Attachment& frame, const SE3<double>& placement, double weight = 1);
Goal pose_goal(const Attachment& frame, const Partial& position, const Partial& rpy = {}, double weight = 1);
/// The centre of mass of the scene, or of one of its robots [m].
Goal center_of_mass_goal(const Scene& scene, const Partial& position, const std::string& robot = "", double weight = 1);
/// The position of a joint with one coordinate [rad, m]; "r0/knee".
Goal joint_goal(const Scene& scene, const std::string& joint, double value, double weight = 1);
/// A contact of the scene, active or not, is in place.
Goal contact_goal(const Scene& scene, const std::string& contact, double weight = 1);

struct GoalLeft {       // How far a goal is from being met.
  double position = 0;  // m
  double angle = 0;     // rad
};

struct PlaceOptions {        // When the search ends, and how often it starts.
  int iterations = 100;      // steps tried at most, from each start
  double tolerance = 1e-12;  // met: no row of e is more, times the root of its weight, or than rounding of places there
  int restarts = 0;          // further starts while goals are missed: random joints within limits, bases as in q
  unsigned seed = 0;         // of these
};

struct PlacedScene {           // The configuration found, and what it lacks.
  Eigen::VectorXd q;           // nq, within the limits
  int iterations = 0;          // steps tried, from all starts
  std::vector<GoalLeft> left;  // by goal

  /// Whether every goal is met but for `error` [m, rad].
  bool met(double error = 1e-9) const;
};

/// From q (nq), which is brought within the limits first; a joint whose limits are equal stays there. Throws
/// std::invalid_argument for a size, a number, a robot, joint or contact that does not fit.
PlacedScene place(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, const std::vector<Goal>& goals,
                  const PlaceOptions& options = {});

/// For a scene file with <pose> elements: finds the q that they ask for, from the file's; where consistent="true"
/// stands too, with the active contacts in place whose B' the file says. Contacts that leave B' out are held where
/// their frames are then. Adds a finding of kind "pose" that says what moved. Throws InputError, by the worst pose,
/// where they cannot all be met within limits from there.
void place(SceneFile& file);

/// The references of a task's terms that are poses, as fit_state (analysis/load_scene.hpp), from the scene's q. Throws
/// InputError, by the worst pose.
void place_references(TaskFile& task);

}  // namespace manycontact
