#pragma once
// A scene as plain data: robots (instances of models), contacts among the robots and with the world, and loads.

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "manycontact/model/model.hpp"

namespace manycontact {

struct Robot {  // One robot of a scene.
  std::string name;
  std::shared_ptr<const Model> model;
  SE3<double> base;  // placement of the base in the world; for a floating base, its placement in neutral(scene)
  int idx_q = 0, idx_v = 0, idx_u = 0;  // index of the first coordinate in the scene's q, v, u
};

/// The constraint of a contact: on a point (1D, 2D, 3D), on a frame (6D), or on a frame except its rotation about one
/// axis (5D, a hinge).
enum class ContactType { k1D, k2D, k3D, k5D, k6D };
/// The axes in which constraint rows, wrenches, or velocities of frames are expressed.
enum class ReferenceFrame {
  kLocal,
  kWorld,
  kLocalWorldAligned,
  LOCAL = kLocal,  // Pinocchio's names
  WORLD = kWorld,
  LOCAL_WORLD_ALIGNED = kLocalWorldAligned
};

constexpr int contact_rows(ContactType t) {  // the number of constraint rows of a contact
  switch (t) {
    case ContactType::k1D:
      return 1;
    case ContactType::k2D:
      return 2;
    case ContactType::k3D:
      return 3;
    case ContactType::k5D:
      return 5;
    case ContactType::k6D:
      break;
  }
  return 6;
}

/// Returns whether a contact of this type has angular constraint rows.
constexpr bool holds_turning(ContactType t) { return t == ContactType::k5D || t == ContactType::k6D; }
/// Returns whether a contact of this type has an axis (Contact::axis).
constexpr bool has_axis(ContactType t) { return t == ContactType::k1D || t == ContactType::k5D; }

/// Returns the name of a contact type in scene files: "6d".
inline std::string to_string(ContactType t) { return std::to_string(contact_rows(t)) + "d"; }

/// A frame on a joint's body or in the world, to which contacts, external wrenches and springs are attached.
struct Attachment {
  RobotIndex robot = -1;   // number of the robot in the scene; -1: the world
  JointIndex joint = -1;   // number of the joint in the robot's model; -1: the fixed base
  SE3<double> placement;   // placement of the frame on that body
  std::string frame = {};  // the robot's frame to which `placement` adds an offset, if any; empty if unknown
};
/// Returns whether the body of an attachment can move. The world and fixed bases cannot.
inline bool moves(const Attachment& at) { return at.robot >= 0 && at.joint >= 0; }

struct PairRows;  // defined in the private module contact

/// A bilateral contact between frame A on a robot and frame B' on another body or in the world. The members `A` and `B`
/// place these two frames. Their constraint rows are defined in detail/contact/rows.hpp.
struct Contact {
  std::string name;
  ContactType type = ContactType::k6D;
  ReferenceFrame reference_frame = ReferenceFrame::kLocal;
  Attachment A = {}, B = {};
  Vec3<double> axis = Vec3<double>::UnitZ();  // unit vector; 1D: the constrained component, in the reference frame; 5D:
                                              // the free axis of rotation, in A's axes and in those of B'
  double alpha = 0, beta = 0;                 // stabilisation gains [1/s^2], [1/s] of position and velocity errors
  bool active = true;                         // initial state; SceneData::active may switch the contact later

  // Properties of a unilateral contact. They are not part of the equations; see `violations` in analysis/findings.hpp.
  std::optional<double> mu = {};                  // friction coefficient; none: no friction limit, the contact may pull
  std::optional<Vec3<double>> normal = {};        // unit vector out of the surface, in the world, or in the axes of B'
                                                  // if B is on a body; none: the world's z for points, A's own z for 6D
  Eigen::Vector2d box = Eigen::Vector2d::Zero();  // 6D: length (x) and width (y) of the support area [m]; 0: none

  // Set only inside of solve: this 6D contact represents all contacts between two bodies by `pair_rank` rows.
  std::shared_ptr<const PairRows> pair = {};
  int pair_rank = 0;
  int rows() const { return pair ? pair_rank : contact_rows(type); }  // number of constraint rows, 1 to 6
};

/// An external wrench on a body, at a frame: for example wind, a hand, or a rope.
struct ExternalWrench {
  std::string name;
  Attachment at;  // the frame; the force acts at its origin
  ReferenceFrame reference_frame =
      ReferenceFrame::kLocal;                  // axes of the wrench: those of the frame, which rotate with the body, or
                                               // the world's (kWorld and kLocalWorldAligned are the same)
  Vec6<double> wrench = Vec6<double>::Zero();  // initial [force; torque] [N, N m]; solve uses SceneData::wrenches
};

/// A massless spring and damper between two points. It pulls A towards B with the force
///
///     stiffness (s - length) + damping ds/dt,    s the distance between the points
///
/// along the line through them; a negative force presses them apart. If the points coincide, the line has no direction,
/// and a solve fails (Reason::kSpringWithoutDirection), unless length and damping are zero.
struct Spring {
  std::string name;
  Attachment A, B;       // the origins of both frames are the spring's ends; B may be in the world
  double stiffness = 0;  // N / m
  double length = 0;     // length at rest [m]
  double damping = 0;    // N s / m
};

/// A spring in a joint with one coordinate q; its torque is -stiffness (q - rest). Model::damping adds joint damping.
struct JointSpring {
  RobotIndex robot = -1;
  JointIndex joint = -1;
  double stiffness = 0;  // N m / rad or N / m
  double rest = 0;       // rad or m
};

struct Scene {  // Constant while it is solved; dynamics/data.hpp lists what may change between solves.
  std::string name;
  Vec3<double> gravity{0, 0, -9.81};
  double damping = 0;  // delta in J a + a0 + delta f = 0, Crocoddyl's JMinvJt_damping [1/kg]; 0: rigid contacts
  /// Geometric tolerance [m]; for angles it is divided by the longest moment arm. Rows of J that are linearly dependent
  /// to within this tolerance are treated as dependent, in accelerations, forces and derivatives. 0: exact up to
  /// rounding.
  double tolerance = 0;
  /// Characteristic length L [m], above 0, that weights moments m against forces f. Least-norm contact forces minimise
  /// sum f^2 + sum (m / L)^2. In the least squares of inconsistent contacts, it weights rotations against
  /// displacements.
  double moment_length = 1;
  std::vector<Robot> robots;
  std::vector<Contact> contacts;
  std::vector<ExternalWrench> wrenches;
  std::vector<Spring> springs;
  std::vector<JointSpring> joint_springs;

