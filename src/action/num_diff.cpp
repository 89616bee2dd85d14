#include "manycontact/action/num_diff.hpp"

#include <cmath>
#include <ostream>

namespace manycontact {

using NumDiff = DifferentialActionModelNumDiff;
using DataPtr = std::shared_ptr<DifferentialActionDataAbstract>;

DifferentialActionDataNumDiff::DifferentialActionDataNumDiff(NumDiff* model)
    : DifferentialActionDataAbstract(model),
      data_0(model->get_model()->createData()),
      data_step(model->get_model()->createData()) {}

namespace {

const DifferentialActionModelAbstract& given(const std::shared_ptr<DifferentialActionModelAbstract>& model) {
  require(model != nullptr, "DifferentialActionModelNumDiff", "a model is expected, not a null pointer");
  return *model;
}

}  // namespace

NumDiff::DifferentialActionModelNumDiff(std::shared_ptr<DifferentialActionModelAbstract> model, bool with_gauss_approx)
    : DifferentialActionModelAbstract(given(model).get_state(), given(model).get_nu()),
      model_(std::move(model)),
      gauss_(with_gauss_approx),
      step_(std::cbrt(std::numeric_limits<double>::epsilon())) {
  u_lb_ = model_->get_u_lb();
  u_ub_ = model_->get_u_ub();
  update_has_control_limits();
}

void NumDiff::set_disturbance(double disturbance) {
  require(disturbance > 0 && std::isfinite(disturbance), "DifferentialActionModelNumDiff::set_disturbance",
          std::to_string(disturbance) + " was given, a positive number is expected");
  step_ = disturbance;
}

DataPtr NumDiff::createData() { return std::make_shared<DifferentialActionDataNumDiff>(this); }

namespace {

DifferentialActionDataNumDiff& own(const DataPtr& data) {
  auto* d = dynamic_cast<DifferentialActionDataNumDiff*>(&check_data("DifferentialActionModelNumDiff", data));
  require(d, "DifferentialActionModelNumDiff",
          "the data were created by another model, data of this one's createData() are expected");
  return *d;
}

void copy_values(const DifferentialActionDataAbstract& from, DifferentialActionDataAbstract& to) {
  to.xout = from.xout;
  to.cost = from.cost;
  to.r = from.r;
  to.g = from.g;
  to.h = from.h;
}

// d of column i by a central difference of two values.
template <class A, class B>
void column(const A& plus, const B& minus, double h, Eigen::Index i, Eigen::MatrixXd& out) {
  out.col(i) = (plus - minus) / (2 * h);
}

}  // namespace

// The model around a point: x moved along the tangent, u as it is, or the reverse.
struct NumDiff::At {
  DifferentialActionModelAbstract& model;
  DataPtr data;
  Eigen::VectorXd x, u;
  bool terminal;

