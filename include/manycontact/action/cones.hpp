#pragma once
// Linear inequalities lb <= A f <= ub for a contact force or wrench f: friction, and the centre of pressure inside the
// foot. Names, A and bounds are those of Crocoddyl's cones. R contains the cone's axes (z: the normal) in the axes of
// f. Setters take effect with update(). Numbers out of range throw std::invalid_argument (Crocoddyl replaces them and
// warns).

#include <iosfwd>
#include <limits>

#include "manycontact/action/fwd.hpp"

namespace manycontact {

/// A friction cone with nf facets, followed by the normal force: nf + 1 rows for f (3).
class FrictionCone {
 public:
  using MatrixX3s = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  /// mu >= 0; nf even. inner_appr: the facets are inside the round cone rather than around it. Forces in N.
  FrictionCone(const Eigen::Matrix3d& R, double mu, std::size_t nf = 4, bool inner_appr = true, double min_nforce = 0,
               double max_nforce = std::numeric_limits<double>::infinity());
  FrictionCone() : FrictionCone(Eigen::Matrix3d::Identity(), 0.7) {}
  void update();

  const MatrixX3s& get_A() const { return A_; }
  const Eigen::VectorXd& get_lb() const { return lb_; }
  const Eigen::VectorXd& get_ub() const { return ub_; }
  std::size_t get_nf() const { return nf_; }
  const Eigen::Matrix3d& get_R() const { return R_; }
  double get_mu() const { return mu_; }
  bool get_inner_appr() const { return inner_; }
  double get_min_nforce() const { return min_; }
  double get_max_nforce() const { return max_; }
  void set_R(const Eigen::Matrix3d& R) { R_ = R; }
  void set_mu(double mu);
  void set_inner_appr(bool inner_appr) { inner_ = inner_appr; }
  void set_min_nforce(double min_nforce);
  void set_max_nforce(double max_nforce);

 private:
  std::size_t nf_;
  Eigen::Matrix3d R_;
  double mu_;
  bool inner_;
  double min_, max_;
  MatrixX3s A_;
  Eigen::VectorXd lb_, ub_;
};
std::ostream& operator<<(std::ostream& os, const FrictionCone& cone);

/// The friction cone, centre of pressure inside the box, and yaw torque of a rectangular foot: nf + 13 rows for the
/// wrench [force; moment] at the centre of the box.
class WrenchCone {
 public:
  using MatrixX6s = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  /// box: length and width [m]; an infinite side gives no limit (its rows are zero).
  WrenchCone(const Eigen::Matrix3d& R, double mu, const Eigen::Vector2d& box, std::size_t nf = 4,
             bool inner_appr = true, double min_nforce = 0,
             double max_nforce = std::numeric_limits<double>::infinity());
  WrenchCone()
      : WrenchCone(Eigen::Matrix3d::Identity(), 0.7,
                   Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity())) {}
  void update();

  const MatrixX6s& get_A() const { return A_; }
  const Eigen::VectorXd& get_lb() const { return lb_; }
  const Eigen::VectorXd& get_ub() const { return ub_; }
  std::size_t get_nf() const { return friction_.get_nf(); }
  const Eigen::Matrix3d& get_R() const { return friction_.get_R(); }
  const Eigen::Vector2d& get_box() const { return box_; }
  double get_mu() const { return friction_.get_mu(); }
  bool get_inner_appr() const { return friction_.get_inner_appr(); }
  double get_min_nforce() const { return friction_.get_min_nforce(); }
  double get_max_nforce() const { return friction_.get_max_nforce(); }
  void set_R(const Eigen::Matrix3d& R) { friction_.set_R(R); }
  void set_box(const Eigen::Vector2d& box);
  void set_mu(double mu) { friction_.set_mu(mu); }
  void set_inner_appr(bool inner_appr) { friction_.set_inner_appr(inner_appr); }
  void set_min_nforce(double min_nforce) { friction_.set_min_nforce(min_nforce); }
  void set_max_nforce(double max_nforce) { friction_.set_max_nforce(max_nforce); }

 private:
  FrictionCone friction_;
  Eigen::Vector2d box_;
  MatrixX6s A_;
  Eigen::VectorXd lb_, ub_;
};
std::ostream& operator<<(std::ostream& os, const WrenchCone& cone);

/// The centre of pressure inside the box: 4 rows for the wrench. As in Crocoddyl, the length bounds the moment about y,
/// the width the moment about x.
class CoPSupport {
 public:
  using Matrix46s = Eigen::Matrix<double, 4, 6>;

  CoPSupport(const Eigen::Matrix3d& R, const Eigen::Vector2d& box);
  CoPSupport(const WrenchCone& cone) : CoPSupport(cone.get_R(), cone.get_box()) {}
  CoPSupport() : CoPSupport(WrenchCone()) {}
  void update();

  const Matrix46s& get_A() const { return A_; }
  const Eigen::Vector4d& get_lb() const { return lb_; }
  const Eigen::Vector4d& get_ub() const { return ub_; }
  const Eigen::Vector2d& get_box() const { return box_; }
  const Eigen::Matrix3d& get_R() const { return R_; }
  void set_R(const Eigen::Matrix3d& R) { R_ = R; }
  void set_box(const Eigen::Vector2d& box);

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector2d box_;
  Matrix46s A_;
  Eigen::Vector4d lb_, ub_;
};
std::ostream& operator<<(std::ostream& os, const CoPSupport& support);

}  // namespace manycontact
