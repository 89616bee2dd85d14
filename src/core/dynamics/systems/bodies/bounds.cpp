// Componentwise error bounds of a solution of the body-space system A z = b:
//
//   |z - z_true| <= |A^-1| (|r| + c eps (|A||z| + |b|)),
//
// where c eps is a relative rounding error, and r = b - A z. Each equation has terms of one body and its parent. A is
// symmetric if the body's acceleration is paired with the equation of forces, and the body's force with the equation of
// accelerations. Rounding errors of b are relative to the terms that b is computed from: terms v x* Y v, of size
// |v|^2 |Y|, cancel if bodies move fast relative to their joints.

#include <algorithm>
#include <cmath>
#include <limits>

#include "../../internal.hpp"
#include "bodies.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/sparse/condition.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

using V6 = Vec6<double>;

// Returns the largest terms of a contact's a0, including the size of its placement in the world, which is rounded too.
internal::RowTerms<double> answered(const Contact& contact, const ContactData<double>& rows) {
  const double place = contact.B.robot < 0 ? internal::largest_entry<double>(contact.B.placement.p) : 0;
  return internal::row_terms<double>(contact, rows, place);
}

// Returns |r| + c eps |terms| per equation: six of a and six of f per body; then joints; then contact rows.
std::vector<double> uncertainty(const Scene& scene, SceneData& data, const BodiesSystem& form) {
  const Island& island = form.owner.island;
  const BodyPattern& p = *form.factor.system.pattern;
  const BodyResidual& left = form.solution.residual;
  const double c = (tolerance::kBoundRounding + 6) * std::numeric_limits<double>::epsilon();
  std::vector<double> w;
  // the smallest normal number counts as a term: below it, rounding errors are no longer relative
  const auto rounding = [c](double scale) { return c * std::max(scale, std::numeric_limits<double>::min()); };
  w.reserve(12 * static_cast<std::size_t>(p.nodes) + p.nv + p.nc);
  for (int i = 0; i < p.nodes; ++i) {
    for (int k = 0; k < 6; ++k) w.push_back(std::abs(left.r.motion[i][k]) + rounding(left.body_scale[i][k / 3]));
    for (int k = 0; k < 6; ++k) w.push_back(std::abs(left.r.force[i][k]) + rounding(left.body_scale[i][2 + k / 3]));
  }
  for (std::size_t k = 0, i = 0; k < form.kin.size(); ++k)
    for (const V6& v : form.kin[k].v) {
      const double square = std::pow(v.cwiseAbs().maxCoeff(), 2),
                   size = internal::inertia_size(form.factor.system.Y[i]);
      for (std::size_t e = 0; e < 12; ++e) w[12 * i + e] += c * square * (e < 6 ? 1 : size);
      ++i;
    }
  const std::vector<double> applied = internal::applied_sizes(scene, data, island).tau;
  each_velocity_block(scene, island, [&](int at, int first, int n) {
    for (int i = 0; i < n; ++i)
      w.push_back(std::abs(left.r.joints[first + i]) + rounding(left.joint_scale[first + i] + applied[at + i]));
  });
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const internal::RowTerms<double> terms = answered(contact, form.contacts[k]);
    for (int i = 0; i < contact.rows(); ++i) {
      const int row = island.row_offset[k] + i;
      w.push_back(std::abs(left.r.rows[row]) + rounding(left.row_scale[row] + terms.of_row(i)));
    }
  }
  return w;
}

// Estimates the largest entry of |A^-1| w, among accelerations of joints or (of_rows) contact forces, by the 1-norm of
// their columns of diag(w) A^-T.
double bound(BodiesSystem& form, const std::vector<double>& w, bool of_rows) {
  const BodySystem& s = form.factor.system;
  const BodyPattern& p = *s.pattern;
  BodySolve& v = form.products;
  v.resize(p);
  const std::size_t joints = 12 * static_cast<std::size_t>(p.nodes), rows = joints + p.nv;
  const auto take = [&](const double* x) {
    for (int i = 0; i < p.nodes; ++i) {
      v.b.motion[i] = Eigen::Map<const V6>(x + 12 * i);
      v.b.force[i] = Eigen::Map<const V6>(x + 12 * i + 6);
    }
    v.b.joints = Eigen::Map<const Eigen::VectorXd>(x + joints, p.nv);
    v.b.rows = Eigen::Map<const Eigen::VectorXd>(x + rows, p.nc);
  };
  const auto weigh = [&w](double* x) {
    for (std::size_t k = 0; k < w.size(); ++k) x[k] *= w[k];
  };
  const auto keep = [&](double* x) {
    std::fill_n(x, of_rows ? rows : joints, 0.0);
    if (!of_rows) std::fill_n(x + rows, p.nc, 0.0);
  };
  // Solves with A^-1 or its transpose. The transpose exchanges a and f, up to signs, which do not matter in norms.
  const auto solve = [&](double* x, bool transposed) {
    take(x);
    solve_bodies(s, form.factor.ldl, v.b, v.x);
    for (int i = 0; i < p.nodes; ++i) {
      Eigen::Map<V6>(x + 12 * i) = transposed ? V6(-v.x.force[i]) : v.x.motion[i];
      Eigen::Map<V6>(x + 12 * i + 6) = transposed ? V6(-v.x.motion[i]) : v.x.force[i];
    }
    Eigen::Map<Eigen::VectorXd>(x + joints, p.nv) = v.x.joints;
    Eigen::Map<Eigen::VectorXd>(x + rows, p.nc) = v.x.rows;
  };
  const auto forward = [&](double* x) { weigh(x), solve(x, false), keep(x); };
  const auto backward = [&](double* x) { keep(x), solve(x, true), weigh(x); };
  return tolerance::kNormEstimate * sparse::norm_1_estimate(static_cast<int>(w.size()), backward, forward);
}

