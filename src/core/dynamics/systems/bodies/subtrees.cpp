// Solves an island by sparse-bodies subtree by subtree (kkt/bodies/subtrees.hpp). Subtrees of one shape are solved once
// they fill a SIMD batch. Their forces on the constrained bodies above are added to the contact forces last.

#include <algorithm>

#include "../../internal.hpp"
#include "bodies.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;

// Calls use(node of the subtree, robot of the island, joint of the robot) for each node of the subtree.
template <class Use>
void each_joint(const BodiesSystem& bodies, const BodySubtree& subtree, Use&& use) {
  const std::vector<int>& offset = bodies.factor.system.pattern->node_offset;
  std::size_t robot = 0;
  for (int i = 0; i < subtree.pattern->nodes; ++i) {
    while (robot + 1 < offset.size() && offset[robot + 1] <= subtree.node[i]) ++robot;
    use(i, robot, subtree.node[i] - offset[robot]);
  }
}

// Evaluates the matrix and the right-hand side of a subtree's equations. The constrained body above, if any, has a
// known acceleration, which is added to the right-hand side of the subtree's root bodies.
void evaluate_subtree(const Scene& scene, const SceneData& data, BodiesSystem& bodies, const BodySubtree& subtree,
                      BodiesSystem::Slot& slot) {
  BodySystem& s = slot.system;
  BodyVectors& b = slot.solution.b;
  slot.subtree = &subtree;
  s.S.setZero();  // the slot's previous subtree has the same shape, but may have joints of different types
  each_joint(bodies, subtree, [&](int i, std::size_t robot, int joint) {
    evaluate_node(scene, data, bodies, robot, joint, i, s.pattern->first_dof[i], s, b);
    if (s.pattern->parent[i] < 0 && subtree.above >= 0) b.motion[i] += motion_at(bodies.held[subtree.above].a, s.r[i]);
  });
  int first = 0;
  for (int k : subtree.contact) {
    const int contact = bodies.owner.island.contacts[k], rows = scene.contacts[contact].rows();
    evaluate_rows(scene, data, bodies, k, first, s, b);
    for (int i = 0; i < rows; ++i) slot.row[first + i] = data.f_offset[contact] + i;
    first += rows;
  }
}

// Factorizes a cut's rows and solves for its body's acceleration. Returns false if factorize_hold finds them dependent.
bool hold_body(const BodiesSystem::Slot& slot, const BodyCut& cut, HeldBody& held) {
  if (!factorize_hold(slot.system, cut.node, cut.row, 6, held.hold)) return false;
  V6 g;
  for (int k = 0; k < 6; ++k) {
    g[k] = slot.solution.b.rows[cut.row[k]];
    held.row[k] = slot.row[cut.row[k]];
  }
  held.a = held.hold.Q * solve_transposed(held.hold, g);  // G^T a = g, G = Q R
  return true;
}

// Copies a subtree's accelerations and contact forces to data.a and data.f.
void put_subtree(const Scene& scene, SceneData& data, const BodiesSystem& bodies, const BodiesSystem::Slot& slot) {
  const BodySubtree& subtree = *slot.subtree;
  const BodyPattern& p = *subtree.pattern;
  const BodyVectors& x = slot.solution.x;
  each_joint(bodies, subtree, [&](int i, std::size_t k, int joint) {
    const Robot& robot = scene.robots[bodies.owner.island.robots[k]];
    const int to = robot.idx_v + robot.model->joints[joint].idx_v;
    data.a.segment(to, p.ndof[i]) = x.joints.segment(p.first_dof[i], p.ndof[i]);
  });
  for (int row = 0; row < p.nc; ++row) data.f[slot.row[row]] = -x.rows[row];
}

// Computes a subtree's force on the body above. Returns the relative part that the body's six rows cannot support.
double reaction_of(const BodiesSystem::Slot& slot, const BodyHold& hold, V6& reaction) {
  const BodyPattern& p = *slot.subtree->pattern;
  V6 size = V6::Zero();
  reaction.setZero();
  for (int i = 0; i < p.nodes; i = p.end[i]) {
    const V6 f = force_from(slot.solution.x.force[i], slot.system.r[i]);
    reaction += f, size += f.cwiseAbs();
  }
  const V6 left = reaction - hold.Q * (hold.Q.transpose() * reaction).eval();
  const double worst = size.maxCoeff();
  return worst == 0 ? 0 : left.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / worst;
}

// Solves subtrees in a shape's slots in a SIMD batch, then failed ones alone. Returns false if one has no solution.
bool solve_filled(const Scene& scene, SceneData& data, BodiesSystem& bodies, BodiesSystem::Shape& shape,
                  BodyAnswer& answer) {
  shape.side_by_side.clear();
  for (std::size_t k = 0; k < shape.filled; ++k)
    shape.side_by_side.push_back({&shape.slots[k].system, &shape.slots[k].solution, false, 0, {}});
  if (shape.lanes && shape.filled > 0) shape.lanes->solve(shape.side_by_side);
  for (std::size_t k = 0; k < shape.filled; ++k) {
    BodiesSystem::Slot& slot = shape.slots[k];
    auto& [system, solution, sound, factor_nonzeros, refinement] = shape.side_by_side[k];
    if (!sound) {
      if (factorize_and_solve(*system, shape.ldl, bodies.dependence, *solution, refinement) != Reason::kNone)
        return false;
      factor_nonzeros = nonzeros(*shape.pattern, shape.ldl);
    }
    put_subtree(scene, data, bodies, slot);
    if (const int above = slot.subtree->above; above >= 0) {
      const double left = reaction_of(slot, bodies.held[above].hold, bodies.reaction[above]);
      if (!(left <= tolerance::kConverged)) return false;
      refinement.backward_error = std::max(refinement.backward_error, left);
    }
    answer.add(factor_nonzeros, solution->residual, refinement);
  }
  shape.filled = 0;
  return true;
}

}  // namespace

bool solve_by_subtrees(const Scene& scene, SceneData& data, BodiesSystem& bodies, BodyAnswer& answer) {
  if (bodies.shapes.empty() || scene.damping > 0) return false;
  for (BodiesSystem::Shape& shape : bodies.shapes) shape.filled = 0;
  begin_evaluation(scene, data, bodies);
  for (const BodySubtree& subtree : bodies.subtrees->subtrees) {
    BodiesSystem::Shape& shape = bodies.shapes[subtree.shape];
    BodiesSystem::Slot& slot = shape.slots[shape.filled++];
    evaluate_subtree(scene, data, bodies, subtree, slot);
    for (int c = subtree.first_cut; c < subtree.end_cut; ++c)
      if (!hold_body(slot, bodies.subtrees->cuts[c], bodies.held[c])) return false;
    if (shape.filled == shape.slots.size() && !solve_filled(scene, data, bodies, shape, answer)) return false;
  }
  for (BodiesSystem::Shape& shape : bodies.shapes)
    if (!solve_filled(scene, data, bodies, shape, answer)) return false;
  for (std::size_t c = 0; c < bodies.held.size(); ++c) {
    const V6 y = forces_of(bodies.held[c].hold, bodies.reaction[c]);
    for (int k = 0; k < 6; ++k) data.f[bodies.held[c].row[k]] += y[k];  // f = -y
  }
  return true;
}

}  // namespace manycontact::internal
