#pragma once
// Residuals of centre of mass and momentum, of the whole scene or of one robot. Names and constructors are Crocoddyl's,
// with the robot as an additional argument; nu is nv by default.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base: robots and their mass.
class CentroidalResidual : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;

  /// number of the robot; -1: the whole scene
  int get_robot() const { return robot_; }

 protected:
  /// Throws std::invalid_argument for a robot that does not exist, or robots without mass.
  CentroidalResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nr, std::size_t nu,
                     Dependence on, int robot);
  int robot_;
  int first_, last_;  // numbers of the robots: first to last - 1
  double mass_;       // mass of these robots [kg]
};

/// The position of the centre of mass minus cref (3) [m], in the world.
class ResidualModelCoMPosition : public CentroidalResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelCoMPosition(std::shared_ptr<StateMultibody> state, const Eigen::Vector3d& cref, std::size_t nu,
                           int robot = -1);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelCoMPosition(std::shared_ptr<StateMultibody> state, const Eigen::Vector3d& cref);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void print(std::ostream& os) const override;

  const Eigen::Vector3d& get_reference() const { return cref_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Eigen::Vector3d& reference) { cref_ = reference; }

 private:
  Eigen::Vector3d cref_;
};

/// The momentum [linear; angular about the centre of mass] minus href (6) [N s, N m s], in world axes. Rotors
/// (armature) do not contribute.
class ResidualModelCentroidalMomentum : public CentroidalResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelCentroidalMomentum(std::shared_ptr<StateMultibody> state, const Vec6<double>& href, std::size_t nu,
                                  int robot = -1);
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  ResidualModelCentroidalMomentum(std::shared_ptr<StateMultibody> state, const Vec6<double>& href);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void print(std::ostream& os) const override;

  const Vec6<double>& get_reference() const { return href_; }  // the reference of the residual or contact
  /// Sets the reference; a wrong size throws std::invalid_argument.
  void set_reference(const Vec6<double>& reference) { href_ = reference; }

 private:
  Vec6<double> href_;
};

}  // namespace manycontact
