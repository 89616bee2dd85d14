// Energy of steps in which springs rotate bodies by angles too large for linear forces.
//
// A body that rotates by an angle x in a step leaves a spring's line by s x^2 / 2, which a spring that is faster than
// the step takes back at once. Bodies that rotate by radians are wrong in every linear term: energy may grow from step
// to step. So robots with such springs gain no energy except from motors, external wrenches and contacts. Where they
// did, only a share is left of their motion relative to that as one rigid body, which follows from their momentum
// (one_body.hpp). With a share of 0 no spring changes its length, and clusters fixed to the world stay at rest. A
// spring counts with what a step can make of its energy, k e^2 / 2 / (1 + h^2 k / m).

#include <algorithm>
#include <cmath>
#include <numeric>

#include "internal.hpp"
#include "manycontact/algorithm/energy.hpp"
#include "resisting_forces.hpp"
#include "robot_sets.hpp"

namespace manycontact::internal {

namespace {

constexpr double kTurn = 0.02, kFarTurn = 0.2;  // rad; with springs faster than the step, and with any
constexpr double kRounding = 1e-10;             // of the energies that are compared
constexpr double kSmaller = 0.7;                // at least, at a time
constexpr int kMostTrials = 60;

// The farthest turn of a robot's joint in the step.
double turn_of(const Robot& robot, const SimulationData& d) {
  double most = 0;
  for (const Joint& joint : robot.model->joints) {
    if (joint.type == JointType::kPrismatic) continue;
    const int n = joint.type == JointType::kFloating ? 3 : 1;  // coordinates that turn, the last
    most = std::max(most, d.h * d.next_v.segment(robot.idx_v + joint.idx_v + joint.nv() - n, n).norm());
  }
  return most;
}

int moving_end(const Spring& spring) { return moves(spring.A) ? spring.A.robot : spring.B.robot; }

// Per robot, whether it turns far for any spring, or for a spring on it that is faster than the step.
bool find_far(const Scene& scene, const SimulationData& d, BoundedEnergy& e) {
  e.turn.resize(scene.robots.size());
  e.far.resize(scene.robots.size());
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    e.turn[r] = turn_of(scene.robots[r], d);
    e.far[r] = e.turn[r] > kFarTurn;
  }
  if (const auto& s = d.resisting->springs)
    for (std::size_t i = 0; i < s->rows.size(); ++i) {
      const auto number = static_cast<std::size_t>(s->rows[i].spring);
      if (!(s->fast[number] > 1)) continue;
      const Spring& spring = scene.springs[number];
      const double turn = d.h * std::abs(s->rate[static_cast<Eigen::Index>(i)]) / d.applied->springs[number].length;
      bool far = turn > kTurn;
      for (const Attachment* at : {&spring.A, &spring.B})
        far = far || (moves(*at) && e.turn[static_cast<std::size_t>(at->robot)] > kTurn);
      if (far) e.far[static_cast<std::size_t>(moving_end(spring))] = 1;
    }
  return std::find(e.far.begin(), e.far.end(), 1) != e.far.end();
}

// Robots that contacts and springs join.
void find_clusters(const Scene& scene, const SimulationData& d, BoundedEnergy& e) {
  find_robot_sets(scene, d.dynamics.active, true, e.cluster);
  e.sprung.assign(scene.robots.size(), 0);
  for (const Spring& spring : scene.springs) e.sprung[static_cast<std::size_t>(e.cluster[moving_end(spring)])] = 1;
  for (const JointSpring& spring : scene.joint_springs) e.sprung[static_cast<std::size_t>(e.cluster[spring.robot])] = 1;
  for (std::size_t r = 0; r < e.far.size(); ++r)
    if (e.far[r]) e.far[static_cast<std::size_t>(e.cluster[r])] = 1;
}

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
  std::rotate(e.first.begin(), e.first.begin() + 1, e.first.end());  // where each begins
  e.first.back() = static_cast<int>(e.members.size());
}

