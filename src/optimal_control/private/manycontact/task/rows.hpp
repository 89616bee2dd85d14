#pragma once
// Residuals made of another residual.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base: the other residual, whose data are within its own.
class ResidualOfInner : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  bool fits(const ResidualDataAbstract& data) const override;
  using ResidualModelAbstract::calc;
  using ResidualModelAbstract::calcDiff;

  const std::shared_ptr<ResidualModelAbstract>& get_inner() const { return inner_; }  // the other residual

 protected:
  struct Data : ResidualDataAbstract {
    using ResidualDataAbstract::ResidualDataAbstract;
    std::shared_ptr<ResidualDataAbstract> inner;
    std::vector<std::size_t> block;       // one entry per block: the other residual's block
    std::vector<std::vector<int>> taken;  // one entry per block: rows of the other residual's block
  };
  static Data& own(ResidualDataAbstract& data) { return static_cast<Data&>(data); }

  /// name: that of the class.
  ResidualOfInner(const char* name, const std::shared_ptr<ResidualModelAbstract>& inner, std::size_t nr);
  const char* name_;
  std::shared_ptr<ResidualModelAbstract> inner_;
};

class ResidualModelRows : public ResidualOfInner {  // r_i = inner_(rows_i)
 public:
  /// rows: each at most once, of inner's nr.
  ResidualModelRows(std::shared_ptr<ResidualModelAbstract> inner, std::vector<int> rows);
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override;

 private:
  std::vector<int> rows_, row_of_;  // row_of_: of inner's rows, -1 for those left out
};

}  // namespace manycontact
