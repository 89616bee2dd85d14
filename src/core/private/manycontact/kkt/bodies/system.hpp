#pragma once
// An island's equations in accelerations of bodies and forces of joints: many more than in the joint-space K, but each
// involves only a body and its neighbours, however deep the tree. Unknowns are the acceleration a_i and joint force f_i
// of each body i in its body frame (algorithm/body_kinematics.hpp), qdd, and y = -(contact forces):
//
//   a_i = X a_p + S_i qdd_i + c_i                              X: to the child's origin, p: the parent
//   f_i = Y_i a_i + p_i + sum over children j of X_j^T f_j + sum over rows k at i of G_k y_k
//   S_i^T f_i + armature qdd_i = tau_i
//   G_Ak^T a_A + G_Bk^T a_B - delta y_k = g_k
//
// With c = p = 0 this is K [qdd; y] = [tau; g]. A base's acceleration is part of the c of bodies attached to it.

#include <memory>

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

struct BodySystem {
  std::shared_ptr<const BodyPattern> pattern;
  std::vector<Vec3<double>> r;     // one entry per node: its body's origin relative to the parent's origin
  Mat6X<double> S;                 // 6 x nv: motion subspaces
  std::vector<Inertia<double>> Y;  // one entry per node: inertia
  Eigen::VectorXd armature;        // nv
  Mat6X<double> GA, GB;            // 6 x nc: forces on the bodies of A and B for y = 1 of each row
  double delta = 0;

  void reset(std::shared_ptr<const BodyPattern> p);
};

/// Unknowns (a, f, qdd, y), or right-hand sides (c, p, tau, g), in the order motion, force, joints, rows.
struct BodyVectors {
  std::vector<Vec6<double>> motion, force;  // one entry per node: a or c (motion), f or p (force)
  Eigen::VectorXd joints, rows;             // nv: qdd or tau; nc: y or g

  void resize(const BodyPattern& p);
  void set_zero();
};

struct BodyResidual {
  BodyVectors r;  // right-hand minus left-hand sides of the equations in the file header
  // magnitudes of terms; body_scale and joint_scale are set by backward_error only
  std::vector<Eigen::Vector4d> body_scale;  // one entry per node: terms of a (linear, angular) and f (linear, angular)
  Eigen::VectorXd joint_scale;              // nv
  Eigen::VectorXd row_scale;                // nc
  double dynamics = 0, dynamics_scale = 0;  // largest residual, and terms, of the equations of f and joints
  double contact = 0, contact_scale = 0;    // largest residual, and terms, of the equations of rows

  void resize(const BodyPattern& p);
};

/// Computes `out` and returns the backward error: the largest residual of an equation (of three equations together for
/// the linear or angular part of f or a) relative to the size of its terms. This size is at least eps times the largest
/// of all equations of the same kind. In equations of joints and rows, f and a count with the terms of which they are
/// sums. The result is NaN if x is not finite.
double backward_error(const BodySystem& system, const BodyVectors& rhs, const BodyVectors& x, BodyResidual& out);

/// Computes the backward error node by node, during a sweep. Terms are not stored and have no lower bound, so that the
/// result is at least that of backward_error. more: if given, is added to x.rows in the nodes' equations.
class BodyJudge {
 public:
  BodyJudge(const BodySystem& system, const BodyVectors& rhs, const BodyVectors& x, BodyResidual& out)
      : s_(system), b_(rhs), x_(x), out_(out) {}
  void node(int i, const double* more = nullptr);  // equations of node i; call it when its children's forces are known
  void rows();                                     // equations of all rows; call it after all nodes
  double error();                                  // completes `out` and returns the backward error

 private:
  template <int N, bool Keep>
  void equations(int i, const double* more);
  friend double backward_error(const BodySystem&, const BodyVectors&, const BodyVectors&, BodyResidual&);

  const BodySystem& s_;
  const BodyVectors &b_, &x_;
  BodyResidual& out_;
  double error_ = 0, dynamics_ = 0, contact_ = 0;
  double largest_[4] = {0, 0, 0, 0}, joint_ = 0, row_ = 0;
  double sum_ = 0;  // sum of all residuals, not finite if an unknown is not finite
};

}  // namespace manycontact