  const DifferentialActionDataAbstract& operator()(const Eigen::VectorXd& dx_, const Eigen::VectorXd& du) {
    const Eigen::VectorXd at = model.get_state()->integrate_x(x, dx_);
    if (terminal)
      model.calc(data, at);
    else
      model.calc(data, at, u + du);
    return *data;
  }
};

void NumDiff::calc(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  DifferentialActionDataNumDiff& d = own(data);
  model_->calc(d.data_0, x, u);
  copy_values(*d.data_0, d);
}

void NumDiff::calc(const DataPtr& data, const ConstVectorRef& x) {
  DifferentialActionDataNumDiff& d = own(data);
  model_->calc(d.data_0, x);
  copy_values(*d.data_0, d);
}

void NumDiff::differentiate(DifferentialActionDataAbstract& data, At& at, bool terminal) const {
  auto& d = static_cast<DifferentialActionDataNumDiff&>(data);
  const Eigen::Index ndx = state_->get_ndx(), nu = nu_, nv = state_->get_nv();
  const Eigen::Index nr = d.r.size(), ng = d.g.size(), nh = d.h.size();
  d.Fx.setZero(nv, ndx), d.Fu.setZero(nv, nu);
  d.Rx.setZero(nr, ndx), d.Ru.setZero(nr, nu);
  d.Gx.setZero(ng, ndx), d.Gu.setZero(ng, nu);
  d.Hx.setZero(nh, ndx), d.Hu.setZero(nh, nu);
  const auto differ = [&](bool by_x, Eigen::Index i, Eigen::VectorXd& L, Eigen::MatrixXd& F, Eigen::MatrixXd& R,
                          Eigen::MatrixXd& G, Eigen::MatrixXd& H) {
    Eigen::VectorXd dx = Eigen::VectorXd::Zero(ndx), du = Eigen::VectorXd::Zero(nu);
    const double h = by_x ? step_ : step_ * std::max(1.0, std::abs(at.u[i]));
    (by_x ? dx : du)[i] = h;
    DifferentialActionDataAbstract plus(this);
    copy_values(at(dx, du), plus);
    const DifferentialActionDataAbstract& minus = at(-dx, -du);
    L[i] = (plus.cost - minus.cost) / (2 * h);
    if (!terminal) column(plus.xout, minus.xout, h, i, F);
    column(plus.r, minus.r, h, i, R);
    column(plus.g, minus.g, h, i, G);
    column(plus.h, minus.h, h, i, H);
  };
  for (Eigen::Index i = 0; i < ndx; ++i) differ(true, i, d.Lx, d.Fx, d.Rx, d.Gx, d.Hx);
  for (Eigen::Index i = 0; i < nu && !terminal; ++i) differ(false, i, d.Lu, d.Fu, d.Ru, d.Gu, d.Hu);
  if (gauss_) {
    d.Lxx = d.Rx.transpose() * d.Rx;
    d.Lxu = d.Rx.transpose() * d.Ru;
    d.Luu = d.Ru.transpose() * d.Ru;
  } else {
    second_differences(d, at, terminal);
  }
}

// L_ij = (L(+,+) - L(+,-) - L(-,+) + L(-,-)) / 4h^2
void NumDiff::second_differences(DifferentialActionDataAbstract& d, At& at, bool terminal) const {
  const Eigen::Index ndx = state_->get_ndx(), n = ndx + (terminal ? 0 : static_cast<Eigen::Index>(nu_));
  const double h = std::pow(std::numeric_limits<double>::epsilon(), 0.25);
  Eigen::MatrixXd L(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      double sum = 0;
      for (int s : {1, -1})
        for (int t : {1, -1}) {
          Eigen::VectorXd dz = Eigen::VectorXd::Zero(ndx + nu_);
          dz[i] += s * h;
          dz[j] += t * h;
          sum += s * t * at(dz.head(ndx), dz.tail(nu_)).cost;
        }
      L(i, j) = L(j, i) = sum / (4 * h * h);
    }
  d.Lxx = L.topLeftCorner(ndx, ndx);
  if (terminal) return;
  d.Lxu = L.topRightCorner(ndx, nu_);
  d.Luu = L.bottomRightCorner(nu_, nu_);
}

void NumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& x, const ConstVectorRef& u) {
  DifferentialActionDataNumDiff& d = own(data);
  At at{*model_, d.data_step, x, u, false};
  differentiate(d, at, false);
}

void NumDiff::calcDiff(const DataPtr& data, const ConstVectorRef& x) {
  DifferentialActionDataNumDiff& d = own(data);
  At at{*model_, d.data_step, x, Eigen::VectorXd::Zero(nu_), true};
  differentiate(d, at, true);
}

void NumDiff::quasiStatic(const DataPtr& data, VectorRef u, const ConstVectorRef& x, std::size_t maxiter, double tol) {
  model_->quasiStatic(own(data).data_0, u, x, maxiter, tol);
}

void NumDiff::print(std::ostream& os) const { os << "DifferentialActionModelNumDiff {" << *model_ << "}"; }

}  // namespace manycontact
