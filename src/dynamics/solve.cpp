#include "manycontact/dynamics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bodies.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/dynamics/solve_wanted.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "steps.hpp"
#include "threads.hpp"

namespace manycontact {

namespace internal {

Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island) {
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return Reason::kBadDamping;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    if (!q.segment(robot.idx_q, model.nq).allFinite() || !v.segment(robot.idx_v, model.nv).allFinite() ||
        !tau.segment(robot.idx_v, model.nv).allFinite())
      return Reason::kNotFinite;
    if (model.nq == model.nv) continue;  // no quaternion
    for (const Joint& joint : model.joints)
      if (joint.type == JointType::kFloating &&
          std::abs(q.segment<4>(robot.idx_q + joint.idx_q + 3).norm() - 1) > tolerance::kQuaternion)
        return Reason::kBadQuaternion;
  }
  return Reason::kNone;
}

namespace {

// Residuals relative to the terms they are left of; those of the contacts at least to gravity, or a scene at rest would
// have rounding compared with rounding.
void report_residuals(const Scene& scene, const KktPattern& p, const KktVectors& s, IslandReport& report) {
  double r[2] = {0, 0}, scale[2] = {0, scene.gravity.norm()};  // dynamics rows, contact rows
  for (int k = 0; k < p.size(); ++k) {
    const int row = p.perm[k] >= p.nv;
    r[row] = sparse::larger_or_nan(r[row], std::abs(s.r[k]));
    scale[row] = std::max(scale[row], s.scale[k]);
  }
  report.residual_dynamics = r[0] == 0 ? 0 : r[0] / scale[0];
  report.residual_contact = r[1] == 0 ? 0 : r[1] / scale[1];
}

void fail(const Scene& scene, SceneData& data, const Island& island, IslandReport& report) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  report.status = Status::kFailed;
  report.rank = 0;
  report.residual_dynamics = report.residual_contact = report.backward_error = nan;
  each_velocity_block(scene, island, [&](int first, int, int n) { data.a.segment(first, n).setConstant(nan); });
  each_force_block(scene, data.f_offset, island,
                   [&](int first, int, int n) { data.f.segment(first, n).setConstant(nan); });
}

// Kinematics, terms and their memory for the ladder; false where the input cannot be used.
bool ready_for_ladder(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data, IslandWork& d,
                      IslandReport& report) {
  if (has_bodies(d)) make_joint_space(scene, *data.workspace, d);
  evaluate(scene, q, v, *data.workspace, d.island);
  report.reason = check_input(scene, q, v, data.tau, d.island);
  return report.reason == Reason::kNone;
}

// What the ladder found, in the scene's coordinates.
void take_answer(const Scene& scene, SceneData& data, IslandWork& d, IslandReport& report) {
  const KktPattern& p = *d.K.pattern;
  scatter(scene, data.f_offset, p, d.island, d.v.x.data(), data.a, data.f);  // x = [a; -f]
  each_force_block(scene, data.f_offset, d.island, [&](int first, int, int n) { data.f.segment(first, n) *= -1; });
  report_residuals(scene, p, d.v, report);
  report.backward_error = rank_deficient(d) ? sparse::componentwise_backward_error(d.v.r, d.v.scale) : d.last_error;
}

void solve_in_joint_space(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data,
                          FactorScratch& scratch, IslandWork& d, IslandReport& report) {
  if (!ready_for_ladder(scene, q, v, data, d, report)) return fail(scene, data, d.island, report);
  if (!climb_ladder(scene, data, scratch, d, report)) {
    d.factor = nullptr;
    return fail(scene, data, d.island, report);
  }
  take_answer(scene, data, d, report);
}

// By sparse-bodies, or in joint space; there also what sparse-bodies refused, unless it is too large.
void solve_island(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data,
                  FactorScratch& scratch, IslandWork& d, IslandReport& report) {
  reset(report, d.island);
  d.factor = nullptr;
  if (has_bodies(d)) {
    report.reason = check_input(scene, q, v, data.tau, d.island);
    if (report.reason != Reason::kNone) return fail(scene, data, d.island, report);
    if (solve_by_bodies(scene, data, d, report)) return;
    if (joint_space_size(*d.shape) > kMostJointSpace) return fail(scene, data, d.island, report);
    const Reason refused = report.reason;
    solve_in_joint_space(scene, q, v, data, scratch, d, report);
    if (report.reason == Reason::kNone) report.reason = refused;
    return;
  }
  solve_in_joint_space(scene, q, v, data, scratch, d, report);
}

}  // namespace

