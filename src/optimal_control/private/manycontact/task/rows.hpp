#pragma once
// Residuals that wrap another ("inner") residual, to select some of its rows or to express it in other axes.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base class of these residuals, with the inner residual and its data.
class ResidualOfInner : public ResidualModelAbstract {
 public:
  std::shared_ptr<ResidualDataAbstract> createData(DataCollector* shared) override;
  bool fits(const ResidualDataAbstract& data) const override;
  using ResidualModelAbstract::calc;
  using ResidualModelAbstract::calcDiff;

  const std::shared_ptr<ResidualModelAbstract>& get_inner() const { return inner_; }

 protected:
  struct Data : ResidualDataAbstract {
    using ResidualDataAbstract::ResidualDataAbstract;
    std::shared_ptr<ResidualDataAbstract> inner;
    std::vector<std::size_t> block;       // one entry per block: number of the inner residual's block
    std::vector<std::vector<int>> taken;  // one entry per block: the selected rows of the inner residual's block
  };
  static Data& own(ResidualDataAbstract& data) { return static_cast<Data&>(data); }

  ResidualOfInner(const char* name, const std::shared_ptr<ResidualModelAbstract>& inner, std::size_t nr)
      : ResidualModelAbstract(internal::given(name, inner, "a residual")->get_state(), nr, inner->get_nu(),
                              inner->depends_on()),
        name_(name),
        inner_(inner) {}
  const char* name_;
  std::shared_ptr<ResidualModelAbstract> inner_;
};

class ResidualModelRows : public ResidualOfInner {  // r_i = inner_(rows_i)
 public:
  /// rows: indices below inner's nr, each at most once.
  ResidualModelRows(std::shared_ptr<ResidualModelAbstract> inner, std::vector<int> rows);
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override { os << rows_.size() << " rows of " << *inner_; }

 private:
  std::vector<int> rows_, row_of_;  // row_of_: index in rows_ of each row of the inner residual, or -1
};

/// Expresses a residual in the axes of a copied robot, r = X r_inner. Weights and bounds apply along these axes.
class ResidualModelTurned : public ResidualOfInner {
 public:
  /// X has nr rows and columns. Blocks of the inner residual must contain all rows.
  ResidualModelTurned(std::shared_ptr<ResidualModelAbstract> inner, const Eigen::MatrixXd& X);
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override { os << "in a copy's axes " << *inner_; }

 private:
  Eigen::MatrixXd X_;
};

}  // namespace manycontact
