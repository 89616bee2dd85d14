#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "../../internal.hpp"
#include "manycontact/sparse/condition.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "matrix.hpp"
#include "row_terms.hpp"

namespace manycontact {

namespace {

using Apply = std::function<void(double*)>;

Apply inverse(MatrixSystem& m) {  // x -> K^-1 x, or K^+ x if K is singular, by the current factor
  return [&m](double* x) { m.factor->solve(x); };
}

// Magnitudes of the linear and the angular part of a motion or a force. One common magnitude would be too large for a
// body that slides far away: it would count as a rotation with a large moment arm.
struct TwistSize {
  double linear = 0, angular = 0;
  double of(const TwistSize& motion) const { return linear * motion.linear + angular * motion.angular; }
  void take(const Vec6<double>& x) {
    linear = std::max(linear, x.head<3>().cwiseAbs().maxCoeff());
    angular = std::max(angular, x.tail<3>().cwiseAbs().maxCoeff());
  }
};

struct InertiaSize {  // magnitudes of mass, first moment, moments of inertia; at least of m at `lever`
  double m = 0, h = 0, I = 0;
  InertiaSize() = default;
  InertiaSize(const Inertia<double>& Y, double lever)
      : m(std::abs(Y.m)),
        h(std::max(Y.h.cwiseAbs().maxCoeff(), m * lever)),
        I(std::max(Y.I.cwiseAbs().maxCoeff(), m * lever * lever)) {}
  InertiaSize& operator+=(const InertiaSize& o) { return m += o.m, h += o.h, I += o.I, *this; }
  TwistSize operator*(const TwistSize& x) const { return {m * x.linear + h * x.angular, h * x.linear + I * x.angular}; }
};

// Returns the magnitudes of a joint's motion column k, including its rotation times its distance from the origin.
TwistSize size_of_column(const Kinematics<double>& kin, int joint, int k) {
  TwistSize out;
  out.take(kin.J.col(k));
  out.linear = std::max(out.linear, out.angular * kin.oMi[joint].p.cwiseAbs().maxCoeff());
  return out;
}

}  // namespace

// M has terms S^T Yc S, h has S^T f. S: joint motions; Yc: composite inertias; f: body forces; all in the tree frame.
void internal::torque_terms(const Model& model, const RobotData& r, const double* a, double* w, double* largest_of_M) {
  const std::size_t n = model.joints.size();
  std::vector<TwistSize> v(n), acceleration(n), force(n);  // v, acceleration: largest from the base to the body
  std::vector<InertiaSize> Yc(n);
  for (int i = 0; i < model.njoints(); ++i) {
    if (const int parent = model.joints[i].parent; parent >= 0)
      v[i] = v[parent], acceleration[i] = acceleration[parent];
    v[i].take(r.kin.v[i]);
    acceleration[i].take(r.kin.a[i]);
    Yc[i] = InertiaSize(r.kin.Y[i], r.kin.oMi[i].p.cwiseAbs().maxCoeff());
    const TwistSize l = Yc[i] * v[i];  // f = Y a + v x* Y v
    force[i] = Yc[i] * acceleration[i];
    force[i].linear += v[i].angular * l.linear;
    force[i].angular += v[i].angular * l.angular + v[i].linear * l.linear;
  }
  std::fill_n(w, model.nv, 0.0);
  if (largest_of_M) std::fill_n(largest_of_M, model.nv, 0.0);
  for (int i = model.njoints() - 1; i >= 0; --i) {
    const Joint& joint = model.joints[i];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      const TwistSize s = size_of_column(r.kin, i, k), F = Yc[i] * s;
      w[k] += force[i].of(s);
      for (int j = k; j >= 0; j = model.dof_parent[j]) {
        const double entry = F.of(size_of_column(r.kin, model.dof_joint[j], j));
        w[k] += entry * std::abs(a[j]);
        if (j != k) w[j] += entry * std::abs(a[k]);
        if (!largest_of_M) continue;
        largest_of_M[k] = std::max(largest_of_M[k], entry);
        largest_of_M[j] = std::max(largest_of_M[j], entry);
      }
    }
    if (joint.parent < 0) continue;
    Yc[joint.parent] += Yc[i];
    force[joint.parent].linear += force[i].linear;
    force[joint.parent].angular += force[i].angular;
  }
}

double internal::rounding(const Scene& scene, const MatrixSystem& m) {
  int depth = 0;
  for (int r : m.owner.island.robots)
    for (int i : scene.robots[r].model->dof_depth) depth = std::max(depth, i);
  return (tolerance::kBoundRounding + depth) * std::numeric_limits<double>::epsilon();
}

