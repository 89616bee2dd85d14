#pragma once
// Residuals of nodes with an impact. Names and constructors are Crocoddyl's. For residuals of impulses use those of
// contact forces: ResidualModelContactForce, ...FrictionCone, ...WrenchCone, ...CoPPosition.

#include "manycontact/action/residuals/centroidal_residuals.hpp"

namespace manycontact {

/// The jump of the velocity of the whole scene's centre of mass: J_com (v+ - v) (3) [m/s], in the world.
class ResidualModelImpulseCoM : public CentroidalResidual {
 public:
  /// Throws std::invalid_argument for robots without mass.
  explicit ResidualModelImpulseCoM(std::shared_ptr<StateMultibody> state)
      : CentroidalResidual("ResidualModelImpulseCoM", std::move(state), 3, 0, {.q = true, .v = true}, -1) {}
  /// Throws std::invalid_argument unless the data are those of an impulse.
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;

 private:
  void evaluate(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
  void fill_blocks(ResidualDataAbstract& data, const ConstVectorRef& x, const ConstVectorRef& u) const override;
};

}  // namespace manycontact