void reset(IslandReport& report, const Island& island) {
  std::vector<int> memory = std::move(report.dependent_rows);
  memory.clear();
  report = {};
  report.dependent_rows = std::move(memory);
  report.nv = island.nv;
  report.nc = report.rank = island.nc;
}

namespace {

// The islands whose rows depend on each other as in the solve before. Of the others nothing is left behind: a state's
// answer does not depend on the states before it.
void solve_dependent(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data) {
  Workspace& w = *data.workspace;
  if (std::none_of(w.islands.begin(), w.islands.end(), [](const auto& d) { return d->was_dependent; })) return;
  each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *w.islands[i];
    IslandReport& report = data.report.islands[i];
    if (!d.was_dependent) return;
    reset(report, d.island);
    d.factor = nullptr;
    d.was_dependent = ready_for_ladder(scene, q, v, data, d, report);
    if (d.was_dependent && still_dependent(scene, data, thread.scratch, d, report)) take_answer(scene, data, d, report);
  });
}

// Checks what every solve is given, u or tau by its name and size, and prepares.
void begin(const char* function, const Scene& scene, const ConstVector& q, const ConstVector& v, const char* name,
           const ConstVector& torques, int size, SceneData& data) {
  check_scene(scene, data, function);
  check_size(function, "q", q.size(), scene.nq);
  check_size(function, "v", v.size(), scene.nv);
  check_size(function, name, torques.size(), size);
  give_up_solution(data);
  prepare_checked(scene, data);
}

// After begin. wanted: nullptr, or of the rows of f.
const Report& solve_prepared(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                             SceneData& data, const double* wanted = nullptr) {
  Workspace& w = *data.workspace;
  w.wanted = wanted;
  w.asked = wanted != nullptr;
  remake(data.a, scene.nv);
  data.v = v;
  if (tau.data() != data.tau.data()) data.tau = tau;
  for (const Robot& robot : scene.robots)
    add_friction(*robot.model, data.v.data() + robot.idx_v, data.tau.data() + robot.idx_v);
  data.report.method = data.options.method;
  w.q = q;
  w.kinematics_known = false;
  for (const auto& d : w.islands) d->factorizations = 0;
  const OneBlasOfThreads one_blas_thread(w);
  ++w.solves;  // what fails on the way may have left its number behind
  solve_dependent(scene, q, v, data);
  solve_alone(scene, data);
  solve_joined(scene, data);
  const auto left = [](const IslandWork& d) { return !d.in_lanes && !d.was_dependent; };
  each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    IslandWork& d = *w.islands[i];
    if (left(d)) solve_island(scene, q, v, data, thread.scratch, d, data.report.islands[i]);
  });
  w.kinematics_known = std::none_of(w.islands.begin(), w.islands.end(), [](const auto& d) { return d->in_lanes; });
  summarise(data.report);
  w.wanted = nullptr;
  data.serial = w.current = w.solves;
  return data.report;
}

}  // namespace

}  // namespace internal

const Report& solve(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                    SceneData& data) {
  internal::begin("solve", scene, q, v, "u", u, scene.nu, data);
  internal::remake(data.tau, scene.nv);
  for (const Robot& robot : scene.robots) {
    data.tau.segment(robot.idx_v, robot.model->nv).setZero();
    for (int k = 0; k < robot.model->nu(); ++k) data.tau[robot.idx_v + robot.model->actuated[k]] = u[robot.idx_u + k];
  }
  return internal::solve_prepared(scene, q, v, data.tau, data);
}

const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                        SceneData& data) {
  internal::begin("solve_tau", scene, q, v, "tau", tau, scene.nv, data);
  return internal::solve_prepared(scene, q, v, tau, data);
}

const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                        const ConstVector& wanted, SceneData& data) {
  internal::begin("solve_tau", scene, q, v, "tau", tau, scene.nv, data);
  internal::check_size("solve_tau", "wanted", wanted.size(), data.f.size());
  return internal::solve_prepared(scene, q, v, tau, data, wanted.data());
}

}  // namespace manycontact
