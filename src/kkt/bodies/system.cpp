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

// a_i = X a_p + S qdd + c, and f_i without rows and children; the joint's own equations.
template <int N>
void body_equations(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, int i, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  const V6 &a = x.motion[i], &f = x.force[i];
  const int parent = p.parent[i], first = p.first_dof[i];
  V6 r = b.motion[i] - a;
  Eigen::Vector4d scale = out.body_scale[i];
  const double a_lin = lin(a), a_ang = ang(a), f_lin = lin(f), f_ang = ang(f);
  scale[0] = std::max(lin(b.motion[i]), a_lin), scale[1] = std::max(ang(b.motion[i]), a_ang);
  if (parent >= 0) {
    const double lever = reach(s.r[i]);
    const V6 ap = motion_at(x.motion[parent], s.r[i]);
    r += ap;
    scale[0] = std::max({scale[0], lin(ap), lever * ang(ap)});
    scale[1] = std::max(scale[1], ang(ap));
    out.r.force[parent] += force_from(f, s.r[i]);
    Eigen::Vector4d& above = out.body_scale[parent];
    above[2] = std::max(above[2], f_lin);
    above[3] = std::max({above[3], f_ang, lever * f_lin});
  }
  for (int k = first; k < first + N; ++k) {
    const V6 S = s.S.col(k), Sx = S * x.joints[k];
    r += Sx;
    scale[0] = std::max(scale[0], lin(Sx)), scale[1] = std::max(scale[1], ang(Sx));
  }
  out.r.motion[i] = r;
  const Inertia<double>& Y = s.Y[i];
  out.r.force[i] += b.force[i] + Y * a - f;
  const double h = reach(Y.h), I = std::max({Y.I(0, 0), Y.I(1, 1), Y.I(2, 2)});
  scale[2] = std::max({scale[2], f_lin, lin(b.force[i]), Y.m * a_lin + h * a_ang});
  scale[3] = std::max({scale[3], f_ang, ang(b.force[i]), h * a_lin + I * a_ang});
  out.body_scale[i] = scale;
  for (int k = first; k < first + N; ++k) {
    const V6 S = s.S.col(k);
    const double inertia = s.armature[k] * x.joints[k];
    out.r.joints[k] = b.joints[k] - S.dot(f) - inertia;
    out.joint_scale[k] = std::abs(b.joints[k]) + std::abs(inertia) + lin(S) * scale[2] + ang(S) * scale[3];
  }
}

void row_equations(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  for (int k = 0; k < p.nc; ++k) {
    const double y = x.rows[k];
    double r = b.rows[k] + s.delta * y, scale = std::abs(b.rows[k]) + std::abs(s.delta * y);
    const auto end = [&](int node, const auto& G) {
      if (node < 0) return;
      r -= G.dot(x.motion[node]);
      scale += lin(G) * out.body_scale[node][0] + ang(G) * out.body_scale[node][1];
    };
    end(p.A[k], s.GA.col(k));
    end(p.B[k], s.GB.col(k));
    out.r.rows[k] = r;
    out.row_scale[k] = scale;
  }
}

// The rows' forces on their bodies.
void row_forces(const BodySystem& s, const BodyVectors& x, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  for (int k = 0; k < p.nc; ++k) {
    const auto end = [&](int node, const auto& G) {
      if (node < 0) return;
      const V6 F = G * x.rows[k];
      out.r.force[node] += F;
      out.body_scale[node][2] = std::max(out.body_scale[node][2], lin(F));
      out.body_scale[node][3] = std::max(out.body_scale[node][3], ang(F));
    };
    end(p.A[k], s.GA.col(k));
    end(p.B[k], s.GB.col(k));
  }
}

// Keeps NaN.
void take_largest(double& largest, double x) {
  if (!(x <= largest)) largest = x;
}

}  // namespace

double backward_error(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  for (int i = 0; i < p.nodes; ++i) {
    out.r.force[i].setZero();
    out.body_scale[i].setZero();
  }
  row_forces(s, x, out);
  for (int i = p.nodes - 1; i >= 0; --i) {
    if (p.ndof[i] == 1)
      body_equations<1>(s, b, x, i, out);
    else if (p.ndof[i] == 3)
      body_equations<3>(s, b, x, i, out);
    else
      body_equations<6>(s, b, x, i, out);
  }
  row_equations(s, b, x, out);
  constexpr double eps = std::numeric_limits<double>::epsilon();
  Eigen::Vector4d largest = Eigen::Vector4d::Zero();
  double joint = 0, row = 0;
  for (const Eigen::Vector4d& scale : out.body_scale) largest = largest.cwiseMax(scale);
  for (const double scale : out.joint_scale) take_largest(joint, scale);
  for (const double scale : out.row_scale) take_largest(row, scale);
  double error = 0;
  out.dynamics = out.contact = 0;
  const auto judge = [&error](double r, double scale) {
    if (!(r <= error * scale)) error = r / scale;
  };
  for (int i = 0; i < p.nodes; ++i) {
    const Eigen::Vector4d scale = out.body_scale[i].cwiseMax(eps * largest);
    const double f_lin = lin(out.r.force[i]), f_ang = ang(out.r.force[i]);
    judge(lin(out.r.motion[i]), scale[0]), judge(ang(out.r.motion[i]), scale[1]);
    judge(f_lin, scale[2]), judge(f_ang, scale[3]);
    take_largest(out.dynamics, f_lin), take_largest(out.dynamics, f_ang);
  }
  for (int k = 0; k < p.nv; ++k) {
    const double r = std::abs(out.r.joints[k]);
    judge(r, std::max(out.joint_scale[k], eps * joint));
    take_largest(out.dynamics, r);
  }
  for (int k = 0; k < p.nc; ++k) {
    const double r = std::abs(out.r.rows[k]);
    judge(r, std::max(out.row_scale[k], eps * row));
    take_largest(out.contact, r);
  }
  out.dynamics_scale = std::max({largest[2], largest[3], joint});
  out.contact_scale = row;
  const bool finite = std::isfinite(largest.sum()) && std::isfinite(joint) && std::isfinite(row);
  return finite ? error : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace manycontact
