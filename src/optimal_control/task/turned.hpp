#pragma once
// Another residual in the axes of a copy: r = X r_inner, so that weights and bounds are along these axes too.

#include "manycontact/action/residual.hpp"

namespace manycontact::task {

class ResidualModelTurned : public ResidualModelAbstract {  // r = X r_inner
 public:
  /// X: square. A block of the inner residual has all rows.
  ResidualModelTurned(std::shared_ptr<ResidualModelAbstract> inner, const Eigen::MatrixXd& X);

  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  void lay_out(ResidualDataAbstract& data) const override;
  bool fits(const ResidualDataAbstract& data) const override;
  void calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
            const ConstVectorRef& u) override;
  using ResidualModelAbstract::calc;
  void calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override;
  using ResidualModelAbstract::calcDiff;
  void print(std::ostream& os) const override;

 private:
  std::shared_ptr<ResidualModelAbstract> inner_;
  Eigen::MatrixXd X_;
};

}  // namespace manycontact::task
