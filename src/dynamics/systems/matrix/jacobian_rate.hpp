#pragma once
// How J of one contact changes with q. With s_i the columns of J_l, in A's axes (contact/rows.hpp), and s_i moved along
// by the joints above it on its own body, while all is seen from A:
//
//   ds_i/dq_k = -s_k x s_i   k above A:  where i is above B', or above A but on a joint above k's
//                            k above B': where i is above B', on k's joint or on one below
//
// and zero otherwise. The rows of a world-aligned contact turn with A besides: by turned(th_k, s_i) for every k above
// A, joints above both bodies included. So J's derivative times a vector takes sums of s_i along the two chains, and
// its cost is linear in their lengths.

#include "../../workspace.hpp"

namespace manycontact::internal {

class JacobianRate {
 public:
  /// Of the c-th contact of an island, in the coordinates of that. While lin.contacts are of the solution at hand.
  JacobianRate(const Scene& scene, const Workspace& work, const IslandWork& d, std::size_t c)
      : contact_(scene.contacts[d.island.contacts[c]]),
        rows_(work.linearisation->contacts[d.island.contacts[c]]),
        support_(work.supports[d.island.contacts[c]]),
        columns_(d.shape->support().columns[c]),
        chain_a_(work.linearisation->derivatives[d.island.contacts[c]].chain_a),
        first_a_(first_dof(d.island, contact_.A)),
        kin_a_(work.robots[contact_.A.robot].kin),
        joint_a_(scene.robots[contact_.A.robot].model->dof_joint),
        joint_b_(contact_.B.robot < 0 ? joint_a_ : scene.robots[contact_.B.robot].model->dof_joint),
        na_(static_cast<int>(support_.a.size())),
        n_(support_.cols()) {}

  const auto& W() const { return rows_.W; }
  /// use(k) for coordinates k of the island that J changes with.
  template <class Use>
  void each_column(Use&& use) const {
    for (int k : columns_) use(k);
    if (!rows_turn(contact_)) return;
    for (int i : chain_a_) use(first_a_ + i);
  }

  /// use(k, d(J_l y)/dq_k) for coordinates k of the island, some of them twice: to be added up.
  template <class Use>
  void of_motion(const Eigen::VectorXd& y, Use&& use) const {
    using V6 = Vec6<double>;
    const V6 of_b = sum(y, na_, n_);
    const auto column = [&](int k, const V6& above) { use(columns_[k], V6(-cross_motion(rows_.Jl.col(k), above))); };
    each_joint(0, na_, 1, of_b, 1, y, column);
    each_joint(na_, n_, 1, of_b, -1, y, column);
    if (!rows_turn(contact_)) return;
    const V6 nu = of_b + sum(y, 0, na_);
    for (int i : chain_a_) use(first_a_ + i, turned<double>(turn(i), nu));
  }

  /// use(i, (d(J_l^T F)/dq dq)_i) for the contact's coordinates i, F in A's axes.
  template <class Use>
  void of_force(const Vec6<double>& F, const Eigen::VectorXd& dq, Use&& use) const {
    using V6 = Vec6<double>;
    V6 turning = V6::Zero();  // th x F on both parts: -(th x s)^T F = s^T (th x F)
    if (rows_turn(contact_)) {
      Vec3<double> th = Vec3<double>::Zero();
      for (int i : chain_a_) th += turn(i) * dq[first_a_ + i];
      turning = turned<double>(th, F);
    }
    const auto entry = [&](int i, const V6& relative) {
      const V6 s = rows_.Jl.col(i);
      use(columns_[i], -dot(cross_motion(relative, s), F) - dot(s, turning));
    };
    each_joint(na_ - 1, -1, -1, V6::Zero(), 1, dq, entry);
    each_joint(n_ - 1, na_ - 1, -1, sum(dq, 0, n_), -1, dq, entry);
  }

 private:
  int joint(int k) const { return k < na_ ? joint_a_[support_.a[k]] : joint_b_[support_.b[k - na_]]; }
  Vec3<double> turn(int i) const { return rows_.aMA.R.transpose() * kin_a_.J.col(i).template tail<3>(); }
  Vec6<double> sum(const Eigen::VectorXd& x, int begin, int end) const {
    Vec6<double> out = Vec6<double>::Zero();
    for (int k = begin; k < end; ++k) out += rows_.Jl.col(k) * x[columns_[k]];
    return out;
  }
  /// use(k, total + sign sum of s_i x_i over the joints before k's) for k = begin, begin + step, ...
  template <class Use>
  void each_joint(int begin, int end, int step, Vec6<double> total, double sign, const Eigen::VectorXd& x,
                  Use&& use) const {
    Vec6<double> own = Vec6<double>::Zero();
    for (int k = begin; k != end; k += step) {
      if (k != begin && joint(k) != joint(k - step)) {
        total += own;
        own.setZero();
      }
      use(k, total);
      own += sign * x[columns_[k]] * rows_.Jl.col(k);
    }
  }

  const Contact& contact_;
  const ContactData<double>& rows_;
  const ContactSupport& support_;
  const std::vector<int>&columns_, &chain_a_;
  int first_a_;
  const Kinematics<double>& kin_a_;
  const std::vector<int>&joint_a_, &joint_b_;
  int na_, n_;
};

}  // namespace manycontact::internal
