#pragma once
// Residuals of centre of mass and momentum: of the whole scene, or of one of its robots. Names and constructors of
// Crocoddyl, with the robot as an extra; nu defaults to nv as there.

#include "manycontact/action/residual.hpp"

namespace manycontact {

class CentroidalResidual : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;

  /// -1: the whole scene.
  int get_robot() const { return robot_; }

 protected:
  /// Throws std::invalid_argument for a robot that does not exist, or robots without mass.
  CentroidalResidual(const char* name, std::shared_ptr<StateMultibody> state, std::size_t nr, std::size_t nu,
                     Dependence on, int robot);
  int robot_;
  int first_, last_;  // robots [first_, last_)
  double mass_;       // theirs, kg
};

/// c - cref, m in the world.
class ResidualModelCoMPosition : public CentroidalResidual {
 public:
  ResidualModelCoMPosition(std::shared_ptr<StateMultibody> state, const Eigen::Vector3d& cref, std::size_t nu,
                           int robot = -1);
  ResidualModelCoMPosition(std::shared_ptr<StateMultibody> state, const Eigen::Vector3d& cref);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void print(std::ostream& os) const override;

  const Eigen::Vector3d& get_reference() const { return cref_; }
  void set_reference(const Eigen::Vector3d& reference) { cref_ = reference; }

 private:
  Eigen::Vector3d cref_;
};

/// Momentum [linear; angular about the centre of mass] minus href, world axes. Of the bodies: rotors (armature) have
/// none.
class ResidualModelCentroidalMomentum : public CentroidalResidual {
 public:
  ResidualModelCentroidalMomentum(std::shared_ptr<StateMultibody> state, const Vec6<double>& href, std::size_t nu,
                                  int robot = -1);
  ResidualModelCentroidalMomentum(std::shared_ptr<StateMultibody> state, const Vec6<double>& href);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  void print(std::ostream& os) const override;

  const Vec6<double>& get_reference() const { return href_; }
  void set_reference(const Vec6<double>& reference) { href_ = reference; }

 private:
  Vec6<double> href_;
};

}  // namespace manycontact
