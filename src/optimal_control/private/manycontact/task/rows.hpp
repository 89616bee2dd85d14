#pragma once
// Some rows of another residual: r_i = inner_(rows_i).

#include "manycontact/action/residual.hpp"

namespace manycontact {

class ResidualModelRows : public ResidualModelAbstract {  // r_i = inner_(rows_i)
 public:
  /// rows: each at most once, of inner's nr.
  ResidualModelRows(std::shared_ptr<ResidualModelAbstract> inner, std::vector<int> rows);

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

  const std::shared_ptr<ResidualModelAbstract>& get_inner() const { return inner_; }  // the residual picked from
  const std::vector<int>& get_rows() const { return rows_; }                          // its rows, in order

 private:
  std::shared_ptr<ResidualModelAbstract> inner_;
  std::vector<int> rows_, row_of_;  // row_of_: of inner's rows, -1 for those left out
};

}  // namespace manycontact
