// Bounds the energy that springs between points give to the bodies in semi-implicit Euler steps.
//
// If bodies rotate far in a step, ends of springs move otherwise than the step's linear equations predict, and errors
// of stiff springs may accumulate. A cluster is a set of robots coupled by springs and contacts. Each cluster has an
// account of the energy that its springs may give, as in a passivity observer (Hannaford and Ryu, IEEE Trans. Robotics
// and Automation 18, 2002). The account starts with the energy of the springs. A step takes from the account the energy
// of the bodies at its end, minus their energy after a step without springs, minus the work of other forces. Errors of
// the step without springs are weighted by twice the ratio of the account's maximum so far to the kinetic energy
// relative to the rigid motion, at most by 1. If a step would overdraw the account, velocities relative to the
// cluster's rigid-body motion (from its momentum) are scaled down. A cluster fixed to the world has no rigid motion.
// Errors that alternate in sign, as in explicit steps, cancel in the account. The linear equations dissipate energy of
// springs that are faster than the step. If such springs gain energy because their ends rotate far, a cluster fixed to
// the world makes a shorter step.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "internal.hpp"
#include "manycontact/detail/algorithm/energy.hpp"
#include "resisting_forces.hpp"

namespace manycontact::internal {

namespace {

constexpr double kSmaller = 0.7;  // factor by which each trial shortens a step
constexpr int kMostTrials = 60;
constexpr double kFast = 10;        // springs with a larger h^2 k / m are fast: the linear step dissipates their energy
constexpr double kRounding = 1e-9;  // rounding errors of the energies of fast springs, relative to these energies

int moving_end(const Spring& spring) { return moves(spring.A) ? spring.A.robot : spring.B.robot; }

void find_tied(const Scene& scene, const FreeGroups& groups, BoundedEnergy& e) {
  e.tied.assign(scene.robots.size(), 0);
  const auto tie = [&](int robot) { e.tied[e.cluster[robot]] = 1; };
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
  const int first = e.first[cluster];
  return {e.members.data() + first, static_cast<std::size_t>(e.first[static_cast<std::size_t>(cluster) + 1] - first)};
}

// Sorts the free groups (detail/simulation/momentum.hpp) by the cluster that contains them, into e.members.
void sort_groups(const FreeGroups& groups, BoundedEnergy& e) {
  e.of_group.assign(groups.groups.size(), -1);
  e.first.assign(e.cluster.size() + 1, 0);
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    int& cluster = e.of_group[groups.group[j.node]];
    if (cluster >= 0 || group_at(groups, j.node).tied) continue;
    cluster = e.cluster[j.robot];
    ++e.first[static_cast<std::size_t>(cluster) + 1];
  }
  std::partial_sum(e.first.begin(), e.first.end(), e.first.begin());
  e.members.resize(static_cast<std::size_t>(e.first.back()));
  for (int g = static_cast<int>(groups.groups.size()) - 1; g >= 0; --g)
    if (const int cluster = e.of_group[g]; cluster >= 0)
      e.members[--e.first[static_cast<std::size_t>(cluster) + 1]] = g;
  std::rotate(e.first.begin(), e.first.begin() + 1, e.first.end());  // first: start of each cluster in members
  e.first.back() = static_cast<int>(e.members.size());
}

double& at_robot(Eigen::VectorXd& x, const BoundedEnergy& e, int robot) { return x[e.cluster[robot]]; }

// Sets e.kinetic to each cluster's kinetic energy, and `energy` to the sum of its kinetic and gravitational energy.
// d.at_rest.kin then belongs to q, v.
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

// Computes each cluster's energy after the step to x, minus the work of motors, wrenches, joints and the impulses h f.
void find_energies_of_step(const Scene& scene, const Eigen::VectorXd& x, const Eigen::VectorXd& f, double h,
                           SimulationData& d, BoundedEnergy& e, Eigen::VectorXd& energy) {
  find_energies(scene, d.next_q, d.next_v, d, e, energy);
  const Eigen::VectorXd& added = d.resisting->joints.to_add;
  for (int r = 0; r < scene.nrobots(); ++r)
    for (int i = scene.robots[r].idx_v; i < scene.robots[r].idx_v + scene.robots[r].model->nv; ++i)
      at_robot(energy, e, r) -= (d.h * d.w[i] - added[i] * x[i]) * (d.v[i] + x[i]) / 2;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int first = d.dynamics.f_offset[c]; first >= 0) {
      const int n = scene.contacts[c].rows();
      at_robot(energy, e, scene.contacts[c].A.robot) -=
          h * f.segment(first, n).dot(d.wanted.segment(first, n) + d.contact_v.segment(first, n)) / 2;
    }
}