double largest(const Eigen::VectorXd& x) { return x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff(); }

// Returns the largest loads on the island, including weights and bias forces of bodies.
internal::Acting what_acts(const Scene& scene, const BodiesSystem& form) {
  const BodySystem& s = form.factor.system;
  const BodyPattern& p = *s.pattern;
  const BodyVectors& b = form.solution.b;
  internal::Acting acting{scene.gravity.cwiseAbs().maxCoeff()};
  for (int i = 0; i < p.nodes; ++i) {
    acting.load = std::max({acting.load, s.Y[i].m * acting.gravity, b.force[i].cwiseAbs().maxCoeff()});
    for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k)
      acting.add_coordinate(std::abs(b.joints[k]), s.armature[k] + s.S.col(k).dot(s.Y[i] * V6(s.S.col(k))));
  }
  for (std::size_t k = 0; k < form.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[form.owner.island.contacts[k]];
    acting.add_contact(contact, form.contacts[k], answered(contact, form.contacts[k]));
  }
  return acting;
}

}  // namespace

bool BodiesSystem::bound_errors(const Scene& scene, SceneData& data, IslandReport& report) {
  if (!make_current(scene, data)) return false;
  internal::evaluate_rows_at_solution(scene, *this);
  const BodyVectors& x = solution.x;
  (void)backward_error(factor.system, solution.b, x, solution.residual);
  const std::vector<double> w = uncertainty(scene, data, *this);
  // distance of the reported solution, which may be by subtrees, to that of the whole island, whose error is bounded
  double da = 0, df = 0;
  each_velocity_block(scene, owner.island, [&](int from, int to, int n) {
    if (n > 0) da = std::max(da, (data.a.segment(from, n) - x.joints.segment(to, n)).cwiseAbs().maxCoeff());
  });
  each_force_block(scene, data.f_offset, owner.island, [&](int from, int to, int n) {
    df = std::max(df, (data.f.segment(from, n) + x.rows.segment(to, n)).cwiseAbs().maxCoeff());
  });
  const internal::Acting acting = what_acts(scene, *this);
  internal::report_bounds({largest(x.joints), bound(*this, w, false) + da, acting.acceleration()},
                          {largest(x.rows), x.rows.size() == 0 ? 0 : bound(*this, w, true) + df, acting.force()},
                          report);
  return true;
}

bool BodiesSystem::estimate_condition(const Scene& scene, SceneData& data, IslandReport& report) {
  if (!make_current(scene, data)) return false;
  const int n = owner.island.size();
  const auto multiply = [&](double* x) { internal::multiply_bodies(factor.system, x); };
  std::vector<double> b(n), r(n);
  const auto solve = [&](double* x) {  // refined once, as in MatrixSystem
    std::copy_n(x, n, b.data());
    factor.solve(x);
    std::copy_n(x, n, r.data());
    multiply(r.data());
    for (int k = 0; k < n; ++k) r[k] = b[k] - r[k];
    factor.solve(r.data());
    for (int k = 0; k < n; ++k) x[k] += r[k];
  };
  report.condition = sparse::inverse_norm_1(n, multiply) * internal::inverse_norm(n, solve);
  return true;
}

namespace internal {

void multiply_bodies(const BodySystem& s, double* x) {
  const BodyPattern& p = *s.pattern;
  std::vector<V6> a(p.nodes), f(p.nodes);
  for (int i = 0; i < p.nodes; ++i) {
    a[i] = p.parent[i] < 0 ? V6(V6::Zero()) : motion_at(a[p.parent[i]], s.r[i]);
    for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k) a[i] += s.S.col(k) * x[k];
    f[i] = s.Y[i] * a[i];
  }
  for (int k = 0; k < p.nc; ++k) {
    double r = -s.delta * x[p.nv + k];
    if (p.A[k] >= 0) r += s.GA.col(k).dot(a[p.A[k]]), f[p.A[k]] += s.GA.col(k) * x[p.nv + k];
    if (p.B[k] >= 0) r += s.GB.col(k).dot(a[p.B[k]]), f[p.B[k]] += s.GB.col(k) * x[p.nv + k];
    x[p.nv + k] = r;
  }
  for (int i = p.nodes - 1; i >= 0; --i) {
    for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k)
      x[k] = s.S.col(k).dot(f[i]) + s.armature[k] * x[k];
    if (p.parent[i] >= 0) f[p.parent[i]] += force_from(f[i], s.r[i]);
  }
}

}  // namespace internal

}  // namespace manycontact