// Each cluster as one rigid body, and v of that; kinematics are at the start.
void find_bodies(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  FreeGroups& groups = d.free_groups;
  find_tied(scene, groups, e);
  sort_groups(groups, e);
  measure(scene, d.at_rest.kin, groups);
  e.parts.resize(groups.groups.size());
  for (const int g : e.members)
    e.parts[static_cast<std::size_t>(g)] = part_of(groups.groups[static_cast<std::size_t>(g)]);
  e.bodies.resize(e.cluster.size());
  for (int c = 0; c < scene.nrobots(); ++c)
    if (const auto members = groups_of(c, e); !members.empty())
      e.bodies[static_cast<std::size_t>(c)] = one_body(members, e.parts, groups, !e.tied[static_cast<std::size_t>(c)]);
  e.rigid_v.setZero(scene.nv);
  for (const FreeGroups::FreeJoint& j : groups.joints) {
    const std::size_t c = static_cast<std::size_t>(e.cluster[static_cast<std::size_t>(j.robot)]);
    if (j.parent != 0 || e.tied[c]) continue;
    const Robot& robot = scene.robots[j.robot];
    const Joint& joint = robot.model->joints[j.joint];
    const SE3<double>& M = d.at_rest.kin[j.robot].oMi[j.joint];
    const OneBody& body = e.bodies[c];
    const Vec3<double> from_C = d.at_rest.kin[j.robot].origin(j.joint) + M.p - body.C;
    auto v = e.rigid_v.segment(robot.idx_v + joint.idx_v, joint.nv());
    add_motion(joint, M.R.transpose() * (body.V + body.w.cross(from_C)), M.R.transpose() * body.w, v);
  }
}

double& at_robot(Eigen::VectorXd& x, const BoundedEnergy& e, int robot) { return x[e.cluster[robot]]; }

// Energy of each cluster at q, v; and the sum of the sizes of its terms.
void find_energies(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                   const std::vector<double>& fast, std::vector<Kinematics<double>>& kin, BoundedEnergy& e,
                   Eigen::VectorXd& energy) {
  kinematics_at(scene, q, v, kin);
  energy.setZero(scene.nrobots());
  e.kinetic = energy;
  const auto add = [&](int robot, double x) {
    at_robot(energy, e, robot) += x;
    at_robot(e.size, e, robot) += std::abs(x);
  };
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Robot& robot = scene.robots[r];
    const double kinetic = kinetic_energy<double>(*robot.model, kin[r], v.segment(robot.idx_v, robot.model->nv));
    at_robot(e.kinetic, e, r) += kinetic;
    add(r, kinetic);
    add(r, potential_energy<double>(kin[r], scene.gravity));
  }
  for (std::size_t k = 0; k < scene.springs.size(); ++k) {
    const Spring& spring = scene.springs[k];
    const double stretch = (place_of(spring.A, kin) - place_of(spring.B, kin)).norm() - spring.length;
    add(moving_end(spring), spring.stiffness * stretch * stretch / 2 / (1 + fast[k]));
  }
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const double stretch = q[robot.idx_q + robot.model->joints[spring.joint].idx_q] - spring.rest;
    add(spring.robot, spring.stiffness * stretch * stretch / 2);
  }
}

// Adds the most that motors, external wrenches, PD laws and contacts gave in the step.
void add_work(const Scene& scene, const SimulationData& d, BoundedEnergy& e) {
  e.mean = 0.5 * d.h * (d.v + d.next_v);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const int at = scene.robots[r].idx_v, n = scene.robots[r].model->nv;
    at_robot(e.before, e, r) += d.w.segment(at, n).dot(e.mean.segment(at, n));
  }
  for (const JointSpring& spring : scene.joint_springs) {  // in w, at the start
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const Joint& joint = robot.model->joints[spring.joint];
    at_robot(e.before, e, spring.robot) +=
        spring.stiffness * (d.q[robot.idx_q + joint.idx_q] - spring.rest) * e.mean[robot.idx_v + joint.idx_v];
  }
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int first = d.dynamics.f_offset[c]; first >= 0) {
      const int n = scene.contacts[c].rows();
      const double work =
          d.h / 2 * d.dynamics.f.segment(first, n).dot(d.wanted.segment(first, n) + d.contact_v.segment(first, n));
      at_robot(e.before, e, scene.contacts[c].A.robot) += std::max(0.0, work);
    }
}

bool gained(int cluster, const BoundedEnergy& e) {
  const auto c = static_cast<std::size_t>(cluster);
  return e.sprung[c] && e.far[c] && e.after[cluster] - e.before[cluster] > kRounding * e.size[cluster];
}