// Computes the clusters' rigid motions and the kinetic energy relative to these motions. Requires find_energies.
void find_relative_motion(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  find_tied(scene, d.free_groups, e);
  sort_groups(d.free_groups, e);
  measure(scene, d.at_rest.kin, d.free_groups);
  e.bodies.resize(e.cluster.size());
  e.relative = e.kinetic;
  for (int c = 0; c < scene.nrobots(); ++c) {
    const std::span<const int> groups = groups_of(c, e);
    if (groups.empty() || e.tied[c]) continue;
    const OneBody& body = e.bodies[c] = one_body(groups, d.free_groups);
    e.relative[c] -= (body.m * body.V.squaredNorm() + body.w.dot(body.I * body.w)) / 2;
  }
}

// Computes e.rigid_v (nv), the velocities of the clusters' rigid motions.
void find_rigid_velocities(const Scene& scene, const SimulationData& d, BoundedEnergy& e) {
  e.rigid_v.setZero(scene.nv);
  for (const FreeGroups::FreeJoint& j : d.free_groups.joints) {
    const auto c = static_cast<std::size_t>(e.cluster[j.robot]);
    if (j.parent != 0 || e.tied[c]) continue;
    const OneBody& body = e.bodies[c];
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    const SE3<double>& M = d.at_rest.kin[j.robot].oMi[j.joint];
    const Vec3<double> from_C = d.at_rest.kin[j.robot].origin(j.joint) + M.p - body.C;
    auto v = e.rigid_v.segment(robot.idx_v + joint.idx_v, joint.nv());
    add_motion(joint, M.R.transpose() * (body.V + body.w.cross(from_C)), M.R.transpose() * body.w, v);
  }
}

// Scales down velocities relative to the rigid motion in clusters whose springs gave more energy than the account has.
void take_back(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  find_rigid_velocities(scene, d, e);
  e.share.setOnes(scene.nrobots());
  for (int c = 0; c < scene.nrobots(); ++c) {
    const double too_much = e.given[c] - e.account(c, 0);
    if (!(too_much > 0 && e.relative[c] > 0)) continue;
    const double taken = std::min(too_much, e.relative[c]);
    e.share[c] = std::sqrt(1 - taken / e.relative[c]);
    d.work.springs -= taken;
    e.given[c] -= taken, e.relative[c] -= taken;
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

// Computes per cluster the energy stored in all springs, and in those that are faster than the step (kFast).
void find_stretched(const Scene& scene, const SimulationData& d, bool at_start, BoundedEnergy& e,
                    BoundedEnergy::Stretched& out) {
  const ResistingSprings& s = *d.resisting->springs;
  for (Eigen::VectorXd* x : {&out.all, &out.fast}) x->setZero(scene.nrobots());
  if (at_start) e.fast_given.setZero(scene.nrobots());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    const Spring& spring = scene.springs[row.spring];
    const int c = e.cluster[moving_end(spring)];
    if (row.turns >= 0) continue;
    const double length = (place_of(spring.A, d.at_rest.kin) - place_of(spring.B, d.at_rest.kin)).norm(),
                 stretch = at_start ? row.e : length - spring.length, energy = row.k * stretch * stretch / 2;
    out.all[c] += energy;
    if (!(d.h * d.h * row.k * s.own[i] > kFast)) continue;
    out.fast[c] += energy;
    if (at_start) e.fast_given[c] += s.given[i];
  }
}

bool stretches_too_far(int c, const BoundedEnergy& e) {
  return e.at_end.fast[c] + e.fast_given[c] >
         e.at_start.fast[c] + kRounding * (e.at_start.fast[c] + std::abs(e.fast_given[c]));
}

// Shortens the step in clusters that are fixed to the world and whose fast springs gain energy.
void shorten_step(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  find_stretched(scene, d, true, e, e.at_start);
  if (e.at_start.fast.isZero(0) && e.fast_given.isZero(0)) return;
  find_tied(scene, d.free_groups, e);
  find_energies(scene, d.next_q, d.next_v, d, e, e.most);
  find_stretched(scene, d, false, e, e.at_end);
  const double first = e.kinetic.sum() + e.at_end.all.sum();
  for (int k = 0; k < kMostTrials; ++k) {
    e.share.setOnes(scene.nrobots());
    for (int c = 0; c < scene.nrobots(); ++c)
      if (e.tied[c] && stretches_too_far(c, e)) e.share[c] = kSmaller;
    if ((e.share.array() == 1).all()) break;
    for (int r = 0; r < scene.nrobots(); ++r)
      d.dynamics.a.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) *= at_robot(e.share, e, r);
    for (std::size_t c = 0; c < scene.contacts.size(); ++c)
      if (const int at = d.dynamics.f_offset[c]; at >= 0)
        d.contact_v.segment(at, scene.contacts[c].rows()) *= at_robot(e.share, e, scene.contacts[c].A.robot);
    end_step(scene, d.dynamics.a, d);
    e.fast_given += e.kinetic.cwiseProduct(e.share.cwiseAbs2()) - e.kinetic;
    find_energies(scene, d.next_q, d.next_v, d, e, e.most);
    find_stretched(scene, d, false, e, e.at_end);
  }
  d.work.springs += e.kinetic.sum() + e.at_end.all.sum() - first;
}

