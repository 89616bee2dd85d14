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
  int rows() const { return contact_rows(type); }  // 1, 2, 3, 5, 6
};

struct Scene {  // Constant while it is solved; data.hpp says what may change between solves.
  std::string name;
  Vec3<double> gravity{0, 0, -9.81};
  double damping = 0;  // delta, Crocoddyl's JMinvJt_damping
  /// How exact lengths are [m], and over the largest lever angles [rad]: contact rows that depend on each other but for
  /// that are dependent, in accelerations, forces and derivatives. 0: exact to rounding.
  double tolerance = 0;
  std::vector<Robot> robots;
  std::vector<Contact> contacts;

  // Kept by add_robot and add_contact.
  int nq = 0, nv = 0, nu = 0;
  std::unordered_map<std::string, int> robot_index, contact_index;  // by name

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
