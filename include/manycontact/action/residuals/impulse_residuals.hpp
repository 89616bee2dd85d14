#pragma once
// Residuals of impulses. Names and constructors are Crocoddyl's. For the impulses themselves use the residuals of
// contact forces: ResidualModelContactForce, ...FrictionCone, ...WrenchCone, ...CoPPosition.

#include "manycontact/action/residuals/centroidal_residuals.hpp"

namespace manycontact {

/// The jump of the velocity of the whole scene's centre of mass: J_com (v+ - v) (3) [m/s], in the world.
class ResidualModelImpulseCoM : public CentroidalResidual {
 public:
  /// Throws std::invalid_argument for a reference of a wrong size, or a frame that does not exist. nu: by default nv.
  explicit ResidualModelImpulseCoM(std::shared_ptr<StateMultibody> state);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  /// Throws std::invalid_argument unless the data are those of an impulse.
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void print(std::ostream& os) const override;
};

}  // namespace manycontact
