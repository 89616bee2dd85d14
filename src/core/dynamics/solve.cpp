#include "manycontact/dynamics/solve.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "internal.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/detail/model/inputs.hpp"
#include "manycontact/dynamics/give_up_solution.hpp"
#include "manycontact/dynamics/solve_prescribed.hpp"
#include "manycontact/dynamics/solve_step.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "reduction/reduction.hpp"
#include "workspace/threads.hpp"

namespace manycontact {

namespace internal {

Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island) {
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return Reason::kBadDamping;
  if (!(scene.moment_length > 0) || !std::isfinite(scene.moment_length)) return Reason::kBadMomentLength;
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

void fail(const Scene& scene, SceneData& data, const Island& island, IslandReport& report) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  report.status = Status::kFailed;
  report.rank = 0;
  report.residual_dynamics = report.residual_contact = report.backward_error = nan;
  each_velocity_block(scene, island, [&](int first, int, int n) { data.a.segment(first, n).setConstant(nan); });
  each_force_block(scene, data.f_offset, island,
                   [&](int first, int, int n) { data.f.segment(first, n).setConstant(nan); });
}

// Solves one island: by sparse-bodies if chosen; by MatrixSystem otherwise, or if sparse-bodies fails.
void solve_island(const Scene& scene, SceneData& data, ThreadWork& thread, IslandWork& d, IslandReport& report) {
  reset(report, d.island);
  const auto solve_by = [&](IslandSystem* system) {
    if (!system || !system->solve(scene, data, thread, report)) return false;
    d.answered = system;
    return true;
  };
  // Terms are evaluated even if the input is refused below, so that views (views.hpp) have them.
  if (!d.bodies) evaluate_at_state(scene, data, d);
  report.reason = check_input(scene, data.workspace->q, data.v, data.tau, d.island);
  if (report.reason == Reason::kNotFinite && lacks_direction(scene, *data.workspace, d.island))
    report.reason = Reason::kSpringWithoutDirection;
  if (report.reason != Reason::kNone || (!is_inexact(scene, d) && solve_by(d.bodies.get()))) return;
  const Reason refused = report.reason;  // the reason why sparse-bodies refused
  if (solve_by(&d.matrix) && report.reason == Reason::kNone) report.reason = refused;
}

void solve_left(const Scene& scene, SceneData& data) {  // the islands that SIMD batches did not solve
  Workspace& w = *data.workspace;
  const auto is_left = [](const auto& d) { return !d->answered; };
  const auto left = std::ranges::count_if(w.islands, is_left);
  if (left == 0) return;
  each_item(w, w.islands.size(), left > 1, [&](std::size_t i, ThreadWork& thread) {
    if (is_left(w.islands[i])) solve_island(scene, data, thread, *w.islands[i], data.report.islands[i]);
  });
}

void solve_joined(const Scene& scene, SceneData& data) {  // solves islands by RobotsSystem, which uses all threads
  Workspace& w = *data.workspace;
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandWork& d = *w.islands[i];
    if (d.robots && !is_inexact(scene, d) && d.robots->solve(scene, data, w.threads.front(), data.report.islands[i]))
      d.answered = d.robots.get();
  }
}

