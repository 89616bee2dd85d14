#pragma once
// The derivative of one contact's J = W J_l with respect to q. J_l is the Jacobian of the motion of A relative to B'
// (detail/contact/rows.hpp). Its columns s_i move with joints above them, i.e. nearer to the base, and are expressed in
// A's axes:
//
//   ds_i/dq_k = -s_k x s_i   k above A:  if i is above B', or above A on a joint above k's joint
//                            k above B': if i is above B', on k's joint or on a joint below
//
// and zero otherwise. Rows of a world-aligned contact also rotate with A, by turned(th_k, s_i) for every k above A,
// even if k is above both bodies; th_k is the axis of k. Products sum s_i along the chains of A and B', in linear time.

#include "manycontact/detail/contact/derivatives.hpp"

namespace manycontact::internal {

template <class S>
class JacobianRate {  // products with the derivative of one contact's J, from its constraint rows at the solution
  using V6 = Vec6<S>;

 public:
  struct Chain {                      // the joints above body A or B
    const std::vector<int>& support;  // ContactSupport::a or b
    const std::vector<int>& joint;    // joint of each velocity coordinate of the body's robot
  };
  /// columns: coordinates of J's columns. chain_a: coordinates above A, counted from first_a, the first of A's robot.
  JacobianRate(const Contact& contact, const ContactData<S>& rows, Chain a, Chain b, const std::vector<int>& columns,
               const std::vector<int>& chain_a, int first_a, const Kinematics<S>& kin_a)
      : contact_(contact),
        rows_(rows),
        a_(a),
        b_(b),
        columns_(columns),
        chain_a_(chain_a),
        first_a_(first_a),
        kin_a_(kin_a),
        na_(static_cast<int>(a.support.size())),
        n_(na_ + static_cast<int>(b.support.size())) {}

  const auto& W() const { return rows_.W; }
  template <class Use>
  void each_column(Use&& use) const {  // calls use(k) for the coordinates k on which J depends
    for (int k : columns_) use(k);
    if (!rows_turn(contact_)) return;
    for (int i : chain_a_) use(first_a_ + i);
  }

  template <class Y, class Use>
  void of_motion(const Y& y, Use&& use) const {  // calls use(k, d(J_l y)/dq_k); the caller adds values of a repeated k
    const V6 of_b = sum(y, na_, n_);
    const auto column = [&](int k, const V6& above) { use(columns_[k], V6(-cross_motion(rows_.Jl.col(k), above))); };
    each_joint(0, na_, 1, of_b, 1, y, column);
    each_joint(na_, n_, 1, of_b, -1, y, column);
    if (!rows_turn(contact_)) return;
    const V6 nu = of_b + sum(y, 0, na_);
    for (int i : chain_a_) use(first_a_ + i, turned<S>(turn(i), nu));
  }

  template <class Y, class Use>
  void of_force(const V6& F, const Y& dq, Use&& use) const {  // calls use(i, (d(J_l^T F)/dq dq)_i); F: in A's axes
    V6 turning = V6::Zero();  // th x F, th: A's rotation along dq; -(th x s)^T F = s^T (th x F)
    if (rows_turn(contact_)) {
      Vec3<S> th = Vec3<S>::Zero();
      for (int i : chain_a_) th += turn(i) * dq[first_a_ + i];
      turning = turned<S>(th, F);
    }
    const auto entry = [&](int i, const V6& relative) {
      const V6 s = rows_.Jl.col(i);
      use(columns_[i], -dot(cross_motion(relative, s), F) - dot(s, turning));
    };
    each_joint(na_ - 1, -1, -1, V6::Zero(), 1, dq, entry);
    each_joint(n_ - 1, na_ - 1, -1, sum(dq, 0, n_), -1, dq, entry);
  }

 private:
  int joint(int k) const { return k < na_ ? a_.joint[a_.support[k]] : b_.joint[b_.support[k - na_]]; }
  Vec3<S> turn(int i) const { return rows_.aMA.R.transpose() * kin_a_.J.col(i).template tail<3>(); }
  template <class Y>
  V6 sum(const Y& x, int begin, int end) const {
    V6 out = V6::Zero();
    for (int k = begin; k < end; ++k) out += rows_.Jl.col(k) * x[columns_[k]];
    return out;
  }
  /// Calls use(k, total + sign * (sum of s_i x_i over the joints before k's joint)) for k = begin, begin + step, ...
  template <class Y, class Use>
  void each_joint(int begin, int end, int step, V6 total, double sign, const Y& x, Use&& use) const {
    V6 own = V6::Zero();
    for (int k = begin; k != end; k += step) {
      if (k != begin && joint(k) != joint(k - step)) {
        total += own;
        own.setZero();
      }
      use(k, total);
      own += rows_.Jl.col(k) * (S(sign) * x[columns_[k]]);
    }
  }

  const Contact& contact_;
  const ContactData<S>& rows_;
  Chain a_, b_;
  const std::vector<int>&columns_, &chain_a_;
  int first_a_;
  const Kinematics<S>& kin_a_;
  int na_, n_;
};

}  // namespace manycontact::internal
