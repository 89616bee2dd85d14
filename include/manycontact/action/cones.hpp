#pragma once
// Linear inequalities lb <= A f <= ub for a contact force or wrench f: friction, and centre of pressure inside the
// foot. Names, A and bounds are Crocoddyl's. The columns of R are the cone's axes (z: the normal) in the axes of f.
// Setters take effect with update(). Numbers out of range throw std::invalid_argument (Crocoddyl replaces them).

#include <iosfwd>
#include <limits>

#include "manycontact/detail/action/fwd.hpp"

namespace manycontact {

/// A friction cone for a force f (3): nf rows of A for the facets, and a last row for the normal force.
class FrictionCone {
 public:
  using MatrixX3s = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  /// mu: coefficient of friction, >= 0. nf: even. inner_appr: the facets are inside the round cone. Forces in N.
  FrictionCone(const Eigen::Matrix3d& R, double mu, std::size_t nf = 4, bool inner_appr = true, double min_nforce = 0,
               double max_nforce = std::numeric_limits<double>::infinity());
  FrictionCone() : FrictionCone(Eigen::Matrix3d::Identity(), 0.7) {}
  void update();

  const MatrixX3s& get_A() const { return A_; }                  // the matrix of the inequalities
  const Eigen::VectorXd& get_lb() const { return lb_; }          // lower bounds
  const Eigen::VectorXd& get_ub() const { return ub_; }          // upper bounds
  std::size_t get_nf() const { return nf_; }                     // number of facets
  const Eigen::Matrix3d& get_R() const { return R_; }            // the cone's axes
  double get_mu() const { return mu_; }                          // coefficient of friction
  bool get_inner_appr() const { return inner_; }                 // whether the facets are inside the round cone
  double get_min_nforce() const { return min_; }                 // smallest normal force [N]
  double get_max_nforce() const { return max_; }                 // largest normal force [N]
  void set_R(const Eigen::Matrix3d& R) { R_ = R; }               // takes effect with update()
  void set_mu(double mu);                                        // not negative; takes effect with update()
  void set_inner_appr(bool inner_appr) { inner_ = inner_appr; }  // takes effect with update()
  void set_min_nforce(double min_nforce);                        // takes effect with update() [N]
  void set_max_nforce(double max_nforce);                        // takes effect with update() [N]

 private:
  std::size_t nf_;
  Eigen::Matrix3d R_;
  double mu_;
  bool inner_;
  double min_, max_;
  MatrixX3s A_;
  Eigen::VectorXd lb_, ub_;
};
std::ostream& operator<<(std::ostream& os, const FrictionCone& cone);  // prints the cone

/// A wrench cone for f = [force; moment] at the centre of a rectangular foot. Its nf + 13 rows bound friction, centre
/// of pressure and yaw torque.
class WrenchCone {
 public:
  using MatrixX6s = Eigen::Matrix<double, Eigen::Dynamic, 6>;

  /// box: length and width of the foot [m]. The rows of an infinite side are zero, without effect.
  WrenchCone(const Eigen::Matrix3d& R, double mu, const Eigen::Vector2d& box, std::size_t nf = 4,
             bool inner_appr = true, double min_nforce = 0,
             double max_nforce = std::numeric_limits<double>::infinity());
  WrenchCone()
      : WrenchCone(Eigen::Matrix3d::Identity(), 0.7,
                   Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity())) {}
  void update();

  const MatrixX6s& get_A() const { return A_; }                         // the matrix of the inequalities
  const Eigen::VectorXd& get_lb() const { return lb_; }                 // lower bounds
  const Eigen::VectorXd& get_ub() const { return ub_; }                 // upper bounds
  std::size_t get_nf() const { return friction_.get_nf(); }             // number of facets
  const Eigen::Matrix3d& get_R() const { return friction_.get_R(); }    // the cone's axes
  const Eigen::Vector2d& get_box() const { return box_; }               // length and width [m]
  double get_mu() const { return friction_.get_mu(); }                  // coefficient of friction
  bool get_inner_appr() const { return friction_.get_inner_appr(); }    // whether the facets are inside the round cone
  double get_min_nforce() const { return friction_.get_min_nforce(); }  // smallest normal force [N]
  double get_max_nforce() const { return friction_.get_max_nforce(); }  // largest normal force [N]
  void set_R(const Eigen::Matrix3d& R) { friction_.set_R(R); }          // takes effect with update()
  void set_box(const Eigen::Vector2d& box);                             // takes effect with update() [m]
  void set_mu(double mu) { friction_.set_mu(mu); }                      // not negative; takes effect with update()
  void set_inner_appr(bool inner_appr) { friction_.set_inner_appr(inner_appr); }    // takes effect with update()
  void set_min_nforce(double min_nforce) { friction_.set_min_nforce(min_nforce); }  // takes effect with update() [N]
  void set_max_nforce(double max_nforce) { friction_.set_max_nforce(max_nforce); }  // takes effect with update() [N]

 private:
  FrictionCone friction_;
  Eigen::Vector2d box_;
  MatrixX6s A_;
  Eigen::VectorXd lb_, ub_;
};
std::ostream& operator<<(std::ostream& os, const WrenchCone& cone);  // prints the cone

/// Four rows that keep the centre of pressure of f = [force; moment] in a box, whose length bounds the moment about y,
/// and whose width that about x.
class CoPSupport {
 public:
  using Matrix46s = Eigen::Matrix<double, 4, 6>;

  CoPSupport(const Eigen::Matrix3d& R, const Eigen::Vector2d& box);                 // box: length and width [m]
  CoPSupport(const WrenchCone& cone) : CoPSupport(cone.get_R(), cone.get_box()) {}  // the cone's axes
  CoPSupport() : CoPSupport(WrenchCone()) {}
  void update();  // computes A and the bounds

  const Matrix46s& get_A() const { return A_; }            // the matrix of the inequalities
  const Eigen::Vector4d& get_lb() const { return lb_; }    // lower bounds
  const Eigen::Vector4d& get_ub() const { return ub_; }    // upper bounds
  const Eigen::Vector2d& get_box() const { return box_; }  // length and width [m]
  const Eigen::Matrix3d& get_R() const { return R_; }      // the cone's axes
  void set_R(const Eigen::Matrix3d& R) { R_ = R; }         // takes effect with update()
  void set_box(const Eigen::Vector2d& box);                // takes effect with update() [m]

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector2d box_;
  Matrix46s A_;
  Eigen::Vector4d lb_, ub_;
};
std::ostream& operator<<(std::ostream& os, const CoPSupport& support);  // prints the support polygon

}  // namespace manycontact
