#include "turned.hpp"

#include <ostream>
#include <stdexcept>

namespace manycontact::task {

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

void ResidualModelTurned::print(std::ostream& os) const { os << "in a copy's axes " << *inner_; }

}  // namespace manycontact::task