// Computes a bound of the energy of springs after another step. It is twice the energy of the stretch that results if
// the ends continue to move as in this step, reduced by the damping of the implicit step.
void find_most(const Scene& scene, const SimulationData& d, Eigen::VectorXd& most) {
  const ResistingSprings& s = *d.resisting->springs;
  most.setZero(scene.nrobots());
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const ResistingSprings::Row& row = s.rows[i];
    if (row.turns >= 0) continue;
    const Spring& spring = scene.springs[row.spring];
    const Vec3<double> ends = place_of(spring.A, d.at_rest.kin) - place_of(spring.B, d.at_rest.kin);
    const double moved = (ends - d.applied->springs[row.spring].d).norm();
    const double stretch = std::abs(ends.norm() - spring.length) + moved;
    most[d.resisting->bounded.cluster[moving_end(spring)]] +=
        row.k * stretch * stretch / (1 + d.h * d.h * row.k * s.own[i]);
  }
}

}  // namespace

void begin_bound(const Scene& scene, bool goes_on, SimulationData& d) {
  if (!d.resisting || !d.resisting->springs) return;
  BoundedEnergy& e = d.resisting->bounded;
  const ResistingSprings& s = *d.resisting->springs;
  find_robot_sets(scene, d.dynamics.active, true, e.cluster);
  e.most.setZero(scene.nrobots());  // energy stored in each cluster's springs at the start of the step
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const double stretch = d.applied->springs[k].length - scene.springs[k].length;
    at_robot(e.most, e, moving_end(scene.springs[k])) += scene.springs[k].stiffness * stretch * stretch / 2;
  }
  if (!goes_on || e.account.size() == 0)
    e.account.setConstant(scene.nrobots(), 2, std::numeric_limits<double>::quiet_NaN());
  for (int c = 0; c < scene.nrobots(); ++c)
    if (std::isnan(e.account(c, 0))) e.account.row(c).setConstant(e.most[c]);
  end_step(scene, s.without, d);
  find_energies_of_step(scene, s.without, s.f_without, 1, d, e, e.without);
  find_energies(scene, d.q, d.v, d, e, e.before);
  begin_free_motion(scene, d.dynamics.active, d.w, d.h, d.at_rest.kin, d.free_groups);
  find_relative_motion(scene, d, e);
}

void bound_energy(const Scene& scene, SimulationData& d) {
  if (!d.resisting || !d.resisting->springs) return;
  BoundedEnergy& e = d.resisting->bounded;
  shorten_step(scene, d, e);
  find_energies_of_step(scene, d.dynamics.a, d.dynamics.f, d.h, d, e, e.given);
  for (int c = 0; c < scene.nrobots(); ++c) {
    const double of_springs = 2 * e.account(c, 1) < e.relative[c] ? 2 * e.account(c, 1) / e.relative[c] : 1;
    e.given[c] += of_springs * (e.without[c] - e.before[c]) - e.without[c];
  }
  find_relative_motion(scene, d, e);
  if ((e.given.array() > e.account.col(0)).any()) take_back(scene, d, e);
  find_most(scene, d, e.most);
  e.account.col(0) = (e.account.col(0) - e.given.array()).cwiseMax(0).cwiseMin(e.most.array());
  e.account.col(1) = e.account.col(1).cwiseMax(e.account.col(0));
}

}  // namespace manycontact::internal
