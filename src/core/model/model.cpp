#include "manycontact/model/model.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "manycontact/model/interned.hpp"

namespace manycontact {

int Model::find_frame(const std::string& frame_name) const {
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (frames[i].name == frame_name) return static_cast<int>(i);
  return -1;
}

int Model::find_joint(const std::string& joint_name) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == joint_name) return static_cast<int>(i);
  return -1;
}

int Model::torque_index(const Joint& joint) const {
  const auto at = std::lower_bound(actuated.begin(), actuated.end(), joint.idx_v);
  return at != actuated.end() && *at == joint.idx_v ? static_cast<int>(at - actuated.begin()) : -1;
}

double Model::mass() const {
  double m = 0;
  for (const Joint& j : joints) m += j.inertia.m;
  return m;
}

namespace {

int axis_kind(const Vec3<double>& axis) {
  for (int k = 0; k < 3; ++k)
    if (axis == Vec3<double>::Unit(k)) return k;
  return 3;
}

// Computes subtree_end. Throws std::invalid_argument if joints are not numbered depth first.
void number_subtrees(Model& model) {
  const int n = model.njoints();
  model.subtree_end.assign(n, 0);
  for (int i = n - 1; i >= 0; --i) {
    const int parent = model.joints[i].parent;
    if (parent >= i) throw std::invalid_argument("finalize: a joint's parent must come before it");
    model.subtree_end[i] = std::max(model.subtree_end[i], i + 1);
    if (parent >= 0) model.subtree_end[parent] = std::max(model.subtree_end[parent], model.subtree_end[i]);
  }
  for (int i = 1; i < n; ++i) {
    const int parent = model.joints[i].parent;
    int k = i - 1;
    while (k >= 0 && k != parent) k = model.joints[k].parent;
    if (k != parent) throw std::invalid_argument("finalize: joints must be numbered depth first");
  }
}

// Returns the joints that place a robot in the world, e.g. along x and y. From the root, each is followed by the child
// whose subtree has more than half of the joints below it, if there is one. They have at most six coordinates. The last
// is not revolute, unless it is the root.
std::vector<int> path_to_anchor(const Model& model, int root) {
  constexpr int kBaseCoordinates = 6;
  std::vector<int> path{root};
  std::size_t length = 1;
  for (int j = root, coordinates = model.joints[root].nv(); !model.floating_base;) {
    int next = -1, joints = (model.subtree_end[j] - j - 1) / 2;  // number in next's subtree; at first half below j
    for (int child = j + 1; child < model.subtree_end[j]; child = model.subtree_end[child])
      if (model.subtree_end[child] - child > joints) next = child, joints = model.subtree_end[child] - child;
    if (next < 0 || (coordinates += model.joints[next].nv()) > kBaseCoordinates) break;
    path.push_back(j = next);
    if (model.joints[j].type != JointType::kRevolute) length = path.size();
  }
  path.resize(length);
  return path;
}

void find_trees(Model& model) {
  model.trees.clear();
  model.tree_of.assign(model.joints.size(), 0);
  model.on_path.assign(model.joints.size(), 0);
  for (int i = 0; i < model.njoints(); ++i) {
    if (model.joints[i].parent < 0) {
      model.trees.push_back({i, path_to_anchor(model, i)});
      for (int j : model.trees.back().path) model.on_path[j] = 1;
    }
    model.tree_of[i] = static_cast<int>(model.trees.size()) - 1;
  }
}

std::vector<int> actuated_coordinates(const Model& model) {  // call after idx_v is set
  std::vector<int> out;
  for (int i = model.floating_base ? 1 : 0; i < model.njoints(); ++i)
    for (int k = 0; k < model.joints[i].nv() && model.joints[i].actuated; ++k) out.push_back(model.joints[i].idx_v + k);
  return out;
}

// Returns a key with all properties of a model on which patterns and the branches of the algorithms depend.
std::vector<std::uint64_t> key_of(const Model& model) {
  std::vector<std::uint64_t> key{model.floating_base};
  key.reserve(1 + 8 * model.joints.size());
  for (const Joint& joint : model.joints) {
    key.insert(key.end(), {static_cast<std::uint64_t>(joint.parent), static_cast<std::uint64_t>(joint.type),
                           joint.actuated, joint.placement_rotates, static_cast<std::uint64_t>(joint.axis_kind)});
    for (int k = 0; k < 3 && joint.axis_kind == 3; ++k)
      key.push_back(std::bit_cast<std::uint64_t>(joint.axis[k] + 0.0));  // + 0.0 makes -0 equal to 0
  }
  return key;
}

}  // namespace