double internal::rounding_of_J(const Scene& scene, const MatrixSystem& m) {
  return std::max(rounding(scene, m), m.factor->left_of_dropped_rows());
}

void internal::add_terms_of_J(const Scene& scene, const Workspace& work, const MatrixSystem& m,
                              const std::vector<double>& sizes, std::vector<double>& w) {
  const Island& island = m.owner.island;
  const int* iperm = m.K.pattern->iperm.data();
  const double of_J = rounding_of_J(scene, m) / rounding(scene, m);
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const RowTerms<double> J = motion_terms(contact, work.contacts[island.contacts[k]]);
    const std::vector<int>& columns = m.owner.shape->support().columns[k];
    double moved = 0, of_f = 0;
    for (int column : columns) moved += sizes[iperm[column]];
    for (int i = 0, row = island.row_offset[k]; i < contact.rows(); ++i, ++row) {
      const double size = of_J * J.of_row(i) * unit_of(m, row);
      w[iperm[island.nv + row]] += size * moved;
      of_f += size * sizes[iperm[island.nv + row]];
    }
    for (int column : columns) w[iperm[column]] += of_f;
  }
  m.each_change([&](int row, int column, double value) {
    const double size = std::abs(value) / rounding(scene, m);
    w[row] += size * sizes[column];
    w[column] += size * sizes[row];
  });
}

namespace {

using internal::rounding;
using internal::rounding_of_J;

// Returns |r| + c eps |terms| per row of K x = b, in elimination order. r: residual b - K x without the contacts'
// inconsistency; terms: the terms that are summed in the row.
std::vector<double> uncertainty(const Scene& scene, SceneData& data, const MatrixSystem& m) {
  const Workspace& work = *data.workspace;
  const KktVectors& s = m.v;
  const int* iperm = m.K.pattern->iperm.data();
  std::vector<double> w(m.owner.island.size(), 0.0), a(m.owner.island.nv);  // w and a are in the island's order
  for (int k = 0; k < m.owner.island.nv; ++k) a[k] = s.x[iperm[k]];
  for (std::size_t k = 0; k < m.owner.island.robots.size(); ++k) {
    const int r = m.owner.island.robots[k], o = m.owner.island.dof_offset[k];
    internal::torque_terms(*scene.robots[r].model, work.robots[r], a.data() + o, w.data() + o);
  }
  const std::vector<double> applied = internal::applied_sizes(scene, data, m.owner.island).tau;
  each_velocity_block(scene, m.owner.island, [&](int at, int first, int n) {
    for (int i = 0; i < n; ++i) w[first + i] += applied[at + i];
  });
  for (std::size_t k = 0; k < m.owner.island.contacts.size(); ++k) {
    const int c = m.owner.island.contacts[k];
    const internal::RowTerms<double> terms = internal::row_terms(scene, work, c);
    for (int i = 0, row = m.owner.island.row_offset[k]; i < scene.contacts[c].rows(); ++i, ++row)
      w[m.owner.island.nv + row] = terms.of_row(i) * unit_of(m, row);
  }
  std::vector<double> x(s.x), of_J(w.size(), 0.0);
  for (double& entry : x) entry = std::abs(entry);
  internal::add_terms_of_J(scene, work, m, x, of_J);
  const double c = rounding(scene, m);
  const bool deficient = m.deficient();
  std::vector<double> out(w.size());
  for (std::size_t k = 0; k < w.size(); ++k) {
    const int at = iperm[k];
    const double left = deficient ? s.r[at] - s.null_component[at] : s.r[at];
    out[at] = std::abs(left) + c * (s.scale[at] + w[k] + of_J[at]);
  }
  return out;
}

// Estimates the largest of kept_k (|K^-1| w)_k over k as the 1-norm of diag(w) K^-1 diag(kept). kept: weights of the
// unknowns, zero for those that do not count. solve(x): x becomes K^-1 x.
double bound(const Apply& solve, const std::vector<double>& w, const std::vector<double>& kept) {
  const int n = static_cast<int>(w.size());
  const auto mask = [&](double* x) {
    for (int k = 0; k < n; ++k) x[k] *= kept[k];
  };
  const auto scale = [&](double* x) {
    for (int k = 0; k < n; ++k) x[k] *= w[k];
  };
  return tolerance::kNormEstimate *
         sparse::norm_1_estimate(
             n, [&](double* x) { mask(x), solve(x), scale(x); }, [&](double* x) { scale(x), solve(x), mask(x); });
}

// Returns weights of K's unknowns: in rows first ... first+count-1, 1 for a and the row's weight S for f, else zero.
std::vector<double> kept_rows(const MatrixSystem& m, int first, int count) {
  std::vector<double> kept(m.owner.island.size(), 0.0);
  for (int k = first; k < first + count; ++k)
    kept[m.K.pattern->iperm[k]] = k < m.owner.island.nv ? 1 : unit_of(m, k - m.owner.island.nv);
  return kept;
}

// Bounds the change P dJ y of least-norm forces f = J y that is due to rounding errors dJ, which rotate the null space
// of J^T; P = I - J J^+ (Golub, Pereyra, SIAM J. Numer. Anal. 10, 1973, eq. 4.12). The relative errors dJ are c eps in
// the nonzero columns of each row, and eps in all columns due to orthogonal elimination (Higham, theorem 19.4).
double turned_forces(const Scene& scene, const Workspace& work, MatrixSystem& m) {
  const int* iperm = m.K.pattern->iperm.data();
  const int n = m.owner.island.size();
  std::vector<double> y(n, 0.0), w(n, 0.0), part(n);
  for (int k = m.owner.island.nv; k < n; ++k) y[iperm[k]] = m.v.x[iperm[k]];
  m.factor->particular_solution(y.data());
  const double c_eps = rounding_of_J(scene, m);
  double all_moved = 0;
  for (int column = 0; column < m.owner.island.nv; ++column) all_moved += std::abs(y[iperm[column]]);
  for (std::size_t k = 0; k < m.owner.island.contacts.size(); ++k) {
    const int c = m.owner.island.contacts[k], rows = scene.contacts[c].rows();
    double moved = 0;
    for (int column : m.owner.shape->support().columns[k]) moved += std::abs(y[iperm[column]]);
    const internal::RowTerms<double> J = internal::motion_terms(scene.contacts[c], work.contacts[c]);
    const double times = c_eps * moved + std::numeric_limits<double>::epsilon() * all_moved;
    const int row = m.owner.island.row_offset[k];
    for (int i = 0; i < rows; ++i) w[iperm[m.owner.island.nv + row + i]] = J.of_row(i) * times * unit_of(m, row + i);
  }
  m.each_change([&](int row, int column, double value) { w[row] += std::abs(value * y[column]); });
  return bound(
      [&](double* x) {
        for (int k = 0; k < m.owner.island.nv; ++k) x[iperm[k]] = 0;
        std::fill(part.begin(), part.end(), 0.0);
        m.factor->project_out(x, part.data());
        std::copy(part.begin(), part.end(), x);
      },
      w, kept_rows(m, 0, n));
}

}  // namespace

