#pragma once
// Residuals of impulses. Names and constructors of Crocoddyl. Impulses themselves are seen by the residuals of contact
// forces: ResidualModelContactForce, ...FrictionCone, ...WrenchCone, ...CoPPosition.

#include "manycontact/action/residuals/centroidal_residuals.hpp"

namespace manycontact {

/// The jump of the centre of mass's velocity: J_com (v+ - v), m/s in the world, of the whole scene.
class ResidualModelImpulseCoM : public CentroidalResidual {
 public:
  explicit ResidualModelImpulseCoM(std::shared_ptr<StateMultibody> state);

  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void differentiate(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                     const ConstVectorRef& u) override;
  using ResidualModelAbstract::differentiate;
  /// Throws std::invalid_argument but for the data of an impulse.
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void print(std::ostream& os) const override;
};

}  // namespace manycontact
