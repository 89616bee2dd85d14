#pragma once
// Another residual in the axes of a copy: r = X r_inner, so that weights and bounds are along these axes too.

#include "manycontact/task/rows.hpp"

namespace manycontact::task {

class ResidualModelTurned : public ResidualOfInner {  // r = X r_inner
 public:
  /// X: square. A block of the inner residual has all rows.
  ResidualModelTurned(std::shared_ptr<ResidualModelAbstract> inner, const Eigen::MatrixXd& X);
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override;

 private:
  Eigen::MatrixXd X_;
};

}  // namespace manycontact::task
