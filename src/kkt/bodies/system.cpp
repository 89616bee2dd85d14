#include "manycontact/kkt/bodies/system.hpp"

#include <cmath>
#include <limits>

namespace manycontact {

void BodySystem::reset(std::shared_ptr<const BodyPattern> p) {
  r.resize(p->nodes);
  Y.resize(p->nodes);
  S.setZero(6, p->nv);
  armature.setZero(p->nv);
  GA.setZero(6, p->nc);
  GB.setZero(6, p->nc);
  pattern = std::move(p);
}

void BodyVectors::resize(const BodyPattern& p) {
  motion.resize(p.nodes);
  force.resize(p.nodes);
  joints.resize(p.nv);
  rows.resize(p.nc);
}

void BodyVectors::set_zero() {
  std::fill(motion.begin(), motion.end(), Vec6<double>(Vec6<double>::Zero()));
  std::fill(force.begin(), force.end(), Vec6<double>(Vec6<double>::Zero()));
  joints.setZero();
  rows.setZero();
}

void BodyResidual::resize(const BodyPattern& p) {
  r.resize(p);
  body_scale.resize(p.nodes);
  joint_scale.resize(p.nv);
  row_scale.resize(p.nc);
}

namespace {

using V6 = Vec6<double>;

double lin(const V6& x) { return std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}); }
double ang(const V6& x) { return std::max({std::abs(x[3]), std::abs(x[4]), std::abs(x[5])}); }
double reach(const Vec3<double>& r) { return std::max({std::abs(r[0]), std::abs(r[1]), std::abs(r[2])}); }

// Terms of a motion's equation, and a residual with it.
template <int N>
[[gnu::always_inline]] inline void motion_equation(const BodySystem& s, const BodyVectors& b, const BodyVectors& x,
                                                   int i, V6& r, double* scale) {
  const BodyPattern& p = *s.pattern;
  const V6& a = x.motion[i];
  const int parent = p.parent[i], first = p.first_dof[i];
  r = b.motion[i] - a;
  scale[0] = std::max(lin(b.motion[i]), lin(a)), scale[1] = std::max(ang(b.motion[i]), ang(a));
  if (parent >= 0) {
    const V6 ap = motion_at(x.motion[parent], s.r[i]);
    r += ap;
    const double turning = ang(ap);
    scale[0] = std::max({scale[0], lin(ap), reach(s.r[i]) * turning});
    scale[1] = std::max(scale[1], turning);
  }
  for (int k = first; k < first + N; ++k) {
    const V6 Sx = s.S.col(k) * x.joints[k];
    r += Sx;
    scale[0] = std::max(scale[0], lin(Sx)), scale[1] = std::max(scale[1], ang(Sx));
  }
}

void motion_terms(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, int i, double* scale) {
  V6 r;
  const int n = s.pattern->ndof[i];
  n == 1   ? motion_equation<1>(s, b, x, i, r, scale)
  : n == 3 ? motion_equation<3>(s, b, x, i, r, scale)
           : motion_equation<6>(s, b, x, i, r, scale);
}

// The rows' forces and the children's on node i.
[[gnu::always_inline]] inline void outer_forces(const BodySystem& s, const BodyVectors& x, int i, const double* more,
                                                V6& r, double* scale) {
  const BodyPattern& p = *s.pattern;
  for (int child = i + 1; child < p.end[i]; child = p.end[child]) {
    const V6& f = x.force[child];
    r += force_from(f, s.r[child]);
    const double size = lin(f);
    scale[2] = std::max(scale[2], size);
    scale[3] = std::max({scale[3], ang(f), reach(s.r[child]) * size});
  }
  for (int q = p.at_first[i]; q < p.at_first[i + 1]; ++q) {
    const int row = p.at[q];
    const double y = more ? x.rows[row] + more[row] : x.rows[row];
    const auto end = [&](const auto& G) {
      const V6 F = G * y;
      r += F;
      scale[2] = std::max(scale[2], lin(F)), scale[3] = std::max(scale[3], ang(F));
    };
    if (p.A[row] == i)
      end(s.GA.col(row));
    else
      end(s.GB.col(row));
  }
}

// Keeps what is not finite for `sum_` to tell.
void take_largest(double& largest, double x) {
  if (x > largest) largest = x;
}
void take_ratio(double& error, double r, double scale) {
  if (r > error * scale) error = r / scale;
}

}  // namespace

