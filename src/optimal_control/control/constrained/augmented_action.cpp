#include "manycontact/detail/control/augmented_action.hpp"

#include <cmath>

#include "constraint_rows.hpp"
#include "manycontact/sparse/panel_kernels.hpp"

namespace manycontact {

using DataPtr = std::shared_ptr<ActionDataAbstract>;
using internal::ConstraintRows;
using Index = Eigen::Index;

ActionDataAugmentedLagrangian::ActionDataAugmentedLagrangian(ActionModelAugmentedLagrangian* model,
                                                             std::shared_ptr<ActionDataAbstract> data)
    : ActionDataAbstract(model), inner(data ? std::move(data) : model->get_model()->createData()) {
  const ActionModelAbstract& own = *model->get_model();
  const auto rows = static_cast<Index>(std::max(own.get_ng() + own.get_nh(), own.get_ng_T() + own.get_nh_T()));
  const std::size_t ld = sparse::padded(Lx.size() + Lu.size());
  y_next.setZero(rows);
  panel.assign(rows * ld, 0);
  product.assign(ld * ld, 0);
}

ActionModelAugmentedLagrangian::ActionModelAugmentedLagrangian(std::shared_ptr<ActionModelAbstract> model)
    : NodeWithData(internal::given(kName, model)->get_state(), internal::given(kName, model)->get_nu()),
      model_(std::move(model)),
      y_(Eigen::VectorXd::Zero(static_cast<Index>(model_->get_ng() + model_->get_nh()))) {
  u_lb_ = model_->get_u_lb();
  u_ub_ = model_->get_u_ub();
  update_has_control_limits();
}

void ActionModelAugmentedLagrangian::set_penalty(double rho) {
  require(rho > 0 && std::isfinite(rho), kName, "a positive penalty is expected");
  rho_ = rho;
}

DataPtr ActionModelAugmentedLagrangian::createData(DataPtr inner) {
  require(model_->checkData(inner), kName,
          "the data belong to another model, data of the model's createData() are expected");
  require(inner->Fx.rows() == static_cast<Index>(state_->get_ndx()), kName,
          "the model's data have no matrices (ActionModelParts with storage kSparse), kDense is expected");
  return std::make_shared<ActionDataAugmentedLagrangian>(this, std::move(inner));
}

bool ActionModelAugmentedLagrangian::checkData(const DataPtr& data) {
  const auto* d = dynamic_cast<ActionDataAugmentedLagrangian*>(data.get());
  return d && model_->checkData(d->inner);
}

// Adds the constraint terms to the cost. A row of value c, multiplier y and next multiplier y+ adds d (y + y+) / 2 if
// it is active (y+ /= 0), where d = c - bound. Otherwise it adds -y^2 / (2 rho), where rho is the penalty.
void ActionModelAugmentedLagrangian::evaluate(ActionDataAugmentedLagrangian& d, const ConstVectorRef& x,
                                              const ConstVectorRef* u) {
  u ? model_->calc(d.inner, x, *u) : model_->calc(d.inner, x);
  const ConstraintRows rows(*model_, !u);
  check_size(kName, "the multipliers", y_.size(), static_cast<std::size_t>(rows.size()));
  if (d.y_next.size() != rows.size()) d.y_next.resize(rows.size());
  d.xnext = d.inner->xnext;
  d.cost = with_cost_ ? d.inner->cost : 0;
  for (Index i = 0; i < rows.size(); ++i) {
    const double y = y_[i], next = rows.next_multiplier(*d.inner, i, y, rho_);
    d.y_next[i] = next;
    if (next == 0)
      d.cost -= 0.5 * y * y / rho_;
    else
      d.cost += 0.5 * (rows.value(*d.inner, i) - (next > 0 ? rows.upper(i) : rows.lower(i))) * (y + next);
  }
}

void ActionModelAugmentedLagrangian::differentiate(ActionDataAugmentedLagrangian& d, const ConstVectorRef& x,
                                                   const ConstVectorRef* u) {
  u ? model_->calcDiff(d.inner, x, *u) : model_->calcDiff(d.inner, x);
  const ActionDataAbstract& in = *d.inner;
  const bool terminal = !u;
  const ConstraintRows rows(*model_, terminal);
  const Index nx = d.Lx.size(), nu = terminal ? 0 : d.Lu.size();
  const int cols = static_cast<int>(nu + nx), ld = sparse::padded(cols);
  if (d.panel.size() < static_cast<std::size_t>(rows.size() * ld)) d.panel.resize(rows.size() * ld);
  d.Fx = in.Fx, d.Lx = in.Lx, d.Lxx = in.Lxx;
  if (!terminal) d.Fu = in.Fu, d.Lu = in.Lu, d.Lxu = in.Lxu, d.Luu = in.Luu;
  if (!with_cost_) {
    for (Eigen::VectorXd* l : {&d.Lx, &d.Lu}) l->setZero();
    for (Eigen::MatrixXd* L : {&d.Lxx, &d.Lxu, &d.Luu}) L->setZero();
  }

  int active = 0;
  const double root = std::sqrt(rho_);
  for (Index i = 0; i < rows.size(); ++i) {
    if (d.y_next[i] == 0 && rows.lower(i) != rows.upper(i)) continue;
    Eigen::Map<Eigen::RowVectorXd> row(d.panel.data() + active++ * ld, ld);
    row.segment(nu, nx) = root * rows.x_row(in, i);
    row.tail(ld - cols).setZero();
    d.Lx += d.y_next[i] * rows.x_row(in, i).transpose();
    if (terminal) continue;
    row.head(nu) = root * rows.u_row(in, i);
    d.Lu += d.y_next[i] * rows.u_row(in, i).transpose();
  }
  if (active == 0) return;
  double* H = d.product.data();  // product of the panel's transpose and the panel; only its upper triangle is set
  sparse::panel_kernels().upper_product(d.panel.data(), d.panel.data(), active, cols, ld, H);
  for (Index j = 0; j < cols; ++j)
    for (Index i = 0; i <= j; ++i) {
      const double h = H[i * ld + j];
      if (j < nu) {
        d.Luu(i, j) += h;
        if (i != j) d.Luu(j, i) += h;
      } else if (i < nu) {
        d.Lxu(j - nu, i) += h;
      } else {
        d.Lxx(i - nu, j - nu) += h;
        if (i != j) d.Lxx(j - nu, i - nu) += h;
      }
    }
}

void ActionModelAugmentedLagrangian::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x,
                                                 std::size_t maxiter, double tol) {
  const ConstVectorRef given = u;
  model_->quasiStatic(own("quasiStatic", data, x, &given).inner, u, x, maxiter, tol);
}

}  // namespace manycontact
