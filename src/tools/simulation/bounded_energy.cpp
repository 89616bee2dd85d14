// A bound on the energy that springs between points give.
//
// Ends of springs on bodies that rotate far in a step move otherwise than its linear equations foresee, and errors of
// stiff springs may add up. So each cluster of robots that springs and contacts join has an account of the energy that
// its springs may give. It begins with their energy. A step takes from it what the energy of the bodies rises by beyond
// the work of all else. Where that is more than there is, velocities relative to the cluster's motion as one rigid
// body, which follows from its momentum, are scaled such that the step takes what there is. A cluster that the world
// constrains rests as a body. There, springs faster than the step may not stretch so far by rotations that energy
// rises: all moves by a share of the step then. Errors that come and go, as those of explicit steps do, pass through
// the account.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "internal.hpp"
#include "manycontact/algorithm/energy.hpp"
#include "one_body.hpp"
#include "resisting_forces.hpp"
#include "robot_sets.hpp"

namespace manycontact::internal {

namespace {

constexpr double kSmaller = 0.7;  // share of a step, at a time
constexpr int kMostTrials = 60;
constexpr double kFast = 10;   // h^2 k / m of springs whose linear step lets energy fall
constexpr double kFar = 0.01;  // of the kinetic energy: what a step can make of that of springs, stretched by rotations

int moving_end(const Spring& spring) { return moves(spring.A) ? spring.A.robot : spring.B.robot; }

// Finds the clusters that the world constrains.
void find_tied(const Scene& scene, const FreeGroups& groups, BoundedEnergy& e) {
  e.tied.assign(scene.robots.size(), 0);
  const auto tie = [&](int robot) { e.tied[static_cast<std::size_t>(e.cluster[robot])] = 1; };
  for (int r = 0; r < scene.nrobots(); ++r) {
    const std::vector<Joint>& joints = scene.robots[r].model->joints;
    for (std::size_t i = 0; i < joints.size(); ++i)
      if (joints[i].parent < 0 && groups.node[static_cast<std::size_t>(groups.first_body[r]) + i] == 0) tie(r);
  }
  for (const FreeGroups::FreeJoint& j : groups.joints)
    if (group_at(groups, j.node).tied) tie(j.robot);
  for (const Spring& spring : scene.springs)
    if (!moves(spring.A) || !moves(spring.B)) tie(moving_end(spring));
}

std::span<const int> groups_of(int cluster, const BoundedEnergy& e) {
  const int first = e.first[static_cast<std::size_t>(cluster)];
  return {e.members.data() + first, static_cast<std::size_t>(e.first[static_cast<std::size_t>(cluster) + 1] - first)};
}

// Free groups, cluster by cluster.
void sort_groups(const FreeGroups& groups, BoundedEnergy& e) {
  e.of_group.assign(groups.groups.size(), -1);
  e.first.assign(e.cluster.size() + 1, 0);
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    int& cluster = e.of_group[static_cast<std::size_t>(groups.group[static_cast<std::size_t>(j.node)])];
    if (cluster >= 0 || group_at(groups, j.node).tied) continue;
    cluster = e.cluster[static_cast<std::size_t>(j.robot)];
    ++e.first[static_cast<std::size_t>(cluster) + 1];
  }
  std::partial_sum(e.first.begin(), e.first.end(), e.first.begin());
  e.members.resize(static_cast<std::size_t>(e.first.back()));
  for (int g = static_cast<int>(groups.groups.size()) - 1; g >= 0; --g)
    if (const int cluster = e.of_group[static_cast<std::size_t>(g)]; cluster >= 0)
      e.members[static_cast<std::size_t>(--e.first[static_cast<std::size_t>(cluster) + 1])] = g;
  std::rotate(e.first.begin(), e.first.begin() + 1, e.first.end());  // first: where each cluster begins in members
  e.first.back() = static_cast<int>(e.members.size());
}

// Velocities of the clusters as rigid bodies, at the end of the step.
void find_rigid_motion(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  FreeGroups& groups = d.free_groups;
  find_tied(scene, groups, e);
  sort_groups(groups, e);
  measure(scene, d.at_rest.kin, groups);
  e.rigid_v.setZero(scene.nv);
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const int c = e.cluster[static_cast<std::size_t>(j.robot)];
    if (j.parent != 0 || e.tied[static_cast<std::size_t>(c)]) continue;
    const OneBody body = one_body(groups_of(c, e), groups);
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    const SE3<double>& M = d.at_rest.kin[j.robot].oMi[j.joint];
    const Vec3<double> from_C = d.at_rest.kin[j.robot].origin(j.joint) + M.p - body.C;
    auto v = e.rigid_v.segment(robot.idx_v + joint.idx_v, joint.nv());
    add_motion(joint, M.R.transpose() * (body.V + body.w.cross(from_C)), M.R.transpose() * body.w, v);
  }
}

