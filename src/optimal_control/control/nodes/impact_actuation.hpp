#pragma once
// The right-hand side of an impact as an actuation: tau(x, u) = (1 + e) M(q) u, u the velocity before the impact.

#include "manycontact/action/actuation.hpp"

namespace manycontact::internal {

class ImpactActuation : public ActuationModelAbstract {
 public:
  explicit ImpactActuation(std::shared_ptr<StateMultibody> state);

  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  using ActuationModelAbstract::calc, ActuationModelAbstract::calcDiff;
  void commands(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) override {}
  void torqueTransform(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) override {}
  std::shared_ptr<ActuationDataAbstract> createData() override;

  double restitution = 0;    // e
  Eigen::VectorXd armature;  // nv

 private:
  std::shared_ptr<StateMultibody> multibody_;
};

}  // namespace manycontact::internal