template <int N, bool Keep>
void BodyJudge::equations(int i, const double* more) {
  const V6 &a = x_.motion[i], &f = x_.force[i];
  const int first = s_.pattern->first_dof[i];
  double scale[4];
  V6 r;
  motion_equation<N>(s_, b_, x_, i, r, scale);
  out_.r.motion[i] = r;
  sum_ += r.sum();
  take_ratio(error_, lin(r), scale[0]), take_ratio(error_, ang(r), scale[1]);
  const Inertia<double>& Y = s_.Y[i];
  const double h = reach(Y.h), I = std::max({Y.I(0, 0), Y.I(1, 1), Y.I(2, 2)}), a_lin = lin(a), a_ang = ang(a);
  scale[2] = std::max({lin(f), lin(b_.force[i]), Y.m * a_lin + h * a_ang});
  scale[3] = std::max({ang(f), ang(b_.force[i]), h * a_lin + I * a_ang});
  r = b_.force[i] - f;
  r += Y * a;
  outer_forces(s_, x_, i, more, r, scale);
  out_.r.force[i] = r;
  sum_ += r.sum();
  const double r_lin = lin(r), r_ang = ang(r);
  take_ratio(error_, r_lin, scale[2]), take_ratio(error_, r_ang, scale[3]);
  take_largest(dynamics_, std::max(r_lin, r_ang));
  for (int k = 0; k < 4; ++k) take_largest(largest_[k], scale[k]);
  if constexpr (Keep) out_.body_scale[i] = Eigen::Map<const Eigen::Vector4d>(scale);
  for (int k = first; k < first + N; ++k) {
    const V6 S = s_.S.col(k);
    const double inertia = s_.armature[k] * x_.joints[k];
    const double left = b_.joints[k] - S.dot(f) - inertia;
    const double terms = std::abs(b_.joints[k]) + std::abs(inertia) + lin(S) * scale[2] + ang(S) * scale[3];
    out_.r.joints[k] = left;
    sum_ += left;
    take_ratio(error_, std::abs(left), terms);
    take_largest(dynamics_, std::abs(left));
    take_largest(joint_, terms);
    if constexpr (Keep) out_.joint_scale[k] = terms;
  }
}

void BodyJudge::node(int i, const double* more) {
  const int n = s_.pattern->ndof[i];
  n == 1 ? equations<1, false>(i, more) : n == 3 ? equations<3, false>(i, more) : equations<6, false>(i, more);
}

void BodyJudge::rows() {
  const BodyPattern& p = *s_.pattern;
  int last[2] = {-1, -1};  // of which node `terms` are
  double terms[2][4];
  for (int k = 0; k < p.nc; ++k) {
    const double y = x_.rows[k];
    double r = b_.rows[k] + s_.delta * y, scale = std::abs(b_.rows[k]) + std::abs(s_.delta * y);
    const auto end = [&](int node, const auto& G, int which) {
      if (node < 0) return;
      if (last[which] != node) motion_terms(s_, b_, x_, node, terms[which]);
      last[which] = node;
      r -= G.dot(x_.motion[node]);
      scale += lin(G) * terms[which][0] + ang(G) * terms[which][1];
    };
    end(p.A[k], s_.GA.col(k), 0);
    end(p.B[k], s_.GB.col(k), 1);
    out_.r.rows[k] = r;
    out_.row_scale[k] = scale;
    sum_ += r;
    take_ratio(error_, std::abs(r), scale);
    take_largest(contact_, std::abs(r));
    take_largest(row_, scale);
  }
}

double BodyJudge::error() {
  out_.dynamics = dynamics_, out_.contact = contact_;
  out_.dynamics_scale = std::max({largest_[2], largest_[3], joint_});
  out_.contact_scale = row_;
  const bool finite = std::isfinite(sum_) && std::isfinite(out_.dynamics_scale) && std::isfinite(row_) &&
                      std::isfinite(largest_[0]) && std::isfinite(largest_[1]);
  return finite ? error_ : std::numeric_limits<double>::quiet_NaN();
}

double backward_error(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  BodyJudge judge(s, b, x, out);
  for (int i = 0; i < p.nodes; ++i)
    p.ndof[i] == 1   ? judge.equations<1, true>(i, nullptr)
    : p.ndof[i] == 3 ? judge.equations<3, true>(i, nullptr)
                     : judge.equations<6, true>(i, nullptr);
  judge.rows();
  double error = judge.error();
  if (!(error > 0)) return error;
  constexpr double eps = std::numeric_limits<double>::epsilon();
  const Eigen::Vector4d least = eps * Eigen::Map<const Eigen::Vector4d>(judge.largest_);
  error = 0;
  for (int i = 0; i < p.nodes; ++i) {
    const Eigen::Vector4d scale = out.body_scale[i].cwiseMax(least);
    take_ratio(error, lin(out.r.motion[i]), scale[0]), take_ratio(error, ang(out.r.motion[i]), scale[1]);
    take_ratio(error, lin(out.r.force[i]), scale[2]), take_ratio(error, ang(out.r.force[i]), scale[3]);
  }
  for (int k = 0; k < p.nv; ++k)
    take_ratio(error, std::abs(out.r.joints[k]), std::max(out.joint_scale[k], eps * judge.joint_));
  for (int k = 0; k < p.nc; ++k)
    take_ratio(error, std::abs(out.r.rows[k]), std::max(out.row_scale[k], eps * judge.row_));
  return error;
}

}  // namespace manycontact
