#pragma once
// A model describes one robot (or object) as a kinematic tree. It is constant once finalized, and shared by all copies
// of the robot in a scene. Joints are numbered so that a parent comes before its children.

#include <memory>
#include <string>
#include <vector>

#include "manycontact/model/joint.hpp"

namespace manycontact {

/// A named frame fixed to a joint's body: a link of the file, or a link merged into that body through fixed joints.
struct Frame {
  std::string name;
  JointIndex joint = -1;     // -1: fixed to the robot's base
  SE3<double> placement;     // placement in the joint's frame (in the base frame when joint = -1)
  bool merged = false;       // whether the link is attached to its joint's body by fixed or locked joints
  Inertia<double> inertia;   // inertia of this link alone, in this frame; the joint's inertia already contains it
  std::string parent_joint;  // joint of the file whose child is the link; may be a fixed joint; empty for the root
};

/// Elements of the robot's file that were merged, locked, or not modelled, for reports and error messages.
struct ModelNotes {
  std::vector<std::string> merged;    // names of fixed joints
  std::vector<std::string> locked;    // names of joints frozen at a position
  std::vector<std::string> mimic;     // names of joints with <mimic> that are kept independent
  std::vector<std::string> dynamics;  // joints whose <dynamics> damping or friction is not modelled
};

/// A tree of joints. With a floating base, all joints form one tree. Each joint attached to a fixed base starts a tree.
struct Tree {
  int root = 0;           // number of the first joint
  std::vector<int> path;  // joints from the root to the anchor, the body with the origin of the tree frame
};

/// Coulomb friction is smoothed below about this speed [rad/s, m/s], instead of jumping at zero.
constexpr double kFrictionVelocity = 0.01;

struct Model {  // A robot's joints, frames and inertias.
  std::string name;
  bool floating_base = false;  // joint 0 is the floating base
  std::vector<Joint> joints;
  std::vector<Frame> frames;
  Eigen::VectorXd armature;  // nv, kg m^2 (kg for prismatic): reflected rotor inertia, on M's diagonal
  // Damping and friction: every coordinate has the torque -damping v - friction tanh(v / kFrictionVelocity). They have
  // nv entries each, or none if they are not modelled.
  Eigen::VectorXd damping;   // N m s / rad, N s / m
  Eigen::VectorXd friction;  // N m, N: Coulomb friction, smoothed around zero velocity so that it is differentiable
  ModelNotes notes;

  // These members are computed by finalize.
  int nq = 0, nv = 0;
  std::vector<int> actuated;     // coordinates with torques in u: all except those of floating bases and passive joints
  std::vector<int> dof_parent;   // nv: the next coordinate towards the base; -1: none
  std::vector<int> dof_joint;    // nv: the coordinate's joint
  std::vector<int> dof_depth;    // nv: the coordinate's number of ancestors
  std::vector<int> subtree_end;  // one past the last joint of each joint's subtree; joints are numbered depth first
  std::vector<Tree> trees;       // sorted by their roots
  std::vector<int> tree_of;      // one entry per joint: the number of its tree
  std::vector<char> on_path;     // one entry per joint: whether it is on its tree's path
  std::vector<int> M_begin;      // nv+1: start of row i of the packed M (detail/algorithm/crba.hpp). Empty if the
                                 // tree is so deep that M has 2^31 entries or more.
  /// Shared by models that are identical except for names, masses, placements, armatures, damping, friction and limits.
  /// The analysis of one of these models is valid for all of them.
  std::shared_ptr<const struct ModelStructure> structure;

  int njoints() const { return static_cast<int>(joints.size()); }  // movable joints, the floating base included
  int nu() const { return static_cast<int>(actuated.size()); }     // number of coordinates with a torque
  /// Returns the first velocity coordinate that does not belong to a floating base.
  int first_actuated() const { return floating_base ? 6 : 0; }
  /// Returns the index of the frame with the given name, or -1.
  int find_frame(const std::string& frame_name) const;
  /// Returns the index of the joint with the given name, or -1.
  JointIndex find_joint(const std::string& joint_name) const;
  /// Returns the index of a joint's first torque in the robot's u, or -1 if the joint has no torque.
  int torque_index(const Joint& joint) const;
  /// Returns the total mass [kg].
  double mass() const;
};

/// Computes idx_q, idx_v and all derived fields from joints, frames and armature; an empty armature becomes zeros.
/// Throws std::invalid_argument if joints are not numbered depth first, parents before children, or if armature,
/// damping or friction has a wrong size.
void finalize(Model& model);

/// Returns the number of entries of the packed joint-space inertia M. Throws std::length_error if M_begin is empty.
std::size_t packed_size(const Model& model);

/// Returns whether finalize was called since joints were last added or removed.
bool is_finalized(const Model& model);

/// Returns the neutral configuration (nq): zeros and unit quaternions.
Eigen::VectorXd neutral(const Model& model);

/// Returns the name of velocity coordinate `dof`: "knee", or "root[0]" for a joint with several coordinates.
std::string dof_name(const Model& model, int dof);

}  // namespace manycontact
