#pragma once
// Residuals that are made of another residual: they take some of its rows, or all of them in other axes.

#include "manycontact/action/residual.hpp"

namespace manycontact {

/// The common base: contains the other residual, and its data.
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
    std::vector<std::size_t> block;       // one entry per block: the other residual's block
    std::vector<std::vector<int>> taken;  // one entry per block: rows of the other residual's block
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
  /// rows: each at most once, of inner's nr.
  ResidualModelRows(std::shared_ptr<ResidualModelAbstract> inner, std::vector<int> rows);
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override { os << rows_.size() << " rows of " << *inner_; }

 private:
  std::vector<int> rows_, row_of_;  // row_of_: index of each of inner's rows, -1 if it is left out
};

/// Expresses another residual in the axes of a copy: r = X r_inner. Weights and bounds are along these axes too.
class ResidualModelTurned : public ResidualOfInner {
 public:
  /// X: nr x nr. Blocks of the inner residual must contain all rows.
  ResidualModelTurned(std::shared_ptr<ResidualModelAbstract> inner, const Eigen::MatrixXd& X);
  void lay_out(ResidualDataAbstract& data) const override;
  void calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) override;
  void print(std::ostream& os) const override { os << "in a copy's axes " << *inner_; }

 private:
  Eigen::MatrixXd X_;
};

}  // namespace manycontact
