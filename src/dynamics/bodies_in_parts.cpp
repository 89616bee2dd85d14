// An island by sparse-bodies where held bodies cut its trees (kkt/bodies/parts.hpp): each part is evaluated,
// factorized, solved and judged before the next, in memory that all alike parts share.

#include <algorithm>

#include "bodies.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"

namespace manycontact::internal {

namespace {

using V6 = Vec6<double>;

// use(node of the part, robot of the island, its joint) for each.
template <class Use>
void each_joint(const IslandWork& d, const BodyPart& part, Use&& use) {
  const std::vector<int>& offset = d.bodies->factor.system.pattern->node_offset;
  std::size_t robot = 0;
  for (int i = 0; i < part.pattern->nodes; ++i) {
    while (robot + 1 < offset.size() && offset[robot + 1] <= part.node[i]) ++robot;
    use(i, robot, part.node[i] - offset[robot]);
  }
}

// The equations of a part, its bases moved as the body above is.
void evaluate_part(const Scene& scene, const SceneData& data, const IslandWork& d, const BodyPart& part,
                   BodyForm::Part& work) {
  BodySystem& s = work.factor.system;
  BodyVectors& b = work.solution.b;
  s.S.setZero();  // alike parts may have joints of other types
  each_joint(d, part, [&](int i, std::size_t robot, int joint) {
    evaluate_node(scene, data, d, robot, joint, i, s.pattern->first_dof[i], s, b);
    if (s.pattern->parent[i] < 0 && part.above >= 0) b.motion[i] += motion_at(d.bodies->held[part.above].a, s.r[i]);
  });
  int first = 0;
  for (int k : part.contact) {
    evaluate_rows(scene, data, d, k, first, s, b);
    first += scene.contacts[d.island.contacts[k]].rows();
  }
}

// Accelerations and forces of a part.
void put_part(const Scene& scene, SceneData& data, const IslandWork& d, const BodyPart& part, BodyForm::Part& work) {
  const BodyPattern& p = *part.pattern;
  const BodyVectors& x = work.solution.x;
  each_joint(d, part, [&](int i, std::size_t k, int joint) {
    const Robot& robot = scene.robots[d.island.robots[k]];
    const int to = robot.idx_v + robot.model->joints[joint].idx_v;
    data.a.segment(to, p.ndof[i]) = x.joints.segment(p.first_dof[i], p.ndof[i]);
  });
  int first = 0;
  for (int c : part.contact) {
    const int contact = d.island.contacts[c], rows = scene.contacts[contact].rows(), to = data.f_offset[contact];
    data.f.segment(to, rows) = -x.rows.segment(first, rows);
    for (int i = 0; i < rows; ++i) work.row[first++] = to + i;
  }
}

// The rows of a held body give what its own part makes it need, without what hangs below. False: they depend on each
// other, or nearly.
bool hold_body(const BodyForm::Part& work, const BodyCut& cut, HeldBody& held) {
  held.a = work.solution.x.motion[cut.node];
  for (int k = 0; k < 6; ++k) held.row[k] = work.row[cut.row[k]];
  return factorize_hold(work.factor.system, cut.node, cut.row, 6, held.hold);
}

// What hangs on a held body pulls at it: f of its rows changes. Returns what of the pull they do not hold.
double pull_at(SceneData& data, const HeldBody& held, const BodyForm::Part& work) {
  const BodyPattern& p = *work.factor.system.pattern;
  V6 F = V6::Zero(), size = V6::Zero();
  for (int i = 0; i < p.nodes; i = p.end[i]) {
    const V6 f = force_from(work.solution.x.force[i], work.factor.system.r[i]);
    F += f, size += f.cwiseAbs();
  }
  const V6 y = forces_of(held.hold, F), left = F - held.hold.Q * (held.hold.Q.transpose() * F).eval();
  for (int k = 0; k < 6; ++k) data.f[held.row[k]] += y[k];  // f = -y
  const double worst = size.maxCoeff();
  return worst > 0 ? left.cwiseAbs().maxCoeff() / worst : 0;
}

}  // namespace

bool solve_in_parts(const Scene& scene, SceneData& data, IslandWork& d, IslandReport& report) {
  BodyForm& form = *d.bodies;
  if (form.work.empty() || scene.damping > 0) return false;
  form.in_parts = false;
  begin_evaluation(scene, data, d);
  BodyAnswer answer;
  for (const BodyPart& part : form.parts->parts) {
    BodyForm::Part& work = form.work[part.shape];
    evaluate_part(scene, data, d, part, work);
    sparse::Refinement refinement;
    if (factorize_and_solve(work.factor, work.solution, refinement) != Reason::kNone) return false;
    put_part(scene, data, d, part, work);
    for (int c = part.first_cut; c < part.end_cut; ++c)
      if (!hold_body(work, form.parts->cuts[c], form.held[c])) return false;
    if (part.above >= 0) {
      const double pull = pull_at(data, form.held[part.above], work);
      if (!(pull <= tolerance::kConverged)) return false;
      refinement.backward_error = std::max(refinement.backward_error, pull);
    }
    answer.add(work.factor, work.solution, refinement);
  }
  form.in_parts = true;
  report_bodies(scene, answer, d, report);
  return true;
}

}  // namespace manycontact::internal