void tell_precision(SceneData& data) {  // reports islands solved in double precision although single was requested
  if (data.workspace->options.precision != Precision::kSingle) return;
  for (IslandReport& report : data.report.islands)
    if (report.status != Status::kFailed && report.precision == Precision::kDouble && report.reason == Reason::kNone)
      report.reason = Reason::kLowPrecision;
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

void name_dependent_rows(const SceneData& data, const Island& island, std::span<const int> rows, IslandReport& report) {
  const std::vector<int>& offset = island.row_offset;
  report.dependent_rows.clear();
  for (int row : rows) {
    const auto c = std::upper_bound(offset.begin(), offset.end(), row) - offset.begin() - 1;
    report.dependent_rows.push_back(data.f_offset[island.contacts[c]] + row - offset[c]);
  }
  std::sort(report.dependent_rows.begin(), report.dependent_rows.end());
}

namespace {

// Checks the inputs of a solve, and prepares the scene. torques: u or tau, with their `name` and expected `size`.
void begin(const char* function, const Scene& scene, const ConstVector& q, const ConstVector& v, const char* name,
           const ConstVector& torques, int size, SceneData& data) {
  check_scene(scene, data, function);
  check_size(function, "q", q.size(), scene.nq);
  check_size(function, "v", v.size(), scene.nv);
  check_size(function, name, torques.size(), size);
  check_pushes(scene, data, function);
  give_up_solution(data);
  prepare_checked(scene, data);
}

// Stores the inputs of a solve, and marks all islands as not solved.
void begin_state(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                 SceneData& data, std::span<const double> prescribed) {
  Workspace& w = *data.workspace;
  w.prescribed.assign(prescribed.begin(), prescribed.end());
  remake(data.a, scene.nv);
  data.v = v;
  w.given = tau;
  if (tau.data() != data.tau.data()) data.tau = tau;
  for (const Robot& robot : scene.robots)
    add_friction(*robot.model, data.v.data() + robot.idx_v, data.tau.data() + robot.idx_v);
  w.q = q;
  add_applied_forces(scene, data, w.q.data(), data.v.data(), data.tau.data());
  data.report.method = data.options.method;
  ++w.state;  // a new number, even if an earlier solve failed
  for (const auto& d : w.islands) d->answered = nullptr, d->factorizations = 0, d->deficient = false;
}

}  // namespace

const Report& solve_prepared(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                             SceneData& data, std::span<const double> prescribed) {
  Workspace& w = *data.workspace;
  if (w.reduction) return solve_reduced(scene, q, v, tau, data, prescribed);
  begin_state(scene, q, v, tau, data, prescribed);
  solve_alone(scene, data);
  solve_joined(scene, data);
  solve_left(scene, data);
  for (std::size_t i = 0; i < w.islands.size(); ++i)
    if (!w.islands[i]->answered) fail(scene, data, w.islands[i]->island, data.report.islands[i]);
  tell_precision(data);
  data.serial = w.current = w.state;
  if (data.options.precision == Precision::kExtended) refine_extended(scene, data);
  summarise(data.report);
  return data.report;
}

namespace {

class SolveClock {  // SolveTimes: setup until `prepared` is called, then solve until `report` is called
 public:
  void prepared() { prepared_ = Clock::now(); }
  const Report& report(Report& report) const {
    report.times = {us(prepared_ - start_), us(Clock::now() - prepared_)};
    return report;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double us(Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); }
  Clock::time_point start_ = Clock::now(), prepared_ = start_;
};

}  // namespace

}  // namespace internal

const Report& solve(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                    SceneData& data) {
  internal::SolveClock clock;
  internal::begin("solve", scene, q, v, "u", u, scene.nu, data);
  clock.prepared();
  internal::remake(data.tau, scene.nv);
  torques_of_motors(scene, u, data.tau);
  internal::solve_prepared(scene, q, v, data.tau, data);
  return clock.report(data.report);
}

const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                        SceneData& data) {
  internal::SolveClock clock;
  internal::begin("solve_tau", scene, q, v, "tau", tau, scene.nv, data);
  clock.prepared();
  internal::solve_prepared(scene, q, v, tau, data);
  return clock.report(data.report);
}

const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                        const ConstVector& prescribed, SceneData& data) {
  internal::SolveClock clock;
  internal::begin("solve_tau", scene, q, v, "tau", tau, scene.nv, data);
  clock.prepared();
  internal::check_size("solve_tau", "prescribed", prescribed.size(), data.f.size());
  internal::solve_prepared(scene, q, v, tau, data, {prescribed.data(), static_cast<std::size_t>(prescribed.size())});
  return clock.report(data.report);
}

bool solve_step(const Scene& scene, const ConstVector& q, const ConstVector& tau, const ConstVector& prescribed,
                const StartOfStep& start, SceneData& data) {
  Workspace& w = *data.workspace;
  if (w.prepared && w.active == data.active && !internal::stand_alone(scene, w)) return false;
  internal::SolveClock clock;
  data.v.setZero(scene.nv);
  internal::begin("step", scene, q, data.v, "tau", tau, scene.nv, data);
  clock.prepared();
  if (!internal::stand_alone(scene, w)) return false;
  internal::begin_state(scene, q, data.v, tau, data, {prescribed.data(), static_cast<std::size_t>(prescribed.size())});
  internal::solve_alone(scene, data, &start);
  if (std::ranges::any_of(w.islands, [](const auto& d) { return !d->answered; })) return false;
  data.serial = w.current = w.state;
  summarise(data.report);
  clock.report(data.report);
  return true;
}

}  // namespace manycontact