// The relative errors dJ of J are c eps in each row's nonzero columns, and eps in all columns due to orthogonal
// elimination (Higham, theorem 20.3).
std::vector<double> internal::turned_contradiction(const Scene& scene, const Workspace& work, const MatrixSystem& m,
                                                   const std::vector<double>& r) {
  const int* iperm = m.K.pattern->iperm.data();
  std::vector<double> w(m.owner.island.size(), 0.0);
  const double c_eps = rounding_of_J(scene, m);
  double all = 0;
  for (std::size_t k = 0; k < m.owner.island.contacts.size(); ++k) {
    const int c = m.owner.island.contacts[k];
    const internal::RowTerms<double> J = internal::motion_terms(scene.contacts[c], work.contacts[c]);
    double missed = 0;
    const int row = m.owner.island.row_offset[k];
    for (int i = 0; i < scene.contacts[c].rows(); ++i)
      missed += J.of_row(i) * std::abs(r[iperm[m.owner.island.nv + row + i]]) * unit_of(m, row + i);
    all += missed;
    for (int column : m.owner.shape->support().columns[k]) w[iperm[column]] += c_eps * missed;
  }
  const double anywhere = std::numeric_limits<double>::epsilon() * all;
  for (int column = 0; column < m.owner.island.nv; ++column) w[iperm[column]] += anywhere;
  return w;
}

