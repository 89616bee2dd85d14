#pragma once
// The equations of an island with the bodies' accelerations and the joints' forces kept as unknowns: many more than
// accelerations and contact forces of the joint-space K, but each touches a body and its parent only, however deep the
// tree. Unknowns are a_i, f_i (6 each) of every body i, in its body frame (algorithm/body_kinematics.hpp), qdd, and
// y = -(contact forces):
//
//   a_i = X a_p + S_i qdd_i + c_i                              X: to the child's origin, p: the parent
//   f_i = Y_i a_i + p_i + sum over children j of X_j^T f_j + sum over rows k at i of G_k y_k
//   S_i^T f_i + armature qdd_i = tau_i
//   G_Ak^T a_A + G_Bk^T a_B - delta y_k = g_k
//
// With c, p = 0 that is K [qdd; y] = [tau; g]. A base's acceleration is in c of the body on it.

#include <memory>

#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/kkt/bodies/pattern.hpp"

namespace manycontact {

/// The numbers of the system, island-wide: nodes, coordinates and rows as the pattern has them.
struct BodySystem {
  std::shared_ptr<const BodyPattern> pattern;
  std::vector<Vec3<double>> r;     // one entry per node: its origin seen from the parent's
  Mat6X<double> S;                 // 6 x nv
  std::vector<Inertia<double>> Y;  // one entry per node
  Eigen::VectorXd armature;        // nv
  Mat6X<double> GA, GB;            // 6 x nc: forces on A's and B's bodies of a unit y
  double delta = 0;

  void reset(std::shared_ptr<const BodyPattern> p);
};

/// Unknowns (a, f, qdd, y), or right-hand sides (c, p, tau, g), in that order.
struct BodyVectors {
  std::vector<Vec6<double>> motion, force;  // one entry per node
  Eigen::VectorXd joints, rows;             // nv, nc

  void resize(const BodyPattern& p);
  void set_zero();
};

/// How far x is from solving.
struct BodyResidual {
  BodyVectors r;  // right-hand sides minus left-hand sides; f's has the opposite sign
  // set by backward_error alone
  std::vector<Eigen::Vector4d> body_scale;  // one entry per node: terms of a (linear, angular) and f (linear, angular)
  Eigen::VectorXd joint_scale;              // nv
  // set by every computation of residuals
  Eigen::VectorXd row_scale;                // nc
  double dynamics = 0, dynamics_scale = 0;  // largest residuals and terms, of f and of the joints
  double contact = 0, contact_scale = 0;    // and of the rows

  void resize(const BodyPattern& p);
};

/// Fills `out`; returns the backward error, the largest residual of an equation (of a three-vector, of f and a)
/// relative to its terms, these at least eps times the largest of their kind. f in the equation of a joint and a in
/// that of a row count with the terms that they are sums of. NaN when x is not finite.
double backward_error(const BodySystem& system, const BodyVectors& rhs, const BodyVectors& x, BodyResidual& out);

/// The same node by node, within a sweep; no terms are kept and none counts as more than it is, so the error is that of
/// backward_error or larger. x.rows at the nodes: what they are with `more` added, if there is any.
class BodyJudge {
 public:
  BodyJudge(const BodySystem& system, const BodyVectors& rhs, const BodyVectors& x, BodyResidual& out)
      : s_(system), b_(rhs), x_(x), out_(out) {}
  void node(int i, const double* more = nullptr);  // once its children's forces are known
  void rows();                                     // all of them, at last
  double error();                                  // and completes `out`

 private:
  template <int N, bool Keep>
  void equations(int i, const double* more);
  friend double backward_error(const BodySystem&, const BodyVectors&, const BodyVectors&, BodyResidual&);

  const BodySystem& s_;
  const BodyVectors &b_, &x_;
  BodyResidual& out_;
  double error_ = 0, dynamics_ = 0, contact_ = 0;
  double largest_[4] = {0, 0, 0, 0}, joint_ = 0, row_ = 0;
  double sum_ = 0;  // sum of all residuals: not finite where any unknown is not
};

}  // namespace manycontact
