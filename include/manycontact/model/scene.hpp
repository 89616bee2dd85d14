#pragma once
// A scene: robots (instances of models) and the contacts among them and with the world. Plain data, no mathematics.

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
  SE3<double> base;  // in the world: where a fixed base stands, where a floating one starts (neutral)
  int idx_q = 0, idx_v = 0, idx_u = 0;  // first coordinate in the scene's q, v, u
};

/// Rows of a point (1D, 2D, 3D), of a frame (6D), or of a frame that turns freely about one axis (5D, a hinge).
enum class ContactType { k1D, k2D, k3D, k5D, k6D };
enum class ReferenceFrame {
  kLocal,
  kWorld,
  kLocalWorldAligned,
  LOCAL = kLocal,  // Pinocchio's names
  WORLD = kWorld,
  LOCAL_WORLD_ALIGNED = kLocalWorldAligned
};

constexpr int contact_rows(ContactType t) {  // of J: 1, 2, 3, 5, 6
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

/// Whether rows of a contact hold turning.
constexpr bool holds_turning(ContactType t) { return t == ContactType::k5D || t == ContactType::k6D; }
/// Whether a contact has an axis.
constexpr bool has_axis(ContactType t) { return t == ContactType::k1D || t == ContactType::k5D; }

/// "6d", as scene files have it.
inline std::string to_string(ContactType t) { return std::to_string(contact_rows(t)) + "d"; }

/// A body a contact is attached to: a placement on a joint's body of a robot, or in the world.
struct Attachment {
  int robot = -1;          // -1: the world
  int joint = -1;          // of that robot's model; -1: its fixed base
  SE3<double> placement;   // of the contact frame on that body
  std::string frame = {};  // the robot's frame it was made from, before any offset; empty when unknown
};
/// Whether an attachment's body moves: not the world, nor a fixed base.
inline bool moves(const Attachment& at) { return at.robot >= 0 && at.joint >= 0; }

struct PairRows;  // contact/pair_rows.hpp

/// A bilateral contact: frame A on a robot, B' on another body or in the world. Equations in contact/rows.hpp.
struct Contact {
  std::string name;
  ContactType type = ContactType::k6D;
  ReferenceFrame reference_frame = ReferenceFrame::kLocal;
  Attachment A = {}, B = {};
  Vec3<double> axis = Vec3<double>::UnitZ();  // unit; 1D: the component kept, in the reference frame; 5D: about which
                                              // A turns freely, in A's axes and in those of B'
  double alpha = 0, beta = 0;                 // stabilisation gains [1/s^2], [1/s]
  bool active = true;                         // at the start; data may switch it later

  // What a unilateral contact bears: told by analysis/violations.hpp, no part of the equations.
  std::optional<double> mu = {};                  // friction coefficient; none: the contact may pull
  std::optional<Vec3<double>> normal = {};        // unit, out of the surface: in the world, or in B' axes where B is on
                                                  // a body; none: the world's z for points, A's own z for 6D
  Eigen::Vector2d box = Eigen::Vector2d::Zero();  // 6D: length along x and width along y of the support [m]; 0: none

  // Set inside of solve alone: the contact stands for all contacts between the same two bodies, whose rows are reduced
  // to these (contact/pair_rows.hpp). Its type is 6D.
  std::shared_ptr<const PairRows> pair = {};
  int pair_rank = 0;
  int rows() const { return pair ? pair_rank : contact_rows(type); }  // 1 ... 6
};

/// A wrench from outside on a body, at a frame: what pushes or pulls a robot, as wind, a hand, a rope do.
struct Push {
  std::string name;
  Attachment at;  // the frame: its origin is where the force acts
  ReferenceFrame reference_frame =
      ReferenceFrame::kLocal;                  // axes of the wrench: the frame's, which turn with the body,
                                               // or the world's (kWorld, kLocalWorldAligned: the same)
  Vec6<double> wrench = Vec6<double>::Zero();  // [force; torque about the origin] [N, N m] at the start;
                                               // data may change it (SceneData::pushes)
};

/// A spring and damper between two points, massless: it pulls A to B with the force
///
///     stiffness (s - length) + damping ds/dt,    s the distance between the points
///
/// along the line through them, and pushes where that is negative. Where the points coincide the line has no direction,
/// and a solve fails (Reason::kSpringWithoutDirection), unless length and damping are zero.
struct Spring {
  std::string name;
  Attachment A, B;       // the frames' origins; B may be in the world
  double stiffness = 0;  // N / m
  double length = 0;     // at rest [m]
  double damping = 0;    // N s / m
};

/// A spring in a joint of one coordinate: the torque -stiffness (q - rest). (Its damper: Model::damping.)
struct JointSpring {
  int robot = -1, joint = -1;
  double stiffness = 0;  // N m / rad, N / m
  double rest = 0;       // rad, m
};

struct Scene {  // Constant while it is solved; data.hpp says what may change between solves.
  std::string name;
  Vec3<double> gravity{0, 0, -9.81};
  double damping = 0;  // delta, Crocoddyl's JMinvJt_damping
  /// How exact lengths are [m], and over the largest lever angles [rad]: contact rows that depend on each other but for
  /// that are dependent, in accelerations, forces and derivatives. 0: exact to rounding.
  double tolerance = 0;
  /// What contacts' moments count beside their forces where contacts could share both otherwise (forces of least norm),
  /// and turns beside displacements where contacts contradict each other (least squares): a moment as the force that
  /// makes it at this lever [m], above 0.
  double moment_length = 1;
  std::vector<Robot> robots;
  std::vector<Contact> contacts;
  std::vector<Push> pushes;
  std::vector<Spring> springs;
  std::vector<JointSpring> joint_springs;

  // Kept by add_robot, add_contact, add_push and add_spring.
  int nq = 0, nv = 0, nu = 0;
  std::unordered_map<std::string, int> robot_index, contact_index, push_index, spring_index;  // by name

  int nrobots() const { return static_cast<int>(robots.size()); }  // copies counted
};

/// Appends a robot and sets its indices; returns its number. base: where its base stands (fixed), or where
/// neutral(scene) starts it (floating). Throws std::invalid_argument on a duplicate name, a model that was not
/// finalized, or a base that is not finite.
int add_robot(Scene& scene, const std::string& name, std::shared_ptr<const Model> model, const SE3<double>& base = {});

/// The attachment of a robot's frame, with an offset on it. Throws std::invalid_argument for an unknown name, with the
/// nearest one.
Attachment attach(const Scene& scene, const std::string& robot, const std::string& frame,
                  const SE3<double>& offset = {});

/// The same place, in the world when its body cannot move: on a fixed base, where that stands now. Its frame is then
/// "robot/frame".
Attachment world_if_immovable(const Scene& scene, Attachment attachment);

/// Appends a contact, its axis normalised and B' by world_if_immovable, so that it joins no robot that it does not act
/// on; returns its number. A may be on a body that cannot move where B' can: the contact is kept as it is, for A's axes
/// are those of its rows and forces, and with A and B' exchanged it would be another one.
/// Throws std::invalid_argument: an unknown robot or joint, A in the world, A and B' on one body, neither can move,
/// numbers that are not finite, an axis below kZeroDirection, a name used twice, a 5D contact in axes that are not
/// local, a negative mu or box, a box on a contact that is not 6D.
int add_contact(Scene& scene, Contact contact);

/// Appends a push; returns its number. Throws std::invalid_argument: an unknown robot or joint, a body that cannot
/// move, numbers that are not finite, a name used twice.
int add_push(Scene& scene, Push push);

/// Appends a spring, its ends by world_if_immovable and exchanged where A cannot move; returns its number. Throws
/// std::invalid_argument: an unknown robot or joint, both ends on one body, neither can move, a negative number or one
/// that is not finite, a name used twice.
int add_spring(Scene& scene, Spring spring);

/// Appends a joint's spring; returns its number. Throws std::invalid_argument: an unknown robot or joint, a joint of
/// several coordinates, a negative stiffness, a number that is not finite.
int add_joint_spring(Scene& scene, const std::string& robot, const std::string& joint, double stiffness,
                     double rest = 0);

/// "wind[0]", ... "wind[5]" of each push: names of the numbers of all wrenches, one after the other.
std::vector<std::string> push_names(const Scene& scene);

/// Whether anything but motors, gravity and contacts acts: pushes and springs.
inline bool has_applied_forces(const Scene& scene) {
  return !scene.pushes.empty() || !scene.springs.empty() || !scene.joint_springs.empty();
}

/// Names of the coordinates of q, v, u: "r0/knee", or "r0/root[0]" of a joint with several.
std::vector<std::string> configuration_names(const Scene& scene);
std::vector<std::string> velocity_names(const Scene& scene);
std::vector<std::string> torque_names(const Scene& scene);

/// The first coordinate of a joint in the scene's q, v, u. Throw std::invalid_argument for a name that does not exist,
/// with the nearest one, u_index for a floating base too, which has no torques.
int q_index(const Scene& scene, const std::string& robot, const std::string& joint);
int v_index(const Scene& scene, const std::string& robot, const std::string& joint);
int u_index(const Scene& scene, const std::string& robot, const std::string& joint);

}  // namespace manycontact