namespace {

double projected_forces(const MatrixSystem& m) {  // bounds force errors due to rounding of the least-norm projection
  double f = 0;
  for (int k = 0; k < m.owner.island.nc; ++k)
    f = std::max(f, std::abs(m.v.x[m.K.pattern->iperm[m.owner.island.nv + k]]) * unit_of(m, k));
  return m.factor->projector_error() * f;
}

// The largest entry of the reported a or f (size), and the largest difference of an entry to that of MatrixSystem's own
// solution, whose error is bounded (moved). The two differ if another system solved the island.
struct Given {
  double size = 0, moved = 0;
  void add(double given, double own) {
    size = std::max(size, std::abs(given));
    moved = std::max(moved, std::abs(given - own));
  }
};
std::pair<Given, Given> given_answer(const SceneData& data, const Scene& scene, const MatrixSystem& m) {
  const int* iperm = m.K.pattern->iperm.data();
  std::pair<Given, Given> out;
  each_velocity_block(scene, m.owner.island, [&](int given, int own, int n) {
    for (int i = 0; i < n; ++i) out.first.add(data.a[given + i], m.v.x[iperm[own + i]]);
  });
  each_force_block(scene, data.f_offset, m.owner.island, [&](int given, int own, int n) {
    for (int i = 0; i < n; ++i)
      out.second.add(data.f[given + i], -unit_of(m, own + i) * m.v.x[iperm[m.owner.island.nv + own + i]]);
  });
  return out;
}

internal::Acting what_acts(const Scene& scene, const Workspace& work, const MatrixSystem& m) {
  const KktPattern& p = *m.K.pattern;
  internal::Acting acting{scene.gravity.cwiseAbs().maxCoeff()};
  for (int k = 0; k < p.nv; ++k) {
    const int at = p.iperm[k];
    acting.add_coordinate(std::abs(m.v.b[at]), std::abs(m.K.values[p.K.p[at + 1] - 1]));
  }
  for (int c : m.owner.island.contacts)
    acting.add_contact(scene.contacts[c], work.contacts[c], internal::row_terms(scene, work, c));
  return acting;
}

}  // namespace

namespace internal {

double bound_of_solution(MatrixSystem& m, const std::vector<double>& w, int first, int count) {
  if (count == 0) return 0;
  return bound(inverse(m), w, kept_rows(m, first, count));
}

double bound_of_two_solutions(MatrixSystem& m, const std::vector<double>& w, int first, int count) {
  if (count == 0) return 0;
  return bound([&m](double* x) { m.factor->solve(x), m.factor->solve(x); }, w, kept_rows(m, first, count));
}

std::pair<Known, Known> known_answer(const Scene& scene, SceneData& data, MatrixSystem& m) {
  const std::vector<double> w = uncertainty(scene, data, m);
  const auto [a, f] = given_answer(data, scene, m);
  const bool contradicts = m.deficient() && m.contradiction;
  const std::vector<double> turned =
      contradicts ? turned_contradiction(scene, *data.workspace, m, m.v.null_component) : std::vector<double>();
  const auto error = [&](int first, int count, double more) {
    if (count == 0) return 0.0;
    return bound_of_solution(m, w, first, count) + (contradicts ? bound_of_two_solutions(m, turned, first, count) : 0) +
           more;
  };
  double more = f.moved;
  if (m.deficient()) more += turned_forces(scene, *data.workspace, m) + projected_forces(m);
  const Acting acting = what_acts(scene, *data.workspace, m);
  return {{a.size, error(0, m.owner.island.nv, a.moved), acting.acceleration()},
          {f.size, error(m.owner.island.nv, m.owner.island.nc, more), acting.force()}};
}

}  // namespace internal

bool MatrixSystem::bound_errors(const Scene& scene, SceneData& data, IslandReport& report) {
  const auto [a, f] = internal::known_answer(scene, data, *this);
  internal::report_bounds(a, f, report);
  return true;
}

void internal::solve_refined_once(MatrixSystem& m, double* x) {
  const std::size_t n = static_cast<std::size_t>(m.owner.island.size());
  std::vector<double> b(x, x + n), r(n), scale(n);
  m.factor->solve(x);
  sparse::residual(m.K.pattern->K, m.K.values.data(), x, b.data(), r.data(), scale.data());
  m.factor->solve(r.data());
  for (std::size_t k = 0; k < n; ++k) x[k] += r[k];
}

double internal::norm_of(const MatrixSystem& m) {
  std::vector<double> sums(m.owner.island.size());
  return sparse::norm_1(m.K.pattern->K, m.K.values.data(), sums.data());
}

double internal::condition_of(MatrixSystem& m) {
  return norm_of(m) * inverse_norm(m.owner.island.size(), [&m](double* x) { solve_refined_once(m, x); });
}

bool MatrixSystem::estimate_condition(const Scene&, SceneData&, IslandReport& report) {
  report.condition = internal::condition_of(*this);
  return true;
}

}  // namespace manycontact
