#pragma once
// Computes the errors and the Jacobian of goals (analysis/place.hpp), scaled by the square root of each goal's weight.

#include <Eigen/SparseCore>
#include <map>
#include <memory>

#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/place.hpp"
#include "manycontact/detail/algorithm/kinematics.hpp"

namespace manycontact::internal {

class GoalRows {
 public:
  GoalRows(const Scene& scene, const std::vector<Goal>& goals);

  Eigen::VectorXd errors(const Eigen::VectorXd& q);
  /// Returns the Jacobian (rows x nv) at q of the last call of errors(). Its sparsity pattern is the same for all q.
  Eigen::SparseMatrix<double> jacobian();
  const std::vector<GoalLeft>& left() const { return left_; }  // remaining error of each goal, unweighted

 private:
  struct Rows;
  void frame_rows(const Goal& goal, Rows& rows);
  void center_rows(const Goal& goal, Rows& rows);
  void joint_rows(const Goal& goal, Rows& rows);
  void contact_rows_of(const Goal& goal, Rows& rows);
  Vec3<double> middle(const std::vector<Attachment>& frames) const;
  void take_middle(const std::vector<Attachment>& frames, int axis, int row, Rows& rows);
  SE3<double> placed(const Attachment& frame) const;
  void evaluate(bool with_jacobian);
  const Kinematics<double>& kin(int robot) const { return *kin_[robot]; }

  const Scene& scene_;
  const std::vector<Goal>& goals_;
  Eigen::VectorXd q_;
  std::vector<std::unique_ptr<Kinematics<double>>> kin_;  // one entry per robot; null for robots without goals
  std::map<int, RigidBodyData> of_bodies_;                // used for centres of mass; key: robot, -1: the whole scene
  std::vector<double> e_;
  std::vector<Eigen::Triplet<double>> J_;
  std::vector<GoalLeft> left_;
};

}  // namespace manycontact::internal
