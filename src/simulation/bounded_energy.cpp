// Energy of steps in which springs move bodies by angles that no linear force is right for.
//
// What turns by an angle x in a step leaves a spring's line by s x^2 / 2, which a spring that is faster than the step
// takes back at once, and bodies that turn by radians are wrong in everything that is linear: energy may grow from step
// to step. So robots with such springs do not gain energy but for what motors, pushes and contacts give: where they did,
// their velocities are made smaller, by as much as it takes. With v+ = 0 nothing moves and nothing is gained, and what
// is free keeps its momentum (simulation/momentum.hpp) all the same. Of a spring counts what a step can make of its
// energy, k e^2 / 2 / (1 + h^2 k / m).

#include <cmath>

#include "internal.hpp"
#include "manycontact/algorithm/energy.hpp"
#include "manycontact/sparse/union_find.hpp"
#include "momentum_steps.hpp"
#include "resisting_forces.hpp"

namespace manycontact::internal {

namespace {

constexpr double kTurn = 0.02, kFarTurn = 0.2;  // rad; with springs faster than the step, and with any
constexpr double kRounding = 1e-10;             // of the energies that are compared
constexpr double kSmaller = 0.7;                // at least, at a time
constexpr int kMostTrials = 60;

// The farthest turn of a joint in the step.
double turn_of(const Scene& scene, const SimulationData& d) {
  double most = 0;
  for (const Robot& robot : scene.robots)
    for (const Joint& joint : robot.model->joints) {
      if (joint.type == JointType::kPrismatic) continue;
      const int n = joint.type == JointType::kFloating ? 3 : 1;  // coordinates that turn, the last
      most = std::max(most, d.h * d.next_v.segment(robot.idx_v + joint.idx_v + joint.nv() - n, n).norm());
    }
  return most;
}

bool turns_far(const Scene& scene, const SimulationData& d) {
  const double turn = turn_of(scene, d);
  if (turn > kFarTurn || !d.resisting->springs) return turn > kFarTurn;
  const ResistingSprings& s = *d.resisting->springs;
  for (std::size_t i = 0; i < s.rows.size(); ++i) {
    const auto spring = static_cast<std::size_t>(s.rows[i].spring);
    if (s.fast[spring] > 1 && std::max(turn, d.h * std::abs(s.rate[static_cast<Eigen::Index>(i)]) / d.applied->springs[spring].length) > kTurn)
      return true;
  }
  return false;
}

// Robots that contacts and springs join.
void find_clusters(const Scene& scene, const SimulationData& d, BoundedEnergy& e) {
  e.cluster.resize(scene.robots.size());
  sparse::UnionFind sets(e.cluster);
  const auto join = [&](const Attachment& A, const Attachment& B) {
    if (moves(A) && moves(B)) sets.join(A.robot, B.robot);
  };
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (d.dynamics.active[c]) join(scene.contacts[c].A, scene.contacts[c].B);
  for (const Spring& spring : scene.springs) join(spring.A, spring.B);
  for (std::size_t r = 0; r < scene.robots.size(); ++r) e.cluster[r] = sets.root(static_cast<int>(r));
  e.sprung.assign(scene.robots.size(), 0);
  for (const Spring& spring : scene.springs) e.sprung[static_cast<std::size_t>(e.cluster[spring.A.robot])] = 1;
  for (const JointSpring& spring : scene.joint_springs)
    e.sprung[static_cast<std::size_t>(e.cluster[spring.robot])] = 1;
}

double& at_robot(Eigen::VectorXd& x, const BoundedEnergy& e, int robot) { return x[e.cluster[robot]]; }

// Of each cluster at q, v; and the sum of the sizes of what it is made of.
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
    add(spring.A.robot, spring.stiffness * stretch * stretch / 2 / (1 + fast[k]));
  }
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    const double stretch = q[robot.idx_q + robot.model->joints[spring.joint].idx_q] - spring.rest;
    add(spring.robot, spring.stiffness * stretch * stretch / 2);
  }
}

// What motors, pushes, PD laws and contacts gave in the step, at most.
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
      const double work = d.h / 2 * d.dynamics.f.segment(first, n).dot(d.wanted.segment(first, n) + d.contact_v.segment(first, n));
      at_robot(e.before, e, scene.contacts[c].A.robot) += std::max(0.0, work);
    }
}

// Velocities of clusters that gained energy made smaller; false where none did.
bool make_smaller(const Scene& scene, SimulationData& d, BoundedEnergy& e) {
  bool any = false;
  for (int r = 0; r < scene.nrobots(); ++r) {
    const int c = e.cluster[r];
    const double gained = e.after[c] - e.before[c];
    if (!e.sprung[static_cast<std::size_t>(c)] || !(gained > kRounding * e.size[c])) continue;
    any = true;
    const double left = 1 - 2 * gained / e.kinetic[c];  // of what moves, twice what was gained
    const double share = std::max(kSmaller, left > 0 ? std::sqrt(left) : 0);
    e.bounded_v.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) *= share;
    if (c == r) e.share[c] *= share;
  }
  if (any) d.next_v = e.bounded_v;
  return any;
}

}  // namespace

void end_step(const Scene& scene, SimulationData& d) {
  d.stage_v = d.h * d.next_v;
  integrate_scene(scene, d.q, d.stage_v, d.next_q);
  end_free_motion(scene, d.next_q, d.next_v, d.at_rest.kin, d.free_groups);
}

void bound_energy(const Scene& scene, SimulationData& d) {
  if (!d.resisting || (scene.springs.empty() && scene.joint_springs.empty()) || !turns_far(scene, d)) return;
  BoundedEnergy& e = d.resisting->bounded;
  find_clusters(scene, d, e);
  e.size.setZero(scene.nrobots());
  const auto& fast = d.resisting->springs ? d.resisting->springs->fast : e.none;
  find_energies(scene, d.q, d.v, fast, d.at_rest.kin, e, e.before);
  e.share.setOnes(scene.nrobots());
  e.bounded_v = d.dynamics.a;  // v+ before the momentum was seen to
  add_work(scene, d, e);
  double first = 0;
  for (int k = 0; k < kMostTrials; ++k) {
    find_energies(scene, d.next_q, d.next_v, fast, d.at_rest.kin, e, e.after);
    if (k == 0) first = e.after.sum();
    if (!make_smaller(scene, d, e)) break;
    end_step(scene, d);
  }
  d.work.springs += e.after.sum() - first;
  d.dynamics.a = e.bounded_v;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (const int at = d.dynamics.f_offset[c]; at >= 0)
      d.contact_v.segment(at, scene.contacts[c].rows()) *= e.share[e.cluster[scene.contacts[c].A.robot]];
}

}  // namespace manycontact::internal
