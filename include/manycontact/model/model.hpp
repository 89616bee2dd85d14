#pragma once
// One robot (or object): a kinematic tree. Constant once finalized; shared by all copies of the robot in a scene.
// Joints are numbered so that a parent comes before its children.

#include <memory>
#include <string>
#include <vector>

#include "manycontact/model/joint.hpp"

namespace manycontact {

/// A named frame (a link, or a link merged behind fixed joints), fixed on a joint's body.
struct Frame {
  std::string name;
  int joint = -1;            // -1: fixed to the robot's base
  SE3<double> placement;     // in the joint's frame (in the base frame when joint = -1)
  bool merged = false;       // the link hangs on its joint's body behind fixed or locked joints
  Inertia<double> inertia;   // of this link alone, in this frame; the joint's inertia has it already
  std::string parent_joint;  // the joint of the file that carries the link, fixed ones too; empty for the root
};

/// What reading the file merged, locked, or did not model; for `inspect` and the summary.
struct ModelNotes {
  std::vector<std::string> merged;    // fixed joints
  std::vector<std::string> locked;    // frozen joints
  std::vector<std::string> mimic;     // joints with <mimic>, kept independent
  std::vector<std::string> dynamics;  // joints whose <dynamics> damping or friction is not modelled
};

/// A tree of joints: all of a robot's on a floating base, on a fixed base those that hang on it by one joint.
struct Tree {
  int root = 0;           // joint
  std::vector<int> path;  // joints from the root to the anchor, the body that the tree frame's origin is on
};

/// Below this speed Coulomb friction falls to zero instead of jumping [rad/s, m/s].
constexpr double kFrictionVelocity = 0.01;

struct Model {  // A robot's tree: joints, frames, inertias.
  std::string name;
  bool floating_base = false;  // joint 0 is the floating base
  std::vector<Joint> joints;
  std::vector<Frame> frames;
  Eigen::VectorXd armature;  // nv, kg m^2 (kg for prismatic): reflected rotor inertia, on M's diagonal
  // nv, or empty where not modelled: the torque -damping v - friction tanh(v / kFrictionVelocity) on every coordinate.
  Eigen::VectorXd damping;   // N m s / rad, N s / m
  Eigen::VectorXd friction;  // N m, N: Coulomb's, smoothed around standstill so that it has derivatives
  ModelNotes notes;

  // Derived by finalize.
  int nq = 0, nv = 0;
  std::vector<int> actuated;     // velocity coordinates with a torque in u, in its order, ascending: all but a floating
                                 // base's and passive joints'
  std::vector<int> dof_parent;   // nv: the next dof towards the base, -1 at the base
  std::vector<int> dof_joint;    // nv
  std::vector<int> dof_depth;    // nv: number of ancestors
  std::vector<int> subtree_end;  // per joint: one past the last joint of its subtree when numbered depth first
  std::vector<Tree> trees;       // by their roots, ascending
  std::vector<int> tree_of;      // per joint: its tree
  std::vector<char> on_path;     // per joint: on its tree's path
  std::vector<int> M_begin;      // nv+1: row i of M's packed storage (see algorithm/crba.hpp); empty where the tree is
                                 // so deep that this has 2^31 entries or more
  /// The same object in models of one structure: alike but for names, masses, placements, armatures, coefficients of
  /// damping and friction, limits. What is analysed of one holds for all of them.
  std::shared_ptr<const struct ModelStructure> structure;

  int njoints() const { return static_cast<int>(joints.size()); }  // movable ones, the floating base included
  int nu() const { return static_cast<int>(actuated.size()); }     // coordinates with a torque
  int first_actuated() const { return floating_base ? 6 : 0; }     // the first coordinate that is not a floating base's
  /// Index of the frame called `name`, -1 if there is none.
  int find_frame(const std::string& frame_name) const;
  /// Index of the joint called `name`, -1 if there is none.
  int find_joint(const std::string& joint_name) const;
  /// The first of a joint's torques in u, -1 when it has none.
  int torque_of(const Joint& joint) const;
  /// Total mass, kg.
  double mass() const;
};

/// Fills idx_q, idx_v and all derived fields from joints, frames and armature (an empty armature becomes zero).
/// Throws std::invalid_argument when joints are not numbered depth first, parents before children, or a vector of
/// coefficients has another size.
void finalize(Model& model);

/// Entries of M's packed storage. Throws std::length_error where M_begin is empty.
std::size_t packed_size(const Model& model);

/// Whether finalize has run since joints were added or taken away: the derived fields fit the joints.
bool is_finalized(const Model& model);

/// The neutral configuration: zeros, unit quaternions.
Eigen::VectorXd neutral(const Model& model);

/// "knee", or "root[0]" for a coordinate of a joint with several.
std::string dof_name(const Model& model, int dof);

}  // namespace manycontact