  // Maintained by add_robot, add_contact, add_external_wrench and add_spring.
  int nq = 0, nv = 0, nu = 0;
  std::unordered_map<std::string, int> robot_index, contact_index, wrench_index, spring_index;  // name to number

  int nrobots() const { return static_cast<int>(robots.size()); }  // number of robots
};

/// Appends a robot, sets its indices and returns its number. base: placement of a fixed base, or of a floating base in
/// neutral(scene). Throws std::invalid_argument for a duplicate name, a model that is not finalized, or a base that is
/// not finite. Existing SceneData become invalid.
int add_robot(Scene& scene, const std::string& name, std::shared_ptr<const Model> model, const SE3<double>& base = {});

/// Makes the attachment of a robot's frame, with an offset in the frame's axes. Throws std::invalid_argument for an
/// unknown name, and suggests the nearest one.
Attachment attach(const Scene& scene, const std::string& robot, const std::string& frame,
                  const SE3<double>& offset = {});

/// Returns the attachment, expressed in the world if its body cannot move, such as a fixed base. The name of its frame
/// is then "robot/frame".
Attachment world_if_immovable(const Scene& scene, Attachment attachment);

/// Appends a contact; returns its number. The axis is normalised. B' is expressed in the world if its body cannot move,
/// so that the contact does not couple that robot. A is never moved to the world, because rows and forces refer to A.
/// Existing SceneData become invalid.
///
/// Throws std::invalid_argument for:
///
/// - An unknown robot or joint, or a name used twice.
/// - A in the world, A and B' on one body, or two bodies that cannot move.
/// - Numbers that are not finite, an axis shorter than kZeroDirection, a negative mu or box.
/// - A 5D contact whose reference frame is not local, or a box on a contact that is not 6D.
int add_contact(Scene& scene, Contact contact);

/// Appends an external wrench; returns its number. Existing SceneData become invalid. Throws std::invalid_argument for
/// an unknown robot or joint, a body that cannot move, numbers that are not finite, or a name used twice.
int add_external_wrench(Scene& scene, ExternalWrench push);

/// Appends a spring; returns its number. Ends that cannot move are expressed in the world; if A cannot move, A and B
/// are exchanged. Existing SceneData become invalid. Throws std::invalid_argument for an unknown robot or joint, a
/// duplicate name, both ends on one body or immovable, or negative or infinite numbers.
int add_spring(Scene& scene, Spring spring);

/// Appends a spring in a joint; returns its number. stiffness: N m/rad or N/m; rest: rad or m. Existing SceneData
/// become invalid. Throws std::invalid_argument for an unknown robot or joint, a joint with several coordinates, a
/// negative stiffness, or a number that is not finite.
int add_joint_spring(Scene& scene, const std::string& robot, const std::string& joint, double stiffness,
                     double rest = 0);

/// Returns the names of the components of all wrenches: "wind[0]", ... "wind[5]" for each external wrench.
std::vector<std::string> wrench_names(const Scene& scene);

/// Returns whether the scene has forces other than those of motors, gravity and contacts: external wrenches or springs.
inline bool has_applied_forces(const Scene& scene) {
  return !scene.wrenches.empty() || !scene.springs.empty() || !scene.joint_springs.empty();
}

/// Return the names of the coordinates of q, v and u: "r0/knee", or "r0/root[0]" for a joint with several coordinates.
std::vector<std::string> configuration_names(const Scene& scene);
std::vector<std::string> velocity_names(const Scene& scene);
std::vector<std::string> torque_names(const Scene& scene);

/// Return the index of a joint's first coordinate in the scene's q, v or u. They throw std::invalid_argument for an
/// unknown name, and suggest the nearest name. u_index also throws for a joint without torques, such as a floating
/// base.
int q_index(const Scene& scene, const std::string& robot, const std::string& joint);
int v_index(const Scene& scene, const std::string& robot, const std::string& joint);
int u_index(const Scene& scene, const std::string& robot, const std::string& joint);

}  // namespace manycontact
