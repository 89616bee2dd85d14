#include "manycontact/dynamics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "internal.hpp"

namespace manycontact {

namespace internal {

// Residuals relative to the terms they are left of; those of the contacts at least to gravity, or a scene at rest would
// have rounding compared with rounding.
void report_residuals(const Scene& scene, const KktSystem& s, IslandReport& report) {
  const KktPattern& p = *s.pattern;
  double r[2] = {0, 0}, scale[2] = {0, scene.gravity.norm()};  // dynamics rows, contact rows
  double most = 0;
  for (double value : s.scale) most = std::max(most, value);
  report.backward_error = 0;
  for (int k = 0; k < p.size(); ++k) {
    const double floor = std::max(s.scale[k], most * std::numeric_limits<double>::epsilon());
    if (s.r[k] != 0) report.backward_error = std::max(report.backward_error, std::abs(s.r[k]) / floor);
    const int row = p.perm[k] >= p.nv;
    if (!(std::abs(s.r[k]) <= r[row])) r[row] = std::abs(s.r[k]);
    scale[row] = std::max(scale[row], s.scale[k]);
  }
  report.residual_dynamics = r[0] == 0 ? 0 : r[0] / scale[0];
  report.residual_contact = r[1] == 0 ? 0 : r[1] / scale[1];
}

Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island) {
  if (!(scene.damping >= 0) || !std::isfinite(scene.damping)) return Reason::kBadDamping;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    if (!q.segment(robot.idx_q, model.nq).allFinite() || !v.segment(robot.idx_v, model.nv).allFinite() ||
        !tau.segment(robot.idx_v, model.nv).allFinite())
      return Reason::kNotFinite;
    for (const Joint& joint : model.joints)
      if (joint.type == JointType::kFloating && std::abs(q.segment<4>(robot.idx_q + joint.idx_q + 3).norm() - 1) > 1e-6)
        return Reason::kBadQuaternion;
  }
  return Reason::kNone;
}

bool has_vanishing_row(const Scene& scene, const SceneData& data, const IslandData& d) {
  double smallest = std::numeric_limits<double>::infinity(), largest = motion_size(scene, data, d.island);
  for (std::size_t c = 0; c < d.J.size(); ++c) {
    const Eigen::Index rows = scene.contacts[d.island.contacts[c]].rows();
    const Eigen::Map<const Eigen::MatrixXd> J(d.J[c].data(), rows, static_cast<Eigen::Index>(d.J[c].size()) / rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double size = J.cols() > 0 ? J.row(i).cwiseAbs().maxCoeff() : 0;
      smallest = std::min(smallest, size);
    }
  }
  return !d.J.empty() && !(smallest > kRankTolerance * largest);
}

