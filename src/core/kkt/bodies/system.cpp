#include "manycontact/kkt/bodies/system.hpp"

#include <cmath>
#include <limits>

#include "pairs.hpp"

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
using pairs::Two, pairs::max, pairs::sizes;

double reach(const Vec3<double>& r) { return std::max({std::abs(r[0]), std::abs(r[1]), std::abs(r[2])}); }

// Computes the residual r of a_i = X a_p + S_i qdd_i + c_i, p the parent, and its largest linear and angular `scale`.
template <int N>
[[gnu::always_inline]] inline void motion_equation(const BodySystem& s, const BodyVectors& b, const BodyVectors& x,
                                                   int i, V6& r, Two& scale) {
  const BodyPattern& p = *s.pattern;
  const V6& a = x.motion[i];
  const int parent = p.parent[i], first = p.first_dof[i];
  r = b.motion[i] - a;
  scale = max(sizes(b.motion[i]), sizes(a));
  if (parent >= 0) {
    const V6 ap = pairs::motion_at(x.motion[parent], s.r[i]);
    pairs::add(ap, r);
    const Two ap_sizes = sizes(ap);
    scale = max(scale, max(ap_sizes, Two{reach(s.r[i]) * ap_sizes[1], 0}));
  }
  for (int k = first; k < first + N; ++k) {
    const V6 Sx = s.S.col(k) * x.joints[k];
    pairs::add(Sx, r);
    scale = max(scale, sizes(Sx));
  }
}

void motion_terms(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, int i, Two& scale) {
  V6 r;
  const int n = s.pattern->ndof[i];
  n == 1   ? motion_equation<1>(s, b, x, i, r, scale)
  : n == 3 ? motion_equation<3>(s, b, x, i, r, scale)
           : motion_equation<6>(s, b, x, i, r, scale);
}

// Adds the forces of contact rows and of children on node i to the residual r of its force equation, and to the largest
// terms `scale`. more: if given, is added to x.rows.
[[gnu::always_inline]] inline void outer_forces(const BodySystem& s, const BodyVectors& x, int i, const double* more,
                                                V6& r, Two& scale) {
  const BodyPattern& p = *s.pattern;
  for (int child = i + 1; child < p.end[i]; child = p.end[child]) {
    const V6& f = x.force[child];
    pairs::add(pairs::force_from(f, s.r[child]), r);
    const Two f_sizes = sizes(f);
    scale = max(scale, max(f_sizes, Two{0, reach(s.r[child]) * f_sizes[0]}));
  }
  for (int q = p.at_first[i]; q < p.at_first[i + 1]; ++q) {
    const int row = p.at[q];
    const double y = more ? x.rows[row] + more[row] : x.rows[row];
    const V6 F = (p.A[row] == i ? s.GA : s.GB).col(row) * y;
    pairs::add(F, r);
    scale = max(scale, sizes(F));
  }
}

// Raises `largest` to x if x is larger. NaN has no effect here, but makes the sum of all residuals (sum_) NaN.
void take_largest(double& largest, double x) {
  if (x > largest) largest = x;
}
void take_ratio(double& error, double r, double scale) {
  if (r > error * scale) error = r / scale;
}
void take_ratios(double& error, Two r, Two scale) {
  take_ratio(error, r[0], scale[0]), take_ratio(error, r[1], scale[1]);
}

}  // namespace

template <int N, bool Keep>
void BodyJudge::equations(int i, const double* more) {
  const V6 &a = x_.motion[i], &f = x_.force[i];
  const int first = s_.pattern->first_dof[i];
  Two motion_scale, scale;
  V6 r;
  motion_equation<N>(s_, b_, x_, i, r, motion_scale);
  out_.r.motion[i] = r;
  sum_ += r.sum();
  take_ratios(error_, sizes(r), motion_scale);
  const Inertia<double>& Y = s_.Y[i];
  const double h = reach(Y.h), I = std::max({Y.I(0, 0), Y.I(1, 1), Y.I(2, 2)});
  const Two a_sizes = sizes(a);
  scale = max(max(sizes(f), sizes(b_.force[i])), Two{Y.m, h} * a_sizes[0] + Two{h, I} * a_sizes[1]);
  r = b_.force[i] - f;
  pairs::add(pairs::times(Y, a), r);
  outer_forces(s_, x_, i, more, r, scale);
  out_.r.force[i] = r;
  sum_ += r.sum();
  const Two left = sizes(r);
  take_ratios(error_, left, scale);
  take_largest(dynamics_, std::max(left[0], left[1]));
  pairs::store(max(pairs::load(largest_), motion_scale), largest_);
  pairs::store(max(pairs::load(largest_ + 2), scale), largest_ + 2);
  if constexpr (Keep) out_.body_scale[i] << motion_scale[0], motion_scale[1], scale[0], scale[1];
  for (int k = first; k < first + N; ++k) {
    const V6 S = s_.S.col(k);
    const double inertia = s_.armature[k] * x_.joints[k];
    const double r_joint = b_.joints[k] - S.dot(f) - inertia;
    const Two of_f = sizes(S) * scale;
    const double terms = std::abs(b_.joints[k]) + std::abs(inertia) + of_f[0] + of_f[1];
    out_.r.joints[k] = r_joint;
    sum_ += r_joint;
    take_ratio(error_, std::abs(r_joint), terms);
    take_largest(dynamics_, std::abs(r_joint));
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
  int last[2] = {-1, -1};  // nodes for which terms[0], at A, and terms[1], at B, were computed
  Two terms[2];
  for (int k = 0; k < p.nc; ++k) {
    const double y = x_.rows[k];
    double r = b_.rows[k] + s_.delta * y, scale = std::abs(b_.rows[k]) + std::abs(s_.delta * y);
    const auto end = [&](int node, const auto& G, int which) {
      if (node < 0) return;
      if (last[which] != node) motion_terms(s_, b_, x_, node, terms[which]);
      last[which] = node;
      r -= G.dot(x_.motion[node]);
      const Two of_a = sizes(G) * terms[which];
      scale += of_a[0] + of_a[1];
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
    take_ratios(error, sizes(out.r.motion[i]), pairs::load(scale.data()));
    take_ratios(error, sizes(out.r.force[i]), pairs::load(scale.data() + 2));
  }
  for (int k = 0; k < p.nv; ++k)
    take_ratio(error, std::abs(out.r.joints[k]), std::max(out.joint_scale[k], eps * judge.joint_));
  for (int k = 0; k < p.nc; ++k)
    take_ratio(error, std::abs(out.r.rows[k]), std::max(out.row_scale[k], eps * judge.row_));
  return error;
}

}  // namespace manycontact
