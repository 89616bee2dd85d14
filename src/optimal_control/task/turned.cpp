#include "turned.hpp"

#include <ostream>
#include <stdexcept>

namespace manycontact::task {

namespace {

struct TurnedData : ResidualDataAbstract {
  using ResidualDataAbstract::ResidualDataAbstract;
  std::shared_ptr<ResidualDataAbstract> inner;
};

TurnedData& own(ResidualDataAbstract& data) { return static_cast<TurnedData&>(data); }

}  // namespace

ResidualModelTurned::ResidualModelTurned(std::shared_ptr<ResidualModelAbstract> inner, const Eigen::MatrixXd& X)
    : ResidualModelAbstract(inner->get_state(), inner->get_nr(), inner->get_nu(), inner->depends_on()),
      inner_(std::move(inner)),
      X_(X) {
  check_size("ResidualModelTurned", "the matrix", X.rows(), nr_);
  check_size("ResidualModelTurned", "the matrix", X.cols(), nr_);
}

std::shared_ptr<ResidualDataAbstract> ResidualModelTurned::createData(DataCollector* shared) {
  auto data = std::make_shared<TurnedData>(this, shared);
  data->inner = inner_->createData(shared);
  lay_out(*data);
  return data;
}

void ResidualModelTurned::lay_out(ResidualDataAbstract& data) const {
  TurnedData& d = own(data);
  inner_->lay_out(*d.inner);
  d.blocks = d.inner->blocks;
  for (const ResidualBlock& block : d.blocks)
    for (std::size_t i = 0; i < nr_; ++i)
      if (block.rows.size() != nr_ || block.rows[i] != static_cast<int>(i))
        throw std::logic_error("ResidualModelTurned: blocks of all rows are expected");
}

bool ResidualModelTurned::fits(const ResidualDataAbstract& data) const {
  const auto* d = dynamic_cast<const TurnedData*>(&data);
  require(d, "ResidualModelTurned",
          "the data were created by another residual, data of this one's createData() are expected");
  return inner_->fits(*d->inner);
}

void ResidualModelTurned::calc(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                               const ConstVectorRef& u) {
  TurnedData& d = own(*data);
  inner_->calc(d.inner, x, u);
  d.r.noalias() = X_.lazyProduct(d.inner->r);
}

void ResidualModelTurned::calcDiff(const std::shared_ptr<ResidualDataAbstract>& data, const ConstVectorRef& x,
                                   const ConstVectorRef& u) {
  TurnedData& d = own(*data);
  inner_->calcDiff(d.inner, x, u);
  for (std::size_t b = 0; b < d.blocks.size(); ++b) {
    const ResidualBlock& from = d.inner->blocks[b];
    d.blocks[b].Rx.noalias() = X_.lazyProduct(from.Rx);
    d.blocks[b].Ru.noalias() = X_.lazyProduct(from.Ru);
  }
}

void ResidualModelTurned::print(std::ostream& os) const { os << "in a copy's axes " << *inner_; }

}  // namespace manycontact::task
