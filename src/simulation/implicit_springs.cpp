#include "implicit_springs.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "internal.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"

namespace manycontact::internal {

namespace {

// Whether steps of h want k and c, both over m, at their end.
bool too_long(double h, double k, double c) {
  return (k > 0 || c > 0) && !(2 * h <= largest_spring_step(Integrator::kSemiImplicitEuler, k, c));
}

// Models with `added` on the diagonal; robots that shared one share one again.
Scene with_inertias(const Scene& scene, const Eigen::VectorXd& added) {
  Scene out = scene;
  std::vector<std::pair<int, std::shared_ptr<const Model>>> made;  // for the robot of that number
  for (std::size_t r = 0; r < scene.robots.size(); ++r) {
    const Robot& robot = scene.robots[r];
    const auto mine = added.segment(robot.idx_v, robot.model->nv);
    if (mine.isZero(0)) continue;
    const auto same = std::find_if(made.begin(), made.end(), [&](const auto& other) {
      const Robot& twin = scene.robots[static_cast<std::size_t>(other.first)];
      return twin.model == robot.model && added.segment(twin.idx_v, twin.model->nv) == mine;
    });
    if (same == made.end()) {
      auto model = std::make_shared<Model>(*robot.model);
      model->armature += mine;
      made.emplace_back(static_cast<int>(r), std::move(model));
      out.robots[r].model = made.back().second;
    } else {
      out.robots[r].model = same->second;
    }
  }
  return out;
}

void measure(const Scene& scene, const Eigen::VectorXd& q, ImplicitSprings& s) {
  if (s.measured) return;
  SpringMobilities free = spring_mobilities(scene, std::vector<char>(scene.contacts.size(), 0), q);
  s.of_joints = std::move(free.joints);
  for (const Mat3<double>& C : free.springs)
    s.of_springs.push_back(C.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  s.measured = true;
}

// Into added and d.tau.
void take_joints(const Scene& scene, SimulationData& d, ImplicitSprings& s) {
  const double h = d.h;
  s.stiffness.setZero(scene.nv);
  s.to_add.setZero(scene.nv);
  if (s.added.size() == 0) s.added.setZero(scene.nv);
  for (const JointSpring& spring : scene.joint_springs) {
    const Robot& robot = scene.robots[static_cast<std::size_t>(spring.robot)];
    s.stiffness[robot.idx_v + robot.model->joints[spring.joint].idx_v] += spring.stiffness;
  }
  for (const Robot& robot : scene.robots)
    for (int i = 0; i < robot.model->nv; ++i) {
      const double m = s.of_joints[robot.idx_v + i];
      if (!(m > 0)) continue;
      const double k = s.stiffness[robot.idx_v + i], c = robot.model->damping.size() > 0 ? robot.model->damping[i] : 0;
      if (!too_long(h, k * m, c * m)) continue;
      s.to_add[robot.idx_v + i] = h * h * k + h * c;
      d.tau[robot.idx_v + i] += h * c * d.v[robot.idx_v + i];
    }
  if (s.to_add == s.added) return;
  s.added = s.to_add;
  d.kept_active.clear();
  s.at_rest.reset(), s.dynamics.reset();
  if (s.added.isZero(0)) return;
  s.at_rest = std::make_unique<SceneAtRest>(with_inertias(scene, s.added));
  s.dynamics = std::make_unique<SceneData>(s.at_rest->scene, d.dynamics.options);
}

// U, D and c of the springs between points that want it.
void choose_forces(const Scene& scene, const SimulationData& d, ImplicitSprings& s) {
  const double h = d.h;
  s.forces.clear(), s.D.clear(), s.c.clear();
  const auto take = [&](std::size_t spring, const Vec3<double>& direction, double k, double c) {
    s.forces.push_back({static_cast<int>(spring), direction});
    s.D.push_back(h * h * k + h * c);
    s.c.push_back(c);
  };
  for (std::size_t i = 0; i < scene.springs.size(); ++i) {
    const Spring& spring = scene.springs[i];
    const double k = spring.stiffness, c = spring.damping, m = s.of_springs[i];
    if (!(m > 0)) continue;
    if (spring.length == 0 && c == 0) {
      for (int e = 0; e < 3 && too_long(h, k * m, 0); ++e) take(i, Vec3<double>::Unit(e), k, 0);
      continue;
    }
    const auto& at = d.applied->springs[i];
    if (!at.directed) continue;  // the step fails
    if (too_long(h, k * m, c * m)) take(i, at.n, k, c);
    const double across = k * (1 - spring.length / at.length);
    if (!too_long(h, across * m, 0)) continue;
    const Vec3<double> e = at.n.unitOrthogonal();
    take(i, e, across, 0);
    take(i, at.n.cross(e), across, 0);
  }
}

}  // namespace

AtRest at_rest_with_springs(const Scene& scene, SimulationData& d) {
  ImplicitSprings* s = d.implicit.get();
  if (!s || !s->dynamics) return {d.at_rest.scene, d.dynamics};
  s->at_rest->follow(scene, d.h);
  s->dynamics->options = d.dynamics.options;
  s->dynamics->active = d.dynamics.active;
  return {s->at_rest->scene, *s->dynamics};
}

bool take_springs(const Scene& scene, SimulationData& d) {
  if (!d.implicit) return true;
  ImplicitSprings& s = *d.implicit;
  measure(scene, d.q, s);
  take_joints(scene, d, s);
  choose_forces(scene, d, s);
  const auto n = static_cast<Eigen::Index>(s.forces.size());
  if (n == 0) return true;

  s.unit.place(scene, d.q);
  s.unit.look(d.v);
  for (Eigen::Index i = 0; i < n; ++i) s.unit.add(s.forces[i], s.c[i] * s.unit.along(s.forces[i]));
  d.w += s.unit.torques();

  const int numbers = s.unit.number(scene, d.dynamics.active, s.forces);
  const auto [rest, data] = at_rest_with_springs(scene, d);
  const auto solves = [&](const Eigen::VectorXd& b, const Eigen::VectorXd& wanted) {
    const Status status = solve_tau(rest, d.q, d.at_rest.zero, b, wanted, data).status;
    d.worst = std::max(d.worst, status);
    s.unit.look(data.a);
    return status != Status::kFailed;
  };
  s.b = d.tau + d.h * d.w;
  if (!solves(s.b, d.wanted)) return false;
  s.y.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) s.y[i] = s.unit.along(s.forces[i]);
  s.C.setZero(n, n);
  s.none.setZero(d.wanted.size());
  for (int number = 0; number < numbers; ++number) {
    s.of_island.assign(scene.robots.size(), -1);
    for (Eigen::Index j = 0; j < n; ++j)
      if (s.forces[j].number == number) {
        s.of_island[static_cast<std::size_t>(s.forces[j].island)] = static_cast<int>(j);
        s.unit.add(s.forces[j], 1);
      }
    s.b = s.unit.torques();
    if (!solves(s.b, s.none)) return false;
    for (Eigen::Index i = 0; i < n; ++i)
      if (const int j = s.of_island[static_cast<std::size_t>(s.forces[i].island)]; j >= 0)
        s.C(i, j) = s.unit.along(s.forces[i]);
  }
  for (Eigen::Index i = 0; i < n; ++i) s.C(i, i) += 1 / s.D[i];
  s.factor.compute(s.C);
  s.factor.solveInPlace(s.y);
  s.unit.clear();
  for (Eigen::Index i = 0; i < n; ++i) s.unit.add(s.forces[i], -s.y[i] / d.h);
  d.w += s.unit.torques();
  return true;
}

}  // namespace manycontact::internal