namespace {

Reason solve_by(Method method, const Scene& scene, SceneData& data, IslandData& d, IslandReport& report) {
  if (scene.damping == 0 && has_vanishing_row(scene, data, d)) return Reason::kSmallPivot;
  switch (method) {
    case Method::kSparseCholmod:
      return solve_cholmod(d, report);
    case Method::kSparseSupernodal:
      return solve_supernodal(scene, d, report);
    default:
      return solve_ldl(data, d, report);
  }
}

// Leaf-to-root: with damping by the method chosen, without by LDL that drops dependent rows.
Reason solve_safe(const Scene& scene, SceneData& data, IslandData& d, IslandReport& report) {
  assemble_island(scene, data, d.safe, d);
  return scene.damping > 0 ? solve_by(d.method, scene, data, d, report) : solve_dependent(scene, data, d, report);
}

// The ladder: the method and order chosen; leaf-to-root, dropping rows that depend on others; the oracle; where a
// damping is too small to be told from rounding, none.
void solve_island(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data, IslandData& d,
                  IslandReport& report) {
  evaluate(scene, q, v, data, d.island);
  // Rows that were dependent in the last solve mostly still are: the first step would fail.
  const bool expected = d.was_dependent && scene.damping == 0 && d.method != Method::kDense;
  d.was_dependent = false;
  if (expected && solve_safe(scene, data, d, report) == Reason::kNone && rank_deficient(d)) {
    report.changed_order = d.chosen != d.safe;
    report.reason = Reason::kSmallPivot;
    d.was_dependent = true;
    return;
  }
  report.status = Status::kOk;
  assemble_island(scene, data, d.chosen, d);
  if (d.method != Method::kDense) {
    report.reason = solve_by(d.method, scene, data, d, report);
    if (report.reason == Reason::kNone) return;
    const Reason first = report.reason;
    const bool another = scene.damping == 0 || (d.method != Method::kSparseSupernodal && d.chosen != d.safe);
    if (another && solve_safe(scene, data, d, report) == Reason::kNone) {
      d.was_dependent = rank_deficient(d);
      report.changed_order = d.chosen != d.safe;
      report.reason = d.was_dependent ? Reason::kSmallPivot : first;
      return;
    }
    report.reason = first;
  }
  d.factor = Factor::kNone;
  report.status = Status::kOk;
  solve_dense(scene, data, d, report);
  if (report.status != Status::kFailed || report.reason != Reason::kSmallPivot || scene.damping == 0) return;
  // A damping below the rounding of K: the answer without it, as a neighbouring problem's.
  assemble_island(scene, data, d.safe, d);
  for (int k : d.system.pattern->diagonal_slot) d.system.Kx[k] = 0;
  report.refinement_steps = 0;
  if (solve_dependent(scene, data, d, report) != Reason::kNone) return;
  report.status = Status::kRegularised;
  report.reason = Reason::kDampingLost;
}

void fail(const Scene& scene, SceneData& data, const IslandData& d, Reason reason, IslandReport& report) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  report.status = Status::kFailed;
  report.reason = reason;
  report.rank = 0;
  report.residual_dynamics = report.residual_contact = report.backward_error = nan;
  for (int r : d.island.robots) data.a.segment(scene.robots[r].idx_v, scene.robots[r].model->nv).setConstant(nan);
  for (int c : d.island.contacts) data.f.segment(data.f_offset[c], scene.contacts[c].rows()).setConstant(nan);
}

void check_size(const char* what, Eigen::Index given, int expected) {
  if (given != expected)
    throw std::invalid_argument(std::string("solve: ") + what + " has " + std::to_string(given) +
                                " numbers, the scene expects " + std::to_string(expected));
}

}  // namespace
}  // namespace internal

const Report& solve(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                    SceneData& data) {
  internal::check_size("u", u.size(), scene.nu);
  for (const Robot& robot : scene.robots) {
    const int first = robot.model->first_actuated();
    data.tau.segment(robot.idx_v, first).setZero();
    data.tau.segment(robot.idx_v + first, robot.model->nu()) = u.segment(robot.idx_u, robot.model->nu());
  }
  return solve_tau(scene, q, v, data.tau, data);
}

const Report& solve_tau(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                        SceneData& data) {
  using namespace internal;
  check_size("q", q.size(), scene.nq);
  check_size("v", v.size(), scene.nv);
  check_size("tau", tau.size(), scene.nv);
  data.tau = tau;
  prepare(scene, data);
  data.v = v;
  data.report.method = data.options.method;
  const bool whole = data.options.method == Method::kDenseSchur;
  Reason unusable = Reason::kNone;  // the first island's that cannot be used
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandData& d = data.islands[i];
    IslandReport& report = data.report.islands[i];
    std::vector<int> memory = std::move(report.dependent_rows);
    memory.clear();
    report = {};
    report.dependent_rows = std::move(memory);
    report.nv = d.island.nv;
    report.nc = report.rank = d.island.nc;
    d.factor = Factor::kNone;
    const Reason reason = check_input(scene, q, v, data.tau, d.island);
    if (reason != Reason::kNone) {
      report.status = Status::kFailed;
      report.reason = reason;
      if (unusable == Reason::kNone) unusable = reason;
    } else if (whole) {
      evaluate(scene, q, v, data, d.island);
      assemble_island(scene, data, d.system.pattern, d);
    } else {
      solve_island(scene, q, v, data, d, report);
    }
  }
  const bool answered = !whole || unusable == Reason::kNone;
  if (whole && answered) solve_dense_schur(scene, data);
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    const IslandData& d = data.islands[i];
    IslandReport& report = data.report.islands[i];
    if (!answered) report.reason = unusable, report.status = Status::kFailed;
    if (report.status == Status::kFailed) {
      fail(scene, data, d, report.reason, report);
      continue;
    }
    scatter(scene, data, d, d.system.x.data(), data.a, data.f);
    report_residuals(scene, d.system, report);
  }
  if (answered) data.f = -data.f;  // x = [a; -f]
  summarise(data.report);
  data.solved = true;
  return data.report;
}

}  // namespace manycontact