// The step's end with what e.share leaves. A cluster that keeps all is not touched.
void end_with_shares(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  d.next_v = e.unbounded_v;
  for (int r = 0; r < scene.nrobots(); ++r) {
    const double share = e.share[e.cluster[r]];
    if (share == 1) continue;
    const int at = scene.robots[r].idx_v, n = scene.robots[r].model->nv;
    const auto rigid = e.rigid_v.segment(at, n);
    d.next_v.segment(at, n) = rigid + share * (e.unbounded_v.segment(at, n) - rigid);
  }
  for (int c = 0; c < scene.nrobots(); ++c) {
    const auto members = groups_of(c, e);
    if (members.empty()) continue;
    if (e.share[c] == 1)
      keep_all(members, e.parts, d.free_groups);
    else
      approach(e.bodies[static_cast<std::size_t>(c)], members, e.parts, e.share[c],
               !e.tied[static_cast<std::size_t>(c)], d.h, d.free_groups);
  }
  d.dynamics.a = d.next_v;
  end_step(scene, d);
}

// Clusters that gain as one body, too, may do that.
void allow_what_no_share_prevents(const Scene& scene, const std::vector<double>& fast, SimulationData& d,
                                  BoundedEnergy& e) {
  for (int c = 0; c < scene.nrobots(); ++c) e.share[c] = gained(c, e) ? 0 : 1;
  end_with_shares(scene, d, e);
  Eigen::VectorXd& least = e.least;
  find_energies(scene, d.next_q, d.next_v, fast, d.at_rest.kin, e, least);
  for (int c = 0; c < scene.nrobots(); ++c)
    if (e.share[c] == 0) e.before[c] = std::max(e.before[c], least[c]);
}

// Smaller shares for clusters that gained energy; false where none did.
bool make_smaller(const Scene& scene, BoundedEnergy& e) {
  bool any = false;
  for (int c = 0; c < scene.nrobots(); ++c) {
    if (!gained(c, e)) continue;
    any = true;
    const double left = 1 - 2 * (e.after[c] - e.before[c]) / e.kinetic[c];  // of what moves, twice what was gained
    e.share[c] *= std::max(kSmaller, left > 0 ? std::sqrt(left) : 0);
  }
  return any;
}

}  // namespace

void end_step(const Scene& scene, SimulationData& d) {
  d.stage_v = d.h * d.next_v;
  integrate_scene(scene, d.q, d.stage_v, d.next_q);
  end_free_motion(scene, d.next_q, d.next_v, d.at_rest.kin, d.free_groups);
}

void bound_energy(const Scene& scene, SimulationData& d) {
  if (!d.resisting || (scene.springs.empty() && scene.joint_springs.empty()) ||
      !find_far(scene, d, d.resisting->bounded))
    return;
  BoundedEnergy& e = d.resisting->bounded;
  find_clusters(scene, d, e);
  e.size.setZero(scene.nrobots());
  const auto& fast = d.resisting->springs ? d.resisting->springs->fast : e.none;
  find_energies(scene, d.q, d.v, fast, d.at_rest.kin, e, e.before);
  e.unbounded_v = d.dynamics.a;  // v+ before the momentum was seen to
  find_bodies(scene, d, e);
  add_work(scene, d, e);
  find_energies(scene, d.next_q, d.next_v, fast, d.at_rest.kin, e, e.after);
  e.share.setOnes(scene.nrobots());
  bool any = false;
  for (int c = 0; c < scene.nrobots(); ++c) any = any || gained(c, e);
  if (!any) return;
  const double first = e.after.sum();
  allow_what_no_share_prevents(scene, fast, d, e);
  e.share.setOnes();
  (void)make_smaller(scene, e);
  for (int k = 0;; ++k) {
    end_with_shares(scene, d, e);
    find_energies(scene, d.next_q, d.next_v, fast, d.at_rest.kin, e, e.after);
    if (k == kMostTrials || !make_smaller(scene, e)) break;
  }
  d.work.springs += e.after.sum() - first;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int at = d.dynamics.f_offset[c]; at >= 0)
      d.contact_v.segment(at, scene.contacts[c].rows()) *= e.share[e.cluster[scene.contacts[c].A.robot]];
}

}  // namespace manycontact::internal
