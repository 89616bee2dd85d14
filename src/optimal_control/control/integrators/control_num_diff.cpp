#include "../../action/assign.hpp"
#include "../../action/differences.hpp"
#include "manycontact/control/control_parametrization.hpp"

namespace manycontact {

using NumDiff = ControlParametrizationModelNumDiff;
using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

namespace {

constexpr const char* kControlNumDiff = "ControlParametrizationModelNumDiff";

ControlParametrizationDataNumDiff& own(const NumDiff::Data& data) {
  return internal::own_data<ControlParametrizationDataNumDiff>(kControlNumDiff, data);
}

}  // namespace

ControlParametrizationDataNumDiff::ControlParametrizationDataNumDiff(const NumDiff* model)
    : ControlParametrizationDataAbstract(model), data_0(model->get_model()->createData()) {}

NumDiff::ControlParametrizationModelNumDiff(std::shared_ptr<ControlParametrizationModelAbstract> model)
    : ControlParametrizationModelAbstract(internal::given(kControlNumDiff, model)->get_nw(), model->get_nu()),
      NumDiffOf(kControlNumDiff, model) {}

NumDiff::Data NumDiff::createData() { return std::make_shared<ControlParametrizationDataNumDiff>(this); }

void NumDiff::calc(const Data& data, double t, const ConstVectorRef& u) const {
  auto& d = own(data);
  model_->calc(d.data_0, t, u);
  d.w = d.data_0->w;
}

void NumDiff::calcDiff(const Data& data, double t, const ConstVectorRef& u) const {
  auto& d = own(data);
  d.dw_du = internal::jacobian_by_u(static_cast<Eigen::Index>(nw_), u, step_, [&](const Eigen::VectorXd& at) {
    model_->calc(d.data_0, t, at);
    return d.data_0->w;
  });
  calc(data, t, u);
}

void NumDiff::params(const Data& data, double t, const ConstVectorRef& w) const {
  auto& d = own(data);
  model_->params(d.data_0, t, w);
  d.u = d.data_0->u;
}

void NumDiff::multiplyByJacobian(const Data& data, const ConstMatrixRef& A, MatrixRef out, AssignmentOp op) const {
  internal::assign(out, A * own(data).dw_du, op);
}

void NumDiff::multiplyJacobianTransposeBy(const Data& data, const ConstMatrixRef& A, MatrixRef out,
                                          AssignmentOp op) const {
  internal::assign(out, own(data).dw_du.transpose() * A, op);
}

}  // namespace manycontact
