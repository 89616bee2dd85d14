#pragma once
// Inverse kinematics of a scene: finds a configuration that meets goals, within the joints' limits. Let e be the errors
// of the goals and J their derivatives, each goal scaled by the square root of its weight. `place` repeats
//
//     q := q (+) dq        min |J dq + e|^2 + mu |dq|^2        lower <= q + dq <= upper
//
// These are Gauss-Newton steps, damped by mu (Levenberg-Marquardt). Let J now have the columns of the coordinates that
// are not at a limit, and J_limited the columns of those that are. A step is
//
//     dq = -J^T y        (J J^T + mu 1) y = e + J_limited dq_limited
//
// where the matrix J J^T + mu 1 is sparse: two goals are coupled only if they are on one robot, or on robots that
// contacts couple. Block pivoting finds the coordinates at a limit, and ends at the unique minimum of the step. Source:
// Judice, Pires, A block principal pivoting algorithm for large-scale strictly monotone linear complementarity
// problems, Computers & Operations Research 21 (1994).
//
// If these steps converge slowly because a large error remains, Newton steps replace them; the Hessian of |e|^2 is
// applied by conjugate gradients. If |e| is stationary and not zero, the search continues from a point one millimetre
// and one milliradian away: straight knees and elbows, as in the neutral q, are saddle points of |e|.
//
// The errors of contradicting goals are distributed according to their weights. The result is a local minimum near the
// start; with `restarts`, the search is repeated from other configurations.

#include <array>
#include <optional>

#include "manycontact/io/scene_file.hpp"
#include "manycontact/model/rigid_bodies.hpp"

namespace manycontact {

struct TaskFile;  // io/task_file.hpp

/// Three required numbers, some of which may be missing. For example, {std::nullopt, std::nullopt, 0.0} requires z = 0
/// only.
using Partial = std::array<std::optional<double>, 3>;

/// A goal for a configuration; made by the functions below.
struct Goal {
  /// The object that the goal refers to.
  enum class Target { kFrame, kCenterOfMass, kJoint, kContact };
  Target target = Target::kFrame;
  std::string name;  // the name used in error messages
  double weight = 1;

  Attachment frame = {};              // kFrame, on a body that may move
  Partial position = {};              // kFrame, kCenterOfMass: x, y, z in the world [m]
  std::vector<Attachment> from = {};  // not empty: position is relative to the mean of these frames' origins
  Partial rpy = {};  // kFrame: rotations of its axes about the world's x, then y, then z [rad], as in URDF
  std::optional<Mat3<double>> axes = {};  // kFrame: all axes, in the world; rpy is then unused
  RobotIndex robot = -1;                  // kCenterOfMass: -1 for the whole scene; kJoint: the joint's robot
  JointIndex joint = -1;                  // kJoint: a revolute or prismatic joint
  double value = 0;                       // kJoint [rad, m]
  ContactIndex contact = -1;              // kContact: the contact to bring into place
};

/// Return a goal for the complete placement of a frame in the world, or for given components of x, y, z [m] and roll,
/// pitch, yaw [rad]. Roll and pitch without yaw define the tilt of the frame (with {0, 0, open} its z axis points up).
/// Any other subset of angles is compared as rpy, which is singular at a pitch of pi/2. `frame`: made by find_frame or
/// attach.
Goal pose_goal(const Attachment& frame, const SE3<double>& placement, double weight = 1);
Goal pose_goal(const Attachment& frame, const Partial& position, const Partial& rpy = {}, double weight = 1);
/// Returns a goal for the centre of mass of the scene, or of one robot [m]. Throws std::invalid_argument for an unknown
/// robot.
Goal center_of_mass_goal(const Scene& scene, const Partial& position, const std::string& robot = "", double weight = 1);
/// Returns a goal for the position of a one-coordinate joint "r0/knee" [rad, m]. Throws std::invalid_argument for other
/// joints.
Goal joint_goal(const Scene& scene, const std::string& joint, double value, double weight = 1);
/// Returns a goal to bring a contact, active or not, into place. Throws std::invalid_argument for an unknown name.
Goal contact_goal(const Scene& scene, const std::string& contact, double weight = 1);

struct GoalLeft {       // The remaining error of a goal.
  double position = 0;  // m
  double angle = 0;     // rad
};

struct PlaceOptions {        // When the search ends, and from how many configurations it starts.
  int iterations = 1000;     // largest number of steps from each start; it ends earlier if the error stays constant
  double tolerance = 1e-12;  // a goal is met if every row of its error e, times the root of its weight, is below this
                             // tolerance or below the rounding errors
  int restarts = 0;          // further starts while goals are not met, at random joints within limits, bases as in q
  unsigned seed = 0;         // seed of the random starts
};

struct PlacedScene {           // The configuration found, and its remaining errors.
  Eigen::VectorXd q;           // nq, within the limits
  int iterations = 0;          // steps from all starts
  bool out_of_steps = false;   // whether the search for q ended at PlaceOptions::iterations: the error still decreased
  std::vector<GoalLeft> left;  // one entry per goal

  /// Returns whether the remaining errors of all goals are at most `error` [m, rad].
  bool met(double error = 1e-9) const;
};

/// Searches from q (nq), which is first moved within the limits. A joint whose limits are equal does not move. Throws
/// std::invalid_argument for a wrong size or number, or an unknown robot, joint or contact. Allocates. Thread-safe.
PlacedScene place(const Scene& scene, const ConstVectorRef& q, const std::vector<Goal>& goals,
                  const PlaceOptions& options = {});

/// Computes the q required by the <pose> elements of a scene file, starting from the file's q. With consistent="true",
/// active contacts whose target frame B' is in the file are brought into place; other contacts get B' from the q found.
/// Adds a finding of kind "pose" that states what moved. Throws InputError for the worst pose that cannot be met.
void place(SceneFile& file);

/// Computes the references of a task's terms that are given as poses, from the scene's q; see fit_state in
/// analysis/load_scene.hpp. Throws InputError for the worst pose if they cannot be met.
void place_references(TaskFile& task);

}  // namespace manycontact
