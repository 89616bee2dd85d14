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

double lin(const V6& x) { return x.head<3>().cwiseAbs().maxCoeff(); }
double ang(const V6& x) { return x.tail<3>().cwiseAbs().maxCoeff(); }

// a_i = X a_p + S qdd + c, and f_i without rows and children; the joint's own equations.
void body_equations(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, int i, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  const V6 &a = x.motion[i], &f = x.force[i];
  V6 r = b.motion[i] - a;
  Eigen::Vector4d& scale = out.body_scale[i];
  scale[0] = std::max(lin(b.motion[i]), lin(a)), scale[1] = std::max(ang(b.motion[i]), ang(a));
  if (p.parent[i] >= 0) {
    const V6 ap = motion_at(x.motion[p.parent[i]], s.r[i]);
    r += ap;
    scale[0] = std::max({scale[0], lin(ap), s.r[i].cwiseAbs().maxCoeff() * ang(ap)});
    scale[1] = std::max(scale[1], ang(ap));
  }
  for (int k = p.first_dof[i]; k < p.first_dof[i] + p.ndof[i]; ++k) {
    const V6 Sx = s.S.col(k) * x.joints[k];
    r += Sx;
    scale[0] = std::max(scale[0], lin(Sx)), scale[1] = std::max(scale[1], ang(Sx));
    out.r.joints[k] = b.joints[k] - s.S.col(k).dot(f) - s.armature[k] * x.joints[k];
    out.joint_scale[k] =
        std::abs(b.joints[k]) + s.S.col(k).cwiseAbs().dot(f.cwiseAbs()) + std::abs(s.armature[k] * x.joints[k]);
  }
  out.r.motion[i] = r;
  const Inertia<double>& Y = s.Y[i];
  out.r.force[i] += b.force[i] + Y * a - f;
  const double v = lin(a), w = ang(a), h = Y.h.cwiseAbs().maxCoeff(), I = Y.I.diagonal().cwiseAbs().maxCoeff();
  scale[2] = std::max({scale[2], lin(f), lin(b.force[i]), Y.m * v + h * w});
  scale[3] = std::max({scale[3], ang(f), ang(b.force[i]), h * v + I * w});
  const int parent = p.parent[i];
  if (parent < 0) return;
  const V6 to_parent = force_from(f, s.r[i]);
  out.r.force[parent] += to_parent;
  Eigen::Vector4d& above = out.body_scale[parent];
  above[2] = std::max(above[2], lin(to_parent));
  above[3] = std::max({above[3], ang(to_parent), s.r[i].cwiseAbs().maxCoeff() * lin(to_parent)});
}

void row_equations(const BodySystem& s, const BodyVectors& b, const BodyVectors& x, BodyResidual& out) {
  const BodyPattern& p = *s.pattern;
  for (int k = 0; k < p.nc; ++k) {
    const double y = x.rows[k];
    double r = b.rows[k] + s.delta * y, scale = std::abs(b.rows[k]) + std::abs(s.delta * y);
    const auto end = [&](int node, const auto& G) {
      if (node < 0) return;
      r -= G.dot(x.motion[node]);
      scale += G.cwiseAbs().dot(x.motion[node].cwiseAbs());
      const V6 F = G * y;
      out.r.force[node] += F;
      out.body_scale[node][2] = std::max(out.body_scale[node][2], lin(F));
      out.body_scale[node][3] = std::max(out.body_scale[node][3], ang(F));
    };
    end(p.A[k], s.GA.col(k));
    end(p.B[k], s.GB.col(k));
    out.r.rows[k] = r;
    out.row_scale[k] = scale;
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
  row_equations(s, b, x, out);
  for (int i = p.nodes - 1; i >= 0; --i) body_equations(s, b, x, i, out);

  constexpr double eps = std::numeric_limits<double>::epsilon();
  Eigen::Vector4d largest = Eigen::Vector4d::Zero();
  for (const Eigen::Vector4d& scale : out.body_scale) largest = largest.cwiseMax(scale);
  const double joint = p.nv > 0 ? out.joint_scale.maxCoeff() : 0, row = p.nc > 0 ? out.row_scale.maxCoeff() : 0;
  double error = 0;
  out.dynamics = out.contact = 0;
  const auto judge = [&error](double r, double scale) {
    if (!(r <= error * scale)) error = r / scale;
  };
  for (int i = 0; i < p.nodes; ++i) {
    const Eigen::Vector4d scale = out.body_scale[i].cwiseMax(eps * largest);
    judge(lin(out.r.motion[i]), scale[0]), judge(ang(out.r.motion[i]), scale[1]);
    judge(lin(out.r.force[i]), scale[2]), judge(ang(out.r.force[i]), scale[3]);
    take_largest(out.dynamics, std::max(lin(out.r.force[i]), ang(out.r.force[i])));
  }
  for (int k = 0; k < p.nv; ++k) {
    judge(std::abs(out.r.joints[k]), std::max(out.joint_scale[k], eps * joint));
    take_largest(out.dynamics, std::abs(out.r.joints[k]));
  }
  for (int k = 0; k < p.nc; ++k) {
    judge(std::abs(out.r.rows[k]), std::max(out.row_scale[k], eps * row));
    take_largest(out.contact, std::abs(out.r.rows[k]));
  }
  out.dynamics_scale = std::max({largest[2], largest[3], joint});
  out.contact_scale = row;
  const bool finite = std::isfinite(largest.sum()) && std::isfinite(joint) && std::isfinite(row);
  return finite ? error : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace manycontact