double& at_robot(Eigen::VectorXd& x, const BoundedEnergy& e, int robot) {
  return x[e.cluster[static_cast<std::size_t>(robot)]];
}

// Kinetic and total energy of each cluster but that of its springs between points; kinematics are at q, v then.
void find_energies(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, SimulationData& d,
                   BoundedEnergy& e, Eigen::VectorXd& energy) {
  kinematics_at(scene, q, v, d.at_rest.kin);
  e.kinetic.setZero(scene.nrobots());
  energy.setZero(scene.nrobots());
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Robot& robot = scene.robots[r];
    const Kinematics<double>& kin = d.at_rest.kin[r];
    at_robot(e.kinetic, e, r) += kinetic_energy<double>(*robot.model, kin, v.segment(robot.idx_v, robot.model->nv));
    at_robot(energy, e, r) += potential_energy<double>(kin, scene.gravity);
  }
  energy += e.kinetic;
}

// Adds the most that motors, external wrenches, joints and contacts gave in the step, whose end is x.
void add_work(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  const Eigen::VectorXd& added = d.resisting->joints.to_add;
  for (int r = 0; r < scene.nrobots(); ++r)
    for (int i = scene.robots[r].idx_v; i < scene.robots[r].idx_v + scene.robots[r].model->nv; ++i)
      at_robot(e.before, e, r) += (d.h * d.w[i] - added[i] * d.dynamics.a[i]) * (d.v[i] + d.dynamics.a[i]) / 2;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int first = d.dynamics.f_offset[c]; first >= 0) {
      const int n = scene.contacts[c].rows();
      const double work =
          d.h / 2 * d.dynamics.f.segment(first, n).dot(d.wanted.segment(first, n) + d.contact_v.segment(first, n));
      at_robot(e.before, e, scene.contacts[c].A.robot) += std::max(0.0, work);
    }
}

double excess(int c, const BoundedEnergy& e) { return e.after[c] - e.before[c] - e.stored[c]; }

// Scales the velocities relative to the rigid motion of a cluster down if its springs gave too much energy.
void take_back(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  find_rigid_motion(scene, d, e);
  e.share = e.kinetic;
  find_energies(scene, d.next_q, e.rigid_v, d, e, e.most);
  for (int c = 0; c < scene.nrobots(); ++c) {
    const double moves = e.share[c] - e.kinetic[c], too_much = excess(c, e);
    const double left = too_much > 0 && moves > 0 ? std::max(0.0, 1 - too_much / moves) : 1;
    e.share[c] = std::sqrt(left);
    d.work.springs -= (1 - left) * moves;
    e.after[c] -= (1 - left) * moves;
  }
  for (int r = 0; r < scene.nrobots(); ++r) {
    const double share = at_robot(e.share, e, r);
    const int at = scene.robots[r].idx_v, n = scene.robots[r].model->nv;
    auto taken = e.rigid_v.segment(at, n);
    taken = (1 - share) * (d.next_v.segment(at, n) - taken);
    d.dynamics.a.segment(at, n) -= taken;
    d.next_v.segment(at, n) -= taken;
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int at = d.dynamics.f_offset[c]; at >= 0)
      d.contact_v.segment(at, scene.contacts[c].rows()) *= at_robot(e.share, e, scene.contacts[c].A.robot);
}

// Energies of each cluster's springs: of all, of those faster than the step, and what a step can make of the latter.
void find_stretched(const Scene& scene, const SimulationData& d, bool at_start, const BoundedEnergy& e,
                    BoundedEnergy::Stretched& out) {
  const ResistingSprings& s = *d.resisting->springs;
  for (Eigen::VectorXd* x : {&out.all, &out.fast, &out.useful}) x->setZero(scene.nrobots());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    if (row.turns >= 0) continue;
    const Spring& spring = scene.springs[static_cast<std::size_t>(row.spring)];
    const double length = (place_of(spring.A, d.at_rest.kin) - place_of(spring.B, d.at_rest.kin)).norm(),
                 stretch = at_start ? row.e : length - spring.length, energy = row.k * stretch * stretch / 2;
    const double fast = d.h * d.h * row.k * s.own[static_cast<Eigen::Index>(i)];
    const int c = e.cluster[static_cast<std::size_t>(moving_end(spring))];
    out.all[c] += energy;
    if (fast > kFast) out.fast[c] += energy, out.useful[c] += energy / (1 + fast);
  }
}

