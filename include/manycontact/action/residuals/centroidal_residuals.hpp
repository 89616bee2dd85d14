#pragma once
// Residuals of centre of mass and momentum, of the whole scene or one robot. Names and constructors are Crocoddyl's,
// plus the robot; nu is nv by default. Constructors throw std::invalid_argument for a missing or massless robot.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base: contains the numbers of the robots, and their mass.
class CentroidalResidual : public NamedResidual {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;

  int get_robot() const { return robot_; }  // number of the robot; -1: the whole scene

 protected:
  /// Throws std::invalid_argument for a robot that does not exist, or robots without mass.
  CentroidalResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nr, std::size_t nu,
                     Dependence on, RobotIndex robot);
  int robot_;
  int first_, last_;  // numbers of the robots: first to last - 1
  double mass_;       // total mass of robots first_ to last_ - 1 [kg]
};

/// The position of the centre of mass (3) minus the reference cref [m], in the world.
class ResidualModelCoMPosition : public ResidualWithReference<CentroidalResidual, Eigen::Vector3d> {
 public:
  /// robot: number of the robot; -1: the whole scene.
  ResidualModelCoMPosition(std::shared_ptr<StateMultibody> state, const Eigen::Vector3d& cref,
                           std::size_t nu = kDefaultNu, RobotIndex robot = -1)
      : ResidualWithReference(cref, "ResidualModelCoMPosition", std::move(state), 3u, nu, Dependence{.q = true},
                              robot) {}
  void print(std::ostream& os) const override { os << name_ << " {cref=" << reference_.transpose() << "}"; }

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

/// The momentum [linear; angular about the centre of mass] - href (6) [N s, N m s], in world axes, without armature.
class ResidualModelCentroidalMomentum : public ResidualWithReference<CentroidalResidual, Vec6<double>> {
 public:
  /// robot: number of the robot; -1: the whole scene.
  ResidualModelCentroidalMomentum(std::shared_ptr<StateMultibody> state, const Vec6<double>& href,
                                  std::size_t nu = kDefaultNu, RobotIndex robot = -1)
      : ResidualWithReference(href, "ResidualModelCentroidalMomentum", std::move(state), 6u, nu,
                              Dependence{.q = true, .v = true}, robot) {}
  void print(std::ostream& os) const override { os << name_ << " {href=" << reference_.transpose() << "}"; }

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

}  // namespace manycontact
