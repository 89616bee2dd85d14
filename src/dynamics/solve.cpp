#include "manycontact/dynamics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "internal.hpp"
#include "manycontact/sparse/condition.hpp"

namespace manycontact {

namespace internal {

namespace {

// Residuals relative to the terms they are left of; those of the contacts at least to gravity, or a scene at rest would
// have rounding compared with rounding.
void report_residuals(const Scene& scene, const KktSystem& s, IslandReport& report) {
  const KktPattern& p = *s.pattern;
  double r[2] = {0, 0}, scale[2] = {0, scene.gravity.norm()};  // dynamics rows, contact rows
  for (int k = 0; k < p.size(); ++k) {
    const int row = p.perm[k] >= p.nv;
    if (!(std::abs(s.r[k]) <= r[row])) r[row] = std::abs(s.r[k]);
    scale[row] = std::max(scale[row], s.scale[k]);
  }
  report.residual_dynamics = r[0] == 0 ? 0 : r[0] / scale[0];
  report.residual_contact = r[1] == 0 ? 0 : r[1] / scale[1];
}

// Why this island's input cannot be used, kNone if it can.
Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                   const Island& island) {
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    const Model& model = *robot.model;
    if (!q.segment(robot.idx_q, model.nq).allFinite() || !v.segment(robot.idx_v, model.nv).allFinite() ||
        !u.segment(robot.idx_u, model.nu()).allFinite())
      return Reason::kNotFinite;
    for (const Joint& joint : model.joints)
      if (joint.type == JointType::kFloating &&
          std::abs(q.segment<4>(robot.idx_q + joint.idx_q + 3).norm() - 1) > 1e-6)
        return Reason::kBadQuaternion;
  }
  return Reason::kNone;
}

Reason solve_by(Method method, const Scene& scene, SceneData& data, IslandData& d, IslandReport& report) {
  switch (method) {
    case Method::kSparseCholmod:
      return solve_cholmod(d, report);
    case Method::kSparseSupernodal:
      return solve_supernodal(scene, d, report);
    default:
      return solve_ldl(data, d, report);
  }
}

// The ladder: the method and order chosen; the same in leaf-to-root order; the oracle.
void solve_island(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u,
                  SceneData& data, IslandData& d, IslandReport& report) {
  if (d.system.pattern != d.chosen) d.system.reset(d.chosen);
  evaluate(scene, q, v, u, data, d);
  if (d.method != Method::kDense) {
    report.reason = solve_by(d.method, scene, data, d, report);
    if (report.reason == Reason::kNone) return;
    if (d.method != Method::kSparseSupernodal && d.chosen != d.safe && report.reason != Reason::kSmallPivot) {
      const Reason first = report.reason;
      d.system.reset(d.safe);
      evaluate(scene, q, v, u, data, d);
      if (solve_by(d.method, scene, data, d, report) == Reason::kNone) {
        report.changed_order = true;
        report.reason = first;
        return;
      }
    }
  }
  d.factor = Factor::kNone;
  solve_dense(scene, d, report);
}

void fail(const Scene& scene, SceneData& data, const IslandData& d, Reason reason, IslandReport& report) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  report.status = Status::kFailed;
  report.reason = reason;
  report.rank = 0;
  report.residual_dynamics = report.residual_contact = nan;
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
  using namespace internal;
  check_size("q", q.size(), scene.nq);
  check_size("v", v.size(), scene.nv);
  check_size("u", u.size(), scene.nu);
  prepare(scene, data);
  data.v = v;
  data.report.method = data.options.method;
  const bool whole = data.options.method == Method::kDenseSchur;
  Reason unusable = Reason::kNone;  // the first island's that cannot be used
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandData& d = data.islands[i];
    IslandReport& report = data.report.islands[i];
    report = {};
    report.nv = d.island.nv;
    report.nc = report.rank = d.island.nc;
    d.factor = Factor::kNone;
    const Reason reason = check_input(scene, q, v, u, d.island);
    if (reason != Reason::kNone) {
      report.status = Status::kFailed;
      report.reason = reason;
      if (unusable == Reason::kNone) unusable = reason;
    } else if (whole) {
      evaluate(scene, q, v, u, data, d);
    } else {
      solve_island(scene, q, v, u, data, d, report);
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

namespace {

Eigen::MatrixXd dense_matrix(const KktSystem& s) {
  const sparse::UpperCsc& K = s.pattern->K;
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(K.n, K.n);
  for (int j = 0; j < K.n; ++j)
    for (int k = K.p[j]; k < K.p[j + 1]; ++k) out(K.i[k], j) = out(j, K.i[k]) = s.Kx[k];
  return out;
}

}  // namespace

void estimate_condition(const Scene& scene, SceneData& data) {
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandData& d = data.islands[i];
    KktSystem& s = d.system;
    if (d.factor == Factor::kNone) {
      data.report.islands[i].condition = std::numeric_limits<double>::infinity();
      continue;
    }
    const double norm = sparse::norm_1(s.pattern->K, s.Kx.data(), s.scale.data());
    std::function<void(double*)> apply = [&](double* x) { internal::solve_with_factor(scene, d, x); };
    if (d.factor == Factor::kDenseSchur)  // a factor of the whole scene: here the island's own is needed
      apply = [lu = dense_matrix(s).partialPivLu(), n = d.island.size()](double* x) {
        Eigen::Map<Eigen::VectorXd> rhs(x, n);
        rhs = lu.solve(rhs).eval();
      };
    data.report.islands[i].condition = norm * sparse::inverse_norm_1(d.island.size(), apply);
  }
  summarise(data.report);
}

}  // namespace manycontact
