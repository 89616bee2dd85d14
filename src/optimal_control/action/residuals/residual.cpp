#include "manycontact/action/residual.hpp"

#include "residual_parts.hpp"

namespace manycontact {

ResidualBlock::ResidualBlock(std::vector<int> r, std::vector<int> x, std::vector<int> u)
    : rows(std::move(r)), xcols(std::move(x)), ucols(std::move(u)) {
  Rx.setZero(rows.size(), xcols.size());
  Ru.setZero(rows.size(), ucols.size());
}

ResidualDataAbstract::ResidualDataAbstract(const ResidualModelAbstract* model, DataCollector* s)
    : shared(s), r(Eigen::VectorXd::Zero(model->get_nr())), ndx_(model->get_state()->get_ndx()), nu_(model->get_nu()) {
  if (!model->whole_ && !(shared && shared->whole)) return;
  Rx.setZero(r.size(), ndx_);
  Ru.setZero(r.size(), nu_);
}

namespace {

Eigen::MatrixXd whole(const std::vector<ResidualBlock>& blocks, Eigen::Index nr, std::size_t n,
                      std::vector<int> ResidualBlock::*cols, RowMajorMatrix ResidualBlock::*J) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(nr, n);
  for (const ResidualBlock& b : blocks)
    for (std::size_t i = 0; i < b.rows.size(); ++i)
      for (std::size_t j = 0; j < (b.*cols).size(); ++j) out(b.rows[i], (b.*cols)[j]) = (b.*J)(i, j);
  return out;
}

}  // namespace

Eigen::MatrixXd ResidualDataAbstract::whole_Rx() const {
  return whole(blocks, r.size(), ndx_, &ResidualBlock::xcols, &ResidualBlock::Rx);
}
Eigen::MatrixXd ResidualDataAbstract::whole_Ru() const {
  return whole(blocks, r.size(), nu_, &ResidualBlock::ucols, &ResidualBlock::Ru);
}

ResidualModelAbstract::ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu,
                                             Dependence on)
    : state_(std::move(state)),
      nr_(nr),
      nu_(internal::nu_or_default(state_, nu)),
      on_(on),
      unone_(Eigen::VectorXd::Zero(nu_)) {}

ResidualModelAbstract::ResidualModelAbstract(std::shared_ptr<StateAbstract> state, std::size_t nr, std::size_t nu,
                                             bool q_dependent, bool v_dependent, bool u_dependent)
    : ResidualModelAbstract(std::move(state), nr, nu, Dependence{q_dependent, v_dependent, u_dependent}) {
  whole_ = true;
}

void ResidualModelAbstract::calc(const DataPtr& data, const ConstVectorRef& x) {
  if (get_u_dependent())
    data->r.setZero();
  else
    calc(data, x, unone_);
}

void ResidualModelAbstract::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  differentiate(data, x, u);
  if (data->Rx.size() == 0 && data->Ru.size() == 0) return;
  data->Rx = data->whole_Rx();
  data->Ru = data->whole_Ru();
}

void ResidualModelAbstract::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  if (!get_u_dependent()) return calcDiff(data, x, unone_);
  if (whole_) {
    data->Rx.setZero();
    return;
  }
  differentiate(data, x);
  if (data->Rx.size() > 0) data->Rx = data->whole_Rx();
}

void ResidualModelAbstract::differentiate(const DataPtr&, const ConstVectorRef&, const ConstVectorRef&) {
  throw std::logic_error(
      "ResidualModelAbstract::calcDiff: the residual has no derivatives, define calcDiff in the class of the residual");
}

void ResidualModelAbstract::differentiate(const DataPtr& data, const ConstVectorRef& x) {
  if (!get_u_dependent()) return differentiate(data, x, unone_);
  for (ResidualBlock& block : data->blocks) block.Rx.setZero();
}

void ResidualModelAbstract::take_whole(ResidualDataAbstract& data) const {
  if (!whole_) return;
  data.blocks[0].Rx = data.Rx;
  if (data.blocks[0].Ru.cols() == data.Ru.cols()) data.blocks[0].Ru = data.Ru;
}

std::shared_ptr<ResidualDataAbstract> ResidualModelAbstract::createData(DataCollector* shared) {
  auto data = std::make_shared<ResidualDataAbstract>(this, shared);
  lay_out(*data);
  return data;
}

void ResidualModelAbstract::lay_out(ResidualDataAbstract& data) const {
  data.blocks.clear();
  const auto all = [](std::size_t n) { return internal::range(0, static_cast<int>(n)); };
  data.blocks.emplace_back(all(nr_), all(state_->get_ndx()), all(get_u_dependent() ? nu_ : 0));
}

}  // namespace manycontact