bool stretches_too_far(int c, const BoundedEnergy& e) {
  return e.at_end.fast[c] > e.at_start.fast[c] && e.at_end.useful[c] > kFar * e.kinetic_before[c] &&
         e.after[c] + e.at_end.all[c] > e.before[c] + e.at_start.all[c];
}

// Ends the step with shares of its motion in clusters whose springs stretch too far.
void shorten_step(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  find_stretched(scene, d, true, e, e.at_start);
  find_stretched(scene, d, false, e, e.at_end);
  find_tied(scene, d.free_groups, e);
  double first = 0;
  for (int k = 0; k < kMostTrials; ++k) {
    e.share.setOnes(scene.nrobots());
    bool any = false;
    for (int c = 0; c < scene.nrobots(); ++c)
      if (e.tied[static_cast<std::size_t>(c)] && stretches_too_far(c, e)) e.share[c] = kSmaller, any = true;
    if (k == 0) first = e.after.sum() + e.at_end.all.sum();
    if (!any) break;
    for (int r = 0; r < scene.nrobots(); ++r)
      d.dynamics.a.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) *= at_robot(e.share, e, r);
    for (std::size_t c = 0; c < scene.contacts.size(); ++c)
      if (const int at = d.dynamics.f_offset[c]; at >= 0)
        d.contact_v.segment(at, scene.contacts[c].rows()) *= at_robot(e.share, e, scene.contacts[c].A.robot);
    end_step(scene, d.dynamics.a, d);
    find_energies(scene, d.next_q, d.next_v, d, e, e.after);
    find_stretched(scene, d, false, e, e.at_end);
  }
  d.work.springs += e.after.sum() + e.at_end.all.sum() - first;
}

// The most that springs can hold at the end of the step: twice the energy that they have if their ends move on as in
// this step, of what a step can make of it.
void find_most(const Scene& scene, const SimulationData& d, Eigen::VectorXd& most) {
  const ResistingSprings& s = *d.resisting->springs;
  most.setZero(scene.nrobots());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    if (row.turns >= 0) continue;
    const Spring& spring = scene.springs[static_cast<std::size_t>(row.spring)];
    const Vec3<double> ends = place_of(spring.A, d.at_rest.kin) - place_of(spring.B, d.at_rest.kin);
    const double moved = (ends - d.applied->springs[static_cast<std::size_t>(row.spring)].d).norm();
    const double stretch = std::abs(ends.norm() - spring.length) + moved;
    most[d.resisting->bounded.cluster[moving_end(spring)]] +=
        row.k * stretch * stretch / (1 + d.h * d.h * row.k * s.own[static_cast<Eigen::Index>(i)]);
  }
}

}  // namespace

void begin_bound(const Scene& scene, bool goes_on, SimulationData& d) {
  if (!d.resisting || !d.resisting->springs) return;
  BoundedEnergy& e = d.resisting->bounded;
  find_robot_sets(scene, d.dynamics.active, true, e.cluster);
  Eigen::VectorXd& now = e.after;
  now.setZero(scene.nrobots());
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const double stretch = d.applied->springs[k].length - scene.springs[k].length;
    at_robot(now, e, moving_end(scene.springs[k])) += scene.springs[k].stiffness * stretch * stretch / 2;
  }
  if (!goes_on || e.stored.size() == 0) e.stored.setConstant(scene.nrobots(), std::numeric_limits<double>::quiet_NaN());
  for (int c = 0; c < scene.nrobots(); ++c)
    if (std::isnan(e.stored[c])) e.stored[c] = now[c];
  find_energies(scene, d.q, d.v, d, e, e.before);
  e.kinetic_before = e.kinetic;
  add_work(scene, d, e);
}

void bound_energy(const Scene& scene, SimulationData& d) {
  if (!d.resisting || !d.resisting->springs) return;
  BoundedEnergy& e = d.resisting->bounded;
  find_energies(scene, d.next_q, d.next_v, d, e, e.after);
  shorten_step(scene, d, e);
  bool any = false;
  for (int c = 0; c < scene.nrobots(); ++c) any = any || excess(c, e) > 0;
  if (any) take_back(scene, d, e);
  find_most(scene, d, e.most);
  e.stored = (e.stored + e.before - e.after).cwiseMax(0).cwiseMin(e.most);
}

}  // namespace manycontact::internal