struct ModelStructure {};  // only its address is used; models of one structure share it

void finalize(Model& model) {
  number_subtrees(model);
  find_trees(model);
  model.nq = model.nv = 0;
  model.dof_parent.clear();
  model.dof_joint.clear();
  model.dof_depth.clear();
  for (int i = 0; i < model.njoints(); ++i) {
    Joint& joint = model.joints[i];
    joint.idx_q = model.nq;
    joint.idx_v = model.nv;
    joint.axis_kind = axis_kind(joint.axis);
    joint.placement_rotates = joint.placement.R != Mat3<double>::Identity();
    model.nq += joint.nq();
    model.nv += joint.nv();
    for (int k = 0; k < joint.nv(); ++k) {
      int parent = joint.idx_v + k - 1;
      if (k == 0) {
        const int pj = joint.parent;
        parent = pj < 0 ? -1 : model.joints[pj].idx_v + model.joints[pj].nv() - 1;
      }
      model.dof_parent.push_back(parent);
      model.dof_joint.push_back(i);
      model.dof_depth.push_back(parent < 0 ? 0 : model.dof_depth[parent] + 1);
    }
  }
  model.actuated = actuated_coordinates(model);
  model.M_begin.assign(1, 0);
  for (int i = 0; i < model.nv; ++i) {
    if (model.M_begin[i] > std::numeric_limits<int>::max() - model.dof_depth[i] - 1) {
      model.M_begin.clear();
      break;
    }
    model.M_begin.push_back(model.M_begin[i] + model.dof_depth[i] + 1);
  }
  if (model.armature.size() == 0) model.armature = Eigen::VectorXd::Zero(model.nv);
  for (const Eigen::VectorXd* x : {&model.damping, &model.friction})
    if (x->size() != 0 && x->size() != model.nv)
      throw std::invalid_argument("finalize: damping and friction must have nv entries, or none");
  if (model.armature.size() != model.nv) throw std::invalid_argument("finalize: armature must have nv entries");
  static Interned<const ModelStructure> structures;
  model.structure = structures.find(key_of(model), [] { return std::make_shared<const ModelStructure>(); }).object;
}

std::size_t packed_size(const Model& model) {
  if (model.M_begin.empty())
    throw std::length_error("'" + model.name + "' is so deep that its joint-space inertia has 2^31 entries or more");
  return model.M_begin.back();
}

bool is_finalized(const Model& model) {
  int nq = 0, nv = 0;
  for (const Joint& joint : model.joints) {
    if (joint.idx_q != nq || joint.idx_v != nv) return false;
    nq += joint.nq();
    nv += joint.nv();
  }
  const auto n = static_cast<std::size_t>(nv);
  return model.nq == nq && model.nv == nv && model.actuated == actuated_coordinates(model) &&
         model.dof_parent.size() == n && model.dof_joint.size() == n && model.dof_depth.size() == n &&
         model.subtree_end.size() == model.joints.size() && model.tree_of.size() == model.joints.size() &&
         (model.M_begin.size() == n + 1 || (model.M_begin.empty() && n > 0)) && model.armature.size() == nv &&
         model.structure;
}

Eigen::VectorXd neutral(const Model& model) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.nq);
  for (const Joint& j : model.joints)
    if (j.type == JointType::kFloating) q[j.idx_q + 6] = 1;
  return q;
}

std::string dof_name(const Model& model, int dof) {
  const Joint& joint = model.joints[model.dof_joint[dof]];
  if (joint.nv() == 1) return joint.name;
  return joint.name + "[" + std::to_string(dof - joint.idx_v) + "]";
}

}  // namespace manycontact
