#include "manycontact/task/rows.hpp"

#include <stdexcept>

namespace manycontact {

std::shared_ptr<ResidualDataAbstract> ResidualOfInner::createData(DataCollector* shared) {
  auto data = std::make_shared<Data>(this, shared);
  data->inner = inner_->createData(shared);
  lay_out(*data);
  return data;
}

bool ResidualOfInner::fits(const ResidualDataAbstract& data) const {
  const auto* d = dynamic_cast<const Data*>(&data);
  require(d, name_, "the data were created by another residual, data of this residual's createData() are expected");
  return inner_->fits(*d->inner);
}

ResidualModelRows::ResidualModelRows(std::shared_ptr<ResidualModelAbstract> inner, std::vector<int> rows)
    : ResidualOfInner("ResidualModelRows", inner, rows.size()), rows_(std::move(rows)), row_of_(inner_->get_nr(), -1) {
  int next = 0;
  for (const int row : rows_) {
    require(row >= 0 && row < static_cast<int>(row_of_.size()) && row_of_[row] < 0, name_,
            "a row does not exist or occurs twice, rows of the residual, each at most once, are expected");
    row_of_[row] = next++;
  }
}

void ResidualModelRows::lay_out(ResidualDataAbstract& data) const {
  Data& d = own(data);
  inner_->lay_out(*d.inner);
  d.blocks.clear();
  d.block.clear();
  d.taken.clear();
  for (std::size_t b = 0; b < d.inner->blocks.size(); ++b) {
    const ResidualBlock& block = d.inner->blocks[b];
    std::vector<int> rows, taken;
    for (std::size_t i = 0; i < block.rows.size(); ++i) {
      const int row = row_of_[block.rows[i]];
      if (row < 0) continue;
      rows.push_back(row);
      taken.push_back(static_cast<int>(i));
    }
    if (rows.empty()) continue;
    d.blocks.emplace_back(std::move(rows), block.xcols, block.ucols);
    d.block.push_back(b);
    d.taken.push_back(std::move(taken));
  }
}

void ResidualModelRows::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  Data& d = own(*data);
  inner_->calc(d.inner, x, u);
  for (std::size_t i = 0; i < rows_.size(); ++i) d.r[i] = d.inner->r[rows_[i]];
}

void ResidualModelRows::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  Data& d = own(*data);
  inner_->calcDiff(d.inner, x, u);
  for (std::size_t b = 0; b < d.blocks.size(); ++b) {
    const ResidualBlock& from = d.inner->blocks[d.block[b]];
    for (std::size_t i = 0; i < d.taken[b].size(); ++i) {
      d.blocks[b].Rx.row(static_cast<Eigen::Index>(i)) = from.Rx.row(d.taken[b][i]);
      d.blocks[b].Ru.row(static_cast<Eigen::Index>(i)) = from.Ru.row(d.taken[b][i]);
    }
  }
}

ResidualModelTurned::ResidualModelTurned(std::shared_ptr<ResidualModelAbstract> inner, const Eigen::MatrixXd& X)
    : ResidualOfInner("ResidualModelTurned", inner, inner->get_nr()), X_(X) {
  check_size(name_, "the matrix", X.rows(), nr_);
  check_size(name_, "the matrix", X.cols(), nr_);
}

void ResidualModelTurned::lay_out(ResidualDataAbstract& data) const {
  Data& d = own(data);
  inner_->lay_out(*d.inner);
  d.blocks = d.inner->blocks;
  for (const ResidualBlock& block : d.blocks)
    for (std::size_t i = 0; i < nr_; ++i)
      if (block.rows.size() != nr_ || block.rows[i] != static_cast<int>(i))
        throw std::logic_error("ResidualModelTurned: blocks of all rows are expected");
}

void ResidualModelTurned::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  Data& d = own(*data);
  inner_->calc(d.inner, x, u);
  d.r.noalias() = X_.lazyProduct(d.inner->r);
}

void ResidualModelTurned::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  Data& d = own(*data);
  inner_->calcDiff(d.inner, x, u);
  for (std::size_t b = 0; b < d.blocks.size(); ++b) {
    const ResidualBlock& from = d.inner->blocks[b];
    d.blocks[b].Rx.noalias() = X_.lazyProduct(from.Rx);
    d.blocks[b].Ru.noalias() = X_.lazyProduct(from.Ru);
  }
}

}  // namespace manycontact
